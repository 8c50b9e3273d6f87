from dataclasses import replace

import numpy as np
import pytest

from flexdepth.runtime.depthmap import FocalSource, Intrinsics
from flexdepth.solvers.planes import with_planes
from flexdepth.solvers.seen import Seen
from flexdepth.solvers.two_frame import (
    Evidence,
    Kind,
    Region,
    TwoFrameSettings,
    Unknown,
    two_frame,
)

SIZE = 60, 80
CAMERA = Intrinsics.centred(80, 60, 90.0, FocalSource.GIVEN)
ROW, COLUMN = np.mgrid[: SIZE[0], : SIZE[1]]
SLANTED = 0.1 + COLUMN / 80 * 0.2
"""Inverse depth of a wall that comes nearer to the right."""


@pytest.fixture
def answer():
    """What is found of a camera that goes to the right before a slanted wall and a floor."""
    inverse = np.where(ROW < 40, SLANTED, 0.1 + (ROW - 40) / 60)
    flow = np.zeros((*SIZE, 2), np.float32)
    flow[..., 0] = -90 * inverse
    seen = Seen(flow, np.full(SIZE, 0.01, np.float32), CAMERA)
    return two_frame(seen, TwoFrameSettings(dense=None))


@pytest.fixture
def image():
    """A blue wall above a brown floor."""
    shown = np.zeros((*SIZE, 3), np.uint8)
    shown[:40], shown[40:] = (60, 90, 200), (150, 100, 50)
    return shown


def without(answer, hole, reason=Unknown.OCCLUDED):
    """Return the answer with a hole."""
    return replace(
        answer,
        depth=np.where(hole, np.nan, answer.depth),
        spread=np.where(hole, np.inf, answer.spread),
        unknown=np.where(hole, np.uint8(reason), answer.unknown),
    )


def test_a_hole_in_a_wall_lies_in_its_plane_and_is_said_to_be_inferred(answer, image):
    hole = (ROW > 8) & (ROW < 32) & (COLUMN > 20) & (COLUMN < 60)
    found = with_planes(without(answer, hole), image)
    unit = np.median((answer.depth * SLANTED)[:40])
    assert found.valid.all()
    np.testing.assert_array_equal(found.inferred, hole)
    np.testing.assert_allclose((found.depth * SLANTED / unit)[hole], 1, atol=0.01)
    np.testing.assert_allclose(found.spread[hole], 0.25, atol=0.02)
    np.testing.assert_array_equal(found.depth[~hole], answer.depth[~hole])


def test_what_strays_from_its_plane_is_less_certain(answer, image):
    hole = (ROW > 8) & (ROW < 32) & (COLUMN > 20) & (COLUMN < 60)
    waves = replace(answer, depth=answer.depth * np.where((ROW + COLUMN) % 2 == 0, 0.7, 1.4))
    assert with_planes(without(waves, hole), image).spread[hole].min() > 0.4


def test_what_is_hardly_seen_stays_unknown(answer, image):
    hole = (ROW < 40) & ((COLUMN > 6) | (ROW > 30))
    found = with_planes(without(answer, hole), image)
    assert not found.inferred.any()
    assert np.isnan(found.depth[hole]).all()


def test_sky_and_what_has_no_scale_is_not_inferred(answer, image):
    hole = (ROW > 8) & (ROW < 32) & (COLUMN > 20) & (COLUMN < 60)
    for reason in (Unknown.SKY, Unknown.SCALE):
        assert not with_planes(without(answer, hole, reason), image).inferred.any()


def test_a_hole_in_what_moves_lies_in_its_own_plane_and_errs_as_its_scale_does(answer, image):
    labels = ((ROW < 40) & (COLUMN > 20)).astype(np.int32)
    nearer = np.where(labels == 1, answer.depth / 2, answer.depth)
    mover = Region(1, Kind.RIGID, Evidence.ORDERING, 0.2, 0.4, int(labels.sum()))
    moves = replace(answer, labels=labels, depth=nearer, regions=(*answer.regions, mover))
    hole = (ROW > 8) & (ROW < 32) & (COLUMN > 20) & (COLUMN < 60)
    found = with_planes(without(moves, hole), image)
    np.testing.assert_allclose((found.depth / nearer)[hole], 1, atol=0.02)
    np.testing.assert_allclose(found.spread[hole], np.hypot(0.25, 0.4), atol=0.02)
