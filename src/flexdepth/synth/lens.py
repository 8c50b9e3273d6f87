"""From linear light to the picture that a camera would have saved."""

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.random import Generator
from numpy.typing import NDArray


@dataclass(frozen=True, eq=False)
class Film:
    """How one camera takes pictures.

    Attributes:
        brightness: Which grey the image's geometric mean becomes.
        balance: Red, green and blue against the true ones.
        shoulder: How soon highlights are compressed.
        vignette: How much darker the corners are.
        blur: Of the lens, pixels.
        grain: Noise of a white pixel.
    """

    brightness: float
    balance: NDArray[np.float64]
    shoulder: float
    vignette: float
    blur: float
    grain: float

    @classmethod
    def drawn(cls, rng: Generator) -> "Film":
        """Return a random camera."""
        return cls(
            brightness=float(np.exp(rng.uniform(np.log(0.035), np.log(0.32)))),
            balance=np.exp(rng.normal(0, 0.06, 3)),
            shoulder=rng.uniform(0.1, 0.6),
            vignette=rng.uniform(0, 0.5),
            blur=rng.uniform(0.3, 0.9),
            grain=rng.uniform(0, 0.025),
        )

    def picture(self, rng: Generator, light: NDArray[np.float32]) -> NDArray[np.uint8]:
        """Return an 8-bit sRGB picture: exposure, white balance, highlights, blur, noise."""
        height, width = light.shape[:2]
        grey = light.mean(-1)
        middle = float(np.exp(np.log(grey + 1e-4).mean()))
        exposed = light * (self.brightness / middle) * self.balance
        compressed = exposed * (1 + exposed * self.shoulder / 4) / (1 + exposed * self.shoulder)
        row, column = np.mgrid[:height, :width]
        radius = np.hypot((row + 0.5) / height - 0.5, (column + 0.5) / width - 0.5)
        shaded = compressed * (1 - self.vignette * radius[..., None] ** 2)
        blurred = cv2.GaussianBlur(shaded.astype(np.float32), (0, 0), self.blur)
        grain = rng.normal(0, self.grain, light.shape) * np.sqrt(np.clip(blurred, 0, 1) + 0.02)
        picture = np.clip(blurred + grain, 0, 1)
        encoded = np.where(
            picture <= 0.0031308, 12.92 * picture, 1.055 * picture ** (1 / 2.4) - 0.055
        )
        return np.asarray((255 * encoded).round(), np.uint8)


def photograph(rng: Generator, light: NDArray[np.float32]) -> NDArray[np.uint8]:
    """Return the picture that a random camera takes."""
    return Film.drawn(rng).picture(rng, light)
