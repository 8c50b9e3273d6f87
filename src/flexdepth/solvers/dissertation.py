"""The objective of chapter 5: a depth, a rotation and a translation of each pixel, eleven terms.

Kept beside `two_frame` so that the difference can be shown. It does not find depth, in either form:

- Flow sees R and t / D alone, and (D s, t s) explains it with any s at each pixel: nothing but the
  smoothness of t ties the depths of neighbours together. Turning each pixel's ray onto its match
  explains all flow with any depth.
- As written, motion and essential matrix are of different conventions; the angle between pixel
  coordinates is ill-conditioned; the mean length of t, 0.01, does not go with a range of depth in
  metres; and synchrony costs most where all is rigid.
"""

from collections.abc import Callable, Mapping
from dataclasses import asdict, dataclass
from enum import StrEnum
from types import MappingProxyType

import torch
from torch import Tensor

from flexdepth.geometry.camera import Camera
from flexdepth.geometry.field import slopes
from flexdepth.geometry.sampling import bilinear, inverse_distance, pixel_centres
from flexdepth.losses.epipolar import epipolar, epipolar_as_written
from flexdepth.losses.flow import brightness_as_written, photometric, sparse_flow
from flexdepth.losses.gauge import depth_range, depth_scale, mean_length
from flexdepth.losses.motion_boundaries import motion_boundaries, motion_boundaries_as_written
from flexdepth.losses.perspective import perspective, perspective_as_written
from flexdepth.losses.synchrony import synchrony, synchrony_as_written


class Form(StrEnum):
    """How chapter 5's objective is read."""

    AS_WRITTEN = "as-written"
    """Equation by equation."""
    CORRECTED = "corrected"
    """Without its errata: one convention, rays instead of pixels, one scale."""


@dataclass(frozen=True)
class Weights:
    """Of each of the eleven terms; the dissertation's, table 5.1."""

    sparse_perspective: float = 1.0
    dense_perspective: float = 1.0
    sparse_epipolar: float = 0.01
    dense_epipolar: float = 0.01
    sparse_flow: float = 0.1
    dense_flow: float = 0.1
    motion_boundaries: float = 1.0
    synchrony: float = 1.0
    mean_length: float = 0.1
    depth_scale: float = 1e-4
    depth_range: float = 1.0


TABLE_5_1 = Weights()


@dataclass(frozen=True)
class Scale:
    """What holds the scale.

    Attributes:
        length: The mean length of t.
        nearest: The least depth, in the unit of t.
        farthest: The largest.
        quantile: ρ of the motion's borders: the share of slopes that are not exempt.
    """

    length: float
    nearest: float
    farthest: float
    quantile: float


@dataclass(frozen=True, eq=False)
class View:
    """What two frames show.

    Attributes:
        camera: Of both frames.
        flow: Height x width x 2, pixels, finite.
        trusted: Height x width: where flow counts.
        key: Sparse matches in the key frame, m x 2, pixels; m may be 0.
        target: Likewise, in the target.
        frames: The two in gray, 1 x height x width, in [0, 1]; None where they are not given.
    """

    camera: Camera
    flow: Tensor
    trusted: Tensor
    key: Tensor
    target: Tensor
    frames: tuple[Tensor, Tensor] | None


@dataclass(frozen=True, eq=False)
class Fields:
    """The unknowns: depth height x width, n and t 3 x height x width, flow height x width x 2."""

    depth: Tensor
    n: Tensor
    t: Tensor
    flow: Tensor

    def stacked(self) -> Tensor:
        """Return D, n and t as 7 maps."""
        return torch.cat([self.depth[None], self.n, self.t])


Terms = Mapping[str, Tensor]
Objective = Callable[[Fields, View, Scale], Terms]


def total(terms: Terms, weights: Weights) -> Tensor:
    """Return the weighted sum of the terms."""
    said = asdict(weights)
    return torch.stack([said[name] * value for name, value in terms.items()]).sum()


def as_written(fields: Fields, view: View, scale: Scale) -> Terms:
    """Return the eleven terms as chapter 5 has them; X_target = R (X_key - t) in (5.22)."""
    key = pixel_centres(fields.depth).flatten(0, 1)
    target = key + fields.flow.flatten(0, 1)
    dense = _points(fields.stacked().flatten(1).mT)
    sparse = _points(inverse_distance(fields.stacked(), view.key))
    across, down = slopes(torch.cat([fields.n, fields.t]))

    def epipolar_of(one: Tensor, other: Tensor, motion: tuple[Tensor, Tensor, Tensor]) -> Tensor:
        rays = view.camera.unproject(one), view.camera.unproject(other)
        return epipolar_as_written(*rays, *motion[1:])

    dense_flow = fields.flow.new_zeros(())
    if view.frames is not None:
        dense_flow = brightness_as_written(*view.frames, fields.flow).mean()
    borders = [motion_boundaries_as_written(each, scale.quantile) for each in (across, down)]
    return {
        "sparse_perspective": _mean(
            perspective_as_written(view.key, view.target, *sparse, view.camera)
        ),
        "dense_perspective": _trusted_mean(
            perspective_as_written(key, target, *dense, view.camera), view
        ),
        "sparse_epipolar": _mean(epipolar_of(view.key, view.target, sparse)),
        "dense_epipolar": _trusted_mean(epipolar_of(key, target, dense), view),
        "sparse_flow": _sparse_flow(fields, view, inverse_distance),
        "dense_flow": dense_flow,
        "motion_boundaries": borders[0] + borders[1],
        "synchrony": synchrony_as_written(across, down).mean(),
        **_scales(fields, scale),
    }


def corrected(fields: Fields, view: View, scale: Scale) -> Terms:
    """Return the eleven terms without their errata: L1 measures, of geometry all in radians.

    A change of t counts as the angle ρ ∂t by which it moves the point, so that it can be set beside
    one of n. ρ = 1/D takes no gradient there, lest all things flee to where nothing costs.
    """
    key = view.camera.unproject(pixel_centres(fields.depth).flatten(0, 1))
    target = view.camera.unproject((pixel_centres(fields.depth) + fields.flow).flatten(0, 1))
    dense = _points(fields.stacked().flatten(1).mT)
    sparse = _points(bilinear(fields.stacked(), view.key))
    sparse_rays = view.camera.unproject(view.key), view.camera.unproject(view.target)
    inverse = 1 / fields.depth.detach()[:-1, :-1]
    across, down = (
        torch.cat([n, inverse * t]) for n, t in zip(slopes(fields.n), slopes(fields.t), strict=True)
    )
    dense_flow = fields.flow.new_zeros(())
    if view.frames is not None:
        error, inside = photometric(*view.frames, fields.flow)
        dense_flow = error.where(inside, 0.0).sum() / inside.sum().clamp(min=1)
    borders = [motion_boundaries(each, scale.quantile) for each in (across, down)]
    return {
        "sparse_perspective": _mean(perspective(*sparse_rays, *sparse)),
        "dense_perspective": _trusted_mean(perspective(key, target, *dense), view),
        "sparse_epipolar": _mean(epipolar(*sparse_rays, *sparse[1:])),
        "dense_epipolar": _trusted_mean(epipolar(key, target, *dense[1:]), view),
        "sparse_flow": _sparse_flow(fields, view, bilinear),
        "dense_flow": dense_flow,
        "motion_boundaries": borders[0] + borders[1],
        "synchrony": synchrony(across, down).mean(),
        **_scales(fields, scale),
    }


OBJECTIVES: Mapping[Form, Objective] = MappingProxyType(
    {Form.AS_WRITTEN: as_written, Form.CORRECTED: corrected}
)


def _points(values: Tensor) -> tuple[Tensor, Tensor, Tensor]:
    """Return D, n and t of points from m x 7 numbers."""
    return values[:, 0], values[:, 1:4], values[:, 4:7]


def _mean(values: Tensor) -> Tensor:
    return values.sum() / max(len(values), 1)


def _trusted_mean(values: Tensor, view: View) -> Tensor:
    trusted = view.trusted.flatten()
    return values.where(trusted, 0.0).sum() / trusted.sum().clamp(min=1)


def _sparse_flow(fields: Fields, view: View, sample: Callable[[Tensor, Tensor], Tensor]) -> Tensor:
    there = sample(fields.flow.movedim(-1, 0), view.key)
    return _mean(sparse_flow(there, view.target - view.key))


def _scales(fields: Fields, scale: Scale) -> dict[str, Tensor]:
    depth = fields.depth.flatten()
    return {
        "mean_length": mean_length(fields.t.flatten(1).mT, scale.length),
        "depth_scale": depth_scale(depth),
        "depth_range": depth_range(depth, scale.nearest, scale.farthest),
    }
