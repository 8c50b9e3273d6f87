"""Which moving regions are one thing."""

import cv2
import numpy as np
import pytest

from flexdepth.solvers.answer import Kind
from flexdepth.solvers.pose import Pose
from flexdepth.solvers.region_motion import RegionMotion
from flexdepth.solvers.sight import Sight
from flexdepth.solvers.things import Thing, own_turn, things

HEIGHT, WIDTH, FOCAL = 48, 64, 60.0
PERSON, CAR = np.s_[8:40, 10:26], np.s_[14:26, 26:38]
ASIDE = Pose(np.eye(3), np.array([-1.0, 0.0, 0.0]))


def found(flow_of_car):
    """Return the things of a picture in which somebody who bends is seen beside a car."""
    row, column = np.mgrid[:HEIGHT, :WIDTH] + 0.5
    key = np.stack(
        [(column - WIDTH / 2) / FOCAL, (row - HEIGHT / 2) / FOCAL, np.ones_like(row)], -1
    )
    flow = np.zeros((HEIGHT, WIDTH, 2))
    flow[..., 0] = -1.0
    bending = np.stack([np.cos(row) * np.sin(column / 2), np.sin(row / 2) * np.cos(column)], -1)
    flow[PERSON] = ((5.0, 0.0) + 1.2 * bending)[PERSON]
    flow[CAR] = flow_of_car
    target = key.copy()
    target[..., :2] += flow / FOCAL
    labels = np.zeros((HEIGHT, WIDTH), np.int32)
    labels[PERSON], labels[CAR] = 1, 2
    trusted = np.ones((HEIGHT, WIDTH), bool)
    sight = Sight(key, target, flow, np.full((HEIGHT, WIDTH), 0.05), trusted, np.full(2, FOCAL))
    return things(labels, labels, sight, ASIDE, 0.012)[1]


def test_a_car_that_passes_behind_somebody_is_a_thing_of_its_own():
    person, car = found((-6.0, 0.0))
    assert (person.kind, car.kind) == (Kind.FLEXIBLE, Kind.RIGID)


def test_what_is_carried_goes_with_its_carrier():
    (both,) = found((5.0, 0.0))
    assert len(both.labels) == 2


@pytest.mark.parametrize(("kind", "turn"), [(Kind.RIGID, 0.2), (Kind.FLEXIBLE, 0.0)])
def test_how_far_a_thing_turns_is_told_beside_the_camera(kind, turn):
    camera, own = (Pose(cv2.Rodrigues(np.array([0, a, 0.0]))[0], np.zeros(3)) for a in (0.1, 0.3))
    one = np.ones(4)
    assert own_turn(
        Thing((1,), (RegionMotion(kind, own, one, one, 0.0),)), camera
    ) == pytest.approx(turn)
