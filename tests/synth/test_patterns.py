import numpy as np
import pytest

from flexdepth.synth.patterns import PATTERNS, SIZE, Library, fractal


@pytest.fixture(scope="module")
def library():
    return Library.made(np.random.default_rng(0), 2)


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


def test_a_pattern_seen_from_afar_is_its_mean(library):
    layer = library.layer(np.random.default_rng(0), "checks")
    far = library.weights(np.array([layer]), np.array([[0.3, 0.8]]), np.array([1e4]))
    assert far[0] == pytest.approx(library.levels[0][layer].mean((0, 1)) / 255, abs=0.02)


def test_a_pattern_seen_from_near_is_its_texel(library):
    layer = library.layer(np.random.default_rng(0), "collage")
    uv = np.array([[(10 + 0.5) / SIZE, (200 + 0.5) / SIZE], [3 + 10.5 / SIZE, -1 + 200.5 / SIZE]])
    near = library.weights(np.array([layer, layer]), uv, np.array([0.1, 0.1]))
    texel = library.levels[0][layer][200, 10] / 255
    assert near == pytest.approx(np.stack([texel, texel]), abs=1e-6)
