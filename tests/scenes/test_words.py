from dataclasses import replace

import numpy as np
import pytest

from flexdepth.runtime.depthmap import FocalSource
from flexdepth.scenes.picture import solution_picture
from flexdepth.scenes.words import cautions, position, summary
from flexdepth.solvers.criterion import MotionKind
from flexdepth.solvers.pose import Pose
from flexdepth.solvers.two_frame import Evidence, Unknown


def moved(solution, **changes):
    motion = replace(solution.found.camera_motion, **changes)
    return replace(solution, found=replace(solution.found, camera_motion=motion))


def test_what_is_known_is_said_in_words(solution):
    said = summary(solution)
    assert said == [
        "The camera went right (x, y, z: 1.000, 0.000, 0.000) and turned 0.00 degrees.",
        "Depth for 75.0% of the frame, in units of the camera's way; none for 8.3% hidden in the "
        "target or not matched, 16.7% sky.",
        "Mover 1: rigid, 6.9% of the frame; scale from where it touches what is still "
        "(confidence 0.75).",
    ]
    assert cautions(solution) == []


def test_a_camera_that_goes_ahead_and_turns_is_told_so(solution):
    turn = np.array([[0.0, 0, 1], [0, 1, 0], [-1, 0, 0]])  # 90 degrees about y
    pose = Pose(turn, np.array([-0.8, 0.0, 0.6]))
    there = moved(solution, pose=pose)
    np.testing.assert_allclose(position(there.found), [0.6, 0.0, 0.8])
    assert summary(there)[0].startswith("The camera went right and forward")
    assert "turned 90.00 degrees" in summary(there)[0]


@pytest.mark.parametrize(
    ("kind", "said"),
    [(MotionKind.STILL, "has stood still"), (MotionKind.ROTATION, "turned 0.00 degrees on the")],
)
def test_a_camera_that_has_not_travelled_is_told_so(kind, said, solution):
    there = moved(solution, kind=kind, pose=Pose(np.eye(3), np.zeros(3)))
    assert said in summary(there)[0]
    assert any("show no depth of what is still" in line for line in cautions(there))


def test_an_assumed_focal_length_is_said_with_its_angle(solution):
    camera = replace(solution.camera, focal_x=24.0, source=FocalSource.ASSUMED)
    views = replace(solution.views, camera=camera)
    (said,) = cautions(replace(solution, views=views))
    assert "24 px, a view of 90 degrees, is taken by assumption" in said


def test_a_scale_that_cannot_be_seen_is_said(solution):
    still, mover = solution.found.regions
    regions = still, replace(mover, evidence=Evidence.UNKNOWN)
    (said,) = cautions(replace(solution, found=replace(solution.found, regions=regions)))
    assert said.startswith("the scale of 1 of the things that move cannot be seen")


def test_a_frame_in_which_most_moves_by_itself_is_doubted(solution):
    (said,) = cautions(moved(solution, inliers=0.3))
    assert said.startswith("only 30% of what is matched moves as the static world would")


def test_there_are_words_for_whatever_a_scale_hangs_on_and_a_pixel_lacks(solution, found):
    for evidence in Evidence:
        mover = replace(found.regions[1], evidence=evidence)
        there = replace(solution, found=replace(found, regions=(found.regions[0], mover)))
        assert "; scale " in summary(there)[-1]
    for reason in Unknown:
        nothing = np.full_like(found.unknown, reason)
        there = replace(solution, found=replace(found, unknown=nothing))
        assert reason is Unknown.KNOWN or "100.0%" in summary(there)[1]
        assert solution_picture(there).size


def test_motion_without_parts_is_told_by_its_share(solution, found):
    one = replace(solution, found=replace(found, regions=found.regions[:1]))
    assert summary(one)[-1] == "6.9% of the frame moves by itself, in no separate parts."
    still = replace(found, regions=found.regions[:1], moving=np.zeros_like(found.moving))
    assert summary(replace(solution, found=still))[-1].startswith("Nothing moves by itself")


def test_many_movers_are_not_all_told(solution):
    still, mover = solution.found.regions
    regions = (still, *(replace(mover, label=label) for label in range(1, 10)))
    said = summary(replace(solution, found=replace(solution.found, regions=regions)), most=6)
    assert said[-1] == "3 smaller movers more."
