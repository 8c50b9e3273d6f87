import numpy as np
import pytest

from flexdepth.evaluation.region import (
    EIGEN,
    EIGEN_NYU,
    GARG,
    WHOLE,
    Box,
    KittiCrop,
)
from flexdepth.runtime.errors import InputError

# Every number here was published or worked out by hand for one image size.
PUBLISHED = {
    "Garg of a whole image": (GARG, (375, 1242), (153, 371, 44, 1197)),
    "Eigen of a whole image": (EIGEN, (375, 1242), (124, 342, 44, 1197)),
    "Garg of the benchmark crop": (GARG, (352, 1216), (143, 349, 43, 1172)),
    "Eigen of the benchmark crop": (EIGEN, (352, 1216), (117, 321, 43, 1172)),
    # 0.40810811 · 370 is 151.0000007, 0.99189189 · 370 is 366.9999993: every digit counts.
    "Garg of another size": (GARG, (370, 1224), (151, 366, 43, 1180)),
    "the benchmark crop": (KittiCrop(), (375, 1242), (23, 375, 13, 1229)),
    "Garg in the benchmark crop": (KittiCrop(GARG), (375, 1242), (166, 372, 56, 1185)),
    "Eigen on NYU": (EIGEN_NYU, (480, 640), (45, 471, 41, 601)),
    "everything": (WHOLE, (7, 9), (0, 7, 0, 9)),
}


@pytest.mark.parametrize("name", PUBLISHED)
def test_a_region_has_the_published_rows_and_columns(name):
    region, size, box = PUBLISHED[name]
    assert region.box(*size) == box


def test_the_two_gargs_score_different_numbers_of_pixels():
    assert np.prod(GARG.box(375, 1242).size) == 251_354
    assert np.prod(KittiCrop(GARG).box(375, 1242).size) == 232_574


def test_a_region_of_an_odd_width_is_cut_as_int_does():
    # (1241 - 1216) / 2 is 12.5, and with 1243 it is 13.5.
    assert KittiCrop().box(376, 1241) == Box(24, 376, 12, 1228)
    assert KittiCrop().box(376, 1243) == Box(24, 376, 13, 1229)


def test_garg_lies_inside_the_benchmark_crop_at_every_size_of_kitti():
    for size in ((370, 1224), (370, 1226), (374, 1238), (375, 1242), (376, 1241)):
        outer, inner = KittiCrop().box(*size), GARG.box(*size)
        assert outer.top <= inner.top
        assert inner.bottom <= outer.bottom
        assert outer.left <= inner.left
        assert inner.right <= outer.right


def test_other_sizes_than_the_published_are_refused():
    with pytest.raises(InputError, match="rows 45:471 and columns 41:601 of 640x480; the truth is"):
        EIGEN_NYU.box(240, 320)
    with pytest.raises(InputError, match="no image of KITTI"):
        KittiCrop().box(192, 640)


def test_a_box_cuts_what_its_size_says():
    box = PUBLISHED["Garg of a whole image"][0].box(375, 1242)
    assert np.zeros((375, 1242))[box.slices].shape == box.size == (218, 1153)
