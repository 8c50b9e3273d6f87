import io

import numpy as np
import pytest
from PIL import Image

from flexdepth.synth.sensor import Sensor

FLAT = np.full((64, 64, 3), 0.25, np.float32)


def sensor(**changes):
    silent = {
        "shot": 0.0, "read": 0.0, "grain": 0.3, "blotch": 0.0, "smear": 0.0, "sharpening": 0.0,
        "quality": 100,
    }  # fmt: skip
    return Sensor(**{**silent, **changes})


def test_a_silent_sensor_only_rounds():
    assert np.array_equal(sensor().noisy(np.random.default_rng(0), FLAT), FLAT)
    assert (sensor().developed(FLAT) == round(255 * 0.25)).all()


def test_shot_noise_grows_with_the_root_of_the_light():
    rng = np.random.default_rng(0)
    dim, bright = (
        (sensor(shot=1e-3).noisy(rng, level * FLAT) - level * FLAT).std() for level in (0.5, 2.0)
    )
    assert bright / dim == pytest.approx(2, rel=0.05)


def test_read_noise_is_there_in_the_dark():
    dark = np.zeros((64, 64, 3), np.float32)
    assert sensor(read=0.01).noisy(np.random.default_rng(0), dark).std() == pytest.approx(
        0.01, rel=0.3
    )
    assert not sensor(shot=1e-2).noisy(np.random.default_rng(0), dark).any()


def test_noise_has_no_mean():
    out = sensor(shot=1e-3, read=0.01, blotch=1.0).noisy(np.random.default_rng(1), FLAT)
    assert out.mean() == pytest.approx(0.25, abs=2e-3)


def test_smoothing_takes_noise_and_leaves_edges():
    noisy = FLAT + np.random.default_rng(0).normal(0, 0.02, FLAT.shape).astype(np.float32)
    noisy[:, 32:] += 0.5
    shown = sensor(smear=0.1).developed(noisy).astype(float) / 255
    assert shown[:, 5:27].std() < 0.6 * noisy[:, 5:27].std()
    assert shown[:, 34:].mean() - shown[:, :30].mean() == pytest.approx(0.5, abs=0.02)


def test_sharpening_leaves_halos():
    edge = FLAT.copy()
    edge[:, 32:] = 0.75
    shown = sensor(sharpening=1.0).developed(edge)
    assert shown[30, 31, 0] < round(255 * 0.25) - 10
    assert shown[30, 32, 0] > round(255 * 0.75) + 10


def test_compression_changes_little_and_colours_stay_in_their_channels():
    picture = np.zeros((64, 64, 3), np.float32)
    picture[..., 0] = np.linspace(0.2, 0.8, 64)
    shown = sensor(quality=60).developed(picture).astype(float) / 255
    assert np.abs(shown - picture).mean() < 0.02


@pytest.mark.parametrize("colour", [(230, 20, 20), (20, 20, 230), (30, 200, 90)])
@pytest.mark.parametrize("quality", [30, 60, 89])
def test_a_saved_picture_is_what_pillow_saves(colour, quality):
    """JPEG keeps luma sharp, of which red has .299 and blue .114."""
    row, column = np.mgrid[:32, :48]
    stripes = (((row // 3 + column // 5) % 2)[..., None] * np.array(colour)).astype(np.uint8)
    file = io.BytesIO()
    Image.fromarray(stripes).save(file, "JPEG", quality=quality, subsampling="4:2:0")
    shown = sensor(quality=quality).developed(stripes.astype(np.float32) / 255)
    assert shown == pytest.approx(np.asarray(Image.open(file)).astype(int), abs=1)


def test_less_light_means_more_noise():
    bright, dark = (
        np.mean([Sensor.drawn(np.random.default_rng(k), level).read for k in range(50)])
        for level in (0.3, 0.05)
    )
    assert dark > 2 * bright
