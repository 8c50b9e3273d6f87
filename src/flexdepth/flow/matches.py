"""Sparse matches: the term of chapter 5, against which dense flow is checked.

References:
    Alcantarilla, Nuevo and Bartoli, Fast explicit diffusion for accelerated features in nonlinear
    scale spaces, BMVC 2013.
"""

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from flexdepth.flow.field import FlowField
from flexdepth.flow.frames import Image, gray_pair

_RATIO = 0.8


@dataclass(frozen=True, eq=False)
class Matches:
    """Points of the key frame and the same points in the target.

    Attributes:
        key: Points by (x, y), pixels from the top left corner: the first pixel's centre is 0.5.
        target: Likewise, in the target frame.
    """

    key: NDArray[np.float64]
    target: NDArray[np.float64]

    def __len__(self) -> int:
        """Return how many there are."""
        return len(self.key)


@dataclass(frozen=True)
class Akaze:
    """AKAZE keypoints, matched where each is the other's nearest and no second comes near.

    Attributes:
        threshold: Of the detector's response; smaller finds more keypoints.
        most: The most keypoints of a frame that are matched, the strongest first.
    """

    threshold: float = 1e-3
    most: int = 4000

    def between(self, key: Image, target: Image) -> Matches:
        """Return the matches; there may be none.

        Args:
            key: Height x width, or height x width x 3 in RGB; 0 to 255.
            target: Another view of it, of the same size.

        Raises:
            InputError: The frames differ in size or one shows nothing.
        """
        detector = cv2.xfeatures2d.AKAZE.create(threshold=self.threshold, max_points=self.most)
        described = [detector.detectAndCompute(frame, None) for frame in gray_pair(key, target)]
        (points, words), (others, other_words) = described
        if min(len(points), len(others)) < 2:
            return Matches(np.zeros((0, 2)), np.zeros((0, 2)))
        matcher = cv2.BFMatcher(cv2.NORM_HAMMING)
        there = matcher.knnMatch(words, other_words, k=2)
        back = {found.queryIdx: found.trainIdx for found in matcher.match(other_words, words)}
        pairs = [
            (points[best.queryIdx].pt, others[best.trainIdx].pt)
            for best, second in there
            if best.distance < _RATIO * second.distance and back[best.trainIdx] == best.queryIdx
        ]
        ends = np.array(pairs, np.float64).reshape(-1, 2, 2) + 0.5
        return Matches(ends[:, 0], ends[:, 1])


@dataclass(frozen=True)
class Agreement:
    """How far sparse matches bear dense flow out.

    Attributes:
        matches: How many begin on valid flow.
        share: Of these, what ends where the flow says; NaN if there are none.
    """

    matches: int
    share: float


def agreement(field: FlowField, matches: Matches, within: float = 2.0) -> Agreement:
    """Return how many of the matches on valid flow end where the flow says.

    The two are found by different means from different traits of the frames: where they agree on
    little, as across a cut, one of them is wrong.

    Args:
        field: Dense flow.
        matches: Of the same two frames.
        within: Pixels.
    """
    height, width = field.valid.shape
    column, row = np.clip(np.floor(matches.key).astype(int), 0, (width - 1, height - 1)).T
    valid = field.valid[row, column]
    shift = (matches.target - matches.key)[valid]
    off = np.linalg.norm(field.flow[row, column][valid] - shift, axis=1)
    return Agreement(len(off), float((off <= within).mean()) if len(off) else float("nan"))
