import numpy as np
import pytest

from flexdepth.synth.patterns import PATTERNS, SIZE, fractal


@pytest.mark.parametrize("name", PATTERNS)
def test_every_pattern_gives_two_weights_between_0_and_1(name):
    pattern = PATTERNS[name](np.random.default_rng(1))
    assert pattern.shape == (SIZE, SIZE, 2)
    assert pattern.min() >= 0
    assert pattern.max() <= 1


def test_noise_repeats_without_a_seam():
    noise = fractal(np.random.default_rng(0), 2.0)
    inside = np.abs(np.diff(noise, axis=0)).mean()
    across = np.abs(noise[0] - noise[-1]).mean()
    assert across < 3 * inside
