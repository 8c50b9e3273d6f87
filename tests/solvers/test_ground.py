"""The ground that things stand on."""

import numpy as np
import pytest

from flexdepth.solvers.ground import ground

HEIGHT, WIDTH = 60, 80


def cluttered(floor_share, rough=0.0):
    """Return rays, and inverse depth: a floor 1.5 below, seen in a part of the lower half.

    It is rough by up to a part of its inverse depth.

    What stands before it is at many depths, so that no plane but the floor is large.
    """
    row, column = np.mgrid[:HEIGHT, :WIDTH] + 0.5
    key = np.stack([(column - WIDTH / 2) / 70, (row - 20) / 70, np.ones_like(row)], -1)
    random = np.random.default_rng(3)
    inverse = random.uniform(0.5, 2.0, (HEIGHT, WIDTH))
    floor = np.zeros((HEIGHT, WIDTH), bool)
    floor[HEIGHT // 2 :, : round(floor_share * WIDTH)] = True
    bumps = 1 + random.uniform(-rough, rough, (HEIGHT, WIDTH))
    return key, np.where(floor, bumps * key[..., 1] / 1.5, inverse)


def test_a_floor_that_a_fifth_of_the_lower_half_shows_is_the_ground():
    found = ground(*cluttered(0.2), np.ones((HEIGHT, WIDTH), bool))
    np.testing.assert_allclose(found.plane, [0, 1 / 1.5, 0], atol=1e-3)
    assert found.share == pytest.approx(0.22, abs=0.05)


def test_what_a_twentieth_of_it_shows_is_not():
    assert ground(*cluttered(0.05), np.ones((HEIGHT, WIDTH), bool)) is None


def test_what_only_spreads_about_a_plane_must_be_larger_to_be_the_ground():
    everywhere = np.ones((HEIGHT, WIDTH), bool)
    assert ground(*cluttered(0.2, rough=0.03), everywhere) is None
    assert ground(*cluttered(0.4, rough=0.03), everywhere) is not None
