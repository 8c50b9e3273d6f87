from dataclasses import replace

import numpy as np
import pytest

from flexdepth.synth.landscapes import under
from flexdepth.synth.materials import Part, material
from flexdepth.synth.scene import Aim, Carrier
from flexdepth.synth.shapes import box
from flexdepth.synth.skies import weather
from flexdepth.synth.viewpoints import (
    BENT,
    CAR,
    FIXED,
    HAND,
    IN_ROOMS,
    ON_STAIRS,
    ROBOT,
    SEATED,
    STANDING,
    TALL_ROBOT,
    VACUUM,
    viewpoint,
)

RNG = np.random.default_rng(0)
WORLD = under(RNG, [], weather(RNG))
ROOM = {"eyes": (np.array([-3.0, 0, -2.0]), np.array([3.0, 2.4, 2.0])), "ceiling": 2.4}


def views(carrier, count=200, **changes):
    rng = np.random.default_rng(1)
    world = replace(WORLD, carriers=((1.0, carrier),), **changes)
    return [viewpoint(rng, world, 4 / 3) for _ in range(count)]


@pytest.mark.parametrize("carrier", [CAR, HAND, ROBOT, STANDING, SEATED, VACUUM, TALL_ROBOT])
def test_a_camera_is_as_high_as_its_carrier_holds_it(carrier):
    heights = [view.eye[1] for view in views(carrier)]
    low, high = carrier.height
    assert low <= min(heights) < low + 0.1 * (high - low)
    assert high - 0.1 * (high - low) < max(heights) <= high


def test_cars_look_along_the_road_and_level():
    forward = np.array([view.world_from_camera[:, 2] for view in views(CAR)])
    assert (np.abs(forward[:, 2]) > 0.9).all()
    assert np.abs(forward[:, 1]).max() < 0.15
    assert 0.3 < (forward[:, 2] > 0).mean() < 0.7


def test_a_subject_is_in_the_middle_of_the_picture():
    still = Carrier((1.0, 1.2), Aim.SUBJECT, 0.0, (0.0, 0.0), 0.0)
    subject = np.array([4.0, 2.0, 1.0])
    for view in views(still, 20, subject=subject):
        seen = view.world_from_camera.T @ (subject - view.eye)
        assert seen[:2] == pytest.approx([0, 0], abs=1e-9)
        assert seen[2] > 0


def test_the_width_of_the_picture_is_the_carriers():
    narrow = replace(HAND, view=(60.0, 60.0))
    for view in views(narrow, 3):
        # Half the width is 4/10 of the diagonal of a picture of 4 to 3.
        assert view.focal == pytest.approx(0.4 / np.tan(np.radians(30)))


def forward(found):
    return np.array([view.world_from_camera[:, 2] for view in found])


def pitches(found):
    return np.arcsin(forward(found)[:, 1])


def test_robots_hold_cameras_low_and_level_and_hands_do_not():
    robots, hands = (views(carrier, 300, **ROOM) for carrier in (VACUUM, STANDING))
    assert np.std(pitches(robots)) < 0.08
    assert np.std(pitches(hands)) > 0.15
    rolls = [
        np.std([np.arcsin(view.world_from_camera[1, 0]) for view in found])
        for found in (robots, hands)
    ]
    assert rolls[0] < 0.02
    assert rolls[1] > 0.045


def test_nobody_holds_a_camera_through_the_ceiling_or_a_wall():
    thing = Part(box((1.0, 1.0, 1.0), (0.1, 0.1, 0.1)), material(RNG, "wood"))
    low = {**ROOM, "ceiling": 1.6, "parts": [thing]}
    subjects = ((np.array([2.5, 0.0, 1.5]), np.array([3.5, 1.9, 2.5])),)
    for _, carrier in IN_ROOMS:
        eyes = np.array([view.eye for view in views(carrier, 100, subjects=subjects, **low)])
        assert (eyes >= ROOM["eyes"][0]).all()
        assert (eyes[:, [0, 2]] <= ROOM["eyes"][1][[0, 2]]).all()
        assert eyes[:, 1].max() <= 1.6


def test_a_fixed_camera_looks_down_into_the_room_from_its_edge():
    found = views(FIXED, 200, **ROOM)
    eyes = np.array([view.eye for view in found])
    reach = np.abs(eyes[:, [0, 2]]) / (3.0, 2.0)
    assert reach.max(1) == pytest.approx(1)
    assert (reach.min(1) < 0.99).mean() > 0.9
    assert (pitches(found) < 0).mean() > 0.97
    inwards = -(eyes * forward(found))[:, [0, 2]].sum(1)
    assert (inwards > 0).mean() > 0.95


def test_who_looks_at_a_thing_has_it_in_the_picture():
    thing = Part(box((9.0, 4.0, -6.0), (0.1, 0.1, 0.1)), material(RNG, "wood"))
    still = Carrier((1.0, 1.2), Aim.THING, 0.0, (0.0, 0.0), 0.0)
    for view in views(still, 50, parts=[thing], **ROOM):
        sight = np.array([9.0, 4.0, -6.0]) - view.eye
        # A quarter of a metre aside each way, ten metres away.
        assert view.world_from_camera[:, 2] @ sight / np.linalg.norm(sight) > np.cos(0.15)


def test_who_bends_over_a_thing_is_near_it():
    subjects = ((np.array([0.5, 0.0, 0.5]), np.array([1.0, 0.8, 0.7])),)
    found = views(BENT, 300, subjects=subjects, **ROOM)
    away = [np.linalg.norm(view.eye - np.clip(view.eye, *subjects[0]), ord=2) for view in found]
    assert max(away) < 1.5
    assert np.mean(np.array(away) > 0.3) > 0.5
    ahead = [view.world_from_camera[:, 2] @ (np.mean(subjects[0], 0) - view.eye) for view in found]
    assert np.mean(np.array(ahead) > 0) > 0.95


def test_on_stairs_a_camera_is_above_a_place_and_looks_along_the_slope():
    # A flight of 45 degrees towards z; the upper floor is two storeys up.
    places = np.array([(0.0, k, k) for k in np.arange(0, 6, 0.2)])
    still = replace(STANDING, yaw=0.0, pitch=(0.0, 0.0))
    found = views(still, 200, places=places, **ROOM)
    heights = np.array([np.min(np.abs(view.eye - places)[:, [0, 2]].sum(1)) for view in found])
    assert heights == pytest.approx(0, abs=1e-12)
    above = np.array([view.eye[1] - view.eye[2] for view in found])
    assert above.min() >= 1.2
    assert above.max() <= 1.8
    assert np.abs(pitches(found)) == pytest.approx(np.pi / 4)


def test_shares_of_who_holds_cameras_add_up_to_one():
    for who in (IN_ROOMS, ON_STAIRS):
        assert sum(share for share, _ in who) == pytest.approx(1)
