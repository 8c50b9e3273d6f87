"""Where to begin: models that many matches agree on, by OpenCV's USAC with MAGSAC's score.

The same matches give the same model: the draws have a fixed seed, and one thread.

References:
    Raguram et al., USAC, PAMI 2013; Barath et al., MAGSAC++, CVPR 2020.
"""

import cv2
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

_POINTS = 3000
"""More are thinned out: the draws need no more."""

_SMALLEST_THRESHOLD = 0.1


def essential_matrix(key: Array, target: Array, focal: Array, noise: Array) -> Array | None:
    """Return E with yᵀ E x = 0, or None where USAC finds none.

    Args:
        key: Rays n x 3, z = 1.
        target: Likewise.
        focal: Across and down, pixels.
        noise: n standard deviations, pixels.
    """
    one, other = (_pixels(each, focal) for each in (key, target))
    matrix, straight = np.diag([*focal, 1.0]), np.zeros(4)
    found, _ = cv2.findEssentialMat(
        one, other, matrix, matrix, straight, straight, _settings(noise)
    )
    return None if found is None or found.shape != (3, 3) else np.asarray(found, np.float64)


def homography(key: Array, target: Array, focal: Array, noise: Array) -> Array | None:
    """Return H of length 1 with y ~ H x, or None where USAC finds none.

    Args:
        key: Rays n x 3, z = 1.
        target: Likewise.
        focal: Across and down, pixels.
        noise: n standard deviations, pixels.
    """
    one, other = (_pixels(each, focal) for each in (key, target))
    found, _ = cv2.findHomography(one, other, _settings(noise))
    if found is None:
        return None
    scaling = np.array([*focal, 1.0])
    rays = np.asarray(found, np.float64) * scaling / scaling[:, None]
    return np.asarray(rays / np.linalg.norm(rays))


def _pixels(rays: Array, focal: Array) -> Array:
    """Return where some of the rays are seen, counted from the principal point."""
    some = np.linspace(0, len(rays) - 1, min(len(rays), _POINTS)).astype(int)
    return np.asarray(rays[some, :2] * focal)


def _settings(noise: Array) -> cv2.UsacParams:
    settings = cv2.UsacParams()
    settings.confidence = 0.9999
    settings.maxIterations = 2000
    settings.threshold = max(_SMALLEST_THRESHOLD, 3 * float(np.median(noise)))
    settings.score = cv2.SCORE_METHOD_MAGSAC
    settings.isParallel = False
    settings.randomGeneratorState = 0
    return settings
