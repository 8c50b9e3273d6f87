import numpy as np
import pytest
from PIL import Image

from flexdepth.evaluation.catalogue import PROTOCOLS
from flexdepth.evaluation.evaluate import evaluate
from flexdepth.evaluation.pictures import error, worst, write_worst
from flexdepth.runtime.colour import UNKNOWN

BLUE, WHITE, RED = (33, 102, 172), (247, 247, 247), (178, 24, 43)


def test_half_as_far_is_blue_right_is_white_and_twice_as_far_is_red():
    found = error(np.array([[-1.0, 0.0, 1.0, np.nan, -9.0, 9.0]]))
    np.testing.assert_array_equal(found, [[BLUE, WHITE, RED, UNKNOWN, BLUE, RED]])


def test_a_wide_picture_of_errors_has_a_legend_below():
    assert error(np.zeros((40, 200))).shape[0] > 40
    assert error(np.zeros((40, 90))).shape == (40, 90, 3)


@pytest.fixture
def three(pair, metric, shelf):
    truth = np.full((48, 64), 4.0)
    pairs = shelf(*(pair(name, truth) for name in ("good", "bad", "fair")))
    said = shelf(*(metric(truth * factor) for factor in (1.0, 2.0, 1.2)))
    found = evaluate(pairs, said, PROTOCOLS["metric"], lambda _done: None)
    return found, pairs, said


def test_the_worst_come_first(three):
    assert [score.name for _, score in worst(three[0], 2)] == ["bad", "fair"]
    assert [number for number, _ in worst(three[0], 3)] == [1, 2, 0]


def test_the_worst_images_are_drawn_and_those_of_before_are_gone(three, tmp_path):
    Image.new("RGB", (4, 4)).save(tmp_path / "01-own.png")
    write_worst(tmp_path, *three, 2)
    assert sorted(path.name for path in tmp_path.iterdir()) == [
        "01-bad.png",
        "01-own.png",
        "02-fair.png",
    ]
    write_worst(tmp_path, *three, 1)
    assert sorted(path.name for path in tmp_path.iterdir()) == ["01-bad.png", "01-own.png"]
    with Image.open(tmp_path / "01-bad.png") as picture:
        assert picture.width > 4 * 64


def test_sparse_points_are_drawn_larger(pair, metric, shelf, tmp_path):
    truth = np.zeros((48, 64))
    truth[24, 32] = 4
    pairs, said = shelf(pair("road", truth)), shelf(metric(np.full((48, 64), 8.0)))
    found = evaluate(pairs, said, PROTOCOLS["metric"], lambda _done: None)
    write_worst(tmp_path, found, pairs, said, 1)
    with Image.open(tmp_path / "01-road.png") as picture:
        red = (np.asarray(picture) == RED).all(-1).sum()
    # A disc of radius 2.5: 21 pixels.
    assert red == 21


def test_wide_images_come_in_two_rows(pair, metric, shelf, tmp_path):
    truth = np.full((30, 120), 4.0)
    pairs, said = shelf(pair("road", truth)), shelf(metric(truth))
    found = evaluate(pairs, said, PROTOCOLS["metric"], lambda _done: None)
    write_worst(tmp_path, found, pairs, said, 1)
    with Image.open(tmp_path / "01-road.png") as picture:
        assert 2 * 120 < picture.width < 3 * 120
        assert picture.height > 2 * 30
