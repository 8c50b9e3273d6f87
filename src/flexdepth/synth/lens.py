"""From linear light to the picture that a camera would have saved."""

import cv2
import numpy as np
from numpy.random import Generator
from numpy.typing import NDArray


def photograph(rng: Generator, light: NDArray[np.float32]) -> NDArray[np.uint8]:
    """Return an 8-bit sRGB picture: exposure, white balance, highlights, blur, vignette, noise."""
    height, width = light.shape[:2]
    grey = light.mean(-1)
    middle = float(np.exp(np.log(grey + 1e-4).mean()))
    brightness = float(np.exp(rng.uniform(np.log(0.035), np.log(0.32))))
    exposed = light * (brightness / middle) * np.exp(rng.normal(0, 0.06, 3))
    shoulder = rng.uniform(0.1, 0.6)
    compressed = exposed * (1 + exposed * shoulder / 4) / (1 + exposed * shoulder)
    row, column = np.mgrid[:height, :width]
    radius = np.hypot((row + 0.5) / height - 0.5, (column + 0.5) / width - 0.5)
    shaded = compressed * (1 - rng.uniform(0, 0.5) * radius[..., None] ** 2)
    blurred = cv2.GaussianBlur(shaded.astype(np.float32), (0, 0), rng.uniform(0.3, 0.9))
    grain = rng.normal(0, rng.uniform(0, 0.025), light.shape) * np.sqrt(
        np.clip(blurred, 0, 1) + 0.02
    )
    picture = np.clip(blurred + grain, 0, 1)
    encoded = np.where(picture <= 0.0031308, 12.92 * picture, 1.055 * picture ** (1 / 2.4) - 0.055)
    return np.asarray((255 * encoded).round(), np.uint8)
