"""A second picture of the same moment: nothing moves between the two, so every scale is fixed."""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from flexdepth.solvers.answer import Evidence, Region
from flexdepth.solvers.correspondences import pixel_centres, rays
from flexdepth.solvers.fusion import certainty, common_factor, fused
from flexdepth.solvers.pose import Pose
from flexdepth.solvers.seen import Seen, Stereo
from flexdepth.solvers.two_view import seen_along
from flexdepth.solvers.world import World

Array = NDArray[np.float64]

_CLEAR = 2.0
"""Standard deviations of disparity that make a depth."""


def with_stereo(world: World, seen: Seen, stereo: Stereo) -> World:
    """Return the world in metres: each region's scale is that of its disparity.

    Depth is the mean of what motion and disparity say, weighted by their certainty; where the
    camera has stayed or the target hides a pixel it is the disparity's. Where disparity does not
    tell the camera's way in metres, the world is as it was.
    """
    inverse, spread = _disparity(seen, stereo)
    factors = [
        common_factor(world.inverse_depth, inverse, certainty(spread, world.labels == region.label))
        for region in world.regions
    ]
    # Whether disparity tells metres: of the camera's way, or alone if that is none.
    tied = factors[0] is not None if world.camera.translates else np.isfinite(inverse).any()
    if not tied:
        return world.noted(_UNTIED)
    scaled, translation = world.inverse_depth.copy(), world.translation.copy()
    regions: list[Region] = []
    for region, found in zip(world.regions, factors, strict=True):
        inside = world.labels == region.label
        if found is not None:
            scaled[inside] *= found[0]
            translation[inside] /= found[0]
            if region.label > 0:
                region = replace(  # noqa: PLW2901 (the region as it now is)
                    region, evidence=Evidence.STEREO, confidence=1.0, scale_spread=found[1]
                )
        else:
            scaled[inside] = np.nan
        regions.append(region)
    own = np.hypot(world.shape_spread, _MODEL)
    depth, left, _ = fused((scaled, own), (inverse, spread))
    return replace(
        world,
        regions=tuple(regions),
        inverse_depth=depth,
        shape_spread=left,
        translation=translation,
        metric=True,
    )


_MODEL = 0.01
"""What a region's motion errs by beside noise: bending things more, but stereo sees these."""

_UNTIED = (
    "the right picture adds nothing: too little of what is still is found in it to tell metres"
)


def _disparity(seen: Seen, stereo: Stereo) -> tuple[Array, Array]:
    """Return inverse depth in 1/m and its relative standard deviation; NaN and inf if unknown."""
    centres = pixel_centres(*stereo.noise.shape)
    known = np.isfinite(stereo.flow).all(axis=-1) & np.isfinite(stereo.noise)
    shift = np.where(known[..., None], stereo.flow, 0.0).astype(np.float64)
    noise = np.where(known, stereo.noise, 1.0).astype(np.float64)
    focal = np.array([seen.camera.focal_x, seen.camera.focal_y])
    pose = Pose(np.eye(3), np.array([-stereo.baseline, 0.0, 0.0]))
    along = seen_along(rays(centres, seen.camera), rays(centres + shift, seen.camera), pose, focal)
    good = known & (along.parallax > _CLEAR * noise)
    return (
        np.where(good, along.inverse_depth, np.nan),
        np.where(good, along.spread * noise, np.inf),
    )
