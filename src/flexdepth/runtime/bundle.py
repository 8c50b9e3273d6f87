"""What a model bundle says of itself: the JSON in the metadata of its ONNX file."""

import json
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from types import MappingProxyType

from flexdepth.runtime.depthmap import Space
from flexdepth.runtime.errors import InputError
from flexdepth.runtime.fields import Field, is_positive, is_text

METADATA_KEY = "flexdepth"
"""The name of the metadata that holds the JSON."""

FORMAT = 1
"""The one format of the JSON that this version reads."""

_LARGEST_SIDE = 8192


@dataclass(frozen=True)
class Description:
    """What a bundle says of itself.

    Attributes:
        name: Such as "compact".
        version: Of the weights.
        licence: Of the weights, as an SPDX identifier.
        space: `metric` if the numbers become metres once the focal length is known, else
            `scale`.
        area: Width and height whose product is the number of pixels that the network runs at.
        multiple: Width and height of what the network is given are multiples of this.
        canonical_focal: The focal length, in diagonals of a 4:3 image of the same area, for which
            `depth` is metres.
        source: How the weights were made.
        scale_spread: The relative standard deviation of metres by one factor for the whole map,
            the focal length being known; None where nobody has measured it.
    """

    name: str
    version: str
    licence: str
    space: Space
    area: tuple[int, int]
    multiple: int
    canonical_focal: float
    source: str
    scale_spread: float | None = None


def read_description(text: str, file: Path) -> Description:
    """Return the description in the JSON of a bundle's metadata.

    Args:
        text: The JSON.
        file: Named in errors.

    Raises:
        InputError: The text is no JSON object, of another format, or a field is absent or wrong.
    """
    try:
        fields = json.loads(text)
    except ValueError as error:
        raise InputError(f"{file}: metadata `{METADATA_KEY}`: no JSON: {error}") from error
    if not isinstance(fields, dict):
        raise InputError(f"{file}: metadata `{METADATA_KEY}`: wanted an object, got {text[:40]!r}")
    if fields.get("format") != FORMAT:
        raise InputError(
            f"{file}: metadata `format`: wanted {FORMAT}, got {fields.get('format')!r}; "
            f"another version of flexdepth reads it"
        )
    for name, field in _FIELDS.items():
        if field.default is None and fields.get(name) is None:
            continue
        if name not in fields or not field.fits(fields[name]):
            got = repr(fields[name]) if name in fields else "nothing"
            raise InputError(f"{file}: metadata `{name}`: wanted {field.wanted}, got {got}")
    return Description(
        **{name: fields[name] for name in ("name", "version", "licence", "source", "multiple")},
        space=Space(fields["space"]),
        area=(fields["area"][0], fields["area"][1]),
        canonical_focal=float(fields["canonical_focal"]),
        scale_spread=fields.get("scale_spread"),
    )


def _is_side(value: object) -> bool:
    return type(value) is int and 1 <= value <= _LARGEST_SIDE


def _is_area(value: object) -> bool:
    return isinstance(value, list) and len(value) == 2 and all(map(_is_side, value))


_TEXT = Field(is_text, "a line of text")
_FIELDS: Mapping[str, Field] = MappingProxyType(
    {
        "name": _TEXT,
        "version": _TEXT,
        "licence": _TEXT,
        "source": _TEXT,
        "space": Field(lambda value: value in (Space.METRIC, Space.SCALE), "'metric' or 'scale'"),
        "area": Field(_is_area, f"[width, height], each 1 to {_LARGEST_SIDE}"),
        "multiple": Field(_is_side, f"a whole number, 1 to {_LARGEST_SIDE}"),
        "canonical_focal": Field(is_positive, "a number > 0"),
        "scale_spread": Field(is_positive, "a number > 0", default=None),
    }
)
