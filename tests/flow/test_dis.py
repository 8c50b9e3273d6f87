import cv2
import numpy as np
import pytest

from flexdepth.data.tagged_floats import read_flow
from flexdepth.flow.dis import Dis
from flexdepth.runtime.errors import InputError


def test_a_sheet_that_slides_is_followed(cut):
    field = Dis().between(cut(), cut(right=3, down=-2))
    inner = field.flow[10:-10, 10:-10]
    assert np.abs(inner - (-3, 2)).max() < 0.1
    assert field.valid[10:-10, 10:-10].all()
    assert np.nanmax(field.noise[10:-10, 10:-10]) < 0.2
    assert not field.valid[:, :1].any()  # It has left the picture.


def test_the_same_frame_twice_has_not_moved(cut):
    field = Dis().between(cut(), cut())
    assert field.valid.all()
    assert np.abs(field.flow).max() < 1e-3


def test_colour_is_seen_as_gray(cut):
    key, target = cut(), cut(right=2)
    colour = [np.repeat(each[..., None], 3, axis=2) for each in (key, target)]
    np.testing.assert_array_equal(Dis().between(*colour).flow, Dis().between(key, target).flow)


def test_frames_that_cannot_be_matched_are_refused(cut):
    with pytest.raises(InputError, match="one size are wanted, got 160x120 and 160x119"):
        Dis().between(cut(), cut()[1:])
    with pytest.raises(InputError, match="at least 32x32 pixels are wanted, got 160x31"):
        Dis().between(cut()[:31], cut()[:31])
    with pytest.raises(InputError, match="the target frame has no texture"):
        Dis().between(cut(), np.full((120, 160), 77, np.uint8))
    with pytest.raises(InputError, match=r"grays correlate by 0\.\d+.*is there a cut between them"):
        Dis().between(cut(), cut(seed=1))
    snow = np.random.default_rng(0).integers(0, 256, (2, 240, 320)).astype(np.uint8)
    with pytest.raises(InputError, match=r"only \d% of the key frame is found again.*a cut"):
        Dis().between(*snow)


def test_the_noise_on_a_rendered_scene_is_about_the_error(samples):
    folder = samples / "flow_sintel_easy"
    truth = read_flow(folder / "gt" / "frame_0002.flo")
    frames = (folder / f"clean/easy/frame_000{number}.png" for number in (2, 3))
    field = Dis().between(*(cv2.imread(str(frame), cv2.IMREAD_GRAYSCALE) for frame in frames))
    assert field.coverage > 0.95
    error = np.abs(field.flow - truth)[field.valid]
    assert np.median(error) < 0.04
    noise = field.noise[field.valid]
    fifths = np.digitize(noise, np.quantile(noise, [0.2, 0.4, 0.6, 0.8]))
    for fifth in range(5):
        spread = np.median(error[fifths == fifth]) / 0.6745
        assert 0.4 < spread / np.median(noise[fifths == fifth]) < 1.2
