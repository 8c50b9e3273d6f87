"""`flexdepth data check SET` and `flexdepth data convert SET`: data sets as they are published."""

import sys
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Annotated, Any, Generic, Literal, TypeVar

import tyro
from PIL import Image

from flexdepth.cli.progress import counted
from flexdepth.cli.sets import listed_sets, named_set, parsed
from flexdepth.data.catalogue import DATASETS
from flexdepth.data.conversion import convert
from flexdepth.data.doctor import Checkup, checkup, contact_sheet, spread_out
from flexdepth.data.folder import Pair
from flexdepth.data.verdicts import Verdict
from flexdepth.runtime.atomic import replacing
from flexdepth.runtime.depthmap import DepthMap
from flexdepth.runtime.errors import InputError
from flexdepth.runtime.files import SUFFIXES
from flexdepth.runtime.lens import FocalLength
from flexdepth.runtime.model import Model, load_model
from flexdepth.runtime.predictor import Predictor

_FOUND = 2

_PAGE = """\
usage: flexdepth data check SET [options]  say what is wrong with a data set
       flexdepth data convert SET -o DIR   make it a folder of image/ and depth/

flexdepth data check SET --help lists what a set takes; --root is its folder.
The sets:
{sets}
"""

Data = TypeVar("Data")


@dataclass(frozen=True)
class Check(Generic[Data]):
    """Look for a wrong depth scale, missing, repeated or shifted depth, wrong cameras, saturation.

    A sample of the pairs is compared with the bundled model, with the edges of the pictures and
    with the right angles of what people build. Prints a verdict for each check and writes a sheet
    of pictures. Exit code 2 where something was found.
    """

    data: Annotated[Data, tyro.conf.arg(name="")]
    """The set's own settings."""
    pairs: Annotated[int, tyro.conf.arg(metavar="N")] = 24
    """How many pairs are looked at, evenly spread over the set."""
    sheet: Annotated[Path, tyro.conf.arg(metavar="FILE")] = Path("check.png")
    """Where the sheet of pictures goes (PNG)."""


@dataclass(frozen=True)
class Convert(Generic[Data]):
    """Write every pair to DIR/image/NAME.png and DIR/depth/NAME.npz.

    What is there already is left alone; an interrupted conversion goes on.
    """

    data: Annotated[Data, tyro.conf.arg(name="")]
    """The set's own settings."""
    output_dir: Annotated[Path, tyro.conf.arg(aliases=("-o",), metavar="DIR")]
    """Where the files go."""
    format: Literal["npz", "npy", "png16", "exr", "pfm"] = "npz"
    """Of the depth files. png16 is exact to half a step, the others to the bit."""


def run(arguments: Sequence[str]) -> int:
    """Do what the first argument says with the set that the second one names."""
    match list(arguments):
        case ["check" | "convert" as verb, place, *rest] if not place.startswith("-"):
            name, more = named_set(place)
            return (_check if verb == "check" else _convert)(name, [*more, *rest])
        case ["-h" | "--help", *_] | ["check" | "convert", "-h" | "--help", *_]:
            sys.stdout.write(_PAGE.format(sets=listed_sets()))
            raise SystemExit(0)
    raise InputError("say what to do with which set: flexdepth data check SET (flexdepth data -h)")


def _check(name: str, arguments: Sequence[str]) -> int:
    command = f"flexdepth data check {name}"
    kind = DATASETS[name]
    settings = parsed(Check[kind], Check(kind()), arguments, command)  # type: ignore[valid-type]
    if settings.pairs < 1:
        raise InputError("--pairs is a whole number >= 1")
    pairs = settings.data.load()
    with counted("looking", len(spread_out(len(pairs), settings.pairs))) as watch:
        result = checkup(pairs, _predicted, settings.pairs, watch)
    _write_sheet(settings.sheet, pairs, result)
    sys.stdout.write(f"{name}: {result.looked_at} of {result.total} pairs\n")
    for each in result.findings:
        sys.stdout.write(f"{each.verdict:<12}{each.check:<17}{each.text}\n")
        if each.verdict is Verdict.FOUND and each.images:
            sys.stdout.write(f"{'':<29}such as {', '.join(each.images[:4])}\n")
    sys.stdout.write(f"{settings.sheet}: {len(result.shown)} of them to look at\n")
    return _FOUND if result.found else 0


def _convert(name: str, arguments: Sequence[str]) -> int:
    command = f"flexdepth data convert {name}"
    kind = DATASETS[name]
    default = Convert(kind(), tyro.MISSING)
    settings = parsed(Convert[kind], default, arguments, command)  # type: ignore[valid-type]
    pairs = settings.data.load()
    with counted("converting", len(pairs)) as watch:
        written = convert(pairs, settings.output_dir, SUFFIXES[settings.format], name, watch)
    sys.stdout.write(f"{settings.output_dir}: {written} of {len(pairs)} pairs written\n")
    return 0


def _predicted(pair: Pair) -> DepthMap:
    camera = pair.truth.intrinsics
    lens = None if camera is None else FocalLength((camera.focal_x * camera.focal_y) ** 0.5)
    return Predictor(_model(), lens).predict(pair.image)


@cache
def _model() -> Model:
    return load_model()


def _write_sheet(path: Path, pairs: Any, result: Checkup) -> None:  # noqa: ANN401
    with replacing(path) as temporary:
        Image.fromarray(contact_sheet(pairs, result.shown)).save(temporary, format="PNG")
