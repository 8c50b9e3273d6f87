"""Images of rare distances are seen more often."""

import cv2
import numpy as np
import pytest

from flexdepth.data.even_folder import EvenFolder, times_seen
from flexdepth.data.folder import Folder
from flexdepth.runtime.depthmap import DepthMap, FocalSource, Intrinsics, Space
from flexdepth.runtime.errors import InputError
from flexdepth.runtime.files import write_depth


def folder_of(root, depths, focals=None):
    """Write an image of each depth, half of it sky; a name says its number."""
    (root / "image").mkdir()
    for number, depth in enumerate(depths):
        focal = 7.0 if focals is None else focals[number]
        camera = Intrinsics.centred(8, 6, focal, FocalSource.GIVEN)
        values = np.full((6, 8), depth, np.float32)
        values[:3] = np.inf
        truth = DepthMap(values, Space.METRIC, camera)
        write_depth(root / "depth" / f"{number:02d}.npz", truth, None)
        cv2.imwrite(str(root / "image" / f"{number:02d}.png"), np.zeros((6, 8, 3), np.uint8))
    return root


def seen(folder):
    """Return how many times each image is given."""
    pairs = folder.load()
    names = [int(pairs[place].name) for place in range(len(pairs))]
    return np.bincount(names).tolist()


@pytest.mark.parametrize(("most", "often"), [(4.0, 4), (9.0, 8)])
def test_one_of_nine_that_is_ten_times_as_far_is_seen_as_often_as_allowed(tmp_path, most, often):
    """Eight lie together, one away from them: its density is an eighth."""
    root = folder_of(tmp_path, [2.0] * 4 + [20.0] + [2.0] * 4)
    assert seen(EvenFolder(root, power=1.0, most=most)) == [1] * 4 + [often] + [1] * 4
    assert seen(EvenFolder(root, power=0.0, most=most)) == [1] * 9


def test_what_looks_as_large_counts_as_equally_far(tmp_path):
    """Twice as far with twice the focal length."""
    root = folder_of(tmp_path, [2.0] * 3 + [4.0], [7.0] * 3 + [14.0])
    assert seen(EvenFolder(root, power=1.0)) == [1, 1, 1, 1]


def test_what_shows_nothing_but_sky_is_seen_once(tmp_path):
    root = folder_of(tmp_path, [2.0] * 4 + [np.inf, 20.0])
    assert seen(EvenFolder(root, power=1.0)) == [1, 1, 1, 1, 1, 4]
    assert np.array_equal(times_seen(np.full(3, np.nan), 1.0, 4.0), np.ones(3))


def test_distances_that_are_even_already_stay_even():
    """Away from both ends, where the density falls off."""
    times = times_seen(np.linspace(0, 4, 4001), 1.0, 4.0)
    assert times[800:-800] == pytest.approx(np.ones(2401), rel=0.03)


@pytest.mark.parametrize("power", [0.3, 0.8, 1.0])
def test_a_normal_distribution_is_seen_as_its_density_says(power):
    """Of ln distance, with a deviation of .8; the kernel adds its own variance of .04."""
    drawn = np.random.default_rng(0).normal(1.0, 0.8, 20_000)
    times = times_seen(drawn, power, 1e9)
    middle = np.abs(drawn - 1) < 1.2
    expected = np.exp(0.5 * power * (drawn - 1) ** 2 / (0.64 + 0.04))
    ratio = (times / expected)[middle]
    assert ratio / np.median(ratio) == pytest.approx(np.ones(middle.sum()), rel=0.15)


def test_fractions_add_up(tmp_path):
    """Twenty at 2 m and eight at 20 m: each of these is seen (20/8)^.8 = 2.08 times."""
    root = folder_of(tmp_path, [2.0] * 20 + [20.0] * 8)
    found = seen(EvenFolder(root))
    assert found[:20] == [1] * 20
    assert sum(found[20:]) == round(8 * 2.5**0.8)


def test_its_parts_are_those_of_a_folder(tmp_path):
    root = folder_of(tmp_path, [2.0] * 12)
    for part in ("first", "last"):
        even, plain = EvenFolder(root, part).load(), Folder(root, part).load()
        assert [even[k].name for k in range(len(even))] == [
            plain[k].name for k in range(len(plain))
        ]


def test_depth_without_a_camera_is_named(tmp_path):
    root = folder_of(tmp_path, [2.0])
    bare = DepthMap(np.ones((6, 8), np.float32), Space.METRIC)
    write_depth(root / "depth" / "00.npz", bare, None)
    with pytest.raises(InputError, match=r"00\.npz: training needs metric depth with a camera"):
        EvenFolder(root).load()


@pytest.mark.parametrize(("power", "most"), [(-0.1, 4.0), (1.1, 4.0), (0.5, 0.5), (0.5, np.inf)])
def test_a_power_or_number_of_times_out_of_range_is_refused(power, most):
    with pytest.raises(InputError, match="wanted a power from 0 to 1"):
        EvenFolder(power=power, most=most)
