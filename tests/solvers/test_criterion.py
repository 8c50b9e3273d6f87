from math import log

import numpy as np
import pytest

from flexdepth.solvers.criterion import COMPLEXITY, Complexity, MotionKind, gric


def test_the_criterion_is_worked_by_hand():
    # n = 3, d = 3: e² is cut at 2 (4 - 3) = 2, so 0.5 + 2 + 1; 3 · 3 log 4; 5 log 12.
    square = np.array([0.5, 100.0, 1.0])
    assert gric(square, Complexity(5, 3)) == pytest.approx(3.5 + 9 * log(4) + 5 * log(12))
    # d = 2: cut at 4.
    assert gric(square, Complexity(0, 2)) == pytest.approx(5.5 + 6 * log(4))


def test_relief_counts_from_six_tenths_of_the_noise_on():
    # Beside a turn, a general motion explains one more component of noise, and the relief.
    random = np.random.default_rng(0)
    across, along = random.normal(size=(2, 20_000))
    for relief, wins in ((0.3, MotionKind.ROTATION), (1.2, MotionKind.GENERAL)):
        shown = along + relief * random.choice([-1, 1], along.shape)
        scores = {
            MotionKind.ROTATION: gric(across**2 + shown**2, COMPLEXITY[MotionKind.ROTATION]),
            MotionKind.GENERAL: gric(across**2, COMPLEXITY[MotionKind.GENERAL]),
        }
        assert min(scores, key=scores.__getitem__) is wins
