"""People who walk, stand, sit and hop; their skin and clothes bend with them."""

from dataclasses import dataclass
from functools import lru_cache
from math import cos, pi, sin

import numpy as np
from numpy.random import Generator

from flexdepth.synth.courses import Course, Gait, bent, tipped
from flexdepth.synth.dress import Dress
from flexdepth.synth.materials import Material
from flexdepth.synth.shapes import Array, Mesh, joined, tilt, turn
from flexdepth.synth.skins import limb, skin

# Lengths below are shares of the body's height; rows are rings from below upwards:
# height, half the width, half the depth, how far ahead.
_PELVIS = (
    (0.455, 0.045, 0.045, 0.0), (0.475, 0.088, 0.064, -0.004), (0.51, 0.1, 0.072, -0.008),
    (0.55, 0.097, 0.068, -0.005), (0.59, 0.09, 0.06, 0.0),
)  # fmt: skip
_CHEST = (
    (0.53, 0.1, 0.072, -0.006), (0.57, 0.096, 0.067, -0.003), (0.62, 0.085, 0.06, 0.0),
    (0.67, 0.088, 0.063, 0.004), (0.72, 0.097, 0.069, 0.006), (0.765, 0.104, 0.067, 0.003),
    (0.795, 0.108, 0.058, 0.0), (0.815, 0.098, 0.05, -0.002), (0.832, 0.068, 0.042, -0.004),
    (0.85, 0.036, 0.036, -0.003),
)  # fmt: skip
_HEAD = (
    (0.825, 0.033, 0.033, -0.006), (0.862, 0.031, 0.033, 0.0), (0.872, 0.03, 0.038, 0.014),
    (0.888, 0.037, 0.047, 0.01), (0.91, 0.042, 0.053, 0.007), (0.935, 0.045, 0.056, 0.004),
    (0.96, 0.045, 0.056, 0.0), (0.982, 0.036, 0.044, -0.002), (0.995, 0.018, 0.022, -0.002),
)  # fmt: skip
_SHOE = (
    (-0.045, 0.014, 0.014, 0.022), (-0.036, 0.021, 0.03, 0.026), (-0.01, 0.022, 0.034, 0.03),
    (0.02, 0.024, 0.026, 0.022), (0.06, 0.028, 0.02, 0.014), (0.09, 0.027, 0.015, 0.01),
    (0.108, 0.016, 0.01, 0.008),
)  # fmt: skip
"""Rings from heel to toes: z, half the width, half the height, height of the middle."""

_LEG = (0.056, 0.054, 0.047, 0.041, 0.036, 0.037, 0.034, 0.026, 0.023)
_ARM = (0.033, 0.031, 0.028, 0.025, 0.023, 0.023, 0.021, 0.018, 0.016)
_HIP, _THIGH, _SHIN, _ANKLE = 0.52, 0.243, 0.235, 0.042
_SHOULDER, _UPPER_ARM, _FOREARM, _HAND = 0.783, 0.172, 0.15, 0.09
_HEEL, _BALL = -0.04, 0.06


@dataclass(frozen=True)
class Pose:
    """How a body is held.

    Attributes:
        hips: Greatest height of the hips, a share of the body's height.
        feet: How far ahead of the hips the feet are, likewise.
        fold: Least bend of the elbows, radians.
    """

    hips: float
    feet: float
    fold: float


UPRIGHT = Pose(0.53, 0.0, 0.3)


@dataclass(frozen=True, eq=False)
class Person:
    """Somebody on a course.

    Attributes:
        height: Metres.
        girth: Width against the usual.
        dress: Clothes.
        course: Where the body goes; one that does not go gestures.
        gait: How the feet follow.
        swing: Radians that the arms swing, or gesture.
        hop: Metres of a hop, once in each gait period and highest at time 0; 0 keeps the feet
            on the ground.
        pose: How the body is held.
    """

    height: float
    girth: float
    dress: Dress
    course: Course
    gait: Gait
    swing: float
    hop: float
    pose: Pose = UPRIGHT

    @classmethod
    def drawn(cls, rng: Generator, course: Course, hop: float) -> "Person":
        """Return a random person who walks the course."""
        height = float(rng.normal(1.7, 0.09)) if rng.random() < 0.85 else float(rng.uniform(1, 1.5))
        step = height * (0.18 + 0.15 * course.speed)
        walks = course.speed > 0.2
        period = 2 * step / course.speed if walks else float(rng.uniform(0.9, 2.5))
        return cls(
            height=height,
            girth=float(rng.uniform(0.9, 1.25)),
            dress=Dress.drawn(rng),
            course=course,
            gait=Gait(period, 0.62, 0.06 * height if walks else 0.0),
            swing=float(rng.uniform(0.3, 0.6) if walks else rng.uniform(0.2, 1.0)),
            hop=hop,
        )

    @property
    def looks(self) -> tuple[Material, ...]:
        """The materials of the meshes: trousers, shirt, skin, hair, shoes."""
        wear = self.dress
        return wear.trousers, wear.shirt, wear.skin, wear.hair, wear.shoes

    def meshes(self, time: float) -> list[Mesh]:
        """Return trousers, shirt, skin, hair and shoes at a time."""
        axes, place = self.course.axes(time), self.course.place(time)
        raised = self.hop * abs(cos(pi * time / self.gait.period))
        body = [joined(group) for group in self._body(time)]
        at = place + np.array([0, raised, 0])
        return [mesh.scaled(self.height).turned(axes).placed(at) for mesh in body]

    def _body(self, time: float) -> tuple[list[Mesh], ...]:
        """Return the meshes of each material, in heights: left is x, up y, ahead z."""
        phase = 2 * pi * time / self.gait.period
        feet = [self._foot(time, side) for side in _SIDES]
        pelvis, hips, chest, nod = self._posture(phase, [ankle for _, ankle in feet])
        trousers, shirt, flesh = [_trunk(_PELVIS, self.girth, pelvis, hips, hips)], [], []
        for side, (_, ankle) in zip(_SIDES, feet, strict=True):
            hip = pelvis + hips @ (0.05 * side * self.girth, -0.015, 0)
            knee = bent(hip, ankle, (_THIGH, _SHIN), np.array([0.08 * side, 0, 1.0]))
            trousers.append(_covered((hip, knee, ankle), _LEG, self.dress.leg, self.girth))
            flesh.append(_covered((hip, knee, ankle), _LEG, 1.0, 0.93 * self.girth))
        shirt.append(_trunk(_CHEST, self.girth * self.dress.loose, pelvis, hips, chest))
        if self.dress.hem:
            shirt.append(self._skirt(pelvis, hips, [ankle for _, ankle in feet]))
        for side in _SIDES:
            arm = self._arm(pelvis, chest, side, phase)
            shirt.append(_covered(arm[:3], _ARM, self.dress.sleeve, self.girth * self.dress.loose))
            flesh.append(_covered(arm[:3], _ARM, 1.0, 0.93))
            flesh.append(_hand(arm[2], arm[3], chest))
        flesh.append(_trunk(_HEAD, 1.0, pelvis, chest, nod))
        rings = _hair_rings(self.dress.nape)
        share = (rings[0][0] - _HEAD[0][0]) / (_HEAD[-1][0] - _HEAD[0][0])
        hair = _trunk(rings, 1.0, pelvis, chest + share * (nod - chest), nod)
        return trousers, shirt, flesh, [hair], [shoe for shoe, _ in feet]

    @property
    def _walks(self) -> bool:
        return self.gait.lift > 0

    def _posture(self, phase: float, ankles: list[Array]) -> tuple[Array, Array, Array, Array]:
        """Return where the pelvis is, and how pelvis, chest and head are turned.

        The pelvis is as high as the longer leg allows, sways over the foot that stands and turns
        with the leg that is ahead; the chest turns against it.
        """
        twist = 0.13 * cos(phase) if self._walks else 0.15 * sin(phase)
        sway = 0.01 * cos(phase - 1.95)
        reach = 0.997 * (_THIGH + _SHIN)
        level = [a[1] + np.sqrt(max(reach**2 - a[2] ** 2 - 0.0004, 0.04)) for a in ankles]
        lowest = -0.008 * float(np.log(np.exp(-np.array(level) / 0.008).sum())) + 0.018
        pelvis = np.array([sway, min(lowest, self.pose.hips), 0.0])
        lean = tilt(0.05 if self._walks else 0.03 * sin(phase))
        chest = turn(twist) @ lean
        return pelvis, turn(-0.7 * twist), chest, turn(-0.3 * twist) @ tilt(0.04 * sin(2 * phase))

    def _foot(self, time: float, side: int) -> tuple[Mesh, Array]:
        """Return a shoe and its ankle."""
        phase = 0.0 if side > 0 else 0.5
        own, raised = self.gait.step(time, phase) if self._walks else (time, 0.0)
        aside, ahead = 0.048 * side * self.height, self.pose.feet * self.height
        spot = self.course.beside(own, aside, ahead) - self.course.place(time)
        at = self.course.axes(time).T @ spot / self.height + (0, raised / self.height, 0)
        yaw = self.course.turning * (own - time) + 0.12 * side
        pitch = self.gait.pitch(time, phase, 0.3, 0.75) if self._walks else 0.0
        ankle = tipped(np.array([0, _ANKLE, -0.012]), pitch, _HEEL, _BALL)
        shoe = _shoe()
        sole = Mesh(tipped(shoe.corners, pitch, _HEEL, _BALL), shoe.uv)
        return sole.placed(at, yaw), at + turn(yaw) @ ankle

    def _arm(self, pelvis: Array, chest: Array, side: int, phase: float) -> tuple[Array, ...]:
        """Return shoulder, elbow, wrist and fingertips of one arm."""
        rises = -side * cos(phase) if self._walks else max(0.0, sin(phase + side))
        swing = self.swing * rises * (1 if self._walks else 2)
        shoulder = pelvis + chest @ (0.102 * side * self.girth, _SHOULDER - _HIP, 0)
        fold = self.pose.fold + 0.7 * max(swing, 0.0)

        def hanging(angle: float, out: float) -> Array:
            direction = np.array([out * side, -cos(angle), sin(angle)])
            return np.asarray(chest @ direction / np.linalg.norm(direction))

        elbow = shoulder + _UPPER_ARM * hanging(swing - 0.1, 0.16)
        wrist = elbow + _FOREARM * hanging(swing + fold, 0.02)
        return shoulder, elbow, wrist, wrist + _HAND * hanging(swing + 1.1 * fold, -0.05)

    def _skirt(self, pelvis: Array, hips: Array, ankles: list[Array]) -> Mesh:
        """Return a skirt or the lower half of a coat, as wide as the stride."""
        ahead = np.array([ankle[2] for ankle in ankles])
        share = np.linspace(0, 1, 6)
        top = pelvis + np.array([0, 0.05, 0])
        drop = share * (top[1] - self.dress.hem)
        stride = share[:, None] ** 1.3 * (0, 0, 0.45 * ahead.mean())
        middle = top - drop[:, None] * (0, 1, 0) + stride
        spread = 0.3 * np.ptp(ahead) / 2
        wide = self.girth * (0.102 + 0.03 * share)
        deep = self.girth * (0.076 + 0.02 * share) + spread * share
        return skin(middle, hips[:, 0], np.stack([wide, deep], 1), 16)


_SIDES = (1, -1)


def _trunk(
    rings: tuple[tuple[float, ...], ...], girth: float, pelvis: Array, low: Array, high: Array
) -> Mesh:
    """Return the body between rings, turned from `low` at the lowest to `high` at the highest.

    Rotations near one another are mixed by their mean, which is a rotation to second order.
    """
    height, wide, deep, ahead = np.array(rings).T
    share = ((height - height[0]) / (height[-1] - height[0]))[:, None, None]
    mixed = (1 - share) * low + share * high
    offsets = np.stack([0 * height, height - _HIP, ahead], 1)
    centres = pelvis + (mixed @ offsets[..., None])[..., 0]
    return skin(centres, mixed[..., 0], girth * np.stack([wide, deep], 1), 14)


def _covered(
    joints: tuple[Array, ...], radii: tuple[float, ...], share: float, girth: float
) -> Mesh:
    """Return a limb from its first joint down to a share of its length."""
    along = np.linspace(0, share * (len(joints) - 1), 2 * len(joints) - 1)
    line = [np.interp(along, range(len(joints)), axis) for axis in np.array(joints).T]
    radius = np.interp(np.linspace(0, share, len(radii)), np.linspace(0, 1, len(radii)), radii)
    return limb(np.stack(line, 1), np.array([1.0, 0, 0]), girth * radius, 3)


def _hand(wrist: Array, tip: Array, chest: Array) -> Mesh:
    line = wrist + np.linspace(0, 1, 5)[:, None] * (tip - wrist)
    thick = np.array([[0.013, 0.016], [0.012, 0.024], [0.012, 0.026], [0.01, 0.02], [0.005, 0.01]])
    return skin(line, chest[:, 0], thick, 8)


def _hair_rings(nape: float) -> tuple[tuple[float, ...], ...]:
    """Return rings of hair that leave the face free."""
    crown = (
        (0.962, 0.049, 0.056, -0.008),
        (0.985, 0.041, 0.05, -0.004),
        (1.003, 0.02, 0.026, -0.004),
    )
    back = ((0.93, 0.049, 0.05, -0.014), (0.945, 0.05, 0.052, -0.014))
    fall = ((nape, 0.038, 0.026, -0.034), (0.5 * nape + 0.462, 0.046, 0.044, -0.02))
    return *(fall if nape < 0.9 else ()), *back, *crown


@lru_cache(maxsize=1)
def _shoe() -> Mesh:
    """Return a shoe that points along z and stands on y = 0 with a flat sole."""
    place, wide, high, level = np.array(_SHOE).T
    line = np.stack([0 * place, level, place], 1)
    last = skin(line, np.array([1.0, 0, 0]), np.stack([wide, high], 1), 12)
    return Mesh(np.maximum(last.corners, (-1.0, 0.0, -1.0)), last.uv)
