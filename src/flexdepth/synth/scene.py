"""A scene: parts, light and sky, and where a camera may stand in it."""

from dataclasses import dataclass, field
from enum import Enum

import numpy as np
from numpy.typing import NDArray

from flexdepth.synth.materials import Part


@dataclass(frozen=True, eq=False)
class AreaLight:
    """A horizontal square lamp.

    Attributes:
        centre: Its middle, metres.
        side: Its side length, metres.
        power: Red, green, blue; the irradiance at 1 m straight below it.
    """

    centre: NDArray[np.float64]
    side: float
    power: NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Sun:
    """Parallel light.

    Attributes:
        towards: Unit vector from the ground to the sun.
        power: Red, green, blue irradiance on a surface that faces it.
    """

    towards: NDArray[np.float64]
    power: NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Beam:
    """Sunlight that comes into a room through a window in a wall that is otherwise closed.

    Attributes:
        corner: A corner of the opening, metres.
        along: From there to the next corner.
        up: And to the other neighbour.
        panes: Panes in a row and in a column; the bars between them cast shadows.
        towards: Unit vector to the sun.
        power: Red, green, blue irradiance on a surface that faces the sun.
    """

    corner: NDArray[np.float64]
    along: NDArray[np.float64]
    up: NDArray[np.float64]
    panes: int
    towards: NDArray[np.float64]
    power: NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Spot:
    """A lamp that throws a cone of light, such as the head lamps of a car.

    Attributes:
        place: Where it is, metres.
        ahead: Unit vector along the middle of its cone.
        half_angle: Between that and the rim of the cone, radians; to there the light fades.
        power: Red, green, blue; the irradiance at 1 m on a surface that faces it, in the middle.
    """

    place: NDArray[np.float64]
    ahead: NDArray[np.float64]
    half_angle: float
    power: NDArray[np.float64]


class Aim(Enum):
    """What a camera is turned to, and where it is held for that."""

    ROAD = "road"
    """Either way along z."""
    AROUND = "around"
    """Any direction."""
    SUBJECT = "subject"
    """The scene's subject."""
    THING = "thing"
    """A thing of the scene, wherever that is."""
    ACROSS = "across"
    """Where somebody else could stand, as high as the camera is held here."""
    EDGE = "edge"
    """The same, from the edge of where cameras stand."""
    NEAR = "near"
    """One of the scene's subjects, from half a step away."""


@dataclass(frozen=True)
class Carrier:
    """Who holds a camera, and how.

    Attributes:
        height: Of the camera above the floor, least and most, metres; lower under low ceilings.
        aim: What it is turned to.
        yaw: Spread of the heading around that, radians.
        pitch: Mean and spread of the upward tilt, radians.
        roll: Spread of the roll, radians.
        view: Least and most width of the picture, degrees.
    """

    height: tuple[float, float]
    aim: Aim
    yaw: float
    pitch: tuple[float, float]
    roll: float
    view: tuple[float, float] = (40.0, 88.0)


@dataclass(frozen=True, eq=False)
class Scene:
    """Everything that is rendered.

    Attributes:
        parts: Meshes with materials.
        lamps: Area lights.
        sun: The sun, or None.
        ambient: Light from all sides, red, green, blue; it is shaded by what is near.
        occlusion_reach: Metres within which a surface takes ambient light from another.
        horizon: Sky colour at the horizon.
        zenith: Sky colour overhead.
        clouds: Share of the sky that is clouded.
        eyes: Region where cameras are, low corner and high corner, metres; who holds them says
            how high.
        outdoors: Whether it is under the sky.
        beams: Sunlight through windows.
        subjects: Regions worth a look from near, low corner and high corner, metres.
        road: Half the width of a road on y = 0 along z, in the middle; 0 where there is none.
        gloom: How much darker the thick of a cloud is than its rim, 0 to 1.
        haze: Share of a thing's light that is lost in each metre of air.
        carriers: Who holds cameras here, each with a share.
        ceiling: Metres from the floor up to what cameras stay below.
        places: Where they stand: points of floors, treads and landings by (x, y, z); anywhere in
            `eyes` on y = 0 where there are none.
        subject: What cameras are mostly turned to, or None.
        nearest: Metres that a camera keeps from what fills more than a corner of its picture.
        variety: Surfaces of how many materials a picture shows at least.
        spots: Lamps that light what is ahead of them.
        dark: Whether what drives here has its lamps on.
    """

    parts: list[Part]
    lamps: list[AreaLight]
    sun: Sun | None
    ambient: NDArray[np.float64]
    occlusion_reach: float
    horizon: NDArray[np.float64]
    zenith: NDArray[np.float64]
    clouds: float
    eyes: tuple[NDArray[np.float64], NDArray[np.float64]]
    outdoors: bool
    road: float = 0.0
    beams: tuple[Beam, ...] = ()
    subjects: tuple[tuple[NDArray[np.float64], NDArray[np.float64]], ...] = ()
    gloom: float = 0.0
    haze: float = 0.0
    carriers: tuple[tuple[float, Carrier], ...] = ()
    ceiling: float = np.inf
    places: NDArray[np.float64] = field(default_factory=lambda: np.empty((0, 3)))
    subject: NDArray[np.float64] | None = None
    nearest: float = 0.2
    variety: int = 7
    spots: tuple[Spot, ...] = ()
    dark: bool = False
