"""Which network, losses, sizes and augmentation: short trainings beside one another.

    python benchmarks/choices.py --data DIR --held-out DIR [--samples DIR] [--only NAME ...]
                                 [--iterations N] [-o DIR]
    python benchmarks/choices.py --weights DIR [--held-out DIR] [--samples DIR] [--only NAME ...]

Every variant (variants.py) differs from `compact`, at 160x128, in one thing. All start from the
same seed and, but for those that change the batches themselves, see the same batches; `again` is
`compact` with another seed, and says how much of a difference is luck. Each is judged, at the size
it learnt at, on rendered scenes that were not trained on, by its averaged weights and by those of
the last iteration: AbsRel and delta1 fitted in disparity, AbsRel of metres with the true focal
length, boundary F1. With --samples it is judged on photos too (docs/samples.md): AbsRel fitted in
disparity and as metres as `quality.py` has them, of the network's own map enlarged, the means over
the sets that choices are made on. With -o, averaged weights are written, half-precision, one file
a variant; --weights judges those instead of training. Prints one line of JSON a variant. Uses a
GPU where there is one.
"""

import argparse
import json
import time
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path

import torch
from judges import Judges
from safetensors.torch import load_file, save_file
from torch import Tensor, nn
from variants import VARIANTS, Variant, built, network_of, terms_of

from flexdepth.data.folder import Folder
from flexdepth.networks.compact import CompactNetwork
from flexdepth.runtime.errors import InputError
from flexdepth.tensors import moved
from flexdepth.training.averaging import follow
from flexdepth.training.batches import Batches, Pairs, loader
from flexdepth.training.loop import LoopSettings, Run, learn
from flexdepth.training.objective import check_finite
from flexdepth.training.optimiser import set_rate
from flexdepth.training.processes import Place


def trained(
    variants: Mapping[str, Variant], data: Pairs, loop: LoopSettings, processes: int, place: Place
) -> Mapping[str, Run]:
    """Train variants that see the same batches, each batch by one after another."""
    runs = {name: Run.started(built(each), loop, place) for name, each in variants.items()}
    batches = next(iter(variants.values())).batches
    for number, batch in enumerate(loader(Batches(data, batches, loop.iterations), 0, processes)):
        seen = moved(batch, place.device)
        rate = loop.optimiser.rate_at(number, loop.iterations)
        for name, run in runs.items():
            set_rate(run.optimiser, rate)
            check_finite(learn(run.network, loop, terms_of(variants[name]), seen), number)
            nn.utils.clip_grad_norm_(run.network.parameters(), loop.optimiser.largest_gradient)
            run.optimiser.step()
            follow(run.average, run.network, number, loop.average_decay)
    return runs


def groups(names: Sequence[str]) -> list[dict[str, Variant]]:
    """Return the wanted variants, those together that see the same batches."""
    found: list[dict[str, Variant]] = []
    for name in names:
        variant = VARIANTS[name]
        same = [g for g in found if next(iter(g.values())).batches == variant.batches]
        if same:
            same[0][name] = variant
        else:
            found.append({name: variant})
    return found


def kept(name: str, folder: Path) -> CompactNetwork:
    """Return a variant's network with the averaged weights of an earlier run.

    The spread, which is not judged, keeps its first weights.

    Raises:
        InputError: The file is missing, or of another network.
    """
    path = folder / f"{name}.safetensors"
    if not path.is_file():
        raise InputError(f"{path}: no such file; train with -o {folder}")
    network = network_of(VARIANTS[name])
    spread = {k: v for k, v in network.state_dict().items() if k.startswith("spread.")}
    stored = {k: v for k, v in load_file(path).items() if not k.startswith("spread.")}
    try:
        network.load_state_dict(spread | stored)
    except RuntimeError as error:
        raise InputError(f"{path}: not of the variant {name}: {error}") from error
    return network


def judged_again(
    names: Sequence[str], folder: Path, judges: Judges, place: Place
) -> Iterator[Mapping[str, object]]:
    """Yield what is printed of the weights of an earlier run."""
    for name in names:
        network = kept(name, folder).to(place.device)
        yield {"variant": name, "averaged": judges.figures(network, VARIANTS[name].size, place)}


def trained_and_judged(
    names: Sequence[str], options: argparse.Namespace, judges: Judges, place: Place
) -> Iterator[Mapping[str, object]]:
    """Train, keep the weights if wanted, and yield what is printed."""
    data = Folder(options.data).load()
    loop = LoopSettings(iterations=options.iterations, average_decay=0.99)
    for group in groups(names):
        start = time.monotonic()
        runs = trained(group, data, loop, options.processes, place)
        seconds = round(time.monotonic() - start, 1)
        for name, run in runs.items():
            figures = {
                "averaged": judges.figures(run.average, VARIANTS[name].size, place),
                "last": judges.figures(run.network, VARIANTS[name].size, place),
            }
            if options.output_dir is not None:
                options.output_dir.mkdir(parents=True, exist_ok=True)
                weights = {k: half(v) for k, v in run.average.state_dict().items()}
                save_file(weights, options.output_dir / f"{name}.safetensors")
            yield {"variant": name, "group_seconds": seconds, **figures}


def main() -> None:
    """Train or take what was trained, judge and print."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    origin = parser.add_mutually_exclusive_group(required=True)
    origin.add_argument("--data", type=Path, help="a folder of flexdepth synth to train on")
    origin.add_argument("--weights", type=Path, metavar="DIR", help="judge what -o DIR wrote")
    parser.add_argument("--held-out", type=Path, metavar="DIR", help="renders to judge by")
    parser.add_argument("--samples", type=Path, metavar="DIR", help="photos to judge by")
    parser.add_argument("--only", action="append", choices=VARIANTS, help="may be repeated")
    parser.add_argument("--iterations", type=int, default=240)
    parser.add_argument("--processes", type=int, default=2, help="that make batches")
    parser.add_argument("-o", "--output-dir", type=Path)
    options = parser.parse_args()
    written = options.output_dir if options.weights is None else None
    if options.held_out is None and options.samples is None and written is None:
        parser.error("nothing to judge by: name --held-out DIR, --samples DIR or both")
    place = Place(device="cuda" if torch.cuda.is_available() else "cpu")
    held_out = Folder(options.held_out).load() if options.held_out else None
    judges = Judges(held_out, options.samples)
    names = options.only or list(VARIANTS)
    if options.weights is None:
        lines = trained_and_judged(names, options, judges, place)
    else:
        lines = judged_again(names, options.weights, judges, place)
    for line in lines:
        print(json.dumps(line), flush=True)


def half(value: Tensor) -> Tensor:
    """Return weights in half precision, counts as they are."""
    return (value.half() if value.is_floating_point() else value).cpu().contiguous()


if __name__ == "__main__":
    try:
        main()
    except InputError as error:
        raise SystemExit(f"error: {error}") from error
