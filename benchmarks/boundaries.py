"""How sharp the edges of predictions are, beside what their own number of pixels allows.

Depth Pro's boundary F1 needs truth that is dense and lies where the picture's edges lie: the
rendered sets. The ceiling is what the truth itself scores after being reduced to the size at
which the bundled network runs and brought back: no map of that size can do much better.
"""

from collections.abc import Mapping

import cv2
import numpy as np
from numpy.typing import NDArray
from samples import scored_pixels
from scores import Fit, Seen, fitted

from flexdepth.evaluation.boundary import boundary_f1, has_edge
from flexdepth.runtime.depthmap import Space
from flexdepth.runtime.sizes import HasArea, network_size

CEILING = "truth, reduced"


def boundaries(seen: Seen, cap: float, network: HasArea) -> Mapping[str, float]:
    """Return the boundary F1 of each model and the ceiling; nothing where the truth has no edge.

    Disparity up to a factor and an offset is fitted to the truth first; depth is taken as it is.

    Args:
        seen: What the models predict for a picture.
        cap: The farthest truth that counts, in metres.
        network: The size at which the bundled network runs.
    """
    truth = np.nan_to_num(seen.pair.truth.values.astype(np.float64), nan=0.0, posinf=0.0)
    valid = scored_pixels(truth, cap)
    if not valid.any() or not has_edge(truth, valid):
        return {}
    found = {}
    for name, prediction in seen.maps.items():
        is_disparity = prediction.space is Space.AFFINE_DISPARITY
        fit = Fit.DISPARITY if is_disparity else Fit.MEDIAN
        found[name] = boundary_f1(fitted(prediction, fit, truth, valid, cap), truth, valid)
    height, width = truth.shape
    reduced = there_and_back(truth, valid, network_size(width, height, network))
    return found | {CEILING: boundary_f1(reduced, truth, valid)}


def there_and_back(
    truth: NDArray[np.float64], valid: NDArray[np.bool_], size: tuple[int, int]
) -> NDArray[np.float64]:
    """Return the truth reduced to a width and a height by means of its logarithm, and enlarged."""
    log = np.log(np.where(valid, truth, 1.0))
    share = cv2.resize(valid.astype(np.float64), size, interpolation=cv2.INTER_AREA)
    small = cv2.resize(np.where(valid, log, 0.0), size, interpolation=cv2.INTER_AREA)
    # What is unknown at the small size lies beside known pixels at most by a pixel of it.
    near = cv2.blur(small, (3, 3)) / np.maximum(cv2.blur(share, (3, 3)), 1e-9)
    known = np.where(share > 0, small / np.maximum(share, 1e-9), near)
    own = cv2.resize(known, truth.shape[::-1], interpolation=cv2.INTER_LINEAR)
    return np.asarray(np.exp(own), np.float64)
