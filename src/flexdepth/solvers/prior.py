"""Depth from the single picture, as a soft term beside what motion shows.

The prior has a scale of its own in each region: what it says of the shape of a thing, and what it
says of the thing's size beside the rest, are weighed apart. So geometry carries what moves enough
to be seen, the prior what does not, and its share is shown for every pixel.
"""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from flexdepth.solvers.answer import Evidence, Region
from flexdepth.solvers.fusion import common_factor, fused, measured_spread
from flexdepth.solvers.seen import Prior, Seen
from flexdepth.solvers.world import World

Array = NDArray[np.float64]

_BESIDE = 5.0
"""By how many of its spreads the prior errs in the size of a thing beside the rest.

Of 1, 1.5, 2, 3 and 5 the last spoilt least of what geometry knows on tuning pairs (moving .249,
.207, .186, .167 and .156; geometry alone .151): a thing's size is what a single picture tells
worst. Where geometry knows nothing of a size, the prior's counts alone.
"""


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
    depth = np.asarray(prior.depth, np.float64)
    sky = np.isposinf(depth) & (world.labels == 0) & ~(world.shape_spread < _NEAR)
    usable = np.isfinite(depth) & (depth > 0)
    said = np.where(usable, 1 / np.where(usable, depth, 1.0), np.nan)
    doubt = np.where(usable, np.asarray(prior.spread, np.float64), np.inf)
    own = _own(world)
    found = common_factor(
        said, own, (world.labels == 0) / np.maximum(world.shape_spread, 0.02) ** 2
    )
    if found is None and (world.metric or world.camera.translates):
        said[:] = np.nan
        world = world.noted(_UNTIED)
    unit = 1.0 if found is None else found[0]
    strays = 0.0 if found is None else found[1] * np.sqrt(_INDEPENDENT)
    inverse, spread = np.full(said.shape, np.nan), np.full(said.shape, np.inf)
    share, translation = np.zeros(said.shape), world.translation.copy()
    regions: list[Region] = []
    for region in world.regions:
        inside = world.labels == region.label
        scale, told = _weighed(region, (own, said * unit), np.where(inside, 1 / doubt**2, 0.0))
        shape = common_factor(said, own * scale, inside / np.maximum(world.shape_spread, 0.02) ** 2)
        factor = unit if shape is None else shape[0]
        shown = (own * scale, world.shape_spread)
        likely = (said * factor, np.maximum(doubt, strays))
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


def _weighed(region: Region, maps: tuple[Array, Array], certain: Array) -> tuple[float, Region]:
    """Return the factor on a moving region's inverse depths, and the region as it then is."""
    if region.label == 0:
        return 1.0, region
    found = common_factor(maps[0], maps[1], certain)
    if found is None:
        return 1.0, region
    doubt = _BESIDE / np.sqrt(float(np.median(certain[certain > 0])))
    said = 1 / max(doubt, 1e-3) ** 2
    kept = 0.0 if np.isinf(region.scale_spread) else 1 / max(region.scale_spread, 1e-3) ** 2
    part = said / (said + kept)
    spread = float(1 / np.sqrt(said + kept))
    evidence = Evidence.PRIOR if part > 0.5 else region.evidence
    confidence = float(min(1.0, max(region.confidence, 0.08 / spread)))
    return found[0] ** part, replace(
        region, evidence=evidence, scale_spread=spread, confidence=confidence
    )
