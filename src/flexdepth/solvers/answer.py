"""What the solver of two frames says, and what it says instead of inventing depth."""

from dataclasses import dataclass
from enum import IntEnum, StrEnum

import numpy as np
from numpy.typing import NDArray

from flexdepth.solvers.ego_motion import CameraMotion

Array = NDArray[np.float64]


class Evidence(StrEnum):
    """What the scale of a region, beside that of the static world, hangs on."""

    CAMERA = "camera"
    """It is the static world: its scale is that of the camera's way."""
    CONTACT = "contact"
    """It stands on the static world where its foot is seen."""
    ORDERING = "ordering"
    """It is before what it hides and the ground at its lowest part; it may be nearer still."""
    MOTION = "motion"
    """Only at this scale it stays where it is, or moves level over the ground."""
    STEREO = "stereo"
    PRIOR = "prior"
    """Single-image depth, of it and of what is around it."""
    UNKNOWN = "unknown"
    """Two frames do not tell, and nothing else was given."""


class Kind(StrEnum):
    """How what a region shows has moved."""

    STATIC = "static"
    RIGID = "rigid"
    """By one rotation and translation of its own."""
    FLEXIBLE = "flexible"
    """No one motion explains it."""


class Unknown(IntEnum):
    """Why a pixel has no depth."""

    KNOWN = 0
    """It has one."""
    NO_FLOW = 1
    OCCLUDED = 2
    """Its flow is not to be trusted, as where the target does not show it."""
    LOW_PARALLAX = 3
    """What the camera's travel moves it by does not clear the flow's noise."""
    SCALE = 4
    """It moves by itself, and nothing ties its scale to the static world's."""
    BEHIND = 5
    """The motion would put it behind the camera."""
    SKY = 6
    """The prior says so."""


@dataclass(frozen=True, eq=False)
class Region:
    """Pixels that move together.

    Attributes:
        label: Its number in the map of labels; 0 is the static world.
        kind: How it moves.
        evidence: What its scale hangs on.
        confidence: Of that scale, 0 to 1: the probability that depth is right within a tenth.
        scale_spread: Its relative standard deviation; +inf where it is not known.
        pixels: How many.
    """

    label: int
    kind: Kind
    evidence: Evidence
    confidence: float
    scale_spread: float
    pixels: int


@dataclass(frozen=True, eq=False)
class TwoFrame:
    """Depth and motion of every pixel of the key frame; maps are height x width.

    Attributes:
        depth: z; in units of the camera's way, |t| = 1, or in metres where `metric`; NaN where it
            is not known, +inf where the prior says sky.
        rotation: x 3: axis times angle, radians, of X_target = R X_key + t.
        translation: x 3: t of the same, in the unit of depth.
        labels: Number of each pixel's region; 0 is the static world.
        regions: What is known of each, by its label.
        moving: Whether the pixel moves by itself.
        parallax: Pixels along the epipolar line of its region's motion; NaN without flow.
        residual: Pixels between the flow and what depth and motion say; NaN without flow.
        flow: The flow that was used, x 2, pixels: what a second look at the pictures found where
            that stands still, else as it was seen; NaN is unknown.
        noise: Its standard deviation, pixels; NaN where it was not trusted.
        spread: Relative standard deviation of depth; +inf where it is not known.
        unknown: `Unknown`: 0 where depth is known.
        inferred: Whether depth is not seen, but lies in the plane of what looks the same around it.
        camera_motion: The camera's own.
        prior_share: How much of the depth is the prior's, 0 to 1; None without one.
        metric: Whether depth and translation are in metres.
        notes: What was given and adds nothing, and why, one line each.
    """

    depth: Array
    rotation: Array
    translation: Array
    labels: NDArray[np.int32]
    regions: tuple[Region, ...]
    moving: NDArray[np.bool_]
    parallax: Array
    residual: Array
    flow: Array
    noise: Array
    spread: Array
    unknown: NDArray[np.uint8]
    inferred: NDArray[np.bool_]
    camera_motion: CameraMotion
    prior_share: Array | None
    metric: bool
    notes: tuple[str, ...] = ()

    @property
    def valid(self) -> NDArray[np.bool_]:
        """Where depth is known."""
        return np.asarray(self.unknown == Unknown.KNOWN)
