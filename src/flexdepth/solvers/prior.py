"""Depth from the single picture, as a soft term beside what motion shows.

The prior has a scale of its own in each region: what it says of the shape of a thing is weighed
here, what it says of how near the thing is beside the rest with all else that tells of that
(`relative_scale`). So geometry carries what moves enough to be seen, the prior what does not, and
its share is shown for every pixel.
"""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from flexdepth.solvers.answer import Evidence, Region
from flexdepth.solvers.fusion import fused, measured_spread
from flexdepth.solvers.pictured import Pictured, pictured
from flexdepth.solvers.seen import Prior, Seen
from flexdepth.solvers.world import World

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]

_BESIDE = 0.3
"""The least relative error of what the prior alone says of how near a thing is beside the rest."""

_SURE = 0.08
"""The probability of an error below a tenth, times the spread, where that is large."""

_NEAR = 1 / 3
"""What geometry sees to be nearer than infinity by three deviations is no sky, whatever is said."""

_INDEPENDENT = 10.0
"""As many deviations of the prior from what geometry sees `common_factor` takes to be its own."""

_UNTIED = (
    "the single-image depth is left out: too little of what is still has depth both in it and by "
    "the frames to tell its unit in theirs"
)


def with_prior(world: World, seen: Seen, prior: Prior) -> World:
    """Return the world with the prior's part in it.

    How far the prior's shapes err is measured where geometry sees them, over the frame and at each
    pixel, if that is more than it says: it is to help where geometry does not see, and not to
    spoil what it does. A far wall, which geometry sees least surely, is where the prior errs most,
    and all of the wall alike.

    Where the camera has stayed, all depth is the prior's, in its own unit. Where it has not, and
    nothing tells that unit in the camera's way, the prior tells of sky alone.
    """
    sky = np.isposinf(prior.depth) & (world.labels == 0) & ~(world.shape_spread < _NEAR)
    picture, own = pictured(prior), _own(world)
    found = picture.unit(own, world.shape_spread, world.labels == 0)
    if found is None and (world.metric or world.camera.translates):
        picture = replace(picture, inverse_depth=np.full_like(own, np.nan))
        world = world.noted(_UNTIED)
    said = picture.inverse_depth
    unit = 1.0 if found is None else found[0]
    strays = 0.0 if found is None else found[1] * np.sqrt(_INDEPENDENT)
    inverse, spread = np.full(said.shape, np.nan), np.full(said.shape, np.inf)
    share, translation = np.zeros(said.shape), world.translation.copy()
    regions: list[Region] = []
    for region in world.regions:
        inside = world.labels == region.label
        scale, told = _placed(region, inside, own / unit, picture)
        shape = picture.unit(own * scale, world.shape_spread, inside)
        factor = unit if shape is None else shape[0]
        shown = (own * scale, world.shape_spread)
        likely = (said * factor, np.maximum(picture.doubt, strays))
        depths = fused(shown, (likely[0], measured_spread(shown, likely)))
        for out, values in zip((inverse, spread, share), depths, strict=True):
            out[inside] = values[inside]
        translation[inside] /= scale
        regions.append(told)
    inverse[sky], spread[sky], share[sky] = 0.0, 0.0, 1.0
    tied = found is not None or not world.camera.translates
    metric = world.metric or (prior.metric and seen.camera.source.is_known and tied)
    metres = unit if metric and not world.metric else 1.0
    return replace(
        world,
        regions=tuple(regions),
        inverse_depth=inverse / metres,
        shape_spread=spread,
        translation=translation * metres,
        prior_share=share,
        metric=metric,
        sky=sky,
    )


def _own(world: World) -> Array:
    known = world.sight.trusted | np.isfinite(world.shape_spread)
    good = known & np.isfinite(world.inverse_depth) & (world.inverse_depth > 0)
    return np.where(good, world.inverse_depth, np.nan)


def _placed(region: Region, inside: Mask, own: Array, picture: Pictured) -> tuple[float, Region]:
    """Return the factor on a region's inverse depths, and the region as it then is.

    What moves by itself and has no scale yet is as near as the prior says.
    """
    if region.label == 0 or np.isfinite(region.scale_spread):
        return 1.0, region
    told = picture.of_thing(inside, own)
    if told is None:
        return 1.0, region
    spread = float(np.hypot(_BESIDE, told[1]))
    return float(np.exp(told[0])), replace(
        region, evidence=Evidence.PRIOR, scale_spread=spread, confidence=min(1.0, _SURE / spread)
    )
