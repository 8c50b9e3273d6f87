"""What the numbers in a depth file mean, and the JSON record that says so in every format.

A record reads, for instance::

    {"version": 1, "quantity": "depth", "space": "metric", "unit": "m",
     "width": 640, "height": 480,
     "scale": 0.001, "offset": 0.0, "invalid": 0, "sky": 65535,
     "intrinsics": {"convention": "opencv", "focal_x": 525.0, "focal_y": 525.0,
                    "centre_x": 319.5, "centre_y": 239.5, "source": "assumed",
                    "field_of_view": 62.7},
     "spread": {"median": 0.08, "of_scale": 0.2}, "model": "compact 0.1.0",
     "origin": {"input": "room.jpg"}}

`value = scale * stored + offset`, except for the two reserved numbers: `invalid` (unknown) and
`sky`. Intrinsics are in pixels of this map. They use OpenCV's convention, in which the centre of
the first pixel is 0, whereas `DepthMap` puts the image's corner at 0; the half pixel between
them is added and taken off here and nowhere else. `field_of_view` is in degrees from the left
edge to the right edge, and is there only where the focal length was predicted or assumed. `spread`
is null where nothing is known of it: `median` is that of the relative standard deviations of the
pixels, which npz and EXR hold one by one, and the other formats have no room for; `of_scale` is
that of the one factor of the whole map, null where it is not known. `origin` tells how the file was
made, so that a file made from the same input can be recognised.
"""

import json
from collections.abc import Mapping
from dataclasses import dataclass, field
from math import atan, degrees
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from flexdepth.runtime.depthmap import DepthMap, FocalSource, Intrinsics, Space
from flexdepth.runtime.errors import InputError

VERSION = 1
MAX_TEXT = 1 << 20
"""No record is longer, in bytes: what claims to be is not read."""

_LARGEST = float(np.finfo(np.float32).max)
_HALF_PIXEL = 0.5

Numbers = NDArray[np.uint16] | NDArray[np.float32]
"""A height x width array as it is stored: codes, or the values themselves."""


def quantity(space: Space) -> str:
    """Return `disparity` for affine disparity, else `depth`: the array's name in files."""
    return "disparity" if space is Space.AFFINE_DISPARITY else "depth"


@dataclass(frozen=True)
class Coding:
    """How stored numbers become values: `value = scale * stored + offset`.

    Attributes:
        scale: Value of one step, > 0; metres in the space `metric`.
        offset: Value of the stored number 0.
        invalid: The stored number, or the name of the float, that means unknown.
        sky: The same for sky; None where the file has no mark for it.
    """

    scale: float
    offset: float
    invalid: int | str
    sky: int | str | None

    def __post_init__(self) -> None:
        """Refuse what would not give float32 values."""
        if not (0 < self.scale <= _LARGEST and abs(self.offset) <= 2 * _LARGEST):
            raise InputError(
                f"a scale is a number > 0 and an offset is finite, "
                f"got {self.scale!r} and {self.offset!r}"
            )


def plain(space: Space) -> Coding:
    """Return the coding of the float formats, which store the values themselves."""
    return Coding(1.0, 0.0, "nan", "-inf" if space is Space.AFFINE_DISPARITY else "inf")


@dataclass(frozen=True)
class SpreadMeaning:
    """What a depth file says of how far off its numbers may be.

    Attributes:
        median: Of the relative standard deviations of the pixels.
        of_scale: That of the one factor of the whole map; None where it is not known.
    """

    median: float
    of_scale: float | None

    @classmethod
    def of(cls, depth_map: DepthMap) -> "SpreadMeaning | None":
        """Return what is said of a map; None where it has no spread."""
        if depth_map.spread is None or not np.isfinite(depth_map.spread).any():
            return None
        return cls(float(np.nanmedian(depth_map.spread)), depth_map.scale_spread)

    def record(self) -> dict[str, object]:
        """Return the record as JSON has it."""
        return {"median": self.median, "of_scale": self.of_scale}


@dataclass(frozen=True)
class Meaning:
    """What a depth file says of its numbers."""

    space: Space
    width: int
    height: int
    coding: Coding
    intrinsics: Intrinsics | None = None
    model: str = ""
    origin: Mapping[str, str] = field(default_factory=dict)
    spread: SpreadMeaning | None = None

    @classmethod
    def of(cls, depth_map: DepthMap, coding: Coding, origin: Mapping[str, str] | None) -> "Meaning":
        """Return the meaning of `depth_map` stored with `coding`."""
        height, width = depth_map.values.shape
        return cls(
            depth_map.space,
            width,
            height,
            coding,
            depth_map.intrinsics,
            depth_map.model,
            dict(origin or {}),
            SpreadMeaning.of(depth_map),
        )

    def record(self) -> dict[str, object]:
        """Return the record as JSON has it."""
        return {
            "version": VERSION,
            "quantity": quantity(self.space),
            "space": str(self.space),
            "unit": "m" if self.space is Space.METRIC else "relative",
            "width": self.width,
            "height": self.height,
            "scale": self.coding.scale,
            "offset": self.coding.offset,
            "invalid": self.coding.invalid,
            "sky": self.coding.sky,
            "intrinsics": _camera_record(self.intrinsics, self.width),
            "spread": None if self.spread is None else self.spread.record(),
            "model": self.model,
            "origin": dict(self.origin),
        }

    def text(self) -> str:
        """Return the record as ASCII JSON in one line."""
        return json.dumps(self.record(), allow_nan=False)

    def depth_map(
        self, numbers: Numbers, path: Path, spread: NDArray[np.float32] | None = None
    ) -> DepthMap:
        """Return the depth map that `numbers`, as stored in `path`, stand for."""
        height, width = numbers.shape
        if (width, height) != (self.width, self.height):
            raise InputError(
                f"{path}: holds {width} x {height} numbers, but its meaning speaks of "
                f"{self.width} x {self.height}; write the file and its meaning anew, together"
            )
        if spread is not None and spread.shape != numbers.shape:
            raise InputError(
                f"{path}: holds a spread of the shape {spread.shape} of depth of the shape "
                f"{numbers.shape}; write the file anew"
            )
        of_scale = None if self.spread is None else self.spread.of_scale
        return DepthMap(
            self._values(numbers), self.space, self.intrinsics, self.model, spread, of_scale
        )

    def _values(self, numbers: Numbers) -> NDArray[np.float32]:
        if numbers.dtype == np.float32:
            values = numbers.astype(np.float32, copy=False)
            if self.coding == plain(self.space):
                return values
            known = values != 0 if self.coding.invalid == 0 else np.full(values.shape, True)
            with np.errstate(invalid="ignore"):
                scaled = values.astype(np.float64) * self.coding.scale + self.coding.offset
            return np.where(known, _single(scaled), np.float32(np.nan))
        table = _single(
            np.arange(1 << 16, dtype=np.float64) * self.coding.scale + self.coding.offset
        )
        table[0] = np.nan
        if self.coding.sky is not None:
            table[-1] = -np.inf if self.space is Space.AFFINE_DISPARITY else np.inf
        return table[numbers]


def parsed(text: str | bytes, path: Path) -> Meaning:
    """Return the meaning that `text`, found in `path`, says in JSON."""
    try:
        record: object = json.loads(text)
    except (ValueError, RecursionError) as error:
        raise InputError(f"{path}: its meaning is not JSON ({type(error).__name__})") from error
    return from_record(record, path)


def from_record(record: object, path: Path) -> Meaning:
    """Return the meaning that a JSON value, found in `path`, stands for."""
    if not isinstance(record, dict) or record.get("version") != VERSION:
        raise InputError(
            f"{path}: its meaning is not a flexdepth record of version {VERSION}; "
            f"a newer flexdepth may read it"
        )
    try:
        return Meaning(
            space=Space(record["space"]),
            width=int(record["width"]),
            height=int(record["height"]),
            coding=Coding(
                float(record["scale"]), float(record["offset"]), record["invalid"], record["sky"]
            ),
            intrinsics=_camera(record["intrinsics"]),
            spread=_spread(record.get("spread")),
            model=str(record["model"]),
            origin={str(key): str(value) for key, value in dict(record["origin"]).items()},
        )
    except KeyError as error:
        raise InputError(f"{path}: its meaning lacks the field {error}") from error
    except (TypeError, ValueError, OverflowError) as error:
        raise InputError(f"{path}: its meaning has a wrong field: {error}") from error


def _camera_record(camera: Intrinsics | None, width: int) -> dict[str, object] | None:
    if camera is None:
        return None
    record: dict[str, object] = {
        "convention": "opencv",
        "focal_x": camera.focal_x,
        "focal_y": camera.focal_y,
        "centre_x": camera.centre_x - _HALF_PIXEL,
        "centre_y": camera.centre_y - _HALF_PIXEL,
        "source": str(camera.source),
    }
    if not camera.source.is_known:
        record["field_of_view"] = 2 * degrees(atan(width / 2 / camera.focal_x))
    return record


def _camera(record: object) -> Intrinsics | None:
    if record is None:
        return None
    if not isinstance(record, dict) or record.get("convention") != "opencv":
        raise InputError("the intrinsics must state the convention 'opencv'")
    return Intrinsics(
        float(record["focal_x"]),
        float(record["focal_y"]),
        float(record["centre_x"]) + _HALF_PIXEL,
        float(record["centre_y"]) + _HALF_PIXEL,
        FocalSource(record["source"]),
    )


def _spread(record: object) -> SpreadMeaning | None:
    if record is None:
        return None
    if not isinstance(record, dict):
        raise TypeError(f"`spread` is an object or null, got {record!r}")
    of_scale = record["of_scale"]
    return SpreadMeaning(float(record["median"]), None if of_scale is None else float(of_scale))


def _single(values: NDArray[np.float64]) -> NDArray[np.float32]:
    """Return float32; finite values stay finite, NaN and infinity stay what they are."""
    bounded = np.where(np.isfinite(values), values.clip(-_LARGEST, _LARGEST), values)
    return bounded.astype(np.float32)
