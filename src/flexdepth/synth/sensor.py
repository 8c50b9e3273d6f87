"""Noise as sensors have it, and what cameras do to hide it: smoothing, sharpening, JPEG."""

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.random import Generator
from numpy.typing import NDArray

Array = NDArray[np.float32]


@dataclass(frozen=True, eq=False)
class Sensor:
    """A sensor and the software behind it.

    Attributes:
        shot: Variance of a white pixel's noise; it grows in proportion to the light.
        read: Standard deviation of a black pixel's noise.
        grain: Pixels over which the noise is correlated, as demosaicing leaves it.
        blotch: Strength of slow colour noise against the fine one.
        smear: Range of values that noise reduction takes for the same; 0 leaves the noise.
        sharpening: Weight of an unsharp mask; it leaves halos.
        quality: Of a JPEG that the picture goes through; 100 skips it.
    """

    shot: float
    read: float
    grain: float
    blotch: float
    smear: float
    sharpening: float
    quality: int

    @classmethod
    def drawn(cls, rng: Generator, brightness: float) -> "Sensor":
        """Return a random sensor; where there is little light it is turned up."""
        gain = float(np.exp(rng.normal(-1.3, 0.9))) * (0.12 / brightness) ** 0.7
        return cls(
            shot=min(4e-4 * gain, 2.5e-3),
            read=min(2e-3 * gain, 0.008),
            grain=float(rng.uniform(0.3, 0.9)),
            blotch=float(rng.uniform(0, 1.2) if rng.random() < 0.5 else 0),
            smear=float(rng.uniform(0.02, 0.12) if rng.random() < 0.35 else 0),
            sharpening=float(rng.uniform(0.2, 1.5) if rng.random() < 0.45 else 0),
            quality=int(rng.integers(30, 90)) if rng.random() < 0.35 else 100,
        )

    def noisy(self, rng: Generator, light: Array) -> Array:
        """Return linear light with noise."""
        deviation = np.sqrt(self.shot * np.clip(light, 0, 1) + self.read**2)
        raw = 0.7 * rng.standard_normal(light.shape, np.float32)
        raw += 0.7 * rng.standard_normal((*light.shape[:2], 1), np.float32)
        # What blurring white noise leaves of its spread.
        kept = np.float32((cv2.getGaussianKernel(9, self.grain) ** 2).sum())
        fine = np.asarray(cv2.GaussianBlur(raw, (0, 0), self.grain)) / kept
        if self.blotch:
            height, width = light.shape[:2]
            small = rng.standard_normal((height // 4 + 1, width // 4 + 1, 3), np.float32)
            small -= small.mean(-1, keepdims=True)
            slow = cv2.resize(small, (width, height), interpolation=cv2.INTER_CUBIC)
            fine = fine + self.blotch * slow
        return np.asarray(light + deviation * fine, np.float32)

    def developed(self, encoded: Array) -> NDArray[np.uint8]:
        """Return the picture as it is saved."""
        picture = np.asarray(encoded)
        if self.smear:
            picture = np.asarray(cv2.bilateralFilter(picture, 5, self.smear, 2.0), np.float32)
        if self.sharpening:
            soft = np.asarray(cv2.GaussianBlur(picture, (0, 0), 1.2), np.float32)
            picture = picture + np.float32(self.sharpening) * (picture - soft)
        eight = (255 * np.clip(picture, 0, 1)).round().astype(np.uint8)
        if self.quality == 100:
            return eight
        # OpenCV's pictures are blue, green, red, and JPEG keeps less of blue than of red.
        shown = cv2.cvtColor(eight, cv2.COLOR_RGB2BGR)
        packed = cv2.imencode(".jpg", shown, [cv2.IMWRITE_JPEG_QUALITY, self.quality])[1]
        seen = np.asarray(cv2.imdecode(packed, cv2.IMREAD_COLOR), np.uint8)
        return np.asarray(cv2.cvtColor(seen, cv2.COLOR_BGR2RGB), np.uint8)
