"""What a small YAML file says of an ONNX network that does not say it itself.

A whole card, for a network that gives disparity::

    onnx: midas_small.onnx          # beside the card; by default the card's own name with .onnx
    name: MiDaS v2.1 small
    licence: MIT
    input:
      name: image                   # by default the graph's only input
      size: [256, 256]              # width, height; or `area: [384, 288]` with `multiple: 32`
      layout: nchw                  # or nhwc
      colours: rgb                  # or bgr
    normalisation:                  # (colour x scale - mean) / std, colour being 0 to 255
      scale: 0.00392156862745098    # 1/255, the default
      mean: [0.485, 0.456, 0.406]   # in the order of the colours; by default 0
      std: [0.229, 0.224, 0.225]    # by default 1
    output:
      name: disparity               # by default the graph's only output
      space: affine_disparity       # or metric, scale, affine_depth

For metric depth, or depth up to a factor, `output` may also say:

- `inverse: true`: the numbers are 1/depth.
- `unit: 0.001`: the metres of the depth 1, by default 1.
- `canonical_focal: 1000`: the numbers are metres for a camera of this focal length, and grow with
  it, as Metric3D's do. It counts in pixels of what the network is given, or, with
  `canonical_focal_in: widths` or `diagonals`, in widths or diagonals of it.

A card is data: it is read by YAML's safe loader, and a field that it has not is refused.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from enum import StrEnum
from math import hypot
from pathlib import Path
from types import MappingProxyType
from typing import Any

from flexdepth.runtime.depthmap import Space
from flexdepth.runtime.errors import InputError, reason
from flexdepth.runtime.fields import (
    Field,
    checked,
    is_number,
    is_positive,
    is_text,
    list_of,
    one_of,
)
from flexdepth.runtime.opening import open_input

_LARGEST_SIDE = 8192
_LONGEST = 1 << 16
"""No card is longer, in bytes."""

Triple = tuple[float, float, float]


class Layout(StrEnum):
    """The order of the axes of what the network is given."""

    NCHW = "nchw"
    NHWC = "nhwc"


class Colours(StrEnum):
    """The order of its colours."""

    RGB = "rgb"
    BGR = "bgr"


class FocalIn(StrEnum):
    """What a canonical focal length counts in."""

    PIXELS = "pixels"
    WIDTHS = "widths"
    DIAGONALS = "diagonals"


@dataclass(frozen=True)
class InputCard:
    """What the network is given.

    Attributes:
        area: Width and height; where `multiple` is None exactly these, else their product is the
            number of pixels.
        multiple: Width and height are multiples of this; None: one size for all pictures.
        name: Of the graph's input; empty for the only one.
        layout: The order of the axes.
        colours: The order of the colours.
    """

    area: tuple[int, int]
    multiple: int | None
    name: str
    layout: Layout
    colours: Colours


@dataclass(frozen=True)
class Normalisation:
    """(colour x scale - mean) / std, colour being 0 to 255."""

    scale: float
    mean: Triple
    std: Triple


@dataclass(frozen=True)
class OutputCard:
    """What the network gives.

    Attributes:
        space: What the numbers are ambiguous up to.
        name: Of the graph's output; empty for the only one.
        inverse: The numbers are 1/depth.
        unit: The metres of the depth 1.
        canonical_focal: The focal length for which the numbers are metres; None: any.
        canonical_focal_in: What it counts in.
    """

    space: Space
    name: str
    inverse: bool
    unit: float
    canonical_focal: float | None
    canonical_focal_in: FocalIn

    def focal_in_pixels(self, width: int, height: int) -> float | None:
        """Return the canonical focal length in pixels of what the network is given."""
        if self.canonical_focal is None:
            return None
        pixels = {
            FocalIn.PIXELS: 1.0,
            FocalIn.WIDTHS: float(width),
            FocalIn.DIAGONALS: hypot(width, height),
        }
        return self.canonical_focal * pixels[self.canonical_focal_in]


@dataclass(frozen=True)
class Card:
    """What is said of a network.

    Attributes:
        onnx: The network's file.
        name: The network's.
        licence: Of its weights.
        input: What it is given.
        normalisation: How colours become its numbers.
        output: What it gives.
    """

    onnx: Path
    name: str
    licence: str
    input: InputCard
    normalisation: Normalisation
    output: OutputCard


def read_card(file: Path) -> Card:
    """Return what a card says.

    Raises:
        InputError: The file is missing or no YAML, or a field is absent, unknown or wrong.
    """
    # Most models have no card: YAML is loaded for those that do.
    import yaml  # noqa: PLC0415

    with open_input(file) as opened:
        text = opened.read(_LONGEST)
    try:
        read: object = yaml.safe_load(text)
    except (yaml.YAMLError, UnicodeError, RecursionError) as error:
        raise InputError(
            f"{file}: wanted a YAML card of an ONNX network, got {reason(error)}"
        ) from error
    top = checked(read, "", file, _TOP)
    given = checked(top["input"], "input.", file, _INPUT)
    scaled = checked(top["normalisation"], "normalisation.", file, _NORMALISATION)
    found = checked(top["output"], "output.", file, _OUTPUT)
    _agree(given, found, file)
    size, unit = given["size"] or given["area"], found["canonical_focal"]
    return Card(
        file.parent / (top["onnx"] or f"{file.stem}.onnx"),
        top["name"] or file.stem,
        top["licence"],
        InputCard(
            (size[0], size[1]),
            None if given["size"] else given["multiple"],
            given["name"],
            Layout(given["layout"]),
            Colours(given["colours"]),
        ),
        Normalisation(float(scaled["scale"]), _triple(scaled["mean"]), _triple(scaled["std"])),
        OutputCard(
            Space(found["space"]),
            found["name"],
            found["inverse"],
            float(found["unit"]),
            None if unit is None else float(unit),
            FocalIn(found["canonical_focal_in"]),
        ),
    )


def _agree(given: Mapping[str, Any], found: Mapping[str, Any], file: Path) -> None:
    """Refuse fields that contradict one another."""
    if (given["size"] is None) == (given["area"] is None):
        raise InputError(
            f"{file}: `input.size`: wanted either `size`, for one size, or `area` with `multiple`"
        )
    if (given["area"] is None) != (given["multiple"] is None):
        raise InputError(f"{file}: `input.multiple`: goes with `area`, and only with it")
    is_depth = found["space"] in (Space.METRIC, Space.SCALE)
    if found["inverse"] and not is_depth:
        raise InputError(
            f"{file}: `output.inverse`: wanted with the space metric or scale alone, got "
            f"{found['space']}"
        )
    if found["canonical_focal"] is not None and found["space"] != Space.METRIC:
        raise InputError(
            f"{file}: `output.canonical_focal`: wanted with the space metric alone, got "
            f"{found['space']}"
        )


def _triple(values: Any) -> Triple:  # noqa: ANN401
    return float(values[0]), float(values[1]), float(values[2])


def _is_side(value: object) -> bool:
    return type(value) is int and 1 <= value <= _LARGEST_SIDE


_SIZE = (list_of(2, _is_side), f"[width, height], each 1 to {_LARGEST_SIDE}")
_TOP = MappingProxyType(
    {
        "onnx": Field(is_text, "the name of a file beside the card", None),
        "name": Field(is_text, "a line of text", None),
        "licence": Field(is_text, "a line of text", "unknown"),
        "input": Field(lambda _value: True, "fields"),
        "normalisation": Field(lambda _value: True, "fields", {}),
        "output": Field(lambda _value: True, "fields"),
    }
)
_INPUT = MappingProxyType(
    {
        "name": Field(is_text, "a line of text", ""),
        "size": Field(*_SIZE, None),
        "area": Field(*_SIZE, None),
        "multiple": Field(_is_side, f"a whole number, 1 to {_LARGEST_SIDE}", None),
        "layout": Field(*one_of(Layout), Layout.NCHW),
        "colours": Field(*one_of(Colours), Colours.RGB),
    }
)
_NORMALISATION = MappingProxyType(
    {
        "scale": Field(is_positive, "a number > 0", 1 / 255),
        "mean": Field(list_of(3, is_number), "three numbers", [0, 0, 0]),
        "std": Field(list_of(3, is_positive), "three numbers > 0", [1, 1, 1]),
    }
)
_OUTPUT = MappingProxyType(
    {
        "name": Field(is_text, "a line of text", ""),
        "space": Field(*one_of(Space)),
        "inverse": Field(lambda value: isinstance(value, bool), "true or false", False),
        "unit": Field(is_positive, "a number > 0", 1),
        "canonical_focal": Field(is_positive, "a number > 0", None),
        "canonical_focal_in": Field(*one_of(FocalIn), FocalIn.PIXELS),
    }
)
