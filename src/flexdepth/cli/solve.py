"""`flexdepth solve KEY TARGET`: depth and motion of every pixel from two frames."""

import json
import sys
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from os import path as place
from pathlib import Path
from typing import Annotated, Literal

import tyro
from rich.console import Console

from flexdepth.cli.arguments import told_in_one_line
from flexdepth.flow.dis import Dis
from flexdepth.runtime.errors import InputError, one_line
from flexdepth.runtime.lens import FieldOfView, FocalLength, Lens
from flexdepth.scenes.correspondence import FILE_NOISE, FlowFile, FlowMethod, RaftFlow
from flexdepth.scenes.files import all_made, products, write_solution
from flexdepth.scenes.objective import Objective
from flexdepth.scenes.origin import origin
from flexdepth.scenes.pair import LONG_SIDE, PairSettings, solve
from flexdepth.scenes.prior import BUNDLED
from flexdepth.scenes.views import ViewFiles

_Flag = Annotated[bool, tyro.conf.FlagCreatePairsOff, tyro.conf.arg(help_behavior_hint="")]
_Frame = Annotated[Path | None, tyro.conf.arg(metavar="FRAME", help_behavior_hint="")]
_File = Annotated[Path | None, tyro.conf.arg(metavar="FILE", help_behavior_hint="")]


@dataclass(frozen=True)
class Solve:
    """Find depth and motion of every pixel of KEY in two frames of a scene in which things move.

    In DIR: depth.npz; motion.npz with each pixel's rotation and translation; solution.npz with
    masks, parallax, residual and how far to trust them; solution.json with the camera's own
    motion and the parts that move; solution.png, which shows it all; motion.png, moving.png,
    borders.png; cloud.glb with arrows where things move. Depth is in units of the camera's way,
    or in metres with --stereo, or where the focal length is known and a model tells metres.
    Where two frames do not tell depth, there is none, and solution.npz says why.
    """

    key: Annotated[Path, tyro.conf.Positional, tyro.conf.arg(metavar="KEY", help_behavior_hint="")]
    """The frame whose depth is sought."""
    target: Annotated[
        Path, tyro.conf.Positional, tyro.conf.arg(metavar="TARGET", help_behavior_hint="")
    ]
    """Another frame of the same camera, a moment later or earlier."""
    output_dir: Annotated[Path, tyro.conf.arg(aliases=("-o",), metavar="DIR")] = Path("solution")
    """Where the outputs go."""
    focal: Annotated[float | None, tyro.conf.arg(metavar="PIXELS", help_behavior_hint="")] = None
    """Focal length in pixels of the frames. Without it the frames' EXIF, or else a guess."""
    fov: Annotated[float | None, tyro.conf.arg(metavar="DEGREES", help_behavior_hint="")] = None
    """Field of view from the left edge to the right, instead of --focal."""
    camera: _File = None
    """A file that says fx fy cx cy (see docs/solve.md), instead of --focal."""
    flow_method: Literal["dis", "raft"] = "dis"
    """How the frames are matched: OpenCV's dense inverse search, or torchvision's RAFT."""
    flow_weights: _File = None
    """RAFT's weights, .pth or .safetensors as torchvision has them; nothing is downloaded."""
    flow: Annotated[Path | None, tyro.conf.arg(metavar="FLO", help_behavior_hint="")] = None
    """The flow from KEY to TARGET instead: a .flo file, or a 16-bit PNG as KITTI has it."""
    flow_noise: Annotated[float, tyro.conf.arg(metavar="PIXELS")] = FILE_NOISE
    """How far the flow in --flow errs (one standard deviation)."""
    prior: Annotated[str, tyro.conf.arg(metavar="MODEL|none")] = BUNDLED
    """Model whose depth of KEY alone helps where two frames do not tell, named as for predict;
    none: geometry alone."""
    third: _Frame = None
    """One more frame, such as the one before KEY: shows what TARGET hides."""
    stereo: Annotated[Path | None, tyro.conf.arg(metavar="RIGHT", help_behavior_hint="")] = None
    """The right camera's picture of the moment of KEY, rectified. Needs --baseline."""
    baseline: Annotated[float | None, tyro.conf.arg(metavar="METRES", help_behavior_hint="")] = None
    """How far the right camera is beside the left one."""
    objective: Annotated[Objective, tyro.conf.EnumChoicesFromValues] = Objective.DENSE
    """What is minimised: everything at every pixel; regions alone, which is faster; or chapter 5 of
    the dissertation, as written or corrected, which is slow and only to be compared with."""
    long_side: Annotated[int, tyro.conf.arg(metavar="PIXELS")] = LONG_SIDE
    """Larger frames are made so small first, and so are the outputs."""
    cloud: Annotated[
        tuple[Literal["glb", "ply"], ...],
        tyro.conf.UseAppendAction,
        tyro.conf.arg(help_behavior_hint="(glb; may be repeated)"),
    ] = ()
    """Format of the coloured points with arrows."""
    overwrite: _Flag = False
    """Replace what lies in the place of an output."""
    json: _Flag = False
    """Print solution.json, for scripts, instead of words."""


def run(arguments: Sequence[str]) -> int:
    """Solve the frames that `arguments` name."""
    with told_in_one_line("flexdepth solve"):
        settings = tyro.cli(Solve, args=arguments, prog="flexdepth solve")
    begin = time.monotonic()
    if place.isfile(settings.output_dir):
        raise InputError(f"--output-dir: {settings.output_dir} is a file, wanted a folder")
    wanted, pair = products(settings.cloud or ("glb",)), pair_of(settings)
    made_from = origin(pair)
    folder = settings.output_dir
    if all_made(wanted, folder, made_from, settings.overwrite):
        told, words = tuple(folder / each.name for each in wanted), "made before, from the same"
    else:
        with _said() as say:
            solution = solve(pair, say)
            say("writing")
            told = write_solution(solution, wanted, folder, made_from)
        words = f"done in {time.monotonic() - begin:.1f} s"
    document = json.loads((folder / "solution.json").read_text("ascii"))
    if settings.json:
        sys.stdout.write(json.dumps({**document, "outputs": list(map(str, told))}, indent=1) + "\n")
        return 0
    sys.stdout.write("".join(f"{path}\n" for path in told))
    lines = [*document["summary"], *document["warnings"], words]
    sys.stderr.write("".join(f"flexdepth: {one_line(line)}\n" for line in lines))
    return 0


def pair_of(settings: Solve) -> PairSettings:
    """Return what the settings ask to be solved.

    Raises:
        InputError: Two settings contradict each other, or one needs another.
    """
    return PairSettings(
        ViewFiles(settings.key, settings.target, settings.third, settings.stereo),
        _camera(settings),
        _flow(settings),
        None if settings.prior == "none" else settings.prior,
        settings.baseline,
        settings.objective,
        settings.long_side,
    )


def _camera(settings: Solve) -> Lens | Path | None:
    named = {"--focal": settings.focal, "--fov": settings.fov, "--camera": settings.camera}
    given = [name for name, value in named.items() if value is not None]
    if len(given) > 1:
        raise InputError(f"{' and '.join(given)} say the same thing: give one of them")
    if settings.focal is not None:
        return FocalLength(settings.focal)
    return settings.camera if settings.fov is None else FieldOfView(settings.fov)


def _flow(settings: Solve) -> FlowMethod:
    if settings.flow_weights is not None and settings.flow_method != "raft":
        raise InputError("--flow-weights are RAFT's: say --flow-method raft too")
    if settings.flow is not None and settings.flow_method == "raft":
        raise InputError("--flow and --flow-method raft are two flows: give one of them")
    if settings.flow is None and settings.flow_noise != FILE_NOISE:
        raise InputError("--flow-noise is of the flow in --flow; other flow's noise is measured")
    if settings.flow is not None:
        return FlowFile(settings.flow, settings.flow_noise)
    if settings.flow_method == "dis":
        return Dis()
    if settings.flow_weights is None:
        raise InputError(
            "--flow-method raft needs --flow-weights, a file that torchvision publishes, such as "
            "raft_large_C_T_SKHT_V2-ff5fadd5.pth; flexdepth downloads nothing"
        )
    return RaftFlow(settings.flow_weights)


@contextmanager
def _said() -> Iterator[Callable[[str], None]]:
    """Give what is told what is being done, and shows it to a person at a terminal."""
    console = Console(stderr=True)
    if not console.is_terminal:
        yield lambda _step: None
        return
    with console.status("") as status:
        yield status.update
