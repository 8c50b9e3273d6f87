"""Exposure, white balance, contrast and the way highlights go white."""

from dataclasses import dataclass

import numpy as np
from numpy.random import Generator
from numpy.typing import NDArray

Array = NDArray[np.float32]
_GREY = np.array([0.2126, 0.7152, 0.0722], np.float32)


@dataclass(frozen=True, eq=False)
class Tone:
    """How a camera turns light into colour.

    Attributes:
        brightness: Which linear grey the image's geometric mean becomes.
        balance: Red, green and blue against the true ones.
        shoulder: How soon highlights are compressed; 0 clips them.
        contrast: Exponent of an S-curve around middle grey; 1 leaves it straight.
        saturation: Of colours, 1 leaves them, 0 is black and white.
    """

    brightness: float
    balance: NDArray[np.float64]
    shoulder: float
    contrast: float
    saturation: float

    @classmethod
    def drawn(cls, rng: Generator) -> "Tone":
        """Return random settings: mostly well exposed, at times too dark or too bright."""
        kind = rng.random()
        span = (0.04, 0.1) if kind < 0.12 else (0.32, 0.55) if kind < 0.24 else (0.1, 0.32)
        return cls(
            brightness=float(np.exp(rng.uniform(*np.log(span)))),
            balance=np.exp(rng.normal(0, 0.03, 3) + rng.normal(0, 0.13) * np.array([1, 0, -1])),
            shoulder=float(rng.uniform(0, 0.8) if rng.random() < 0.8 else 0),
            contrast=float(rng.uniform(1.0, 1.9)),
            saturation=float(np.exp(rng.normal(0, 0.25)) if rng.random() < 0.98 else 0),
        )

    def exposed(self, light: Array) -> Array:
        """Return linear light where 1 is white, before anything is clipped."""
        middle = float(np.exp(np.log(light.mean(-1) + 1e-4).mean()))
        return np.asarray(light * (self.brightness / middle) * self.balance, np.float32)

    def encoded(self, light: Array) -> Array:
        """Return sRGB values in [0, 1]."""
        positive = np.maximum(light, 0)
        white = 6.0
        rolled = positive * (1 + positive * self.shoulder / white**2)
        rolled /= 1 + positive * self.shoulder
        grey = (rolled @ _GREY)[..., None]
        coloured = np.clip(grey + self.saturation * (rolled - grey), 0, 1).astype(np.float32)
        display = srgb(coloured)
        curve = display**self.contrast / (
            display**self.contrast + (1 - display) ** self.contrast + 1e-9
        )
        return np.asarray(curve, np.float32)


def srgb(linear: Array) -> Array:
    """Return the standard's encoding of linear light in [0, 1]."""
    return np.where(
        linear <= 0.0031308, 12.92 * linear, 1.055 * np.maximum(linear, 1e-9) ** (1 / 2.4) - 0.055
    ).astype(np.float32)
