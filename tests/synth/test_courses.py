import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from flexdepth.synth.courses import Course, Gait, bent, tipped

angles = st.floats(-3, 3)


def course(speed=1.2, turning=0.3):
    return Course(np.array([2.0, 0.1, -1.0]), 0.7, speed, turning)


def test_a_quarter_circle_ends_a_radius_ahead_and_a_radius_aside():
    arc = Course(np.zeros(3), 0.0, 1.0, np.pi / 2)
    radius = 1.0 / (np.pi / 2)
    assert arc.place(1.0) == pytest.approx([radius, 0, radius])
    assert arc.axes(1.0)[:, 2] == pytest.approx([1, 0, 0])


def test_a_straight_course_goes_as_far_as_its_speed_says():
    straight = Course(np.array([1.0, 2.0, 3.0]), np.pi / 2, 1.5, 0.0)
    assert straight.place(2.0) == pytest.approx([4, 2, 3])
    assert straight.beside(2.0, 0.5, 0.25) == pytest.approx([4.25, 2, 2.5])


@given(angles, st.floats(-2, 2), st.floats(0, 5))
def test_a_course_heads_where_it_goes(heading, turning, time):
    arc = Course(np.zeros(3), heading, 1.0, turning)
    step = 1e-5
    way = (arc.place(time + step) - arc.place(time - step)) / (2 * step)
    assert way == pytest.approx(arc.axes(time)[:, 2], abs=1e-6)


@given(st.floats(0, 30), st.floats(0, 1))
def test_a_standing_foot_keeps_its_time_and_touches_the_ground(time, phase):
    gait = Gait(1.1, 0.6, 0.1)
    passed = (time / gait.period + phase) % 1.0
    own, raised = gait.step(time, phase)
    if 0.01 < passed < 0.58:
        assert raised == 0
        assert gait.step(time + 0.01, phase)[0] == own
    assert abs(own - time) < gait.period


def test_a_foot_is_where_the_body_is_in_the_middle_of_its_stance_and_gains_a_stride_a_period():
    gait = Gait(1.0, 0.6, 0.1)
    assert gait.step(0.3, 0.0)[0] == pytest.approx(0.3)
    assert gait.step(1.3, 0.0)[0] == pytest.approx(1.3)
    assert gait.step(0.8, 0.0) == pytest.approx((0.8, 0.1))


def test_a_foot_lands_on_its_heel_and_leaves_on_its_toes():
    gait = Gait(1.0, 0.6, 0.1)
    assert gait.pitch(0.0, 0.0, 0.3, 0.8) == pytest.approx(-0.3)
    assert gait.pitch(0.2, 0.0, 0.3, 0.8) == 0
    assert gait.pitch(0.6, 0.0, 0.3, 0.8) == pytest.approx(0.8)


def test_a_tipped_foot_turns_about_what_touches_the_ground():
    heel, ball = np.array([0, 0, -0.1]), np.array([0, 0, 0.2])
    foot = np.stack([heel, ball])
    up = tipped(foot, -0.4, -0.1, 0.2)
    down = tipped(foot, 0.4, -0.1, 0.2)
    assert up[0] == pytest.approx(heel)
    assert up[1, 1] == pytest.approx(0.3 * np.sin(0.4))
    assert down[1] == pytest.approx(ball)
    assert down[0, 1] == pytest.approx(0.3 * np.sin(0.4))


@given(st.floats(0.3, 0.79), angles)
def test_a_knee_is_a_thigh_from_the_hip_and_a_shin_from_the_ankle(distance, angle):
    hip = np.array([0.1, 0.9, 0.2])
    ankle = hip + distance * np.array([0, -np.cos(angle), np.sin(angle)])
    knee = bent(hip, ankle, (0.45, 0.35), np.array([0, np.sin(angle), np.cos(angle)]))
    assert np.linalg.norm(knee - hip) == pytest.approx(0.45)
    assert np.linalg.norm(knee - ankle) == pytest.approx(0.35)


def test_a_leg_too_short_is_stretched_and_not_torn():
    knee = bent(np.zeros(3), np.array([0, -2.0, 0]), (0.5, 0.5), np.array([0, 0, 1.0]))
    assert knee == pytest.approx([0, -1, 0], abs=0.05)
