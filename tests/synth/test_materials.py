import numpy as np
import pytest

from flexdepth.synth.library import NAMES, PRINTS
from flexdepth.synth.materials import fitted, material, shown
from flexdepth.synth.surfaces import KINDS, NATURE


@pytest.mark.parametrize("kind", [*KINDS, *NATURE])
def test_every_kind_gives_physical_surfaces(kind):
    for seed in range(12):
        look = material(np.random.default_rng(seed), kind)
        assert look.pattern in NAMES
        assert look.colours.shape == (3, 3)
        assert 0 <= look.gloss < 1
        assert min(look.size) > 0
        # A print's colours are added, so that white paper gives back at most all light.
        most = look.colours.sum(0) if look.pattern in PRINTS else look.colours.max(0)
        assert (look.colours >= 0).all()
        assert (most <= 1.0).all()


@pytest.mark.parametrize("kind", [*KINDS, *NATURE])
def test_every_texture_that_a_kind_names_exists(kind):
    table = KINDS[kind] if kind in KINDS else NATURE[kind]
    assert set(table.patterns) <= set(NAMES)


def test_a_fitted_print_covers_a_thing_once():
    assert fitted(np.random.default_rng(0), "picture", 0.4, 0.3).size == (0.4, 0.3)


def test_a_screen_shines_with_the_prints_own_colours():
    lit = shown("display", (0.5, 0.3), 2.0)
    assert lit.colours == pytest.approx(2 * np.eye(3))
    assert lit.glow == 1
