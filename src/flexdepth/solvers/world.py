"""Depth and motion of every pixel, before it is said which of them are known."""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from flexdepth.solvers.answer import Region
from flexdepth.solvers.correspondences import pixel_centres, rays
from flexdepth.solvers.ego_motion import CameraMotion
from flexdepth.solvers.pieces import Labels
from flexdepth.solvers.seen import Seen
from flexdepth.solvers.sight import Sight
from flexdepth.solvers.two_view import Along, seen_along

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class World:
    """Depth and motion of every pixel, before it is said which of them are known.

    Attributes:
        sight: What is seen.
        camera: The camera's motion.
        labels: Number of each pixel's region; 0 is the static world.
        regions: What is known of each.
        inverse_depth: Of each pixel; NaN where there is none.
        shape_spread: Its relative standard deviation, without that of its region's scale.
        rotation: Of each pixel, x 3 x 3.
        translation: Of each, x 3.
        metric: Whether the unit is the metre.
        prior_share: How much of the depth is the prior's; None without one.
        sky: Where the prior says so; None without one.
        notes: What was given and adds nothing, and why, one line each.
    """

    sight: Sight
    camera: CameraMotion
    labels: Labels
    regions: tuple[Region, ...]
    inverse_depth: Array
    shape_spread: Array
    rotation: Array
    translation: Array
    metric: bool = False
    prior_share: Array | None = None
    sky: NDArray[np.bool_] | None = None
    notes: tuple[str, ...] = ()

    def noted(self, line: str) -> "World":
        """Return the same world with one more thing to be said of it."""
        return replace(self, notes=(*self.notes, line))


def sight_of(seen: Seen) -> Sight:
    """Return the maps that the parts of the solver look at."""
    centres = pixel_centres(*seen.noise.shape)
    flow = np.where(seen.known[..., None], seen.flow, 0.0).astype(np.float64)
    return Sight(
        rays(centres, seen.camera),
        rays(centres + flow, seen.camera),
        flow,
        np.where(seen.trusted, seen.noise, 1.0).astype(np.float64),
        seen.trusted,
        np.array([seen.camera.focal_x, seen.camera.focal_y]),
    )


def along_of(sight: Sight, camera: CameraMotion) -> Along:
    """Return what the flow says of depth, were all still.

    A camera that has stayed shows no parallax: all that its turning leaves is off.
    """
    if camera.translates:
        return seen_along(sight.key, sight.target, camera.pose, sight.focal)
    place = sight.key @ camera.pose.rotation.T
    left = (sight.target[..., :2] - place[..., :2] / place[..., 2:]) * sight.focal
    nothing = np.zeros(left.shape[:2])
    off = np.linalg.norm(left, axis=-1)
    return Along(nothing, off, np.full_like(nothing, np.nan), np.full_like(nothing, np.inf))
