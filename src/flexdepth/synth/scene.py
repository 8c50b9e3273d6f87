"""A scene: parts, light and sky, and where a camera may stand in it."""

from dataclasses import dataclass

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
        eyes: Region where cameras stand, low corner and high corner, metres.
        outdoors: Whether cameras look as cars and walkers do, along z, or around a room.
        beams: Sunlight through windows.
        subjects: Regions worth a look from near, low corner and high corner, metres.
        road: Half the width of a road on y = 0 along z, in the middle; 0 where there is none.
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
