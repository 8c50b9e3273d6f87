"""What is seen of a thing that moves by itself, and what is known of such things beforehand."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from flexdepth.solvers.answer import Kind
from flexdepth.solvers.borders import Border
from flexdepth.solvers.ground import Ground

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Clues:
    """What is seen of one thing.

    Attributes:
        kind: Rigid or flexible.
        border: Its border with the static world.
        motion: a: of its middle, at scale 1.
        turn: Radians by which it turns by itself; 0 for what bends.
        wobble: How far a is uncertain, because the middle of what turns is not seen.
        way: b: the camera's.
        floor: The ground, if there is one.
        typical: ln s that puts it among what is still: a first guess, no clue.
        size: The square root of the area that it shows, at scale 1.
        rest: ln s at which it lies on the ground as a ball does; None for what is no ball.
        foot: ln s at which the lowest that is seen of it is on the ground; None where no ground is
            below it.
        tips: Radians by which it turns about neither an upright nor a level axis, and its flow's
            noise, likewise, over the root of the share of the frame that it fills (neighbours share
            errors in large frames); None for what bends, and where no ground is seen.
        beside: ln s at which it is as near as the moving thing that it touches; None if alone.
        told: ln s at which it is as near as a single picture says, and that one's doubt; None
            without one.
    """

    kind: Kind
    border: Border
    motion: Array
    turn: float
    wobble: float
    way: Array
    floor: Ground | None
    typical: float
    size: float
    rest: float | None
    foot: float | None
    tips: tuple[float, float] | None = None
    beside: float | None = None
    told: tuple[float, float] | None = None


@dataclass(frozen=True)
class Habits:
    """What is known beforehand of rigid, or of bending things.

    Attributes:
        joint: Weight of standing, of hanging on to what is still, of being in the air, and of
            standing with the foot out of sight; of each with staying, moving level, and moving
            anyhow. They sum to about 1.
        part: Weight, against these, of being a part of what moves and is touched.
        contact: Standard deviation of ln s at a contact.
        lifted: How much nearer it stands than what is seen below its foot, in ln s: feet are
            lifted, and one that stands still belongs to what is still.
        shown: The share of its lowest border that ground is seen below at least, if that is a
            foot: the picture's edge cuts off what bends at hems, from which no foot is told.
        stay: Scale of how far from its place a thing strays that stays, in ways of the camera.
        level: Standard deviation of the rise of what moves level, likewise, and per its own way.
    """

    joint: tuple[tuple[float, float, float], ...]
    part: float
    contact: float
    lifted: float
    shown: float
    stay: float
    level: tuple[float, float]


HABITS = {
    Kind.RIGID: Habits(
        ((0.05, 0.59, 0.003), (0.0, 0.0, 0.0), (0.015, 0.08, 0.08), (0.01, 0.08, 0.001)),
        0.5,
        0.04,
        0.0,
        0.0,
        0.02,
        (0.006, 0.004),
    ),
    Kind.FLEXIBLE: Habits(
        ((0.25, 0.2, 0.17), (0.06, 0.0, 0.05), (0.03, 0.04, 0.04), (0.04, 0.03, 0.04)),
        0.6,
        0.1,
        0.05,
        0.3,
        0.08,
        (0.05, 0.05),
    ),
}


def normal(values: Array, deviation: Array | float) -> Array:
    """Return the normal density about 0."""
    return np.asarray(np.exp(-0.5 * (values / deviation) ** 2) / (np.sqrt(2 * np.pi) * deviation))
