"""`flexdepth convert FILE... --format F`: another format, the same meaning."""

import sys
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Literal

import tyro

from flexdepth.cli.arguments import told_in_one_line
from flexdepth.runtime.depthmap import Space
from flexdepth.runtime.errors import InputError
from flexdepth.runtime.files import SUFFIXES, read_depth, read_origin, read_stated, write_depth


@dataclass(frozen=True)
class Convert:
    """Change the format of depth files without losing what their numbers mean.

    A file of other make, which does not say what its numbers mean, is taken with --space and
    --scale, as in: flexdepth convert depth.png --format npz --space metric --scale 0.001
    """

    files: Annotated[
        tuple[Path, ...],
        tyro.conf.Positional,
        tyro.conf.arg(metavar="FILE...", help_behavior_hint=""),
    ]
    """Depth files: npz, npy, 16-bit PNG, EXR, PFM."""
    format: Literal["npz", "npy", "png16", "exr", "pfm"]
    """What to make of them. png16 is exact to half a step, the others to the bit."""
    output_dir: Annotated[
        Path | None, tyro.conf.arg(aliases=("-o",), metavar="DIR", help_behavior_hint="")
    ] = None
    """Folder to write to; without it, beside each file."""
    overwrite: Annotated[
        bool, tyro.conf.FlagCreatePairsOff, tyro.conf.arg(help_behavior_hint="")
    ] = False
    """Replace files that are there."""
    space: Annotated[
        Space | None, tyro.conf.EnumChoicesFromValues, tyro.conf.arg(help_behavior_hint="")
    ] = None
    """What the numbers mean, where the files do not say it."""
    scale: float = 1.0
    """With --space: value of the stored number 1, in metres for metric (0.001: millimetres)."""


def run(arguments: Sequence[str]) -> int:
    """Convert the files that `arguments` name; the good ones are done beside broken ones."""
    with told_in_one_line("flexdepth convert"):
        settings = tyro.cli(Convert, args=arguments, prog="flexdepth convert")
    made, failures = [], []
    for source, target in targets(settings).items():
        try:
            convert(source, target, settings)
            made.append(target)
        except InputError as failure:
            failures.append(str(failure))
    sys.stdout.writelines(f"{target}\n" for target in made)
    if failures:
        raise InputError("; ".join(failures))
    return 0


def targets(settings: Convert) -> dict[Path, Path]:
    """Return where each file goes, refused where two would go to one place."""
    if not settings.files:
        raise InputError("name at least one depth file: flexdepth convert a.npz --format exr")
    if settings.space is None and settings.scale != 1.0:
        raise InputError("--scale is for files that do not say what they mean: give --space too")
    suffix = SUFFIXES[settings.format]
    places = {
        source: (settings.output_dir or source.parent) / f"{source.stem}{suffix}"
        for source in settings.files
    }
    place, count = Counter(places.values()).most_common(1)[0]
    if count > 1:
        raise InputError(f"{place}: {count} of the files would be written there; rename them")
    return places


def convert(source: Path, target: Path, settings: Convert) -> None:
    """Write the depth map in `source` to `target`; its origin then names `source` too."""
    if target.exists() and not settings.overwrite:
        raise InputError(f"{target}: exists already; --overwrite replaces it")
    converted = {"converted_from": source.name}
    if settings.space is not None:
        write_depth(target, read_stated(source, settings.space, settings.scale), converted)
    else:
        write_depth(target, read_depth(source), read_origin(source) | converted)
