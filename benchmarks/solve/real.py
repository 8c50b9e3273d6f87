"""What is marked as moving in two real pairs, against boxes drawn by hand around what does move.

    python benchmarks/solve/real.py [--samples DIR] [--dense] [--share N] [--pictures DIR] [--json]
                                    [--strict]

KITTI 2015 000010, three cars on a crossing, and MPI-Sintel alley_1, a girl before walls; flow by
DIS, geometry alone. Of each thing it prints which share of its boxes' inner half (each box shrunk
about its middle to half its area) is marked as moving, and of all that lies in no box, which share
is. The bars: 60 % at least, 5 % at most; with --strict it exits with 1 where one is missed.
docs/samples.md says where the pictures come from.
"""

import argparse
import json
import sys
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from math import sqrt
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import yaml
from numpy.typing import NDArray
from pairs import HERE

sys.path.insert(0, str(HERE.parent))

from samples import present, usual_folder
from verdict import verdict

from flexdepth.flow.along_lines import AlongLines
from flexdepth.flow.dis import Dis
from flexdepth.runtime.depthmap import FocalSource, Intrinsics
from flexdepth.solvers.seen import Seen
from flexdepth.solvers.two_frame import Dense, TwoFrame, TwoFrameSettings, two_frame

LEAST, MOST = 0.6, 0.05
Mask = NDArray[np.bool_]
Image = NDArray[np.uint8]
Box = Sequence[float]


@dataclass(frozen=True)
class Marked:
    """Shares of pixels marked as moving: of each thing's inner half, and of what is outside."""

    things: dict[str, float]
    outside: float

    @property
    def passed(self) -> bool:
        """Whether the bars are met."""
        return min(self.things.values()) >= LEAST and self.outside <= MOST


def boxed(boxes: Sequence[Box], shape: tuple[int, int], area: float = 1.0) -> Mask:
    """Return the pixels in any of the boxes, each shrunk about its middle to a share of its area.

    A pixel is in a box where its centre is.
    """
    height, width = shape
    across, down = np.arange(width) + 0.5, np.arange(height) + 0.5
    inside = np.zeros(shape, bool)
    for left, top, right, bottom in boxes:
        half = sqrt(area) / 2
        wide = np.abs(across - (left + right) / 2) < half * (right - left)
        high = np.abs(down - (top + bottom) / 2) < half * (bottom - top)
        inside |= high[:, None] & wide
    return inside


def marked(moving: Mask, said: dict[str, Any]) -> Marked:
    """Return what shares of the boxes of one pair, and of the rest, are marked."""
    shape = moving.shape
    things: dict[str, list[Box]] = said["things"]
    every = [box for boxes in things.values() for box in boxes] + said["beside"]
    inner = {name: moving[boxed(boxes, shape, 0.5)].mean() for name, boxes in things.items()}
    outside = moving[~boxed(every, shape)].mean()
    return Marked({name: float(share) for name, share in inner.items()}, float(outside))


def read(path: Path) -> Image:
    """Return a picture in RGB."""
    return np.ascontiguousarray(cv2.imread(str(present(path)), cv2.IMREAD_COLOR)[..., ::-1])


def shrunk(said: dict[str, Any], share: float) -> dict[str, Any]:
    """Return the boxes of a pair whose sides are shrunk to a share."""
    things = {
        name: [[share * side for side in box] for box in boxes]
        for name, boxes in said["things"].items()
    }
    return said | {
        "things": things,
        "beside": [[share * side for side in box] for box in said["beside"]],
    }


def solved(key: Image, target: Image, camera: Intrinsics, *, dense: bool) -> TwoFrame:
    """Return what flexdepth says of a pair, by geometry alone."""
    field = Dis().between(key, target)
    search = AlongLines(key, target, camera)
    seen = Seen(field.flow, field.noise, camera, key, target=target, search=search)
    return two_frame(seen, TwoFrameSettings(dense=Dense() if dense else None))


def shown(key: Image, found: TwoFrame, said: dict[str, Any]) -> Image:
    """Return the key frame with what is marked in red and the boxes, above its depth."""
    picture = key.copy()
    picture[found.moving] = (0.5 * picture[found.moving] + (127, 0, 0)).astype(np.uint8)
    for name, boxes in (*said["things"].items(), ("", said["beside"])):
        for box in boxes:
            left, top, right, bottom = map(round, box)
            colour = (255, 255, 0) if name else (160, 160, 160)
            cv2.rectangle(picture, (left, top), (right, bottom), colour, 1)
    depth = found.depth
    known = np.isfinite(depth) & (depth > 0)
    near = np.where(known, 1 / np.where(known, depth, 1.0), 0.0)
    most = np.quantile(near[known], 0.98) if known.any() else 1.0
    gray = (255 * np.clip(near / most, 0, 1)).astype(np.uint8)
    colours = np.asarray(cv2.applyColorMap(gray, cv2.COLORMAP_TURBO))[..., ::-1].copy()
    colours[~known] = 0
    return np.ascontiguousarray(np.concatenate([picture, colours]))


def measured(said: dict[str, Any], samples: Path, asked: argparse.Namespace) -> Marked:
    """Return what one pair gives, and write its picture where one is asked for."""
    share = asked.share
    key, target = (read(samples / said[name]) for name in ("key", "target"))
    if share != 1:
        key, target = (
            np.asarray(cv2.resize(each, None, fx=share, fy=share, interpolation=cv2.INTER_AREA))
            for each in (key, target)
        )
    # OpenCV counts the first pixel's centre as 0.
    centre = [share * (each + 0.5) for each in said["centre"]]
    focal = share * said["focal"]
    camera = Intrinsics(focal, focal, *centre, FocalSource.GIVEN)
    found = solved(key, target, camera, dense=asked.dense)
    boxes = shrunk(said, share)
    if asked.pictures is not None:
        asked.pictures.mkdir(parents=True, exist_ok=True)
        file = asked.pictures / f"{said['name'].replace(' ', '-').lower()}.png"
        cv2.imwrite(str(file), shown(key, found, boxes)[..., ::-1])
    return marked(found.moving, boxes)


def text(found: Mapping[str, Marked]) -> str:
    """Return what was marked in each pair, beside the bars."""
    lines = []
    for name, one in found.items():
        lines.append(name)
        for thing, share in one.things.items():
            mark = verdict(share >= LEAST)
            lines.append(
                f"  {thing:12} {share:>6.1%} of its inner half   (at least {LEAST:.0%})  {mark}"
            )
        mark = verdict(one.outside <= MOST)
        bar = f"(at most {MOST:.0%})"
        lines.append(f"  {'outside':12} {one.outside:>6.1%}                     {bar:14}  {mark}")
    return "\n".join(lines)


def main() -> int:
    """Measure and print; 1 where --strict and a bar is missed."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--samples", type=Path, default=usual_folder())
    parser.add_argument("--dense", action="store_true", help="refine every pixel, too")
    parser.add_argument("--share", type=float, default=1.0, help="of the frames' sides")
    parser.add_argument("--pictures", type=Path, help="a folder for what was found")
    parser.add_argument("--json", action="store_true")
    parser.add_argument("--strict", action="store_true", help="exit with 1 where a bar is missed")
    asked = parser.parse_args()
    said = yaml.safe_load((HERE / "boxes.yaml").read_text(encoding="utf-8"))
    try:
        found = {each["name"]: measured(each, asked.samples, asked) for each in said}
    except FileNotFoundError as missing:
        print(f"skipped: {missing}")
        return int(asked.strict)
    if asked.json:
        record = {name: asdict(one) | {"passed": one.passed} for name, one in found.items()}
        print(json.dumps(record, indent=1))
    else:
        print(text(found))
    return int(asked.strict and not all(one.passed for one in found.values()))


if __name__ == "__main__":
    sys.exit(main())
