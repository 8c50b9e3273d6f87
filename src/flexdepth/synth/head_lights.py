"""The light that the head lamps of vehicles throw ahead."""

import numpy as np

from flexdepth.synth.parts import Parts, bounds
from flexdepth.synth.scene import Spot
from flexdepth.synth.shapes import tilt, turn

_BRIGHT = 5.0
"""Glow above which a part is the head lamps; tail lamps and the signs of buses stay below."""

_POWER = 25.0
"""Irradiance at 1 m against what the lamps look like."""

_DOWN = 0.1
"""Radians by which the light points below the level."""

_HALF_ANGLE = 0.4
"""Of its cone, radians."""


def head_lights(vehicle: Parts, at: tuple[float, float, float], yaw: float) -> tuple[Spot, ...]:
    """Return the light of a vehicle's head lamps, both together; nothing where they are off.

    Args:
        vehicle: It before it is placed: it drives towards -z.
        at: Where it is placed.
        yaw: How it is turned there.
    """
    heads = max(vehicle, key=lambda part: part.material.glow)
    if heads.material.glow < _BRIGHT:
        return ()
    middle, front = np.mean(bounds([heads]), 0), bounds(vehicle)[0][2]
    # The bodywork must not be in the way of what leaves its middle.
    place = np.array([middle[0], middle[1], front - 0.05])
    ahead = turn(yaw) @ tilt(-_DOWN) @ np.array([0, 0, -1.0])
    power = _POWER * heads.material.glow * heads.material.colours[0]
    return (Spot(turn(yaw) @ place + np.asarray(at, float), ahead, _HALF_ANGLE, power),)
