from collections.abc import Callable

import cv2
import numpy as np
import pytest

MARGIN = 40


@pytest.fixture
def cut() -> Callable[..., np.ndarray]:
    """Return a function that cuts 160 x 120 pixels out of a textured sheet, from a column and row.

    What is seen in a cut `right` of another one has gone left in it.
    """

    def make(right: int = 0, down: int = 0, seed: int = 0) -> np.ndarray:
        noise = np.random.default_rng(seed).uniform(0, 255, (200, 240)).astype(np.float32)
        sheet = cv2.normalize(cv2.GaussianBlur(noise, (0, 0), 1.5), None, 0, 255, cv2.NORM_MINMAX)
        top, left = MARGIN + down, MARGIN + right
        return sheet[top : top + 120, left : left + 160].astype(np.uint8)

    return make
