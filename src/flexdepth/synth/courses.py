"""Where things that move are at a time, and where their feet are: nothing slides that walks."""

from dataclasses import dataclass
from math import pi, sin

import numpy as np

from flexdepth.synth.shapes import Array, tilt, turn


@dataclass(frozen=True, eq=False)
class Course:
    """A level arc, gone along at an even speed.

    Attributes:
        start: Where it begins, metres.
        heading: Yaw at the beginning; 0 goes along z, a quarter turn along x.
        speed: Metres a second.
        turning: Radians a second, from z towards x.
    """

    start: Array
    heading: float
    speed: float
    turning: float

    def place(self, time: float) -> Array:
        """Return the position after `time` seconds."""
        half = self.turning * time / 2
        chord = self.speed * time * float(np.sinc(half / pi))
        return np.asarray(self.start + turn(self.heading + half) @ (0, 0, chord))

    def axes(self, time: float) -> Array:
        """Return the rotation whose columns are left, up and forward."""
        return turn(self.heading + self.turning * time)

    def beside(self, time: float, left: float, ahead: float) -> Array:
        """Return the point so far to the left of where the course is, and so far ahead."""
        return np.asarray(self.place(time) + self.axes(time) @ (left, 0, ahead))


@dataclass(frozen=True)
class Gait:
    """How feet follow a course: each stands still on the ground, then swings to its next print.

    A foot keeps a time of its own, at which it is where the body then is. That time stands still
    with the foot and catches up while it swings.

    Attributes:
        period: Seconds between two prints of one foot.
        duty: Share of the period that a foot stands.
        lift: Metres that a foot is raised while it swings.
    """

    period: float
    duty: float
    lift: float

    def step(self, time: float, phase: float) -> tuple[float, float]:
        """Return a foot's own time in seconds, and its height in metres.

        Args:
            time: Seconds.
            phase: The foot's place in the period, 0 to 1.
        """
        cycle, passed = divmod(time / self.period + phase, 1.0)
        swung = max(0.0, (passed - self.duty) / (1 - self.duty))
        eased = swung - sin(2 * pi * swung) / (2 * pi)
        middle = (cycle - phase + eased + self.duty / 2) * self.period
        return middle, self.lift * sin(pi * swung)

    def pitch(self, time: float, phase: float, strike: float, push: float) -> float:
        """Return how far a foot is tipped, toes down: it lands on the heel and leaves on the toes.

        Args:
            time: Seconds.
            phase: The foot's place in the period.
            strike: Radians, toes up, at landing.
            push: Radians, heel up, at leaving.
        """
        passed = (time / self.period + phase) % 1.0
        knots = np.array([0, 0.1, 0.55, 1.0]) * self.duty
        ends = self.duty + np.array([0.35, 0.75, 1.0]) * (1 - self.duty)
        angles = (-strike, 0.0, 0.0, push, 0.3 * push, -strike, -strike)
        return float(np.interp(passed, np.r_[knots, ends], angles))


def tipped(corners: Array, pitch: float, heel: float, ball: float) -> Array:
    """Return a foot turned about its ball (heel up) or its heel (toes up) where these touch.

    The toes stay flat on the ground while the heel is up.

    Args:
        corners: Points of the foot; it points along z and stands on y = 0.
        pitch: Radians, toes down.
        heel: z of the heel.
        ball: z of the ball.
    """
    pivot = np.array([0, 0, ball if pitch > 0 else heel])
    turned = (corners - pivot) @ tilt(pitch).T + pivot
    toes = (pitch > 0) & (corners[..., 2:] > ball)
    return np.where(toes, corners, turned)


def bent(hip: Array, ankle: Array, lengths: tuple[float, float], knee_towards: Array) -> Array:
    """Return the knee of a leg of two bones between hip and ankle.

    A leg too short for the distance is stretched, so that the foot stays where it stands.
    """
    reach = ankle - hip
    distance = float(np.linalg.norm(reach))
    along = reach / distance
    stretch = max(1.0, distance / (0.999 * sum(lengths)))
    upper, lower = stretch * lengths[0], stretch * lengths[1]
    foot = (distance**2 + upper**2 - lower**2) / (2 * distance)
    aside = knee_towards - (knee_towards @ along) * along
    aside /= max(float(np.linalg.norm(aside)), 1e-9)
    return np.asarray(hip + foot * along + np.sqrt(max(upper**2 - foot**2, 0.0)) * aside)
