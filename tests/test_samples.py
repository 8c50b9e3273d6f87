"""The bundled model on real pictures, where there are any."""

import cv2
import numpy as np
import pytest

import flexdepth
from flexdepth.evaluation.alignment import Alignment, aligned
from flexdepth.evaluation.metrics import abs_rel
from flexdepth.runtime.depthmap import DepthMap, Space

SCENES = {
    "kitchen": (
        "indoor_7scenes_redkitchen/frames/frame-000010.color.jpg",
        "indoor_7scenes_redkitchen/frames/frame-000010.depth.png",
        1000.0,
        10.0,
    ),
    "basement": (
        "mixed_metric3d_kitti_nyu_wild/nyu_demo/rgb/rgb_00050.jpg",
        "mixed_metric3d_kitti_nyu_wild/nyu_demo/depth/sync_depth_00050.png",
        1000.0,
        10.0,
    ),
    "road": (
        "mixed_metric3d_kitti_nyu_wild/kitti_demo/rgb/0000000050.png",
        "mixed_metric3d_kitti_nyu_wild/kitti_demo/depth/0000000050.png",
        256.0,
        80.0,
    ),
}


@pytest.mark.parametrize("scene", SCENES)
def test_a_real_scene_is_seen_better_than_a_flat_wall_or_a_slanted_one(samples, scene):
    photo, measured, codes_per_metre, cap = SCENES[scene]
    truth = cv2.imread(str(samples / measured), cv2.IMREAD_UNCHANGED) / codes_per_metre
    valid = (truth > 1e-3) & (truth < cap)

    def error(prediction):
        fitted = aligned(prediction, Alignment.LEAST_SQUARES_DISPARITY, truth, valid, cap)
        return abs_rel(fitted, truth, valid)

    rows = np.linspace(2, 1, truth.shape[0], dtype=np.float32)[:, None]
    slant = DepthMap(np.broadcast_to(1 / (3 - rows), truth.shape).copy(), Space.SCALE)
    wall = DepthMap(np.ones(truth.shape, np.float32), Space.SCALE)
    seen = error(flexdepth.predict(samples / photo))
    assert seen < min(error(wall), error(slant))


def test_every_odd_picture_gets_a_depth_map_of_its_own_size(samples):
    photos = sorted((samples / "wild_depth_anything_v2").glob("*.jpg"))[:4]
    assert photos
    for photo in photos:
        depth_map = flexdepth.predict(photo)
        height, width = cv2.imread(str(photo)).shape[:2]
        assert depth_map.values.shape == (height, width)
        assert (depth_map.valid | depth_map.sky).all()
        assert depth_map.values.min() > 0


def test_the_sky_over_a_road_is_sky_and_the_road_is_not(samples):
    seen = flexdepth.predict(samples / SCENES["road"][0])
    height = seen.values.shape[0]
    assert seen.sky[: height // 4].mean() > 0.15
    assert seen.sky[height // 2 :].mean() < 0.01
