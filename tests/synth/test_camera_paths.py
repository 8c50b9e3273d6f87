import numpy as np
import pytest

from flexdepth.synth.camera_paths import hand_held, on_car, on_robot
from flexdepth.synth.viewpoints import Viewpoint, looking

START = Viewpoint(np.array([1.0, 1.5, -2.0]), looking(0.3, -0.1, 0.05), 0.7)
PATHS = (hand_held, on_robot, on_car)


def path(make, seed=0):
    return make(np.random.default_rng(seed), START)


@pytest.mark.parametrize("make", PATHS)
def test_a_path_begins_at_its_start_and_stays_a_rotation(make):
    way = path(make)
    assert way.at(0.0).eye == pytest.approx(way.start.eye)
    assert way.at(0.0).world_from_camera == pytest.approx(START.world_from_camera)
    for time in (0.1, 3.0):
        rotation = way.at(time).world_from_camera
        assert rotation.T @ rotation == pytest.approx(np.eye(3), abs=1e-12)
        assert np.linalg.det(rotation) == pytest.approx(1)


@pytest.mark.parametrize("make", PATHS)
def test_a_longer_stride_goes_further_and_turns_as_before(make):
    way = path(make)
    twice = way.striding(2.0)
    for time in (0.2, 1.7):
        gone = way.at(time).eye - way.start.eye
        assert twice.at(time).eye - way.start.eye == pytest.approx(2 * gone)
        assert twice.at(time).world_from_camera == pytest.approx(way.at(time).world_from_camera)


def test_a_robot_is_low_and_drives_where_it_looks():
    way = path(on_robot)
    assert 0.2 <= way.start.eye[1] <= 1.1
    gone = way.at(0.01).eye - way.start.eye
    ahead = START.world_from_camera[[0, 2], 2]
    assert gone[[0, 2]] @ ahead > 0.9 * np.linalg.norm(gone) * np.linalg.norm(ahead)


def test_a_car_follows_the_road_for_metres_a_second():
    gone = path(on_car).at(1.0).eye - START.eye
    assert gone[2] > 1.5
    assert abs(gone[0]) < 0.1 * gone[2]


def test_hands_tremble_more_than_cars():
    def unrest(make):
        ways = [path(make, seed) for seed in range(8)]
        return np.mean([np.abs(way.wobble).sum() for way in ways])

    assert unrest(hand_held) > 2 * unrest(on_car)
