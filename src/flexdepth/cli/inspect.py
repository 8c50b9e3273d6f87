"""`flexdepth inspect FILE...`: what the numbers in depth files mean, and what they are."""

import json
import sys
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import tyro
from rich.console import Console
from rich.table import Table
from rich.text import Text

from flexdepth.cli.arguments import told_in_one_line
from flexdepth.runtime.depthmap import DepthMap
from flexdepth.runtime.errors import InputError
from flexdepth.runtime.files import read_depth, read_meaning


@dataclass(frozen=True)
class Inspect:
    """Say what the numbers in depth files mean: space, unit, camera, range, share valid."""

    files: Annotated[
        tuple[Path, ...],
        tyro.conf.Positional,
        tyro.conf.arg(metavar="FILE...", help_behavior_hint=""),
    ]
    """Depth files: npz, npy, 16-bit PNG, EXR, PFM."""
    json: Annotated[bool, tyro.conf.FlagCreatePairsOff, tyro.conf.arg(help_behavior_hint="")] = (
        False
    )
    """Print a JSON list, one object a file, for scripts."""


class _Console(Console):
    """Leaves it to `cli.main` what a reader that went away, as in `| head`, means."""

    def on_broken_pipe(self) -> None:
        raise BrokenPipeError


def run(arguments: Sequence[str]) -> int:
    """Inspect the files that `arguments` name; the good ones are shown beside broken ones."""
    with told_in_one_line("flexdepth inspect"):
        settings = tyro.cli(Inspect, args=arguments, prog="flexdepth inspect")
    if not settings.files:
        raise InputError("name at least one depth file: flexdepth inspect depth/room.npz")
    found, failures = [], []
    for path in settings.files:
        try:
            found.append({"file": str(path), **facts(read_depth(path)), **read_meaning(path)})
        except InputError as failure:
            failures.append(str(failure))
    if settings.json:
        sys.stdout.write(json.dumps(found, indent=1) + "\n")
    else:
        console = _Console()
        for record in found:
            console.print(Text(str(record["file"])), soft_wrap=True)
            console.print(table(record))
    if failures:
        raise InputError("; ".join(failures))
    return 0


def facts(depth_map: DepthMap) -> dict[str, object]:
    """Return the least and the largest finite value, and the shares valid and sky in 0..1."""
    finite = depth_map.values[depth_map.valid]
    return {
        "least": float(finite.min()) if finite.size else None,
        "largest": float(finite.max()) if finite.size else None,
        "share_valid": float(depth_map.valid.mean()),
        "share_sky": float(depth_map.sky.mean()),
    }


def table(record: Mapping[str, object]) -> Table:
    """Return the facts of one file as a small table."""
    rows = {
        "size": f"{record['width']} x {record['height']}",
        "meaning": f"{record['quantity']}, {record['space']}",
        "range": _range(record),
        "valid": f"{record['share_valid']:.1%}",
        "sky": f"{record['share_sky']:.1%}",
        "spread": _spread(record["spread"]),
        "stored": _stored(record),
        "camera": _camera(record["intrinsics"]),
        "model": str(record["model"] or "not stated"),
    }
    origin = record["origin"]
    if isinstance(origin, Mapping):
        rows |= {f"origin: {name}": str(value) for name, value in origin.items()}
    shown = Table(show_header=False)
    for name, value in rows.items():
        shown.add_row(Text(name), Text(value))
    return shown


def _range(record: Mapping[str, object]) -> str:
    if record["least"] is None:
        return "no finite value"
    unit = "m" if record["unit"] == "m" else "(relative)"
    return f"{record['least']:.4g} to {record['largest']:.4g} {unit}"


def _spread(spread: object) -> str:
    if not isinstance(spread, Mapping):
        return "not known"
    of_scale = spread["of_scale"]
    common = "" if of_scale is None else f"; {of_scale:.1%} more, common to all pixels"
    return f"{spread['median']:.1%} of the depth at the median pixel{common}"


def _stored(record: Mapping[str, object]) -> str:
    if isinstance(record["invalid"], str):
        return f"as it is; unknown {record['invalid']}, sky {record['sky']}"
    offset = f" + {record['offset']:g}" if record["offset"] else ""
    return f"{record['scale']:g} x code{offset}; unknown {record['invalid']}, sky {record['sky']}"


def _camera(intrinsics: object) -> str:
    if not isinstance(intrinsics, Mapping):
        return "not known"
    source = intrinsics["source"]
    if "field_of_view" in intrinsics:
        source = f"{source}, field of view {intrinsics['field_of_view']:.1f} degrees"
    return (
        f"focal {intrinsics['focal_x']:.6g}, {intrinsics['focal_y']:.6g} px ({source}); centre "
        f"{intrinsics['centre_x']:.6g}, {intrinsics['centre_y']:.6g} px (OpenCV)"
    )
