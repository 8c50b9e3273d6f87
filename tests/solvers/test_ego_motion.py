import cv2
import numpy as np
import pytest

from flexdepth.data.trajectory import inverse, rows
from flexdepth.flow.dis import Dis
from flexdepth.flow.matches import Akaze
from flexdepth.runtime.depthmap import FocalSource, Intrinsics
from flexdepth.solvers.correspondences import Correspondences, from_flow
from flexdepth.solvers.criterion import MotionKind
from flexdepth.solvers.ego_motion import camera_motion
from flexdepth.solvers.epipolar import Epipolar
from flexdepth.solvers.pose import Pose, angle

AWAY = np.array([0.3, 0.1, -1.0])
UNIT = AWAY / np.linalg.norm(AWAY)
WALL = np.array([0.05, 0.1, 0.15])


def off(motion, rotation, direction=UNIT):
    """Return by how many radians rotation and direction are off."""
    sine = np.linalg.norm(np.cross(motion.pose.translation, direction))
    return angle(motion.pose.rotation @ rotation.T), np.arctan2(
        sine, motion.pose.translation @ direction
    )


@pytest.mark.parametrize("away", [AWAY, -AWAY, np.array([1.0, 0, 0]), np.array([0, 0, 1.0])])
def test_exact_points_give_the_exact_motion(see, rotation, away):
    motion = camera_motion(see(rotation, away))
    assert motion.kind is MotionKind.GENERAL
    assert max(off(motion, rotation, away / np.linalg.norm(away))) < 1e-8
    assert motion.inliers == 1
    assert motion.noise_factor == 1
    assert motion.translates


@pytest.mark.parametrize("seed", range(3))
def test_a_fifth_of_points_that_move_by_themselves_change_nothing(see, rotation, seed):
    motion = camera_motion(see(rotation, AWAY, movers=0.2, seed=seed))
    assert max(off(motion, rotation)) < 1e-8
    assert 0.75 < motion.inliers < 0.85


def test_errors_are_those_that_the_noise_predicts(see, rotation):
    # The covariance of least squares is (JᵀJ)⁻¹ for residuals of unit deviation.
    seen = see(rotation, AWAY, noise=0.2)
    jacobian = Epipolar(*seen.rays(), seen.focal, seen.noise).jacobian(Pose(rotation, UNIT))[:, 0]
    covariance = np.linalg.inv(jacobian.T @ jacobian)
    predicted = np.sqrt([np.trace(covariance[:3, :3]), np.trace(covariance[3:, 3:])])
    errors = [
        off(camera_motion(see(rotation, AWAY, noise=0.2, seed=seed)), rotation)
        for seed in range(12)
    ]
    ratio = np.sqrt(np.mean(np.square(errors), axis=0)) / predicted
    assert (ratio > 0.6).all()
    assert (ratio < 1.5).all()


@pytest.mark.parametrize("noise", [0.0, 0.2])
@pytest.mark.parametrize("movers", [0.0, 0.2])
def test_turning_and_standing_still_are_recognised(see, rotation, noise, movers):
    turning = camera_motion(see(rotation, noise=noise, movers=movers))
    assert turning.kind is MotionKind.ROTATION
    assert angle(turning.pose.rotation @ rotation.T) < (1e-8 if noise == 0 else 1e-4)
    still = camera_motion(see(np.eye(3), noise=noise, movers=movers))
    assert still.kind is MotionKind.STILL
    assert (still.pose.rotation == np.eye(3)).all()
    for motion in (turning, still):
        assert (motion.pose.translation == 0).all()
        assert not motion.translates
        assert set(motion.scores) == set(MotionKind)


@pytest.mark.parametrize("noise", [0.0, 0.2])
def test_a_wall_is_recognised_and_both_its_motions_are_told(see, rotation, noise):
    motion = camera_motion(see(rotation, AWAY, noise=noise, plane=WALL))
    assert motion.kind is MotionKind.PLANE
    assert max(off(motion, rotation)) < (1e-8 if noise == 0 else 3e-3)
    np.testing.assert_allclose(motion.normal, WALL / np.linalg.norm(WALL), atol=1e-2)
    assert motion.alternative is not None
    assert np.linalg.norm(motion.alternative.translation - UNIT) > 0.1


def test_what_stands_before_the_wall_decides_between_its_motions(see):
    # The other motion turns less here, but only this one explains what stands beside the wall.
    turn = np.array([[np.cos(0.3), 0, -np.sin(0.3)], [0, 1, 0], [np.sin(0.3), 0, np.cos(0.3)]])
    wall, rest = see(turn, AWAY, plane=WALL, noise=0.1), see(turn, AWAY, count=60, noise=0.1)
    key, target, noise = (
        np.concatenate([getattr(each, name) for each in (wall, rest)])
        for name in ("key", "target", "noise")
    )
    motion = camera_motion(Correspondences(key, target, noise, wall.camera))
    assert motion.kind is MotionKind.PLANE
    assert max(off(motion, turn)) < 5e-3


def test_noise_that_was_understated_is_found_out(see, rotation):
    seen = see(rotation, AWAY, noise=0.3, count=3000)
    boasted = Correspondences(seen.key, seen.target, seen.noise / 3, seen.camera)
    motion = camera_motion(boasted)
    assert motion.noise_factor == pytest.approx(3, rel=0.1)
    assert motion.kind is MotionKind.GENERAL
    turned = see(rotation, noise=0.3, count=3000)
    boasted = Correspondences(turned.key, turned.target, turned.noise / 3, turned.camera)
    assert camera_motion(boasted).kind is MotionKind.ROTATION


def test_matches_of_nothing_are_flagged_by_their_inliers_or_their_noise(camera):
    key, target = np.random.default_rng(0).uniform((0, 0), (640, 480), (2, 500, 2))
    motion = camera_motion(Correspondences(key, target, np.full(500, 0.5), camera))
    assert motion.inliers < 0.3 or motion.noise_factor > 10


def test_the_same_matches_give_the_same_motion(see, rotation):
    seen = see(rotation, AWAY, noise=0.2, movers=0.2)
    one, other = camera_motion(seen), camera_motion(seen)
    np.testing.assert_array_equal(one.pose.rotation, other.pose.rotation)
    np.testing.assert_array_equal(one.pose.translation, other.pose.translation)


KITTI = Intrinsics(707.0912, 707.0912, 602.3873, 183.6104, FocalSource.GIVEN)


def test_the_cars_own_motion_is_that_of_its_navigation(samples):
    folder = samples / "driving_kitti_odometry_gray51"
    world_from_camera = rows(folder / "poses.txt")
    errors = []
    for number in range(0, 50, 5):
        key, target = (
            cv2.imread(str(folder / f"image_l/{each:06d}.png"), cv2.IMREAD_GRAYSCALE)
            for each in (number, number + 1)
        )
        field = Dis(finest=1).between(key, target)
        motion = camera_motion(from_flow(field.flow, field.valid, field.noise, KITTI, most=2000))
        assert motion.kind is MotionKind.GENERAL
        truth = inverse(world_from_camera[number + 1]) @ world_from_camera[number]
        way = truth[:3, 3] / np.linalg.norm(truth[:3, 3])
        errors.append(np.degrees(off(motion, truth[:3, :3], way)))
    rotation, direction = np.median(errors, axis=0)
    assert rotation < 0.1
    assert direction < 1


def test_sparse_matches_find_the_cars_motion_too(samples):
    folder = samples / "driving_kitti_odometry_gray51"
    poses = rows(folder / "poses.txt")
    frames = (folder / f"image_l/{each:06d}.png" for each in (20, 21))
    matches = Akaze().between(*(cv2.imread(str(each), cv2.IMREAD_GRAYSCALE) for each in frames))
    noise = np.full(len(matches), 0.5)
    motion = camera_motion(Correspondences(matches.key, matches.target, noise, KITTI))
    truth = inverse(poses[21]) @ poses[20]
    found = off(motion, truth[:3, :3], truth[:3, 3] / np.linalg.norm(truth[:3, 3]))
    assert np.degrees(found[0]) < 0.1
    assert np.degrees(found[1]) < 1


def test_a_camera_before_a_wall_is_not_given_a_general_motion(samples):
    folder = samples / "flow_sintel_easy/clean/easy"
    frames = (cv2.imread(str(folder / f"frame_000{n}.png"), cv2.IMREAD_GRAYSCALE) for n in (2, 3))
    field = Dis(finest=1).between(*frames)
    guess = Intrinsics(1120.0, 1120.0, 512.0, 218.0, FocalSource.ASSUMED)
    motion = camera_motion(from_flow(field.flow, field.valid, field.noise, guess, most=2000))
    assert motion.kind is MotionKind.PLANE
    assert 0.5 < motion.inliers < 0.85  # The girl, who moves, fills a third.
