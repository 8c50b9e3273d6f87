from dataclasses import replace

import numpy as np
import pytest

from flexdepth.synth.landscapes import under
from flexdepth.synth.scene import Aim, Carrier
from flexdepth.synth.skies import weather
from flexdepth.synth.viewpoints import CAR, HAND, ROBOT, viewpoint

RNG = np.random.default_rng(0)
WORLD = under(RNG, [], weather(RNG))


def views(carrier, count=200, **changes):
    rng = np.random.default_rng(1)
    world = replace(WORLD, carriers=((1.0, carrier),), **changes)
    return [viewpoint(rng, world, 4 / 3) for _ in range(count)]


@pytest.mark.parametrize("carrier", [CAR, HAND, ROBOT])
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
