import numpy as np
import pytest

from flexdepth.synth import furniture
from flexdepth.synth.clutter import IN_KITCHENS, IN_SHELVES, ON_DESKS, ON_TABLES, clutter
from flexdepth.synth.parts import bounds

PLACES = (
    furniture.FREE_STANDING, furniture.AGAINST_WALLS, furniture.STORED, furniture.OFFICES,
    furniture.IN_OFFICES, furniture.KITCHENS, furniture.SHOPS, furniture.IN_SHOPS,
)  # fmt: skip
LARGE = sorted({make for place in PLACES for make in place}, key=lambda make: make.__name__)
SMALL = sorted({*IN_KITCHENS, *IN_SHELVES, *ON_DESKS, *ON_TABLES}, key=lambda make: make.__name__)


@pytest.mark.parametrize("make", LARGE + SMALL, ids=lambda make: make.__name__)
def test_a_thing_is_finite_textured_and_stands_on_the_ground(make):
    for seed in range(3):
        thing = make(np.random.default_rng(seed))
        assert all(np.isfinite(part.mesh.corners).all() for part in thing)
        assert all(part.mesh.uv.shape == (*part.mesh.corners.shape[:2], 2) for part in thing)
        low, high = bounds(thing)
        assert -0.25 < low[1] < 2
        assert (high - low).max() < 5


def test_clutter_stays_on_its_table_and_below_the_next_board():
    for seed in range(10):
        things = clutter(np.random.default_rng(seed), (0.8, 0.3), 12, 0.25, IN_SHELVES)
        low, high = bounds(things)
        assert high[1] <= 0.26
        assert np.abs([low[0], high[0]]).max() < 0.75


def test_the_same_generator_makes_the_same_thing():
    first, second = (furniture.kitchen(np.random.default_rng(4)) for _ in range(2))
    assert len(first) == len(second)
    pairs = zip(first, second, strict=True)
    assert all(np.array_equal(a.mesh.corners, b.mesh.corners) for a, b in pairs)
