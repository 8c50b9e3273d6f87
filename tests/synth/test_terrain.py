from dataclasses import replace

import numpy as np
import pytest

from flexdepth.synth.terrain import Terrain


def drawn(seed, **changes):
    return replace(Terrain.drawn(np.random.default_rng(seed), 10.0, 80.0, 12.0), **changes)


@pytest.mark.parametrize("seed", range(4))
def test_the_middle_is_exactly_level(seed):
    x, z = np.random.default_rng(seed).uniform(-12 / np.sqrt(2), 12 / np.sqrt(2), (2, 200))
    assert (drawn(seed).height(x, z) == 0).all()


def test_hills_rise_where_the_view_ends_and_nowhere_else():
    land = drawn(1, relief=np.zeros(9))
    angle = np.linspace(0, 6.3, 400)
    near, far = (land.height(r * np.sin(angle), r * np.cos(angle)) for r in (land.rim[0] - 1, 1500))
    assert (near == 0).all()
    assert 0.3 * land.peaks < far.max() < 2 * land.peaks


def test_a_lake_is_as_deep_as_said_and_the_shore_is_dry():
    land = drawn(2, relief=np.zeros(9), peaks=0.0, basin=(0.0, 20.0, 100.0, 6.0))
    depth = land.height(np.zeros(4), np.array([19.0, 70.0, 100.0, 300.0]))
    assert depth == pytest.approx([0, -6, -6, 0])


def test_rings_of_land_meet_without_a_gap():
    land = drawn(3)
    inner, outer = land.mesh(0.0, 40.0), land.mesh(40.0, 900.0)
    last = inner.corners.reshape(-1, 3)
    first = outer.corners.reshape(-1, 3)
    rim = [np.unique(c[np.abs(np.hypot(c[:, 0], c[:, 2]) - 40) < 1e-6].round(6), axis=0)
           for c in (last, first)]  # fmt: skip
    assert len(rim[0]) > 100
    assert rim[0] == pytest.approx(rim[1], abs=1e-5)


def test_spots_lie_on_the_land_between_two_distances():
    land = drawn(4)
    spots = land.spots(np.random.default_rng(0), 300, (5.0, 200.0))
    away = np.hypot(spots[:, 0], spots[:, 2])
    assert ((away >= 5) & (away <= 200)).all()
    assert spots[:, 1] == pytest.approx(land.height(spots[:, 0], spots[:, 2]))


def test_textures_wander_over_the_land_and_never_fold():
    mesh = drawn(5).mesh(3.0, 60.0)
    place = mesh.corners[..., [0, 2]]
    assert np.abs(mesh.uv - place).max() > 0.7
    edges = [corners[:, 1:] - corners[:, :1] for corners in (place, mesh.uv)]
    turns = [np.linalg.det(pair) for pair in edges]
    large = np.abs(turns[0]) > 1e-6
    assert (turns[1][large] / turns[0][large] > 0).all()
