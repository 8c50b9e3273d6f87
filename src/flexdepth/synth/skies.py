"""Weather and hours: sky, sun, clouds, haze and what light they leave on the ground.

Numbers are relative: a bright sky has a radiance of about 1. Sun against sky follows the usual
measurements of daylight: on a clear day the sun gives a level surface three to six times what the
sky gives, and nothing under an overcast sky, which is then ten times brighter than asphalt.
"""

from dataclasses import dataclass
from math import cos, pi, sin

import numpy as np
from numpy.random import Generator
from numpy.typing import NDArray

from flexdepth.synth.scene import Sun

Colour = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Weather:
    """Light from above.

    Attributes:
        zenith: Sky colour overhead.
        horizon: Sky colour at the horizon.
        ambient: Light from all sides.
        sun: The sun, or None.
        clouds: Share of the sky that is clouded.
        gloom: How much darker the thick of a cloud is than its rim, 0 to 1.
        haze: Share of a thing's light that is lost in each metre of air.
        dark: Whether lamps are lit.
    """

    zenith: Colour
    horizon: Colour
    ambient: Colour
    sun: Sun | None
    clouds: float
    gloom: float
    haze: float
    dark: bool


@dataclass(frozen=True)
class _Hour:
    """What one kind of weather is drawn from: least and most of each number.

    Attributes:
        share: How often it is drawn.
        zenith: Colours overhead.
        horizon: Colours at the horizon.
        sun: Irradiance of the sun against the ambient light's; 0 is no sun.
        elevation: Of the sun, radians.
        tint: Green and blue of the sun against its red, lowest.
        clouds: Share of the sky that is clouded.
        gloom: As in `Weather`.
        dark: Whether lamps are lit.
    """

    share: float
    zenith: tuple[tuple[float, float, float], tuple[float, float, float]]
    horizon: tuple[tuple[float, float, float], tuple[float, float, float]]
    sun: tuple[float, float]
    elevation: tuple[float, float]
    tint: tuple[float, float]
    clouds: tuple[float, float]
    gloom: tuple[float, float]
    dark: bool


_HOURS: dict[str, _Hour] = {
    "clear": _Hour(
        0.27, ((0.06, 0.18, 0.5), (0.25, 0.45, 0.9)), ((0.5, 0.65, 0.85), (0.9, 0.97, 1.1)),
        (2.0, 6.0), (0.3, 1.3), (0.88, 0.7), (-0.2, 0.15), (0.0, 0.2), False,
    ),
    "fair": _Hour(
        0.25, ((0.1, 0.22, 0.5), (0.3, 0.5, 0.9)), ((0.6, 0.7, 0.85), (1.0, 1.05, 1.1)),
        (1.2, 4.5), (0.25, 1.2), (0.88, 0.7), (0.25, 0.7), (0.1, 0.55), False,
    ),
    "overcast": _Hour(
        0.2, ((0.6, 0.63, 0.68), (1.1, 1.15, 1.2)), ((0.65, 0.68, 0.72), (1.1, 1.12, 1.15)),
        (0.0, 0.0), (0.5, 1.0), (1.0, 1.0), (0.8, 1.05), (0.0, 0.4), False,
    ),
    "heavy": _Hour(
        0.09, ((0.15, 0.2, 0.3), (0.5, 0.55, 0.65)), ((0.5, 0.5, 0.5), (0.9, 0.9, 0.9)),
        (0.0, 1.5), (0.15, 0.8), (0.85, 0.6), (0.6, 1.0), (0.55, 0.9), False,
    ),
    "low sun": _Hour(
        0.1, ((0.1, 0.15, 0.35), (0.3, 0.4, 0.7)), ((0.8, 0.5, 0.25), (1.3, 0.85, 0.6)),
        (1.5, 6.0), (0.04, 0.3), (0.6, 0.3), (-0.1, 0.75), (0.1, 0.7), False,
    ),
    "dusk": _Hour(
        0.04, ((0.03, 0.05, 0.13), (0.1, 0.15, 0.3)), ((0.15, 0.12, 0.15), (0.5, 0.3, 0.25)),
        (0.0, 0.0), (0.5, 1.0), (1.0, 1.0), (0.0, 0.9), (0.2, 0.7), True,
    ),
    "night": _Hour(
        0.05, ((0.0005, 0.0006, 0.001), (0.006, 0.008, 0.015)), ((0.002,) * 3, (0.03, 0.024, 0.02)),
        (0.0, 0.0), (0.5, 1.0), (1.0, 1.0), (0.0, 1.0), (0.0, 0.5), True,
    ),
}  # fmt: skip


def weather(rng: Generator) -> Weather:
    """Return random weather at a random hour."""
    shares = np.array([hour.share for hour in _HOURS.values()])
    hour = list(_HOURS.values())[int(rng.choice(len(shares), p=shares / shares.sum()))]
    tone = rng.random()
    zenith = np.asarray(hour.zenith[0]) + tone * (np.subtract(*hour.zenith[::-1]))
    horizon = np.asarray(hour.horizon[0]) + rng.random() * (np.subtract(*hour.horizon[::-1]))
    clouds = float(np.clip(rng.uniform(*hour.clouds), 0, 1))
    gloom = float(rng.uniform(*hour.gloom))
    white = 0.5 * horizon + 0.5 * horizon.mean()
    overhead = zenith + (white * (1 - 0.6 * gloom) - zenith) * clouds
    ambient = (0.6 * overhead + 0.4 * horizon) * rng.uniform(0.7, 1.1)
    haze = 0.0 if rng.random() < 0.25 else float(np.exp(rng.uniform(np.log(1e-4), np.log(2e-3))))
    return Weather(
        zenith=zenith,
        horizon=horizon,
        ambient=ambient,
        sun=_sun(rng, hour, float(ambient.mean())),
        clouds=clouds,
        gloom=gloom,
        haze=haze if rng.random() < 0.96 else float(rng.uniform(0.005, 0.02)),
        dark=hour.dark,
    )


def _sun(rng: Generator, hour: _Hour, ambient: float) -> Sun | None:
    strength = float(rng.uniform(*hour.sun)) * ambient
    if strength <= 0:
        return None
    azimuth, elevation = rng.uniform(0, 2 * pi), rng.uniform(*hour.elevation)
    # Along the road as well, so that it is low in the picture and shadows come towards the camera.
    if rng.random() < 0.3:
        azimuth = rng.choice([pi / 2, -pi / 2]) + rng.normal(0, 0.35)
    flat = cos(elevation)
    towards = np.array([cos(azimuth) * flat, sin(elevation), sin(azimuth) * flat])
    colour = np.array([1.0, rng.uniform(hour.tint[0], 1), rng.uniform(hour.tint[1], 1)])
    return Sun(towards, strength * colour)
