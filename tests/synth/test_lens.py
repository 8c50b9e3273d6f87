import numpy as np
import pytest

from flexdepth.synth.lens import Film, Optics, photograph


def optics(**changes):
    plain = {"vignette": 0.0, "blur": 0.01, "aperture": 0.0, "focus": 0.5}
    return Optics(**{**plain, **changes})


def two_halves(left, right, width=80, height=60):
    depth = np.full((height, width), left, np.float32)
    depth[:, width // 2 :] = right
    return depth


def checks(width=80, height=60):
    row, column = np.mgrid[:height, :width] // 3
    return np.repeat(((row + column) % 2).astype(np.float32)[..., None], 3, -1)


def test_the_same_generator_takes_the_same_picture():
    light, depth = checks(), two_halves(1.0, 4.0)
    once, again = (photograph(np.random.default_rng(5), light, depth, 70.0) for _ in range(2))
    assert once.dtype == np.uint8
    assert np.array_equal(once, again)
    assert not np.array_equal(once, photograph(np.random.default_rng(6), light, depth, 70.0))


def test_a_pinhole_has_everything_in_focus():
    light = checks()
    assert np.array_equal(optics().focused(light, two_halves(0.5, 9.0), 400.0), light)


def test_what_is_as_far_as_the_focus_is_sharp_and_the_rest_is_not():
    light = checks()
    # Two thirds of the middle are near, so that the median is there.
    depth = two_halves(1.0, 4.0)
    depth[:, :60] = 1.0
    seen = optics(aperture=0.03).focused(light, depth, 400.0)
    assert seen[:, 5:50] == pytest.approx(light[:, 5:50])
    # A disc of 0.03 * 400 * (1 - 1/4) = 9 pixels covers three squares of the board.
    assert seen[10:50, 70:].std() < 0.2 * light[10:50, 70:].std()


def test_blur_grows_with_the_difference_of_inverse_depths():
    light = checks()
    depth = np.full((60, 80), 2.0, np.float32)
    spread = []
    for far in (2.2, 3.0, 30.0):
        depth[:, 60:] = far
        spread.append(optics(aperture=0.03).focused(light, depth, 300.0)[10:50, 70:].std())
    assert spread[0] > spread[1] > spread[2]


def test_a_blurred_near_thing_spills_over_what_is_behind_and_not_the_other_way():
    light = np.zeros((60, 80, 3), np.float32)
    light[:, :30] = 1.0
    depth = np.full((60, 80), 5.0, np.float32)
    depth[:, :30] = 0.5
    far_sharp = optics(aperture=0.02, focus=0.9).focused(light, depth, 300.0)
    assert far_sharp[30, 32, 0] > 0.1
    depth[:, :30], depth[:, 30:] = 5.0, 0.5
    near_sharp = optics(aperture=0.02, focus=0.1).focused(light, depth, 300.0)
    assert near_sharp[30, 32, 0] == pytest.approx(0.0, abs=1e-6)


def test_sky_alone_can_be_photographed():
    light, depth = checks(), np.full((60, 80), np.inf, np.float32)
    assert np.isfinite(optics(aperture=0.03).focused(light, depth, 300.0)).all()


def test_corners_are_darker_by_the_vignette():
    flat = np.ones((100, 100, 3), np.float32)
    seen = optics(vignette=0.6).image(flat)
    assert seen[50, 50, 0] == pytest.approx(1, abs=1e-3)
    assert seen[0, 0, 0] == pytest.approx(1 - 0.6 / 2, abs=0.01)


def test_a_film_with_one_camera_takes_all_frames_alike_but_for_noise():
    film = Film.drawn(np.random.default_rng(3))
    light = checks() + 0.2
    first, second = (film.picture(np.random.default_rng(k), light).astype(float) for k in (1, 2))
    assert first.mean() == pytest.approx(second.mean(), abs=2)
