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


@dataclass(frozen=True)
class Disc:
    radius: float = 1.0

    def __post_init__(self):
        if self.radius <= 0:
            raise InputError(f"a radius is positive, got {self.radius:g}")


@dataclass(frozen=True)
class Board:
    shape: Circle | Disc = field(default_factory=Circle)


CODEC = Codec((Circle | Square,))


def test_a_member_of_a_union_comes_back_as_itself():
    drawing = Drawing(Square(2.5), (3,))
    text = json.dumps(CODEC.plain(drawing))
    assert CODEC.restored(Drawing, json.loads(text), "file") == drawing


def test_an_unknown_field_is_named_with_its_place():
    values = CODEC.plain(Drawing())
    values["shape"]["diameter"] = 2
    said = r"run\.json: shape: Circle has no field 'diameter'; it has \['radius'\]"
    with pytest.raises(InputError, match=said):
        CODEC.restored(Drawing, values, "run.json")


def test_the_nearest_field_is_suggested():
    values = {"shape": {"_type": "Circle"}, "sises": [3]}
    with pytest.raises(
        InputError, match="file: Drawing has no field 'sises'; did you mean 'sizes'"
    ):
        CODEC.restored(Drawing, values, "file")


def test_a_wrong_type_is_named_with_its_place():
    values = CODEC.plain(Drawing())
    values["sizes"] = ["many"]
    with pytest.raises(InputError, match="sizes"):
        CODEC.restored(Drawing, values, "run.json")


def test_an_unknown_member_is_refused():
    values = CODEC.plain(Drawing())
    values["shape"]["_type"] = "Triangle"
    said = r"shape: no `_type` 'Triangle'; choose one of \['Circle', 'Square'\]"
    with pytest.raises(InputError, match=said):
        CODEC.restored(Drawing, values, "run.json")


@pytest.mark.parametrize("shape", ["Circle", 3, None, [1]])
def test_a_member_that_is_no_mapping_is_refused(shape):
    with pytest.raises(InputError, match="shape: wanted fields and a `_type` of"):
        CODEC.restored(Drawing, {"shape": shape}, "file")


def test_what_settings_refuse_of_themselves_is_said():
    with pytest.raises(InputError, match="shape: a radius is positive, got -1"):
        Codec((Circle | Disc,)).restored(Board, {"shape": {"_type": "Disc", "radius": -1}}, "file")


def test_a_member_without_a_tag_is_the_one_that_is_meant():
    codec = Codec((Circle | Square,), {Circle | Square: Square})
    untagged = {"shape": {"radius": 2.5}, "sizes": [3]}
    assert codec.restored(Drawing, untagged, "file") == Drawing(Square(2.5), (3,))
    assert codec.restored(Drawing, codec.plain(Drawing()), "file") == Drawing()
    with pytest.raises(InputError, match="shape"):
        codec.restored(Drawing, {"shape": {"_type": "Triangle", "radius": 1.0}}, "file")
    with pytest.raises(InputError, match="shape"):
        CODEC.restored(Drawing, untagged, "file")
