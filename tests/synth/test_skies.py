from dataclasses import replace

import numpy as np
import pytest

from flexdepth.synth.landscapes import under
from flexdepth.synth.scene import Sun
from flexdepth.synth.skies import weather
from flexdepth.synth.skylight import Dome


@pytest.fixture(scope="module")
def many():
    return [weather(np.random.default_rng([0, k])) for k in range(300)]


def test_there_are_sunny_overcast_and_dark_hours(many):
    sunny = sum(one.sun is not None for one in many) / len(many)
    assert 0.5 < sunny < 0.8
    assert 0.04 < sum(one.dark for one in many) / len(many) < 0.16
    assert not any(one.dark and one.sun for one in many)


def test_the_sun_is_above_the_horizon_and_brighter_than_the_sky(many):
    for one in many:
        if one.sun is not None and one.clouds < 0.1:
            assert np.linalg.norm(one.sun.towards) == pytest.approx(1)
            assert one.sun.towards[1] > 0
            assert one.sun.power.mean() > 0.8 * one.ambient.mean()


def sky(**changes):
    rng = np.random.default_rng(3)
    clear = replace(weather(rng), clouds=0.0, sun=None, zenith=np.array([0.1, 0.2, 0.5]),
                    horizon=np.array([0.6, 0.7, 0.8]))  # fmt: skip
    return Dome.drawn(rng, under(rng, [], replace(clear, **changes)))


def test_a_clear_sky_goes_from_horizon_to_zenith():
    light = sky().light(np.array([[0, 0, 2.0], [0, 3.0, 0], [1.0, -1, 0]], np.float32))
    assert light == pytest.approx(np.array([[0.6, 0.7, 0.8], [0.1, 0.2, 0.5], [0.6, 0.7, 0.8]]))


def test_the_sun_is_seen_where_it_stands_and_nowhere_else():
    towards = np.array([0.6, 0.0, 0.8])
    shining = sky(sun=Sun(towards, np.ones(3)))
    at, beside, behind = shining.light(np.array([towards, (1, 0, 0), -towards], np.float32))
    assert at.min() > 10
    assert 0.6 < beside[0] < 1
    assert behind == pytest.approx([0.6, 0.7, 0.8])


def test_clouds_hide_the_sky_where_they_are():
    ways = np.random.default_rng(0).normal(size=(2000, 3)).astype(np.float32)
    ways[:, 1] = np.abs(ways[:, 1])
    bare, clouded = (sky(clouds=share).light(ways)[:, 2] for share in (0.0, 0.4))
    same = np.isclose(bare, clouded, atol=1e-5).mean()
    assert 0.3 < same < 0.95
