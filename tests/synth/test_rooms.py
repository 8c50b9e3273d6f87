from dataclasses import replace

import numpy as np
import pytest

from flexdepth.synth.rooms import (
    HOME,
    cellar,
    cookery,
    corridor,
    furnished,
    home,
    office,
    shop,
)
from flexdepth.synth.stage import Stage
from flexdepth.synth.viewpoints import viewpoint


@pytest.mark.parametrize("make", [home, office, cookery, shop, corridor, cellar])
def test_a_room_is_closed_and_cameras_stand_inside(make):
    for seed in range(2):
        scene = make(np.random.default_rng([3, seed]))
        corners = np.concatenate([part.mesh.corners.reshape(-1, 3) for part in scene.parts[:1]])
        low, high = corners.min(0), corners.max(0)
        assert (scene.eyes[0][[0, 2]] >= low[[0, 2]]).all()
        assert (scene.eyes[1][[0, 2]] <= high[[0, 2]]).all()
        assert scene.eyes[0][1] <= scene.eyes[1][1]
        assert not scene.outdoors
        assert len(scene.lamps) >= 1


def test_sunlight_comes_in_from_outside():
    kind = replace(HOME, pictures=9.0, dark=0.0)
    rooms = [furnished(np.random.default_rng(seed), kind) for seed in range(6)]
    beams = [beam for room in rooms for beam in room.beams]
    assert beams
    for beam in beams:
        outward = np.cross(beam.along, beam.up)
        middle = beam.corner + (beam.along + beam.up) / 2
        outward = outward * np.sign(outward @ (middle * (1, 0, 1)))
        assert beam.towards @ outward > 0


def test_what_is_worth_a_look_from_near_is_inside_the_room():
    scene = cookery(np.random.default_rng(2))
    assert scene.subjects
    for low, high in scene.subjects:
        assert (low <= high).all()


def test_no_ray_leaves_a_room_even_through_an_open_door(library, monkeypatch):
    monkeypatch.setattr("flexdepth.synth.rooms._OPEN", 1.0)
    for seed in range(3):
        rng = np.random.default_rng([5, seed])
        scene = home(rng)
        stage = Stage.built(rng, scene, library)
        eyes = rng.uniform(*scene.eyes, (20000, 3)).astype(np.float32)
        ways = rng.normal(size=eyes.shape).astype(np.float32)
        _, far = stage.hits(eyes, ways, 100.0)
        assert np.isfinite(far).all()


def test_hands_robots_and_fixed_cameras_see_a_room_from_their_heights():
    scene = office(np.random.default_rng(1))
    rng = np.random.default_rng(2)
    heights = np.array([viewpoint(rng, scene, 4 / 3).eye[1] for _ in range(1000)])
    assert heights.min() > 0
    assert heights.max() <= scene.ceiling
    for low, high, share in ((0, 0.6, 0.1), (0.7, 1.2, 0.25), (1.2, 1.8, 0.5), (2.1, 4, 0.05)):
        assert ((heights > low) & (heights < high)).mean() == pytest.approx(share, abs=0.08)
