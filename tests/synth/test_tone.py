import numpy as np
import pytest

from flexdepth.synth.tone import Tone, srgb

STRAIGHT = Tone(0.18, np.ones(3), 0.0, 1.0, 1.0)


def test_the_geometric_mean_becomes_the_wanted_grey():
    light = np.exp(np.random.default_rng(0).normal(3, 1, (20, 20, 1))) * np.ones(3)
    exposed = STRAIGHT.exposed(light.astype(np.float32))
    assert np.exp(np.log(exposed).mean()) == pytest.approx(0.18, rel=1e-3)


def test_srgb_has_the_values_of_the_standard():
    # IEC 61966-2-1: 0.0031308 is where the two pieces meet; 0.214041 is encoded as 0.5.
    linear = np.array([0.0, 0.0031308, 0.2140411, 1.0], np.float32)
    assert srgb(linear) == pytest.approx([0, 0.04045, 0.5, 1], abs=1e-4)


def test_a_straight_tone_is_plain_srgb():
    grey = np.linspace(0, 1, 11, dtype=np.float32)[None, :, None] * np.ones(3, np.float32)
    assert STRAIGHT.encoded(grey) == pytest.approx(srgb(grey), abs=1e-4)


@pytest.mark.parametrize("seed", range(8))
def test_brighter_light_is_never_shown_darker(seed):
    tone = Tone.drawn(np.random.default_rng(seed))
    ramp = np.geomspace(1e-3, 20, 200, dtype=np.float32)[None, :, None] * np.ones(3, np.float32)
    shown = tone.encoded(ramp)[0, :, 1]
    assert (np.diff(shown) >= -1e-5).all()
    assert shown.min() >= 0
    assert shown.max() <= 1


def test_without_saturation_a_picture_is_grey():
    colours = np.random.default_rng(0).random((5, 5, 3)).astype(np.float32)
    shown = Tone(0.18, np.ones(3), 0.3, 1.2, 0.0).encoded(colours)
    assert np.ptp(shown, axis=-1).max() < 1e-6
