"""Refinement of depth and motion at every pixel, from the regions' coarse answer to the fine.

Regions say well how things move; what they leave to the pixels is noise, relief that only its
neighbours tell of, and how bending things bend. The scales at which the terms let go are annealed
from wide to narrow (graduated non-convexity), first in a smaller picture, then in the full one.
"""

from dataclasses import dataclass, replace

import cv2
import numpy as np
from numpy.typing import NDArray

from flexdepth.solvers.answer import Kind
from flexdepth.solvers.field import Field, Scales, Terms
from flexdepth.solvers.least_squares import deviation
from flexdepth.solvers.levenberg import State, step
from flexdepth.solvers.world import World, along_of

Array = NDArray[np.float64]

_COARSEST = 96
"""Pixels of the shorter side: a smaller picture is not begun with."""

_KNOWN, _BENDING = 0.02, 0.5
"""Pixels by which pixels of a rigid, and of a bending region, stray from its motion."""

_RELIEF = 0.05
"""Pixels by which a bending region's f |t₀| ρ strays from what the region step made of it."""

_FIELD, _PLANAR = 0.1, 0.03
"""Pixels by which neighbours' motions differ, and by which surfaces bend from pixel to pixel."""

_LEAST_NOISE = 0.02
"""Pixels: flow is not trusted more than this, be it exact."""

_LEAST_LEFT = 0.1
"""The least share of depth's variance that is taken to be left."""

_ON_THE_LINES = 0.5
"""Flow that strays from the epipolar lines by less of its noise keeps to them, or is exact."""


@dataclass(frozen=True)
class Dense:
    """Refinement of every pixel.

    Attributes:
        steps: Gauss-Newton steps at the finest level; half as many at the others.
        wide: Pixels at which the terms between neighbours let go at first.
        narrow: And in the end.
    """

    steps: int = 3
    wide: float = 2.0
    narrow: float = 0.25


def refined_world(world: World, settings: Dense) -> World:
    """Return the world with the depth and motion of every pixel refined.

    A camera that has stayed shows no depth to refine.
    """
    if not world.camera.translates:
        return world
    field, terms = _begin(world)
    field = _coarse_to_fine(field, terms, settings)
    solved = np.isfinite(world.inverse_depth)
    inverse = np.where(solved, field.inverse_depth, world.inverse_depth)
    return replace(
        world,
        inverse_depth=inverse,
        shape_spread=_left_spread(world, inverse),
        rotation=field.rotation,
        translation=field.translation,
    )


def _left_spread(world: World, inverse: Array) -> Array:
    """Return the spread of the refined depth of what does not bend.

    What smoothing takes from independent errors it moves depth by: of their variance v, a smoother
    that leaves h moves by v - h. Errors that neighbours share it leaves as they are, and moves
    nothing. So what is left is measured, region by region. Where depth moves by more than its
    spread, that was too small, by as much at least. v is 1, as the spread says, but for the static
    world, which shows it.
    """
    spread = world.shape_spread.copy()
    seen = np.isfinite(spread) & (spread > 0) & (world.inverse_depth > 0) & (inverse > 0)
    moved = np.log(inverse[seen] / world.inverse_depth[seen]) / spread[seen]
    for region in world.regions:
        own = world.labels[seen] == region.label
        if region.kind is Kind.FLEXIBLE or not own.any():
            continue
        taken = deviation(moved[own]) ** 2
        begun = _static_variance(world) if region.kind is Kind.STATIC else 1.0
        spread[world.labels == region.label] *= np.sqrt(
            max(begun - taken, _LEAST_LEFT * max(1.0, taken))
        )
    return np.asarray(spread)


def _static_variance(world: World) -> float:
    """Return the variance of the static world's flow, of that which its spread was told.

    Depth's errors come from noise along the epipolar lines, which is as large as that across them.
    The camera's `noise_factor` is judged by all that is seen, and is too large by what moves by
    itself. Noise is at least what it was said to be, for errors that neighbours share pass in part
    for the camera's motion. Flow that was looked for along the lines shows nothing: then 1.
    """
    still = world.sight.trusted & (world.labels == 0)
    across = along_of(world.sight, world.camera).across[still]
    factor = deviation(across / world.sight.noise[still])
    if factor < _ON_THE_LINES:
        return 1.0
    return (max(1.0, factor) / world.camera.noise_factor) ** 2


def _begin(world: World) -> tuple[Field, Terms]:
    sight, labels = world.sight, world.labels
    focal = float(sight.focal.mean())
    unit = focal * float(np.linalg.norm(world.camera.pose.translation))
    inverse = _positive(world)
    noise = np.maximum(sight.noise * world.camera.noise_factor, _LEAST_NOISE)
    rigid = np.array([region.kind is not Kind.FLEXIBLE for region in world.regions])
    first = np.array([np.argmax(labels == k) for k in range(len(rigid))])
    terms = Terms(
        key=sight.key,
        target=np.ascontiguousarray(sight.target[..., :2]),
        focal=sight.focal,
        unit=unit,
        lever=20.0 * max(1.0, float(np.sqrt(labels.size / 19200))),
        certain=np.where(sight.trusted, 1 / noise**2, 0.0),
        labels=labels,
        region_rotation=world.rotation.reshape(-1, 3, 3)[first],
        region_translation=world.translation.reshape(-1, 3)[first],
        region_certain=1 / np.where(rigid, _KNOWN, _BENDING) ** 2,
        depth=inverse,
        depth_certain=np.where(rigid[labels], 0.0, 1 / _RELIEF**2),
    )
    return Field(inverse, world.rotation.copy(), world.translation.copy()), terms


def _positive(world: World) -> Array:
    """Return the inverse depth, above 0 everywhere; where there is none, that of around it."""
    known = np.isfinite(world.inverse_depth) & (world.inverse_depth > 0) & world.sight.trusted
    middle = float(np.median(world.inverse_depth[known])) if known.any() else 1.0
    least = 1e-3 * middle
    filled = np.where(known, world.inverse_depth, 0.0)
    near = cv2.blur(filled, (15, 15)) / np.maximum(
        cv2.blur(known.astype(np.float64), (15, 15)), 1e-9
    )
    return np.maximum(np.where(known, filled, np.where(near > 0, near, middle)), least)


def _scales(settings: Dense, progress: float, noise: float) -> Scales:
    """Return the scales when so much of the annealing is done, 0 to 1.

    Surfaces end where their depth bends by more than noise makes it.
    """
    share = min(progress, 1.0)
    apart = settings.wide * (settings.narrow / settings.wide) ** share
    return Scales(
        data=5.0,
        field=max(apart, 2 * noise),
        planar=2 * noise * 0.5**share,
        region=max(apart, 0.5),
        field_certain=1 / _FIELD**2,
        planar_certain=1 / _PLANAR**2,
    )


def _coarse_to_fine(field: Field, terms: Terms, settings: Dense) -> Field:
    """Return the field after all steps; what half its size changes is taken over first."""
    noise = float(np.median(1 / np.sqrt(terms.certain[terms.certain > 0])))
    fine = min(terms.labels.shape) < 2 * _COARSEST
    if not fine:
        small, small_terms = _halved(field, terms)
        half = replace(settings, steps=max(2, settings.steps // 2 + 1))
        field = _taken_over(field, small, _coarse_to_fine(small, small_terms, half))
    state = State(field)
    for k in range(settings.steps):
        begun = 0.0 if fine else 0.4
        progress = begun + (1 - begun) * k / max(0.7 * settings.steps, 1)
        state = step(state, terms, _scales(settings, progress, noise))
    return state.field


def _halved(field: Field, terms: Terms) -> tuple[Field, Terms]:
    """Return every other pixel; flow and depth are means over its region's pixels beside it."""
    height, width = terms.labels.shape
    grid = slice(0, height // 2 * 2, 2), slice(0, width // 2 * 2, 2)
    corners = [
        (slice(i, height // 2 * 2, 2), slice(j, width // 2 * 2, 2)) for i in (0, 1) for j in (0, 1)
    ]
    same = [terms.labels[at] == terms.labels[grid] for at in corners]
    weights = [
        np.where(s, terms.certain[at] + 1e-9, 0.0) for s, at in zip(same, corners, strict=True)
    ]
    total = np.sum(weights, axis=0)

    def mean(values: Array) -> Array:
        parts = [
            w.reshape(w.shape + (1,) * (values.ndim - 2)) * values[at]
            for w, at in zip(weights, corners, strict=True)
        ]
        return np.asarray(
            np.sum(parts, axis=0) / total.reshape(total.shape + (1,) * (values.ndim - 2))
        )

    small = Field(
        mean(field.inverse_depth), field.rotation[grid].copy(), field.translation[grid].copy()
    )
    focal = terms.focal / 2
    return small, terms._replace(
        key=mean(terms.key),
        target=mean(terms.target),
        focal=focal,
        unit=terms.unit / 2,
        lever=terms.lever / 2,
        certain=np.where(total > 1e-6, total * 4, 0.0),
        labels=np.ascontiguousarray(terms.labels[grid]),
        depth=mean(terms.depth),
        depth_certain=terms.depth_certain[grid] * 4,
    )


def _taken_over(field: Field, before: Field, after: Field) -> Field:
    """Return the fine field with what half its size has changed."""
    height, width = field.inverse_depth.shape
    factor = np.clip(after.inverse_depth / before.inverse_depth, 0.5, 2.0)

    def grown(values: Array) -> Array:
        large = np.repeat(np.repeat(values, 2, axis=0), 2, axis=1)
        pad = [(0, height - large.shape[0]), (0, width - large.shape[1])] + [(0, 0)] * (
            values.ndim - 2
        )
        return np.pad(large, pad, mode="edge")

    return Field(
        field.inverse_depth * grown(factor),
        np.ascontiguousarray(grown(after.rotation)),
        np.ascontiguousarray(grown(after.translation)),
    )
