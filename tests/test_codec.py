import json
from dataclasses import dataclass, field

import pytest

from flexdepth.codec import Codec
from flexdepth.runtime.errors import InputError


@dataclass(frozen=True)
class Circle:
    radius: float = 1.0


@dataclass(frozen=True)
class Square:
    radius: float = 1.0


@dataclass(frozen=True)
class Drawing:
    shape: Circle | Square = field(default_factory=Circle)
    sizes: tuple[int, ...] = (1, 2)


CODEC = Codec((Circle | Square,))


def test_a_member_of_a_union_comes_back_as_itself():
    drawing = Drawing(Square(2.5), (3,))
    text = json.dumps(CODEC.plain(drawing))
    assert CODEC.restored(Drawing, json.loads(text), "file") == drawing


def test_an_unknown_field_is_named_with_its_place():
    values = CODEC.plain(Drawing())
    values["shape"]["diameter"] = 2
    with pytest.raises(InputError, match=r"run\.json: .*diameter.*shape"):
        CODEC.restored(Drawing, values, "run.json")


def test_a_wrong_type_is_named_with_its_place():
    values = CODEC.plain(Drawing())
    values["sizes"] = ["many"]
    with pytest.raises(InputError, match="sizes"):
        CODEC.restored(Drawing, values, "run.json")


def test_an_unknown_member_is_refused():
    values = CODEC.plain(Drawing())
    values["shape"]["_type"] = "Triangle"
    with pytest.raises(InputError, match="shape"):
        CODEC.restored(Drawing, values, "run.json")


def test_a_member_without_a_tag_is_the_one_that_is_meant():
    codec = Codec((Circle | Square,), {Circle | Square: Square})
    untagged = {"shape": {"radius": 2.5}, "sizes": [3]}
    assert codec.restored(Drawing, untagged, "file") == Drawing(Square(2.5), (3,))
    assert codec.restored(Drawing, codec.plain(Drawing()), "file") == Drawing()
    with pytest.raises(InputError, match="shape"):
        codec.restored(Drawing, {"shape": {"_type": "Triangle", "radius": 1.0}}, "file")
    with pytest.raises(InputError, match="shape"):
        CODEC.restored(Drawing, untagged, "file")
