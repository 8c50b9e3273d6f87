import numpy as np
import pytest

from flexdepth.evaluation.alignment import Fit
from flexdepth.evaluation.lines import Line
from flexdepth.evaluation.protocols import Averaging
from flexdepth.evaluation.score import ImageScore
from flexdepth.evaluation.summary import differences, estimates
from flexdepth.runtime.errors import InputError


def scores(*said):
    """Images as (name, pixels, mean square error)."""
    fit = Fit(Line(1.0), False)
    return [
        ImageScore(name, int(pixels), {"rmse": (float(mean),)}, fit) for name, pixels, mean in said
    ]


FRAMES = scores(("a_1", 100, 1.0), ("a_2", 300, 9.0), ("b_1", 600, 16.0))


@pytest.mark.parametrize(
    ("averaging", "wanted"),
    [
        # 1, 3 and 4 m
        (Averaging.IMAGES, 8 / 3),
        # 100 + 2700 + 9600 over 1000 pixels
        (Averaging.PIXELS, np.sqrt(12.4)),
        # 2 m, the mean of 1 and 3, and 4 m
        (Averaging.VIDEOS, 3.0),
        # √(2800 / 400) by 400 pixels, 4 by 600
        (Averaging.VIDEOS_BY_PIXELS, 0.4 * np.sqrt(7) + 0.6 * 4),
    ],
)
def test_images_become_one_number_in_four_ways(averaging, wanted):
    assert estimates(FRAMES, averaging)["rmse"].value == pytest.approx(wanted)


@pytest.mark.parametrize("averaging", Averaging)
def test_the_order_of_images_does_not_matter(averaging):
    turned = estimates(FRAMES[::-1], averaging)["rmse"].value
    assert turned == pytest.approx(estimates(FRAMES, averaging)["rmse"].value)


def test_one_image_or_one_video_has_no_interval():
    (alone,) = estimates(FRAMES[:1], Averaging.IMAGES).values()
    assert (alone.value, alone.low, alone.high) == (1.0, None, None)
    (video,) = estimates(FRAMES[:2], Averaging.VIDEOS).values()
    assert (video.low, video.high) == (None, None)


@pytest.mark.parametrize("averaging", [Averaging.IMAGES, Averaging.PIXELS])
def test_the_interval_is_that_of_images_drawn_again(averaging):
    draw = np.random.default_rng(1)
    pixels, squares = draw.integers(1, 1000, 80), draw.uniform(1, 9, 80)
    every = scores(
        *((f"x{n}_", p, s) for n, (p, s) in enumerate(zip(pixels, squares, strict=True)))
    )
    found = estimates(every, averaging)["rmse"]
    drawn = draw.integers(0, 80, (4000, 80))
    if averaging is Averaging.IMAGES:
        values = np.sqrt(squares)[drawn].mean(1)
    else:
        values = np.sqrt((pixels * squares)[drawn].sum(1) / pixels[drawn].sum(1))
    # 2000 and 4000 draws agree to a tenth of the interval's width.
    wanted = np.quantile(values, [0.025, 0.975])
    assert (found.low, found.high) == pytest.approx(tuple(wanted), abs=0.1 * np.ptp(wanted))
    assert found.low < found.value < found.high


def test_the_same_images_have_the_same_interval():
    first, second = (estimates(FRAMES, Averaging.IMAGES) for _ in range(2))
    assert first == second


def test_nothing_scored_is_no_result():
    with pytest.raises(InputError, match="no image has a score"):
        estimates([], Averaging.IMAGES)


def results(*values, metric="abs_rel"):
    return {f"i{n}": {metric: float(value)} for n, value in enumerate(values)}


def test_a_difference_that_every_image_shows_is_significant():
    hard = np.random.default_rng(0).uniform(0.1, 0.9, 40)
    (found,) = differences(results(*hard), results(*(hard - 0.01))).values()
    assert found.apart.value == pytest.approx(-0.01)
    assert found.p == pytest.approx(1 / 2001)
    assert found.second_better == 1
    assert found.apart.high < 0


def test_two_coins_do_not_differ():
    one, other = np.random.default_rng(0).uniform(0, 1, (2, 40))
    (found,) = differences(results(*one), results(*other)).values()
    assert found.p > 0.05
    assert found.apart.low < 0 < found.apart.high


def test_three_differences_of_one_sign_have_the_p_of_a_quarter():
    # Of the 8 ways to choose signs, 2 give a mean as large.
    (found,) = differences(results(1, 2, 3), results(2, 3, 4)).values()
    assert found.p == pytest.approx(0.25, abs=0.03)


def test_which_is_better_depends_on_the_metric():
    (found,) = differences(
        results(0.5, 0.5, 0.5, metric="delta1"), results(0.6, 0.4, 0.7, metric="delta1")
    ).values()
    assert found.second_better == pytest.approx(2 / 3)
    (found,) = differences(results(0.5, 0.5), results(0.4, 0.3)).values()
    assert found.second_better == 1


def test_only_images_of_both_are_compared():
    (found,) = differences(results(1, 1, 9), results(2, 2)).values()
    assert (found.first, found.second) == (1, 2)
    with pytest.raises(InputError, match="have 1 in common"):
        differences(results(1), results(2, 3))
    with pytest.raises(InputError, match="no metric in common"):
        differences(results(1, 2), results(1, 2, metric="rmse"))
