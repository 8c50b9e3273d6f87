import numpy as np
import pytest

from flexdepth.runtime.colour import UNKNOWN
from flexdepth.scenes.panels import WIDTH, Panel, kinds, magnitude, sheet, signed


def test_what_is_not_known_is_gray_and_more_is_brighter():
    panel = magnitude("parallax", np.array([[0.0, 1.0, 2.0, np.nan]]), " px", most=2.0)
    assert tuple(panel.picture[0, 3]) == UNKNOWN
    brightness = panel.picture[0, :3].sum(axis=1)
    assert brightness[0] < brightness[1] < brightness[2]
    assert panel.legend.marks == ("0.00 px", "1.00 px", "2.00 px")


def test_the_middle_of_a_signed_map_is_white_and_its_sides_are_told_apart():
    panel = signed("k", np.array([[1.0, 3.0, 5.0]]), 3.0, 0.1, "°")
    below, middle, above = panel.picture[0].astype(int)
    assert middle.min() > 240
    assert below[2] > below[0]
    assert above[0] > above[2]
    assert panel.legend.marks[1] == "3.00°"


def test_tiny_differences_are_not_drawn_large():
    panel = signed("k", np.full((2, 2), 3.0001), 3.0, 0.1)
    assert panel.picture.min() > 240


def test_a_map_of_nothing_is_drawn():
    assert (magnitude("m", np.full((2, 2), np.nan)).picture == UNKNOWN[0]).all()
    assert (signed("s", np.full((2, 2), np.nan), 0.0, 1.0).picture == UNKNOWN[0]).all()


def test_kinds_are_named_with_their_share_if_they_occur():
    words = [("a", (1, 1, 1)), ("b", (2, 2, 2)), ("c", (3, 3, 3))]
    panel = kinds("k", np.array([[0, 0, 0, 2]]), words)
    assert list(panel.legend.colours) == ["a 75%", "c 25%"]
    assert panel.picture[0, 3].tolist() == [3, 3, 3]


@pytest.mark.parametrize("shape", [(30, 40), (120, 900), (500, 100)])
def test_a_sheet_holds_its_panels_in_rows(shape):
    picture = np.full((*shape, 3), 7, np.uint8)
    whole = sheet(["heading", "line"], [Panel("a", picture)] * 4 + [Panel("b", None)], 3)
    assert whole.shape[1] > 3 * WIDTH
    tall = round(WIDTH * shape[0] / shape[1])
    assert (whole == 7).all(-1).sum() == 4 * WIDTH * tall
