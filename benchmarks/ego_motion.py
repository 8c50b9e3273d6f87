"""How well the camera's own motion is found on a real drive, beside SIFT and an essential matrix.

    python benchmarks/ego_motion.py [--samples DIR] [--pairs N] [--most N] [--json] [--strict]

Pairs of successive frames of KITTI odometry 06 against the poses of its navigation: degrees
between the rotations, and between the directions of travel. Beside the two of flexdepth stands
what is customary: SIFT matches by the ratio test, OpenCV's RANSAC essential matrix and
`recoverPose`, all with OpenCV's own settings and one pixel. docs/samples.md says where the frames
come from. Seconds are wall clock of one pair, flow or matching included.

The bars are for dense flow: medians of .1 degrees in rotation and 1 degree in direction, and no
more than the customary way has. With --strict it exits with 1 where one is missed.
"""

import argparse
import json
import sys
import time
from collections.abc import Callable, Mapping
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray
from samples import opencv_camera, present, usual_folder
from verdict import verdict

from flexdepth.data.text_files import parsed
from flexdepth.data.trajectory import inverse, rows
from flexdepth.flow.dis import Dis
from flexdepth.flow.matches import Akaze
from flexdepth.runtime.depthmap import Intrinsics
from flexdepth.solvers.correspondences import Correspondences, from_flow
from flexdepth.solvers.ego_motion import camera_motion
from flexdepth.solvers.pose import Pose, angle

DRIVE = "driving_kitti_odometry_gray51"
BAR = {"rotation": 0.1, "direction": 1.0}
"""Degrees, of the medians."""
OURS, CUSTOMARY = "dis", "sift + essential matrix"
AKAZE_NOISE = 0.5
"""Pixels of each component, what its keypoints are off by on these frames."""

Gray = NDArray[np.uint8]
Find = Callable[[Gray, Gray, Intrinsics], Pose]


def by_flow(most: int) -> Find:
    """Return flexdepth's way with dense flow at most so many pixels."""

    def find(key: Gray, target: Gray, camera: Intrinsics) -> Pose:
        field = Dis().between(key, target)
        return camera_motion(from_flow(field.flow, field.valid, field.noise, camera, most)).pose

    return find


def by_akaze(key: Gray, target: Gray, camera: Intrinsics) -> Pose:
    """Return flexdepth's motion from sparse matches."""
    matches = Akaze().between(key, target)
    noise = np.full(len(matches), AKAZE_NOISE)
    return camera_motion(Correspondences(matches.key, matches.target, noise, camera)).pose


def by_sift(key: Gray, target: Gray, camera: Intrinsics) -> Pose:
    """Return the customary motion."""
    detector = cv2.SIFT_create()
    (points, words), (others, other_words) = (
        detector.detectAndCompute(each, None) for each in (key, target)
    )
    pairs = cv2.BFMatcher().knnMatch(words, other_words, k=2)
    good = [one for one, second in pairs if one.distance < 0.8 * second.distance]
    ends = (
        np.array([points[one.queryIdx].pt for one in good]),
        np.array([others[one.trainIdx].pt for one in good]),
    )
    # OpenCV counts the first pixel's centre as 0.
    centre = camera.centre_x - 0.5, camera.centre_y - 0.5
    matrix = np.array([[camera.focal_x, 0, centre[0]], [0, camera.focal_y, centre[1]], [0, 0, 1]])
    cv2.setRNGSeed(0)
    essential, near = cv2.findEssentialMat(*ends, matrix, cv2.RANSAC, 0.999, 1.0)
    _, rotation, translation, _ = cv2.recoverPose(essential, *ends, matrix, mask=near)
    return Pose(np.asarray(rotation), np.asarray(translation).ravel())


def degrees_off(found: Pose, truth: NDArray[np.float64]) -> tuple[float, float]:
    """Return how far rotation and direction are from a 4 x 4 `target_from_key`."""
    way = truth[:3, 3]
    sine = np.linalg.norm(np.cross(found.translation, way))
    direction = np.arctan2(sine, found.translation @ way)
    return np.degrees(angle(found.rotation @ truth[:3, :3].T)), float(np.degrees(direction))


def camera_of(path: Path) -> Intrinsics:
    """Return the left camera: the first row of the calibration, 3 x 4."""
    numbers = parsed(present(path).read_text().splitlines()[0].split(), 12, f"{path}: wanted P0")
    return opencv_camera((numbers[0], numbers[5]), (numbers[2], numbers[6]))


def gray(path: Path) -> Gray:
    """Return a frame."""
    return np.asarray(cv2.imread(str(present(path)), cv2.IMREAD_GRAYSCALE))


def measured(folder: Path, pairs: int, find: Find) -> dict[str, float]:
    """Return what one way finds."""
    camera, poses = camera_of(folder / "calib.txt"), rows(present(folder / "poses.txt"))
    off, seconds = [], []
    for number in range(pairs):
        key, target = (gray(folder / f"image_l/{each:06d}.png") for each in (number, number + 1))
        start = time.perf_counter()
        found = find(key, target, camera)
        seconds.append(time.perf_counter() - start)
        off.append(degrees_off(found, inverse(poses[number + 1]) @ poses[number]))
    rotation, direction = np.array(off).T
    return {
        "rotation": round(float(np.median(rotation)), 4),
        "direction": round(float(np.median(direction)), 3),
        "worst_rotation": round(float(rotation.max()), 3),
        "worst_direction": round(float(direction.max()), 2),
        "seconds": round(float(np.median(seconds)), 2),
    }


def passed(found: Mapping[str, Mapping[str, float]]) -> dict[str, bool]:
    """Return whether dense flow meets each bar, and is no worse there than the customary way."""
    ours, customary = found[OURS], found[CUSTOMARY]
    return {name: ours[name] <= min(bar, customary[name]) for name, bar in BAR.items()}


def text(found: Mapping[str, Mapping[str, float]]) -> str:
    """Return what each way finds, then the bars."""
    lines = [f"{'degrees, median (worst)':26} {'rotation':>16} {'direction':>16} {'seconds':>8}"]
    for way, one in found.items():
        cells = [f"{one[name]:.3f} ({one[f'worst_{name}']:.2f})" for name in BAR]
        lines.append(f"{way:26} {cells[0]:>16} {cells[1]:>16} {one['seconds']:>8.2f}")
    for name, met in passed(found).items():
        most = f"at most {BAR[name]:g}, and {found[CUSTOMARY][name]:.3f} of {CUSTOMARY}"
        measured = f"measured {found[OURS][name]:.3f}  {verdict(met)}"
        lines.append(f"  {OURS}, {name}: {most}  {measured}")
    return "\n".join(lines)


def main() -> int:
    """Measure and print; 1 where --strict and a bar is missed."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--samples", type=Path, default=usual_folder())
    parser.add_argument("--pairs", type=int, default=50)
    parser.add_argument("--most", type=int, default=5_000)
    parser.add_argument("--json", action="store_true", help="print JSON instead of the table")
    parser.add_argument("--strict", action="store_true", help="exit with 1 where a bar is missed")
    asked = parser.parse_args()
    folder = asked.samples / DRIVE
    ways = {OURS: by_flow(asked.most), "akaze": by_akaze, CUSTOMARY: by_sift}
    try:
        found = {name: measured(folder, asked.pairs, find) for name, find in ways.items()}
    except FileNotFoundError as missing:
        print(f"skipped: {missing}")
        return int(asked.strict)
    met = all(passed(found).values())
    if asked.json:
        print(json.dumps({"pairs": asked.pairs, "bar": BAR, **found, "passed": met}, indent=2))
    else:
        print(text(found))
    return int(asked.strict and not met)


if __name__ == "__main__":
    sys.exit(main())
