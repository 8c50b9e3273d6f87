"""What `solution.json` says: the camera's motion, the parts that move, and how far to trust it."""

from collections.abc import Mapping
from importlib.metadata import version
from math import degrees, isfinite

import cv2
import numpy as np
from numpy.typing import NDArray

from flexdepth.flow.matches import Agreement
from flexdepth.runtime.formats.meaning import Meaning, plain
from flexdepth.runtime.origin import Origin
from flexdepth.scenes.pair import Solution
from flexdepth.scenes.prior import told
from flexdepth.scenes.words import cautions, position, summary
from flexdepth.solvers.pose import Pose, angle
from flexdepth.solvers.two_frame import TwoFrame, Unknown

VERSION = 1

ARRAYS = {
    "depth.npz": {
        "depth": "z of each pixel of the key frame; NaN unknown, inf sky",
    },
    "motion.npz": {
        "rotation": "n: axis times angle in radians, x y z, of X_target = R(n) X_key + t",
        "translation": "t of the same, in the unit of depth",
    },
    "solution.npz": {
        "label": "number of the part that a pixel belongs to; 0 is static",
        "moving": "whether the pixel moves by itself",
        "border": "whether another part lies beside it",
        "unknown": "why it has no depth, see unknown_codes; 0: it has one",
        "valid": "whether it has depth",
        "inferred": "whether its depth is not seen, but the plane of what looks the same around",
        "spread": "relative standard deviation of depth; inf unknown",
        "confidence": "of the scale of its part beside what is static, 0 to 1",
        "parallax": "pixels along the epipolar line",
        "residual": "pixels between the flow and what depth and motion say",
        "flow": "from key to target as it was used, pixels right and down; NaN unknown",
        "flow_noise": "its standard deviation, pixels; NaN not trusted",
        "prior_share": "how much of the depth is the single-image depth's, 0 to 1",
    },
}
"""What lies in which file, by its name."""


def record(solution: Solution, origin: Origin) -> dict[str, object]:
    """Return the document, of what JSON has."""
    found, depth = solution.found, solution.depth
    meaning = Meaning.of(depth, plain(depth.space), origin).record()
    shares = np.bincount(found.unknown.ravel(), minlength=len(Unknown)) / found.unknown.size
    width, height = solution.views.size
    return {
        "version": VERSION,
        "flexdepth": version("flexdepth"),
        "width": width,
        "height": height,
        "camera": meaning["intrinsics"],
        "space": meaning["space"],
        "unit": "m" if found.metric else "the camera's way",
        "camera_motion": _camera_motion(found),
        "regions": _regions(found),
        "share_by_reason": {
            reason.name.lower(): round(float(shares[reason]), 6) for reason in Unknown
        },
        "share_inferred": round(float(found.inferred.mean()), 6),
        "median": {
            "parallax": _median(np.abs(found.parallax)),
            "residual": _median(found.residual),
            "flow_noise": _median(solution.flow.noise),
        },
        "akaze": _akaze(solution.borne_out),
        "prior_share": None if found.prior_share is None else _mean(found.prior_share),
        "prior": None if solution.prior is None else solution.prior.model,
        "prior_tells": None if solution.prior is None else told(found),
        "summary": summary(solution),
        "arrays": ARRAYS,
        "unknown_codes": {reason.name.lower(): int(reason) for reason in Unknown},
        "warnings": cautions(solution),
        "origin": dict(origin),
    }


def _camera_motion(found: TwoFrame) -> Mapping[str, object]:
    motion = found.camera_motion
    return {
        "kind": str(motion.kind),
        **_pose(motion.pose),
        "position": [round(float(value), 9) for value in position(found)],
        "turn_degrees": degrees(angle(motion.pose.rotation)),
        "alternative": None if motion.alternative is None else _pose(motion.alternative),
        "inliers": motion.inliers,
        "noise_factor": motion.noise_factor,
    }


def _akaze(borne_out: Agreement) -> Mapping[str, object]:
    share = round(borne_out.share, 6) if borne_out.matches else None
    return {"matches": borne_out.matches, "agree_with_flow": share}


def _pose(pose: Pose) -> Mapping[str, object]:
    axis = np.asarray(cv2.Rodrigues(pose.rotation)[0]).ravel()
    return {
        "rotation": axis.tolist(),
        "rotation_matrix": pose.rotation.tolist(),
        "translation": pose.translation.tolist(),
    }


def _regions(found: TwoFrame) -> list[Mapping[str, object]]:
    return [
        {
            "label": region.label,
            "kind": str(region.kind),
            "share": region.pixels / found.labels.size,
            "pixels": region.pixels,
            "scale_from": str(region.evidence),
            "confidence": region.confidence,
            "scale_spread": region.scale_spread if isfinite(region.scale_spread) else None,
        }
        for region in found.regions
    ]


def _median(values: NDArray[np.floating]) -> float | None:
    known = values[np.isfinite(values)]
    return float(np.median(known)) if known.size else None


def _mean(values: NDArray[np.floating]) -> float | None:
    known = values[np.isfinite(values)]
    return float(known.mean()) if known.size else None
