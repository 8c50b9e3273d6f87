import json

import numpy as np
import pytest
from PIL import Image

from flexdepth.runtime.depthmap import DepthMap, Space
from flexdepth.runtime.errors import InputError

INF, NAN = np.inf, np.nan
LENGTH = 32


@pytest.fixture
def stability(room):
    return room("stability")


def seeing_red(photo):
    """Take the red of a pixel for its depth; red 1 is sky."""
    red = photo.pixels[..., 0].astype(np.float32)
    return DepthMap(np.where(red == 1, np.float32(INF), red), Space.SCALE)


def picture(height=40, width=56):
    """Reds that are multiples of ten, all different in a row and from row to row."""
    steps = np.random.default_rng(0).integers(1, 20, (height, width))
    return np.repeat((10 * steps).astype(np.uint8)[..., None], 3, axis=2)


def test_depth_is_compared_after_one_factor_and_sky_apart(stability):
    first = np.array([1.0, 2.0, 4.0, INF, 3.0, 5.0, INF])
    again = np.array([2.0, 4.0, 8.8, 7.0, INF, NAN, INF])
    said = stability.moved(first, again)
    assert said.factor == 2.0
    assert said.median == 0.0
    # Nine tenths of the way through 0, 0, .1.
    assert said.most == pytest.approx(0.08)
    # Two of the six that were seen again.
    assert said.sky == pytest.approx(1 / 3)


def test_a_picture_that_is_all_sky_is_refused(stability):
    with pytest.raises(InputError, match="all sky"):
        stability.moved(np.full(3, INF), np.ones(3))


@pytest.mark.parametrize("name", ["shift 1", "shift 8", "mirror"])
def test_who_sees_each_pixel_by_itself_is_not_moved_by_place(stability, name):
    said = stability.shown_again(seeing_red, picture())[name]
    assert (said.median, said.most, said.factor, said.sky) == (0.0, 0.0, 1.0, 0.0)


def test_who_sees_brightness_is_off_by_one_factor(stability):
    said = stability.shown_again(seeing_red, picture())["brighter"]
    assert said.factor == pytest.approx(1.1)
    assert said.most == pytest.approx(0, abs=1e-6)


def test_who_takes_the_place_in_the_picture_for_depth_is_moved_by_a_shift(stability):
    def seeing_columns(photo):
        across = np.arange(1, photo.pixels.shape[1] + 1, dtype=np.float32)
        return DepthMap(np.tile(across, (len(photo.pixels), 1)), Space.SCALE)

    said = stability.shown_again(seeing_columns, picture())["shift 8"]
    # 40 columns are in both: 9 to 48 at first, 1 to 40 later.
    ratio = np.arange(1, 41) / np.arange(9, 49)
    assert said.factor == pytest.approx(np.median(ratio))
    assert said.median == pytest.approx(np.median(np.abs(ratio / np.median(ratio) - 1)))


def test_a_shifted_map_goes_back_to_where_it_was(room):
    changes = room("changes")
    depth = np.arange(12, dtype=np.float32).reshape(3, 4)
    back = changes.shifted(1).back(depth, (3, 4))
    assert np.isnan(back[0]).all()
    assert np.isnan(back[:, 0]).all()
    np.testing.assert_array_equal(back[1:, 1:], [[0, 1, 2], [4, 5, 6]])


def test_a_smaller_map_goes_back_to_its_size(room):
    smaller = room("changes").smaller(0.5)
    wide = np.zeros((28, 48, 3), np.uint8)
    assert smaller.shown(wide).shape == (10, 20, 3)
    depth = np.array([[1, 2], [3, INF]], np.float32)
    wanted = [[1, 1, 2, 2], [1, 1, 2, 2], [3, 3, INF, INF], [3, 3, INF, INF]]
    np.testing.assert_array_equal(smaller.back(depth, (4, 4)), wanted)


def test_colours_change_as_much_as_is_said(room):
    changes = room("changes")
    assert changes.brighter(np.array([0, 100, 250], np.uint8)).tolist() == [0, 110, 255]
    gray = np.full((200, 200, 3), 128, np.uint8)
    noise = changes.noisy(gray) - 128.0
    # Rounding to whole steps adds a variance of 1/12.
    assert noise.std() == pytest.approx(np.sqrt(4 + 1 / 12), abs=0.02)
    assert noise.mean() == pytest.approx(0, abs=0.03)
    rough = picture()
    assert changes.compressed(rough).shape == rough.shape
    assert np.abs(changes.compressed(rough) - rough.astype(float)).max() > 2


def plane(level=0.5, right=0.0, down=0.0, height=LENGTH, width=LENGTH):
    """Inverse depth that is affine in the pixel."""
    rows, columns = np.mgrid[:height, :width]
    return level + right * columns + down * rows


def flat(room, seen, true):
    """Return the flatness of inverse depths."""
    return room("flatness").flatness(1 / seen, 1 / true, np.ones(true.shape, bool))


def test_the_truth_times_any_factor_is_flat(room):
    true = plane(0.5, 0.001, 0.002, 2 * LENGTH + 7, 3 * LENGTH)
    said = flat(room, 3 * true, true)
    assert said.windows == 6
    assert said.bent == pytest.approx(0, abs=1e-12)
    assert said.tilted == pytest.approx(0, abs=1e-12)


def test_one_depth_everywhere_is_flat_and_leans_wrongly(room):
    true = plane(0.5, 0.001, 0.002)
    said = flat(room, plane(2.0), true)
    assert said.bent == pytest.approx(0, abs=1e-12)
    # 0 ... 31 have the variance (32² - 1) / 12 and the mean 15.5.
    rises = np.hypot(0.001, 0.002) * np.sqrt((LENGTH**2 - 1) / 12)
    assert said.level == pytest.approx(rises / (0.5 + 0.003 * 15.5))
    assert said.tilted == pytest.approx(said.level)


def test_a_rough_map_is_bent_by_its_roughness_alone(room):
    rows, columns = np.mgrid[:LENGTH, :LENGTH]
    rough = 1 + 0.01 * (-1.0) ** (rows + columns)
    said = flat(room, 3 * rough, plane(0.25))
    assert said.bent == pytest.approx(0.01)
    assert said.tilted == pytest.approx(0, abs=1e-12)


def test_only_windows_whose_truth_is_a_plane_count(room):
    true = plane(height=LENGTH, width=4 * LENGTH)
    true[:, LENGTH + 20 : 2 * LENGTH] = 0.25
    across = np.arange(LENGTH)
    true[:, 2 * LENGTH : 3 * LENGTH] += 1e-4 * (across - 15.5) ** 2
    known = np.ones(true.shape, bool)
    known[5, -1] = False
    module = room("flatness")
    assert module.flatness(1 / true, 1 / true, known).windows == 1
    assert module.flatness(1 / true, 1 / true, np.zeros(true.shape, bool)) is None


def test_a_window_that_is_taken_for_sky_is_wholly_off(room):
    said = room("flatness").flatness(
        np.full((LENGTH, LENGTH), INF), np.ones((LENGTH, LENGTH)), np.ones((LENGTH, LENGTH), bool)
    )
    assert (said.bent, said.tilted) == (1.0, 1.0)


def test_images_count_the_same_whatever_their_windows(room):
    module = room("flatness")
    found = [module.Flatness(1, 0.1, 0.2, 0.3), module.Flatness(9, 0.3, 0.4, 0.5)]
    said = module.mean_over_images(found)
    assert said == pytest.approx(
        {"images": 2, "windows": 10, "bent": 0.2, "tilted": 0.3, "level": 0.4}
    )


def test_photos_are_shown_at_one_size_and_printed(stability, monkeypatch, tmp_path, capsys):
    Image.fromarray(picture(80, 128)).save(tmp_path / "one.png")
    sizes = []

    def predict(photo):
        sizes.append(photo.pixels.shape[:2])
        return seeing_red(photo)

    loaded = type("Loaded", (), {"predict": staticmethod(predict)})
    monkeypatch.setattr(stability.flexdepth, "load", lambda _name: loaded)
    command = ["stability.py", "--photos", str(tmp_path), "--rendered", str(tmp_path / "none")]
    monkeypatch.setattr("sys.argv", command)
    stability.main()
    printed = capsys.readouterr()
    # 640 x 400 less the eight pixels that shifts need.
    assert sizes[0] == (392, 632)
    assert "| one | 0.0 | 0.0 | 0.0 |" in printed.out
    assert "skipped rendered: no folder" in printed.err
    monkeypatch.setattr("sys.argv", [*command, "--json"])
    stability.main()
    said = json.loads(capsys.readouterr().out)
    assert said["stable"]["photos"]["one"]["mirror"]["median"] == 0.0
    assert said["flat"] == []
