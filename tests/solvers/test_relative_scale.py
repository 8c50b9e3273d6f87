"""The scale of a thing that moves by itself, from what is seen of it."""

from dataclasses import replace

import numpy as np
import pytest

from flexdepth.solvers.answer import Evidence, Kind
from flexdepth.solvers.borders import Border, Surroundings, nearness_beside
from flexdepth.solvers.clues import HABITS, Clues
from flexdepth.solvers.ground import Ground
from flexdepth.solvers.places import places
from flexdepth.solvers.relative_scale import least_error, relative_scale

FLOOR = Ground(np.array([0.0, 1.0, 0.0]), 1.0)
"""The camera is one way of its own above it."""

LEVEL = {"motion": np.array([0.9, 0.0, 0.2]), "way": np.array([0.3, 0.0, 0.0])}
"""Camera and thing move level, so that every scale is level: only its place tells."""


def border(ratio, *, foot):
    """Return a border 40 pixels high with 20 pixels at the foot, and 20 above it at each side."""
    row = np.concatenate([np.full(20, 80), np.linspace(40, 79, 40).astype(int)])
    down = np.arange(60) < 20
    slope = np.where(down & foot, 0.01, 0.0)
    nothing = np.zeros(60)
    ratios = np.where(down, ratio, 0.3)
    return Border(row, np.arange(60), down, ratios, slope, nothing + 5.0, nothing, row[down])


def clues(*, foot=True, beneath=None, **other):
    """Return those of a rigid thing that moves level at s = 1, half the camera's height in size.

    `foot` tells whether its foot is seen, and `beneath` ln s at which the lowest that is seen of
    it is on the ground.
    """
    seen = Clues(
        kind=Kind.RIGID,
        border=border(1.0, foot=foot),
        motion=np.array([0.9, 0.2, 0.2]),
        turn=0.0,
        wobble=0.0,
        way=np.array([0.3, 0.2, 0.0]),
        floor=FLOOR,
        typical=-1.0,
        size=0.5,
        rest=None,
        foot=beneath,
    )
    return replace(seen, **other)


def test_what_stands_and_moves_level_has_the_scale_of_its_contact():
    found = relative_scale(clues())
    assert found.evidence is Evidence.CONTACT
    assert found.value == pytest.approx(1.0, abs=0.03)
    assert found.confidence > 0.8


def test_a_ball_lies_where_it_touches_the_ground_not_where_ground_is_seen_below_it():
    found = relative_scale(clues(rest=float(np.log(1.06)), border=border(1.0, foot=True)))
    assert found.value == pytest.approx(1.06, abs=0.03)


def test_a_ball_lies_on_the_ground_even_if_its_lowest_part_is_out_of_sight():
    found = relative_scale(clues(foot=False, beneath=-0.3, rest=0.2, **LEVEL))
    assert found.value == pytest.approx(np.exp(0.2), abs=0.03)
    assert found.evidence is Evidence.CONTACT


def stands(seen):
    """Return ln s at which a thing most likely stands where its foot is seen; None if nowhere."""
    grid, (standing, *_) = places(seen, HABITS[seen.kind])
    return float(grid[standing.argmax()]) if standing.any() else None


def test_what_hides_a_part_of_the_foot_is_not_what_it_stands_on():
    # Below 4 of the 20 pixels of its foot a bed is seen, twice as near as the ground.
    beside_a_bed = border(1.0, foot=True)
    beside_a_bed.ratio[:4] = 2.0
    assert stands(clues(border=beside_a_bed)) == pytest.approx(0.0, abs=0.01)


def test_what_bends_stands_a_little_nearer_than_what_is_seen_below_its_feet():
    assert stands(clues()) == pytest.approx(0.0, abs=0.011)
    assert stands(clues(kind=Kind.FLEXIBLE)) == pytest.approx(0.05, abs=0.011)


def test_hems_that_the_picture_cuts_off_are_no_feet():
    # Ground is seen below 20 of its 80 lowest pixels; the others are at the picture's edge.
    whole = border(1.0, foot=True)
    cut = replace(whole, lower=np.concatenate([whole.lower, np.full(60, 80)]))
    assert stands(clues(kind=Kind.FLEXIBLE, border=whole)) is not None
    assert stands(clues(kind=Kind.FLEXIBLE, border=cut)) is None
    assert stands(clues(border=cut)) == stands(clues())


def test_what_tumbles_is_in_the_air_though_its_foot_seems_to_be_seen():
    upright, tumbles, noisy, unknown = (
        relative_scale(clues(tips=tips, **LEVEL))
        for tips in ((0.0, 1e-4), (0.05, 1e-4), (0.05, 0.1), None)
    )
    assert upright.evidence is Evidence.CONTACT
    assert upright.confidence > unknown.confidence
    assert tumbles.evidence is not Evidence.CONTACT
    assert tumbles.value > 1.2
    # Noise may have turned it.
    assert noisy.evidence is Evidence.CONTACT


def test_a_thing_hardly_hangs_on_to_what_is_behind_all_that_it_hides():
    # 10 of the 60 pixels of its border move with what is still, at s = .3.
    def hangs(behind_it):
        seen = border(1.0, foot=False)
        seen.ratio[:], seen.ratio[:10], seen.jump[:10] = behind_it, 0.3, 0.0
        _, (_, hanging, *_) = places(clues(border=seen), HABITS[Kind.FLEXIBLE])
        return hanging.max()

    assert hangs(behind_it=1.0) < 0.2 * hangs(behind_it=0.2)


def test_what_hides_its_foot_is_nearer_than_the_ground_at_its_lowest_visible_part():
    upright = {"foot": False, "tips": (0.0, 1e-4), **LEVEL}
    found = [relative_scale(clues(beneath=at, **upright)) for at in (-0.5, 0.0, 0.5)]
    for at, scale in zip((-0.5, 0.0, 0.5), found, strict=True):
        assert 1.05 * np.exp(at) < scale.value < 2 * np.exp(at)
        assert scale.evidence is not Evidence.CONTACT
        assert scale.confidence < 0.3


def test_where_ground_is_seen_all_along_below_a_thing_its_foot_is_hardly_hidden():
    seen, covered = (
        places(clues(foot=foot, beneath=0.0), HABITS[Kind.RIGID])[1][3] for foot in (True, False)
    )
    assert covered.max() > 0
    np.testing.assert_allclose(seen, 0.3 * covered)


def test_what_hides_its_foot_has_the_scale_at_which_it_moves_level():
    # a = (.9, .3, .2) rises by .3 / s - .2: it is level at s = 1.5, ln s = .41.
    rising = np.array([0.9, 0.3, 0.2])
    found = relative_scale(clues(foot=False, beneath=0.0, motion=rising))
    assert found.value == pytest.approx(1.5, rel=0.05)
    assert found.evidence is Evidence.MOTION


def test_a_car_ahead_that_drives_as_the_camera_does_is_not_one_that_stays():
    # At s = 3 its middle would keep its place; it stands on the ground at s = 1.
    ahead, way = np.array([0.003, 0.0, 0.9]), np.array([0.0, 0.0, 0.3])
    large = {"motion": ahead, "way": way, "size": 3.0}
    assert relative_scale(clues(**large)).value == pytest.approx(1.0, abs=0.05)
    # As large as that it is likelier to be three times as near, if it may turn where it stays.
    assert relative_scale(clues(turn=0.2, **large)).value == pytest.approx(3.0, rel=0.2)


def test_in_the_air_what_would_be_as_large_as_a_house_is_nearer_than_that():
    # Its motion has no scale at which it is level.
    away = {"foot": False, "way": np.array([0.3, 0.0, 0.2])}
    large, small = (relative_scale(clues(size=size, **away)) for size in (5.0, 0.5))
    assert large.value > 1.4 * small.value
    assert max(large.confidence, small.confidence) < 0.3


def test_in_doubt_a_thing_is_put_where_the_error_is_the_smaller():
    # s is 1 or 2. To say 2 is wrong by a half of the depth, to say 1 by all of it.
    grid, even = np.log([1.0, 2.0]), np.array([0.5, 0.5])
    assert least_error(grid, even) == grid[1]
    # At odds of 4 to 1 both weigh .8 and .4.
    assert least_error(grid, np.array([0.8, 0.2])) == grid[0]


def test_a_limb_is_as_near_as_the_body_that_it_touches():
    # Without a foot, and small enough to be a thing of its own much nearer than that.
    limb = clues(foot=False, size=0.1, way=np.array([0.3, 0.0, 0.2]))
    assert relative_scale(replace(limb, beside=-0.5)).value == pytest.approx(np.exp(-0.5), rel=0.05)


def test_what_stands_elsewhere_is_no_part_of_what_it_touches():
    assert relative_scale(clues(beside=-1.5)).value == pytest.approx(1.0, abs=0.05)


def side_by_side(jump):
    """Return a region, its inverse depth, its right neighbour's, and flow that jumps between."""
    inside, other = np.zeros((6, 20), bool), np.full((6, 20), np.nan)
    inside[:, :10], other[:, 10:] = True, 3.0
    flow = np.zeros((6, 20, 2))
    flow[:, 10:, 0] = jump
    everywhere = np.ones((6, 20), bool)
    around = Surroundings(np.zeros((6, 20)), everywhere, flow, everywhere, 1)
    return inside, np.full((6, 20), 2.0), other, around


def test_a_region_is_as_near_as_its_neighbour_where_their_borders_say_so():
    inside, own, other, around = side_by_side(jump=1.0)
    assert nearness_beside(inside, own, other, around) == pytest.approx(1.5)
    other[:, 10:13] = np.nan
    assert nearness_beside(inside, own, other, around) is None


def test_what_moves_differently_passes_by_and_is_not_joined():
    assert nearness_beside(*side_by_side(jump=6.0)) is None


def test_only_where_motion_goes_on_are_two_regions_joined():
    inside, own, other, around = side_by_side(jump=1.0)
    around.flow[:3, 10:, 0] = 6.0
    other[:3, 10:] = 9.0
    assert nearness_beside(inside, own, other, around) == pytest.approx(1.5)


def test_a_camera_that_stays_tells_no_scale():
    found = relative_scale(clues(way=np.zeros(3)))
    assert (found.evidence, found.confidence, found.spread) == (Evidence.UNKNOWN, 0.0, np.inf)


def test_a_picture_tells_where_a_thing_is_whose_foot_is_out_of_sight():
    # It is nearer than the ground at its lowest visible part: frames do not show by how much.
    upright = {"foot": False, "beneath": 0.0, "tips": (0.0, 1e-4), **LEVEL}
    alone = relative_scale(clues(**upright))
    found = [relative_scale(clues(told=(at, 0.1), **upright)) for at in (0.2, 0.5)]
    assert found[0].value < alone.value < found[1].value
    assert all(each.spread < 0.7 * alone.spread for each in found)
    assert all(each.evidence is Evidence.PRIOR for each in found)


def test_a_picture_hardly_moves_what_is_seen_to_touch_the_ground():
    found = relative_scale(clues(told=(-0.3, 0.2)))
    assert found.value == pytest.approx(1.0, abs=0.04)
    assert found.evidence is Evidence.CONTACT


def test_what_tumbles_stays_before_what_the_picture_puts_it_into():
    # The picture has it as far as the wall behind it, at s = .3.
    flies = {"foot": False, "tips": (0.3, 1e-4), "motion": np.array([0.9, -0.4, 0.2])}
    alone, found = (relative_scale(clues(told=told, **flies)) for told in (None, (-1.2, 0.2)))
    assert found.value > 0.75 * alone.value


def test_where_nothing_else_tells_of_a_things_scale_the_picture_does():
    nowhere = border(1.0, foot=False)
    nowhere = replace(nowhere, **{each: getattr(nowhere, each)[:0] for each in vars(nowhere)})
    away = {"border": nowhere, "way": np.array([0.3, 0.0, 0.2])}
    alone, found = (relative_scale(clues(told=told, **away)) for told in (None, (0.7, 0.1)))
    assert alone.evidence is Evidence.UNKNOWN
    assert found.evidence is Evidence.PRIOR
    assert np.isfinite(found.spread)
    assert found.confidence > 0
