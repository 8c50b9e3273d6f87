"""What two frames tell, in plain words."""

from math import atan, degrees

import numpy as np
from numpy.typing import NDArray

from flexdepth.runtime.depthmap import FocalSource
from flexdepth.scenes.pair import Solution
from flexdepth.solvers.criterion import MotionKind
from flexdepth.solvers.pose import angle
from flexdepth.solvers.two_frame import Evidence, Kind, TwoFrame, Unknown

_WAYS = (("right", "left"), ("down", "up"), ("forward", "back"))
"""Along x, y and z, and against them."""

_ASIDE = 0.17
"""A component below this share of the way, some ten degrees, is not worth a word."""

_HANGS_ON = {
    Evidence.CONTACT: "from where it touches what is still",
    Evidence.ORDERING: "from what it hides: it may be nearer still",
    Evidence.MOTION: "from how it moves: level over the ground, or not at all",
    Evidence.STEREO: "from the stereo pair",
    Evidence.PRIOR: "from the single-image depth",
    Evidence.UNKNOWN: "not known",
    Evidence.CAMERA: "from the camera's way",
}

_WITHOUT = {
    Unknown.NO_FLOW: "without flow",
    Unknown.OCCLUDED: "hidden in the target or not matched",
    Unknown.LOW_PARALLAX: "too little parallax",
    Unknown.SCALE: "of unknown scale",
    Unknown.BEHIND: "would be behind the camera",
    Unknown.SKY: "sky",
}


def camera_translation(found: TwoFrame) -> NDArray[np.float64]:
    """Return t of the camera's own X_target = R X_key + t, in the unit of depth."""
    still = np.asarray(found.labels == 0)
    if found.metric and still.any():
        return np.asarray(np.median(found.translation[still], axis=0), np.float64)
    return found.camera_motion.pose.translation


def position(found: TwoFrame) -> NDArray[np.float64]:
    """Return where the camera is in the target frame, in the key camera's axes and depth's unit."""
    return -found.camera_motion.pose.rotation.T @ camera_translation(found)


def camera_words(solution: Solution) -> list[str]:
    """Return what the camera has done, in a line or two."""
    motion = solution.found.camera_motion
    turn = f"turned {degrees(angle(motion.pose.rotation)):.2f} degrees"
    match motion.kind:
        case MotionKind.STILL:
            return ["The camera has stood still, as far as the frames tell."]
        case MotionKind.ROTATION:
            return [f"The camera has {turn} on the spot, as far as the frames tell."]
    way = position(solution.found)
    unit = way / np.linalg.norm(way)
    names = [
        pair[0 if value > 0 else 1]
        for pair, value in zip(_WAYS, unit, strict=True)
        if abs(value) > _ASIDE
    ]
    numbers = ", ".join(f"{value:.3f}" for value in unit)
    size = f"{np.linalg.norm(way):.3g} m " if solution.found.metric else ""
    line = f"The camera went {size}{' and '.join(names)} (x, y, z: {numbers}) and {turn}."
    if motion.kind is MotionKind.PLANE and motion.alternative is not None:
        return [line, "What is seen lies in one plane: another motion would explain it as well."]
    return [line]


def depth_words(solution: Solution) -> str:
    """Return how much of the frame has depth, in which unit, and why the rest has none."""
    found = solution.found
    shares = np.bincount(found.unknown.ravel(), minlength=len(Unknown)) / found.unknown.size
    unit = "metres" if found.metric else "units of the camera's way"
    if not found.camera_motion.translates and not found.metric:
        unit = "relative numbers"
    rest = [
        f"{shares[reason]:.1%} {words}"
        for reason, words in _WITHOUT.items()
        if shares[reason] >= 0.0005
    ]
    known = f"Depth for {shares[Unknown.KNOWN]:.1%} of the frame, in {unit}"
    if found.inferred.any():
        known += f"; {found.inferred.mean():.1%} is inferred, from what looks the same around it"
    return f"{known}; none for {', '.join(rest)}." if rest else f"{known}."


def region_words(found: TwoFrame, most: int) -> list[str]:
    """Return a line for what is still, and one for each of the largest things that move."""
    movers = [region for region in found.regions if region.kind is not Kind.STATIC]
    if not movers and found.moving.any():
        return [f"{found.moving.mean():.1%} of the frame moves by itself, in no separate parts."]
    if not movers:
        return ["Nothing moves by itself, as far as the frames tell."]
    total = found.labels.size
    lines = [
        f"Mover {region.label}: {region.kind}, {region.pixels / total:.1%} of the frame; scale "
        f"{_HANGS_ON[region.evidence]} (confidence {region.confidence:.2f})."
        for region in sorted(movers, key=lambda each: -each.pixels)[:most]
    ]
    if len(movers) > most:
        lines.append(f"{len(movers) - most} smaller movers more.")
    return lines


def summary(solution: Solution, most: int = 6) -> list[str]:
    """Return what there is to say, one line each."""
    return [
        *camera_words(solution),
        depth_words(solution),
        *region_words(solution.found, most),
    ]


def _unknown_focal(solution: Solution) -> str:
    camera, whence = solution.camera, "by assumption"
    view = 2 * degrees(atan(solution.views.size[0] / 2 / camera.focal_x))
    if camera.source is FocalSource.PREDICTED and solution.prior is not None:
        whence = f"as {solution.prior.model} sees it in the key frame"
    return (
        f"the focal length is not known; {camera.focal_x:.0f} px, a view of {view:.0f} degrees, is "
        f"taken {whence}: angles and shapes hang on it; --focal, --fov or --camera says it"
    )


def cautions(solution: Solution) -> list[str]:
    """Return what a user should know before trusting the result, one line each."""
    found, camera = solution.found, solution.camera
    lines = list(solution.warnings)
    if not camera.source.is_known:
        lines.append(_unknown_focal(solution))
    motion = found.camera_motion
    if not motion.translates:
        what = "has stood still" if motion.kind is MotionKind.STILL else "has only turned"
        lines.append(
            f"the camera {what}, as far as the frames tell: they show no depth of what is still"
            + (", what there is comes from the key frame alone" if found.valid.any() else "")
        )
    if motion.inliers < 0.5:
        lines.append(
            f"only {motion.inliers:.0%} of what is matched moves as the static world would: the "
            "camera's motion may be that of something else"
        )
    unsure = [each.label for each in found.regions if each.evidence is Evidence.UNKNOWN]
    if unsure:
        lines.append(
            f"the scale of {len(unsure)} of the things that move cannot be seen in two frames; "
            "--prior or --stereo tells it"
        )
    return lines
