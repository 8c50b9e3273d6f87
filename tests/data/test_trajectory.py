from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from flexdepth.data.trajectory import (
    from_quaternion,
    inverse,
    log,
    matrix,
    rows,
    stamped,
    turned_down,
)
from flexdepth.runtime.errors import InputError

POSE = "0 -1 0 5\n1 0 0 6\n0 0 1 7\n0 0 0 1\n"
parts = st.lists(st.floats(-1, 1), min_size=4, max_size=4).filter(lambda q: np.dot(q, q) > 0.1)


def test_a_quarter_turn_about_z_takes_x_to_y(tmp_path):
    half = np.sqrt(0.5)
    pose = from_quaternion([1.0, 2.0, 3.0], [0.0, 0.0, half, half], tmp_path)
    np.testing.assert_allclose(pose @ [1, 0, 0, 1], [1, 3, 3, 1], atol=1e-12)


@given(parts)
def test_a_quaternion_of_any_length_is_a_rotation_and_inverts_to_its_transpose(quaternion):
    pose = from_quaternion([1.0, 2.0, 3.0], quaternion, Path())
    turn = pose[:3, :3]
    np.testing.assert_allclose(turn @ turn.T, np.eye(3), atol=1e-12)
    assert np.linalg.det(turn) == pytest.approx(1)
    np.testing.assert_allclose(inverse(pose) @ pose, np.eye(4), atol=1e-12)


@given(parts)
def test_turning_y_down_keeps_a_rotation_and_moves_points_as_their_mirror_images(quaternion):
    pose, mirror = from_quaternion([1.0, 2.0, 3.0], quaternion, Path()), np.diag([1.0, -1, 1, 1])
    point = np.array([0.3, 0.4, 2.0, 1.0])
    turned = turned_down(pose)
    assert np.linalg.det(turned[:3, :3]) == pytest.approx(1)
    np.testing.assert_allclose(turned @ (mirror @ point), mirror @ (pose @ point), atol=1e-12)


def test_a_quaternion_of_zeros_is_refused(tmp_path):
    with pytest.raises(InputError, match="which turns nothing"):
        from_quaternion([0.0] * 3, [0.0] * 4, tmp_path / "t.txt")


def test_each_way_of_writing_gives_the_same_pose(tmp_path):
    four, twelve = tmp_path / "pose.txt", tmp_path / "poses.txt"
    four.write_text(POSE)
    twelve.write_text("\n1 0 0 0 0 1 0 0 0 0 1 0\n" + " ".join(POSE.split()[:12]) + "\n")
    (tmp_path / "t.log").write_text("0 0 1\n" + POSE + "1 1 2\n" + POSE)
    half = np.sqrt(0.5)
    (tmp_path / "tum.txt").write_text(f"# time tx\n1.5 5 6 7 0 0 {half} {half}\n\n")
    wanted = matrix(four)
    assert wanted[:, 3].tolist() == [5, 6, 7, 1]
    np.testing.assert_array_equal(rows(twelve)[1], wanted)
    assert len(log(tmp_path / "t.log")) == 2
    np.testing.assert_array_equal(log(tmp_path / "t.log")[1], wanted)
    ((time, pose),) = stamped(tmp_path / "tum.txt")
    assert time == 1.5
    np.testing.assert_allclose(pose, wanted, atol=1e-12)


@pytest.mark.parametrize(
    ("read", "text", "complaint"),
    [
        (matrix, "1 2 3", r"t\.txt: wanted a pose of 4 x 4 numbers, 16 numbers, got 3"),
        (matrix, POSE.replace("7", "seven"), "wanted a pose.*seven"),
        (rows, "1 2 3", r"t\.txt, line 1: wanted a pose, 12 numbers, got 3"),
        (stamped, "# a\n1 2 3", r"t\.txt, line 2: wanted a trajectory.*got 3"),
        (log, POSE, r"t\.txt: wanted a trajectory log.*got 16"),
    ],
)
def test_a_damaged_trajectory_is_named_with_what_it_should_hold(tmp_path, read, text, complaint):
    path = tmp_path / "t.txt"
    path.write_text(text)
    with pytest.raises(InputError, match=complaint):
        read(path)
    with pytest.raises(InputError, match=r"gone\.txt: no such file"):
        read(tmp_path / "gone.txt")
