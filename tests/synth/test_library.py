from itertools import pairwise

import numpy as np
import pytest

from flexdepth.synth.library import NAMES, PRINTS, WHOLE, Library
from flexdepth.synth.patterns import PATTERNS, SIZE


@pytest.fixture(scope="module")
def library():
    return Library.made(np.random.default_rng(0), 2)


def test_every_texture_has_its_layers(library):
    assert len(library.levels[0]) == 2 * len(NAMES)
    assert [library.layer(np.random.default_rng(0), name) // 2 for name in NAMES] == [
        *range(len(NAMES))
    ]


def test_a_pattern_shares_a_surface_out_among_its_three_colours(library):
    patterns = library.levels[0][: 2 * len(PATTERNS)].astype(int)
    assert np.abs(patterns.sum(-1) - WHOLE).max() <= 2


def test_a_texture_seen_from_afar_is_its_mean(library):
    layer = library.layer(np.random.default_rng(0), "checks")
    far = library.shares(np.array([layer]), np.array([[0.3, 0.8]]), np.array([1e4]))
    assert far[0] == pytest.approx(library.levels[0][layer].mean((0, 1)) / WHOLE, abs=1e-3)


def test_a_texture_seen_from_near_is_its_texel(library):
    layer = library.layer(np.random.default_rng(0), "collage")
    uv = np.array([[(10 + 0.5) / SIZE, (200 + 0.5) / SIZE], [3 + 10.5 / SIZE, -1 + 200.5 / SIZE]])
    near = library.shares(np.array([layer, layer]), uv, np.array([0.1, 0.1]))
    texel = library.levels[0][layer][200, 10] / WHOLE
    assert near == pytest.approx(np.stack([texel, texel]), abs=1e-6)


def test_between_two_texels_a_texture_is_their_mean(library):
    layer = library.layer(np.random.default_rng(0), "painting")
    between = library.shares(
        np.array([layer]), np.array([[11 / SIZE, 200.5 / SIZE]]), np.array([0.1])
    )
    pair = library.levels[0][layer][200, 10:12].astype(float) / WHOLE
    assert between[0] == pytest.approx(pair.mean(0), abs=1e-6)


def test_every_level_has_the_means_of_the_one_before(library):
    assert [level.shape[1] for level in library.levels] == [256, 128, 64, 32, 16, 8, 4, 2, 1]
    for fine, coarse in pairwise(library.levels):
        layers, side = coarse.shape[:2]
        means = fine.reshape(layers, side, 2, side, 2, 3).mean((2, 4), dtype=np.float64)
        assert np.abs(coarse - means).max() <= 0.5


def test_a_dark_gradient_has_no_steps(monkeypatch):
    """Two thousandths of white at one end, a hundredth at the other; 8 bits have three tones."""
    ramp = np.broadcast_to(np.linspace(0.002, 0.01, SIZE)[::-1, None, None], (SIZE, SIZE, 3))
    monkeypatch.setitem(PRINTS, "painting", lambda _: ramp)
    shown = Library.made(np.random.default_rng(0), 1)
    up = np.linspace(0.5, SIZE - 0.5, 4 * SIZE) / SIZE
    uv = np.stack([np.full_like(up, 0.5), up], 1)
    layer = np.full(len(uv), NAMES.index("painting"))
    light = shown.shares(layer, uv, np.full(len(uv), 0.5))[:, 0]
    assert len(np.unique(light)) > 500
    assert np.abs(np.diff(light) / light[1:]).max() < 0.01


@pytest.mark.parametrize("name", PRINTS)
def test_every_print_is_a_picture_in_colour(name):
    picture = PRINTS[name](np.random.default_rng(2))
    assert picture.shape == (SIZE, SIZE, 3)
    assert np.isfinite(picture).all()
    assert np.clip(picture, 0, 1).std() > 0.01


def test_a_print_hangs_the_right_way_up_on_a_wall_where_u_goes_left_and_v_up(library):
    rng = np.random.default_rng(0)
    for make in PATTERNS.values():
        make(rng), make(rng)
    first = next(iter(PRINTS.values()))(rng)
    hung = library.levels[0][2 * len(PATTERNS)] / WHOLE
    assert hung[3, 7] == pytest.approx(first[-4, -8].clip(0, 1), abs=1e-5)
    assert hung[-1, 20] == pytest.approx(first[0, -21].clip(0, 1), abs=1e-5)
