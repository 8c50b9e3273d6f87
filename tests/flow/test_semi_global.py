import numpy as np

from flexdepth.flow.dis import Dis
from flexdepth.flow.semi_global import apart, census, misfit, rough_flow


def test_a_sheet_that_goes_far_is_found_to_a_pixel(cut):
    found = rough_flow(cut(), cut(right=17, down=-9))
    inner = found[15:-15, 25:-25]
    assert np.median(np.abs(inner - (-17, 9)).max(axis=-1)) < 1
    assert (np.abs(inner - (-17, 9)).max(axis=-1) < 1).mean() > 0.95


def test_words_differ_in_the_bits_that_do():
    assert apart(np.uint64(0), np.uint64(0)) == 0
    assert apart(np.uint64(0b1011), np.uint64(0b0110)) == 3
    assert apart(np.uint64(0), np.uint64(2**48 - 1)) == 48


def test_the_census_knows_order_alone():
    gray = np.random.default_rng(0).integers(0, 100, (20, 20)).astype(np.uint8)
    np.testing.assert_array_equal(census(gray), census(2 * gray + 7))
    assert (census(np.full((20, 20), 9, np.uint8)) == 0).all()


def test_true_flow_fits_and_other_flow_does_not(cut):
    words = census(cut()), census(cut(right=4))
    flow = np.zeros((120, 160, 2), np.float32)
    flow[..., 0] = -4
    assert misfit(*words, flow)[20:-20, 20:-20].max() < 0.01
    assert misfit(*words, flow + 3)[20:-20, 20:-20].min() > 8


def test_a_small_thing_that_goes_far_is_found(cut):
    key, target, thing = cut(), cut(), cut(seed=5)[:24, :30]
    key[50:74, 30:60] = thing
    target[50:74, 50:80] = thing
    field = Dis().between(key, target)
    inner = field.flow[56:68, 38:52]
    assert np.abs(inner - (20, 0)).max() < 0.5
