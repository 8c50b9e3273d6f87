from dataclasses import replace

import numpy as np
import pytest

from flexdepth.data.views import OrdinalPair
from flexdepth.evaluation.alignment import Alignment
from flexdepth.evaluation.catalogue import PROTOCOLS
from flexdepth.evaluation.evaluate import evaluate, evaluate_all
from flexdepth.evaluation.protocols import Averaging, Scope
from flexdepth.runtime.depthmap import Space
from flexdepth.runtime.errors import InputError

METRIC = PROTOCOLS["metric"]


def silent(_done):
    pass


@pytest.fixture
def rooms(pair, shelf):
    """Three images, the second without truth."""
    return shelf(pair("a_1", [[1, 2]]), pair("b_1", [[0, 0]]), pair("b_2", [[4, 4]]))


@pytest.fixture
def twice(metric, shelf):
    """Predictions that are 1, 3 and 2 times too far."""
    return shelf(metric([[1, 2]]), metric([[9, 9]]), metric([[8, 8]]))


def test_the_set_is_the_mean_of_its_images_and_the_empty_one_is_reported(rooms, twice):
    told = []
    found = evaluate(rooms, twice, METRIC, told.append)
    assert found.results["abs_rel"].value == pytest.approx(0.5)
    assert [each.name for each in found.scores] == ["a_1", "b_2"]
    assert found.numbers == (0, 2)
    assert [each.name for each in found.left_out] == ["b_1"]
    assert told == [1, 2, 3]
    assert found.sizes == {"2x1 metric": 3}


def test_pooled_is_by_pixels(pair, metric, shelf):
    pairs = shelf(pair("a", [[1, 1, 1]]), pair("b", [[1, 0, 0]]))
    said = shelf(metric([[1, 1, 1]]), metric([[5, 1, 1]]))
    pooled = evaluate(pairs, said, replace(METRIC, averaging=Averaging.PIXELS), silent)
    assert pooled.results["abs_rel"].value == pytest.approx(1)
    assert evaluate(pairs, said, METRIC, silent).results["abs_rel"].value == pytest.approx(2)


def test_a_set_in_which_nothing_is_scored_has_no_result(rooms, twice, shelf):
    with pytest.raises(InputError, match="no image has a score: no pixel has truth"):
        evaluate(shelf(rooms[1]), twice, METRIC, silent)
    with pytest.raises(InputError, match="the set has no image"):
        evaluate(shelf(), twice, METRIC, silent)


def test_each_video_has_one_fit_and_its_first_frames_alone_count(pair, metric, shelf):
    protocol = replace(
        METRIC,
        alignment=Alignment.SCALE,
        per=Scope.VIDEO,
        frames=2,
        averaging=Averaging.VIDEOS,
    )
    truths = {"a_1": [[2, 2]], "a_2": [[4, 4]], "a_3": [[70, 70]], "b_1": [[9, 9]], "b_2": [[9, 9]]}
    pairs = shelf(*(pair(name, truth) for name, truth in truths.items()))
    said = shelf(*(metric([[1, 1]], Space.SCALE) for _ in truths))
    found = evaluate(pairs, said, protocol, silent)
    assert [(each.name, each.fit.line.factor) for each in found.scores] == [
        ("a_1", 3),
        ("a_2", 3),
        ("b_1", 9),
        ("b_2", 9),
    ]
    # Half and a quarter in the first video, nothing in the second.
    assert found.results["abs_rel"].value == pytest.approx((0.5 + 0.25) / 2 / 2)


def test_only_the_videos_of_the_protocol_count(pair, metric, shelf):
    names = ("alley_1_frame_0001", "alley_2_frame_0001", "alley_22_frame_0001")
    pairs = shelf(*(pair(name, [[1, 1]]) for name in names))
    said = shelf(*(metric([[1, 1]]) for _ in names))
    found = evaluate(pairs, said, replace(METRIC, videos=("alley_2",)), silent)
    assert [each.name for each in found.scores] == ["alley_2_frame_0001"]


def test_a_video_in_two_places_is_refused(pair, metric, shelf):
    protocol = replace(METRIC, alignment=Alignment.SCALE, per=Scope.VIDEO)
    pairs = shelf(*(pair(name, [[1, 1]]) for name in ("a_1", "b_1", "a_2")))
    said = shelf(*(metric([[1, 1]]) for _ in range(3)))
    with pytest.raises(InputError, match="video a: its frames do not follow one another"):
        evaluate(pairs, said, protocol, silent)


def test_a_wrong_prediction_is_named(rooms, metric, shelf):
    said = shelf(*(metric([[1, 2]], Space.AFFINE_DEPTH) for _ in range(3)))
    with pytest.raises(InputError, match="a_1: alignment none does not undo"):
        evaluate(rooms, said, METRIC, silent)


def test_several_protocols_share_one_look_at_the_files(rooms, twice):
    asked = []

    class Counting(type(twice)):
        def of(self, pair, number, view):
            asked.append(number)
            return twice.of(pair, number, view)

    found = evaluate_all(rooms, Counting(twice.items), (METRIC, PROTOCOLS["scale"]), silent)
    assert [each.results["abs_rel"].value for each in found] == pytest.approx([0.5, 0])
    assert sorted(asked) == [0, 1, 2]


def test_pairs_of_points_are_scored_by_their_order_alone(metric, shelf):
    image = np.zeros((1, 2, 3), np.uint8)
    pairs = shelf(*(OrdinalPair(name, image, (1, 0), (0, 0)) for name in "abc"))
    said = shelf(metric([[1, 2]]), metric([[3, 2]]), metric([[5, 6]]))
    found = evaluate(pairs, said, PROTOCOLS["whdr"], silent)
    assert found.results["whdr"].value == pytest.approx(1 / 3)
    with pytest.raises(InputError, match="this set holds pairs of points and no depth; try whdr"):
        evaluate(pairs, said, METRIC, silent)


def test_the_digest_tells_one_truth_from_another(rooms, twice, pair, shelf):
    other = shelf(rooms[0], rooms[1], pair("b_2", [[4, 4.001]]))
    first, second, third = (
        evaluate(each, twice, METRIC, silent).truth for each in (rooms, other, rooms)
    )
    assert first != second
    assert first == third
