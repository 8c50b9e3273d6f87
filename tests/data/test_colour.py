import io

import numpy as np
import pytest
from PIL import Image

from flexdepth.data.colour import (
    CHANGES,
    Colour,
    blurred,
    coarsened,
    compressed,
    equalised,
    noisy,
    sharpened,
    toned,
    with_other_spectrum,
    with_other_statistics,
)


def picture(height=48, width=64):
    row, column = np.mgrid[:height, :width]
    wave = 0.5 + 0.3 * np.sin(column / 5)[..., None] * np.cos(row / 7)[..., None]
    return (wave * (0.6, 0.8, 1.0)).astype(np.float32)


def test_colour_of_strength_0_leaves_the_image_alone():
    image = np.random.default_rng(0).integers(0, 256, (6, 7, 3), dtype=np.uint8)
    assert np.array_equal(Colour(0.0)(np.random.default_rng(1), image), image)


def test_colour_changes_the_image_but_not_its_kind():
    image = np.random.default_rng(0).integers(0, 256, (6, 7, 3), dtype=np.uint8)
    lit = Colour()(np.random.default_rng(1), image)
    assert lit.shape == image.shape
    assert lit.dtype == np.uint8
    assert not np.array_equal(lit, image)


def test_the_same_seed_is_the_same_colour_and_another_is_another():
    image = (255 * picture()).astype(np.uint8)
    once, again, other = (Colour()(np.random.default_rng(seed), image) for seed in (3, 3, 4))
    assert np.array_equal(once, again)
    assert not np.array_equal(once, other)


@pytest.mark.parametrize("change", [change for _, change in CHANGES])
def test_every_change_is_visible_finite_and_keeps_the_size(change):
    image = picture(37, 50)
    for seed in range(8):
        out = change(np.random.default_rng(seed), image)
        assert out.shape == image.shape
        assert out.dtype == np.float32
        assert np.isfinite(out).all()
        assert np.abs(out - image).max() > 1e-3


@pytest.mark.parametrize("change", [change for _, change in CHANGES])
def test_no_change_fails_on_an_image_of_one_colour(change):
    for level in (0.0, 1.0):
        assert np.isfinite(
            change(np.random.default_rng(0), np.full((20, 20, 3), level, "f4"))
        ).all()


def test_a_tone_curve_never_swaps_dark_and_bright():
    grey = np.repeat(np.arange(256, dtype=np.uint8)[None, :, None], 3, axis=2)
    for seed in range(20):
        out = toned(np.random.default_rng(seed), grey, 1.0)[0]
        assert (np.diff(out @ (0.299, 0.587, 0.114)) >= -1e-6).all()


def test_another_spectrum_keeps_the_mean_and_what_is_fine():
    image = np.random.default_rng(0).random((64, 64, 3)).astype(np.float32)
    for seed in range(6):
        out = with_other_spectrum(np.random.default_rng(seed), image)
        before, after = (np.fft.fft2(x, axes=(0, 1)) for x in (image, out))
        assert after[0, 0] == pytest.approx(before[0, 0], rel=1e-4)
        assert after[20:44, 20:44] == pytest.approx(before[20:44, 20:44], abs=1e-2)
        low = np.abs(np.fft.fftfreq(64)) < 0.02
        window = np.ix_(low, low)
        turned = np.angle(after[window] / before[window])
        assert np.abs(turned).max() < 1e-2


def test_other_statistics_move_the_mean_towards_one_that_photographs_have():
    dark = 0.05 * picture()
    seen = [with_other_statistics(np.random.default_rng(seed), dark) for seed in range(20)]
    assert all(0.08 < out.mean() < 0.7 for out in seen)
    assert all(out.std() > dark.std() for out in seen)


def test_blur_keeps_the_mean_and_lowers_the_contrast_and_sharpening_raises_it():
    image = np.random.default_rng(0).random((40, 40, 3)).astype(np.float32)
    for seed in range(9):
        soft, sharp = (f(np.random.default_rng(seed), image) for f in (blurred, sharpened))
        assert soft.mean() == pytest.approx(image.mean(), abs=0.01)
        assert soft.std() < image.std() < sharp.std()
        assert coarsened(np.random.default_rng(seed), image).std() < image.std()


def test_noise_has_no_mean():
    flat = np.full((64, 64, 3), 0.4, np.float32)
    for seed in range(6):
        out = noisy(np.random.default_rng(seed), flat)
        assert out.mean() == pytest.approx(0.4, abs=0.01)


def test_compression_is_mild_and_local_contrast_grows():
    image = picture()
    assert compressed(np.random.default_rng(0), image) == pytest.approx(image, abs=0.15)
    faint = 0.4 + 0.1 * picture()
    assert equalised(np.random.default_rng(0), faint).std() > faint.std()


@pytest.mark.parametrize("colour", [(255, 0, 0), (0, 0, 255), (255, 160, 0)])
def test_compression_is_that_of_a_photo_whatever_its_colour(colour):
    """JPEG keeps luma sharp, of which red has .299 and blue .114; Pillow is the reference."""
    row, column = np.mgrid[:32, :48]
    stripes = (((row // 3 + column // 5) % 2)[..., None] * np.array(colour)).astype(np.uint8)
    for seed in range(4):
        quality, file = int(np.random.default_rng(seed).integers(25, 92)), io.BytesIO()
        Image.fromarray(stripes).save(file, "JPEG", quality=quality, subsampling="4:2:0")
        out = compressed(np.random.default_rng(seed), stripes.astype(np.float32) / 255)
        assert 255 * out == pytest.approx(np.asarray(Image.open(file), np.float64), abs=3)


def test_a_frame_covers_the_edges_and_nothing_else():
    image = np.full((40, 60, 3), 90, np.uint8)
    seen = [Colour(1e-9, framed=1e9)(np.random.default_rng(seed), image) for seed in range(40)]
    assert all((picture[2:-2, 3:-3] == 90).all() for picture in seen)
    assert any((picture[0] != 90).all() for picture in seen)
    assert {int(picture[0, 0, 0]) for picture in seen} == {0, 90, 128, 255}
