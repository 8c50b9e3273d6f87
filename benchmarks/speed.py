"""How fast flexdepth is on this machine and how much memory it takes, beside the bars.

    python benchmarks/speed.py [--runs N] [--pairs N] [--threads N] [--json] [--strict]

Each command is a process of its own, from its start to its end, once uncounted and then --runs
times; the median counts. The network is timed in turn with the MiDaS v2.1 small architecture
(midas_small.py) in this process, A B A B, and the median over the pairs of the ratio counts. Wall
clock is what the bars are about; it grows on a busy machine, CPU time (user and system, all
threads) much less. Nothing is downloaded.
"""

import argparse
import json
import os
import platform
import shutil
import sys
import sysconfig
import tempfile
from collections.abc import Callable, Iterator, Sequence
from dataclasses import asdict, dataclass
from itertools import chain
from pathlib import Path
from statistics import median
from typing import Any

import numpy as np
import onnxruntime as ort
from PIL import Image, ImageChops
from runs import Run, child, in_turn, inside
from verdict import MISS, verdict

from flexdepth.runtime.errors import InputError
from flexdepth.runtime.model import load_model
from flexdepth.runtime.sizes import network_size

PHOTO = Path(__file__).parents[1] / "examples" / "coffee.png"
MIDAS = Path(__file__).parent / "midas_small.py"
SMALL, LARGE = (640, 480), (4000, 3000)
GRAIN = 6.0
"""Standard deviation of the grain, of 255: an enlarged picture would decode faster than a photo."""
QUIET = 0.5
"""The load average, in processes, above which the machine is called busy."""


@dataclass(frozen=True)
class Figure:
    """One line of the table: a median over `runs`, or for a peak the largest.

    Attributes:
        value: None where it cannot be measured; `note` says why.
        cpu: The same in CPU time, None where there is no such thing.
        bar: The most that is allowed, None for what is shown for comparison alone.
    """

    name: str
    unit: str
    value: float | None
    cpu: float | None = None
    bar: float | None = None
    runs: tuple[float, ...] = ()
    note: str = ""

    @property
    def verdict(self) -> str:
        """Whether the bar is reached; empty where nothing can be said."""
        if self.bar is None or self.value is None:
            return ""
        return verdict(self.value <= self.bar)


def seconds(name: str, runs: Sequence[Run], bar: float | None = None) -> Figure:
    """Return the median time of runs."""
    walls = tuple(run.wall for run in runs)
    return Figure(name, "s", median(walls), middle([run.cpu for run in runs]), bar, walls)


def middle(values: Sequence[float | None]) -> float | None:
    """Return the median; None where nothing could be measured."""
    known = [value for value in values if value is not None]
    return median(known) if known else None


def memory(name: str, runs: Sequence[Run], bar: float) -> Figure:
    """Return the largest peak of runs, in 10^9 bytes."""
    peaks = tuple(run.peak / 1e9 for run in runs if run.peak is not None)
    if not peaks:
        return Figure(name, "GB", None, bar=bar, note="not measured on Windows")
    return Figure(name, "GB", max(peaks), bar=bar, runs=peaks)


def ratio(name: str, ours: Sequence[Run], theirs: Sequence[Run], bar: float) -> Figure:
    """Return the median over pairs of the time of one as a part of the other's."""
    pairs = list(zip(ours, theirs, strict=True))
    walls = tuple(a.wall / b.wall for a, b in pairs)
    cpu = middle([a.cpu / b.cpu for a, b in pairs if a.cpu and b.cpu])
    return Figure(name, "x", median(walls), cpu, bar, walls)


def make_photo(path: Path, size: tuple[int, int]) -> None:
    """Write the example picture as a JPEG of this size, with the grain of a camera."""
    grain = Image.effect_noise(size, GRAIN)
    with Image.open(PHOTO) as picture:
        photo = picture.convert("RGB").resize(size, Image.Resampling.BICUBIC)
    photo = ImageChops.add(photo, Image.merge("RGB", [grain] * 3), offset=-128)
    photo.save(path, quality=90)


def executable() -> str:
    """Return the `flexdepth` of this environment."""
    found = shutil.which("flexdepth", path=sysconfig.get_path("scripts"))
    if found is None:
        raise InputError(f"no flexdepth beside {sys.executable}; install it: pip install -e .")
    return found


def predicted(photo: Path, options: argparse.Namespace) -> list[Run]:
    """Predict one photo from shell to file, --runs times."""
    out = photo.with_suffix("")
    command = [executable(), "predict", str(photo), "-o", str(out)]
    command += ["--threads", str(options.threads)] if options.threads else []
    command += ["--model", str(options.model)] if options.model else []
    runs = []
    for _ in range(options.runs + 1):
        runs.append(child(command))
        if not (out / f"{photo.stem}.npz").is_file():
            raise InputError(f"{' '.join(command)}: wrote no {photo.stem}.npz")
        shutil.rmtree(out)
    return runs[1:]


def commands(folder: Path, options: argparse.Namespace) -> Iterator[Figure]:
    """Yield the figures of processes."""

    def repeated(*command: str) -> list[Run]:
        return [child(command) for _ in range(options.runs + 1)][1:]

    yield seconds("python, doing nothing", repeated(sys.executable, "-c", ""))
    yield seconds("import flexdepth", repeated(sys.executable, "-c", "import flexdepth"), 0.3)
    yield seconds("flexdepth --help", repeated(executable(), "--help"), 0.5)
    make_photo(folder / "small.jpg", SMALL)
    runs = predicted(folder / "small.jpg", options)
    yield seconds("a 640x480 photo, from shell to file", runs, 1.5)
    make_photo(folder / "large.jpg", LARGE)
    runs = predicted(folder / "large.jpg", options)
    yield seconds("a 12-megapixel photo, from shell to file", runs, 3.0)
    yield memory("a 12-megapixel photo, memory at its peak", runs, 1.0)


def networks(folder: Path, options: argparse.Namespace) -> Iterator[Figure]:
    """Yield the figures of the network and of its peer, of which there is none without torch."""
    model = load_model(options.model, threads=options.threads)
    width, height = network_size(*SMALL, model.description)
    ours = f"network, {width}x{height}"
    file = folder / "midas_small.onnx"
    try:
        child([sys.executable, str(MIDAS), str(file)])
    except InputError as error:
        runs = [
            inside(running(model.session.opened, width, height)) for _ in range(options.pairs + 1)
        ][1:]
        yield seconds(ours, runs)
        yield Figure("network / MiDaS-small", "x", None, bar=1.0, note=str(error))
        return
    settings = ort.SessionOptions()
    settings.intra_op_num_threads = options.threads or 0
    peer = ort.InferenceSession(file, settings, providers=["CPUExecutionProvider"])
    side = peer.get_inputs()[0].shape[-1]
    mine, theirs = in_turn(
        running(model.session.opened, width, height), running(peer, side, side), options.pairs
    )
    yield seconds(ours, mine)
    yield seconds(f"MiDaS-small architecture, {side}x{side}", theirs)
    yield ratio("network / MiDaS-small", mine, theirs, 1.0)


def running(session: ort.InferenceSession, width: int, height: int) -> Callable[[], object]:
    """Return a way to run the network once on noise."""
    image = np.random.default_rng(0).random((1, 3, height, width), np.float32)
    return lambda: session.run(None, {"image": image})


def machine(threads: int | None) -> dict[str, Any]:
    """Return what the figures depend on."""
    return {
        "system": platform.platform(),
        "processors": os.cpu_count(),
        "load": None if sys.platform == "win32" else round(os.getloadavg()[0], 1),
        "threads": threads or "one per physical core",
        "python": platform.python_version(),
        "onnxruntime": ort.__version__,
    }


def table(figures: Sequence[Figure]) -> str:
    """Return the figures as text."""
    lines = [f"{'':<42}{'median':>10}{'CPU':>10}{'bar':>10}"]
    for each in figures:
        cells = (number(value, each.unit) for value in (each.value, each.cpu, each.bar))
        line = f"{each.name:<42}{''.join(f'{cell:>10}' for cell in cells)}  {each.verdict}"
        lines.append(line.rstrip())
    return "\n".join(lines + [f"{each.name}: {each.note}" for each in figures if each.note])


def number(value: float | None, unit: str) -> str:
    """Return a figure as a person says it."""
    return "-" if value is None else f"{value:.3f} {unit}"


def arguments() -> argparse.Namespace:
    """Return what the command line says."""

    def count(text: str) -> int:
        if (value := int(text)) < 1:
            raise argparse.ArgumentTypeError(f"wanted a whole number >= 1, got {text}")
        return value

    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--runs", type=count, default=7, help="of each command; default: 7")
    parser.add_argument("--pairs", type=count, default=25, help="of the networks; default: 25")
    parser.add_argument("--threads", type=count, help="default: one per physical core")
    parser.add_argument("--model", type=Path, metavar="BUNDLE", help="default: the one shipped")
    parser.add_argument("--json", action="store_true", help="print JSON instead of the table")
    parser.add_argument("--strict", action="store_true", help="exit with 1 where a bar is missed")
    return parser.parse_args()


def main() -> int:
    """Measure, print, return the exit code."""
    options = arguments()
    about = machine(options.threads)
    with tempfile.TemporaryDirectory() as folder:
        figures = []
        for figure in chain(commands(Path(folder), options), networks(Path(folder), options)):
            print(f"measured: {figure.name}", file=sys.stderr)
            figures.append(figure)
    if options.json:
        said = [asdict(figure) | {"verdict": figure.verdict} for figure in figures]
        print(json.dumps({"machine": about, "figures": said}, indent=2))
    else:
        print(", ".join(f"{name}: {value}" for name, value in about.items()))
        print(table(figures))
        if (about["load"] or 0) > QUIET:
            print(f"the machine was busy (load {about['load']}): wall clock is not to be trusted")
    missed = any(figure.verdict == MISS for figure in figures)
    return 1 if options.strict and missed else 0


if __name__ == "__main__":
    try:
        sys.exit(main())
    except InputError as error:
        print(error, file=sys.stderr)
        sys.exit(2)
