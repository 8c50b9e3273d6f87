from dataclasses import replace

import numpy as np
import pytest

from flexdepth.data.views import OrdinalPair
from flexdepth.evaluation.alignment import Alignment
from flexdepth.evaluation.catalogue import PROTOCOLS
from flexdepth.evaluation.protocols import Range, Scope
from flexdepth.evaluation.score import (
    ImageScore,
    LeftOut,
    image_score,
    ordinal_score,
    points_of,
    seen_by,
    video_fit,
    video_of,
)
from flexdepth.runtime.depthmap import Space
from flexdepth.runtime.errors import InputError

METRIC, MEDIAN = PROTOCOLS["metric"], PROTOCOLS["scale"]


def score(pair, prediction, protocol=METRIC):
    return image_score(pair.name, seen_by(protocol, pair.truth, prediction), protocol)


@pytest.mark.parametrize(
    ("name", "video"),
    [
        ("alley_1_frame_0001", "alley_1_frame"),
        ("2011_09_26_drive_0001_sync_image_02_0000000005", "2011_09_26_drive_0001_sync_image_02"),
        ("bathroom_0001_00045", "bathroom_0001"),
        ("frame-000010.color", "frame"),
        ("0001", ""),
        ("kitchen", "kitchen"),
    ],
)
def test_a_frame_belongs_to_what_its_name_is_without_its_last_number(name, video):
    assert video_of(name) == video


def test_the_median_comes_before_the_clamp(pair, metric):
    # Truth 30, 60, 70 and prediction 1, 2, 9: the factor is 60 / 2 = 30, and 270 is clamped to 80.
    # Clamped first nothing would change, but after the factor 270 would stay 270.
    found = score(pair("a", [[30, 60, 70]]), metric([[1, 2, 9]], Space.SCALE), MEDIAN)
    assert found.fit.line.factor == 30
    assert found.values["abs_rel"] == pytest.approx((0 + 0 + 10 / 70) / 3)


def test_the_median_of_what_is_clamped_afterwards_is_that_of_the_raw_prediction(pair, metric):
    # Raw predictions beyond the cap take part in the median as they are: 200, not 80.
    found = score(pair("a", [[10, 20, 40]]), metric([[100, 200, 400]]), MEDIAN)
    assert found.fit.line.factor == pytest.approx(0.1)
    assert found.values["abs_rel"] == pytest.approx(0, abs=1e-6)


def test_how_sure_a_prediction_is_does_not_change_its_score(pair, metric):
    room, plain = pair("a", [[1, 2, 0, 4], [5, 6, 7, 8]]), metric([[1, 2, 3, 3], [5, 5, 7, 9]])
    sure = replace(plain, spread=np.full((2, 4), 0.1, np.float32), scale_spread=0.2)
    assert score(room, sure).values == score(room, plain).values
    half = metric([[3, 7]])
    spread = replace(half, spread=np.full((1, 2), 0.1, np.float32))
    assert score(room, spread).values == score(room, half).values


def test_an_image_without_truth_is_left_out_and_never_scored_0(pair, metric):
    found = score(pair("dark", [[0, 0, 90]]), metric([[1, 1, 1]]))
    assert found == LeftOut("dark", "no pixel has truth where the protocol scores")


def test_a_prediction_that_is_unknown_where_truth_is_known_is_refused(pair, metric):
    with pytest.raises(InputError, match="room: the prediction has no depth > 0 at 1 of 2"):
        score(pair("room", [[1, 2]]), metric([[1, np.nan]]))


def test_bts_scores_the_unknown_as_a_millimetre(pair, metric):
    lenient = replace(METRIC, unknown=1e-3)
    found = score(pair("room", [[1, 2]]), metric([[1, np.nan]]), lenient)
    assert found.values["abs_rel"] == pytest.approx((0 + (2 - 1e-3) / 2) / 2)


def test_sky_is_scored_as_the_depth_that_it_stands_for(pair, metric):
    found = score(pair("road", [[1, 40]]), metric([[1, np.inf]]))
    assert found.values["abs_rel"] == pytest.approx((0 + 1) / 2)


def test_only_what_the_protocol_scores_counts(pair, metric):
    protocol = replace(METRIC, scored=Range(1e-3, 10.0))
    found = score(pair("room", [[5, 50, 0]]), metric([[10, 1, 1]]), protocol)
    assert (found.pixels, found.values["abs_rel"]) == (1, 1.0)


def test_a_fit_too_weak_for_prediction_or_truth_is_refused(pair, metric):
    with pytest.raises(InputError, match="does not undo what a prediction in the space scale"):
        score(pair("a", [[1, 2]]), metric([[1, 2]], Space.SCALE))
    with pytest.raises(InputError, match="does not undo what a prediction in the space scale"):
        score(pair("a", [[1, 2]], Space.SCALE), metric([[1, 2]]))
    found = score(pair("a", [[1, 2]], Space.SCALE), metric([[3, 6]]), MEDIAN)
    assert found.values["abs_rel"] == pytest.approx(0, abs=1e-7)


def frames(pair, metric):
    """Two frames whose disparity is 2 / truth + 1, and one with another line, without truth."""
    truths = [[[1, 2]], [[4, 8]], [[0, 0]]]
    said = [[[3, 2]], [[1.5, 1.25]], [[9, 9]]]
    return [
        (pair(f"v_{n}", truth), metric(values, Space.AFFINE_DISPARITY))
        for n, (truth, values) in enumerate(zip(truths, said, strict=True))
    ]


def test_one_line_in_disparity_fits_a_whole_video(pair, metric):
    sintel = PROTOCOLS["sintel-depthcrafter"]
    points = [
        points_of(seen_by(sintel, each.truth, prediction), sintel)
        for each, prediction in frames(pair, metric)
    ]
    fit = video_fit(points, sintel)
    assert fit.inverse
    assert (fit.line.factor, fit.line.offset) == pytest.approx((0.5, -0.5), abs=1e-9)


def test_a_video_is_not_the_sum_of_its_frames(pair, metric):
    """Frames that need different factors fit alone, and not together."""
    video = replace(MEDIAN, per=Scope.VIDEO, alignment=Alignment.SCALE)
    alike = [
        (pair("v_1", [[1, 2]]), metric([[1, 2]], Space.SCALE)),
        (pair("v_2", [[4, 8]]), metric([[2, 4]], Space.SCALE)),
    ]
    seen = [seen_by(video, each.truth, prediction) for each, prediction in alike]
    fit = video_fit([points_of(each, video) for each in seen], video)
    # Σxy / Σx² = (1 + 4 + 8 + 32) / (1 + 4 + 4 + 16)
    assert fit.line.factor == pytest.approx(45 / 25)
    found = image_score("v_1", seen[0], video, fit)
    assert found.values["abs_rel"] == pytest.approx(0.8)
    alone = image_score("v_1", seen[0], video)
    assert alone.values["abs_rel"] == pytest.approx(0)


def test_the_median_of_a_video_is_taken_over_all_its_frames(pair, metric):
    video = replace(MEDIAN, per=Scope.VIDEO)
    alike = [(pair("v_1", [[1, 2]]), [[2, 4]]), (pair("v_2", [[10, 10]]), [[5, 5]])]
    seen = [seen_by(video, each.truth, metric(values, Space.SCALE)) for each, values in alike]
    # Medians of 1, 2, 10, 10 and of 2, 4, 5, 5: 6 and 4.5.
    fit = video_fit([points_of(each, video) for each in seen], video)
    assert fit.line.factor == pytest.approx(6 / 4.5)


def test_a_video_without_truth_has_no_fit(pair, metric):
    nothing = frames(pair, metric)[2]
    for protocol in (PROTOCOLS["sintel-depthcrafter"], replace(MEDIAN, per=Scope.VIDEO)):
        prediction = replace(nothing[1], space=Space.METRIC)
        points = points_of(seen_by(protocol, nothing[0].truth, prediction), protocol)
        assert video_fit([points], protocol) is None


def test_disparity_below_the_least_is_raised_before_the_fit_and_after(pair, metric):
    sintel = replace(PROTOCOLS["sintel-depthcrafter"], per=Scope.IMAGE)
    values = [[1.0, 0.5, -7.0]]
    # -7 counts as 0.001, so the line is that of 1/truth itself.
    found = score(pair("v_1", [[1, 2, 60]]), metric(values, Space.AFFINE_DISPARITY), sintel)
    by_hand = np.polyfit([1.0, 0.5, 1e-3], [1, 1 / 2, 1 / 60], 1)
    assert (found.fit.line.factor, found.fit.line.offset) == pytest.approx(tuple(by_hand))
    depth = 1 / np.maximum(np.polyval(by_hand, [1.0, 0.5, 1e-3]), 1 / 70)
    wanted = np.mean(np.abs(depth - [1, 2, 60]) / [1, 2, 60])
    assert found.values["abs_rel"] == pytest.approx(wanted, rel=1e-6)


def test_edges_are_scored_of_whole_maps_and_without_any_the_image_is_left_out(pair, metric):
    boundary = PROTOCOLS["boundary"]
    truth = np.ones((5, 5))
    truth[2, 2] = 2
    found = score(pair("a", truth), metric(truth), boundary)
    assert found.values == {"boundary_f1": pytest.approx(1)}
    flat = score(pair("wall", np.ones((4, 4))), metric(np.ones((4, 4))), boundary)
    assert flat == LeftOut("wall", "the truth has no edge where the protocol scores")


def test_an_ordinal_pair_is_right_or_wrong(metric):
    photo = OrdinalPair("p", np.zeros((1, 3, 3), np.uint8), farther=(2, 0), nearer=(0, 0))
    whdr = PROTOCOLS["whdr"]
    rising, falling = [[1, 2, 3]], [[3, 2, 1]]
    assert ordinal_score(photo, metric(rising), whdr).values == {"whdr": 0}
    assert ordinal_score(photo, metric(falling), whdr).values == {"whdr": 1}
    near = metric(falling, Space.AFFINE_DISPARITY)
    assert ordinal_score(photo, near, whdr).values == {"whdr": 0}


def test_a_score_is_worth_what_its_means_say(pair, metric):
    found = score(pair("a", [[1, 4]]), metric([[2, 2]]))
    assert isinstance(found, ImageScore)
    assert found.values["rmse"] == pytest.approx(np.sqrt((1 + 4) / 2))
    assert found.values["silog"] == pytest.approx(100 * np.log(2))
