"""The field's energy about a state: gradient, and the product of its curvature with a step."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from flexdepth.compiled import compiled
from flexdepth.solvers.field import (
    CLIP,
    Field,
    Scales,
    Terms,
    bend,
    data_residual,
    edge_residual,
    gm_weight,
    region_residual,
    turned_ray,
)

Array = NDArray[np.float64]


NOTHING = 1e-9
"""A weight of an edge that is left out."""


class Linear(NamedTuple):
    """The residuals' derivatives and weights; h x w pixels, two ways (down, right) to a neighbour.

    Attributes:
        gradient: h x w x 7: by c, a and b.
        data: h x w x 2 x 4: of the data by c and a.
        data_weight: h x w.
        region: h x w x 3: (t - tₖ) / |t₀|, of the region term by c.
        region_weight: h x w.
        depth_weight: h x w.
        edge: 2 x h x w x 11: ρᵢ/ρⱼ, ρⱼ/ρᵢ, both levers over r, and (tᵢ - tⱼ) / |t₀|.
        edge_weight: 2 x h x w.
        bend_weight: 2 x h x w.
    """

    gradient: Array
    data: Array
    data_weight: Array
    region: Array
    region_weight: Array
    depth_weight: Array
    edge: Array
    edge_weight: Array
    bend_weight: Array


def linear(field: Field, terms: Terms, scales: Scales) -> Linear:
    """Return the derivatives at a state."""
    h, w = field.inverse_depth.shape
    found = Linear(
        np.zeros((h, w, 7)),
        np.zeros((h, w, 2, 4)),
        np.zeros((h, w)),
        np.zeros((h, w, 3)),
        np.zeros((h, w)),
        terms.depth_certain,
        np.zeros((2, h, w, 11)),
        np.zeros((2, h, w)),
        np.zeros((2, h, w)),
    )
    _linearise(field, terms, scales, found)
    return found


@compiled
def _linearise(field: Field, terms: Terms, scales: Scales, out: Linear) -> None:
    height, width = field.inverse_depth.shape
    for i in range(height):
        for j in range(width):
            _pixel(field, terms, scales, out, (i, j))
            for axis in range(2):
                way = (1 - axis, axis)
                if i + way[0] >= height or j + way[1] >= width:
                    continue
                _edge(field, terms, scales, out, (axis, i, j))
                if i < way[0] or j < way[1]:
                    continue
                bent = bend(field, terms, (i, j), way)
                if not np.isnan(bent):
                    weight = scales.planar_certain * gm_weight(bent**2, scales.planar)
                    out.bend_weight[axis, i, j] = weight
                    out.gradient[i - way[0], j - way[1], 0] += weight * bent
                    out.gradient[i, j, 0] -= 2 * weight * bent
                    out.gradient[i + way[0], j + way[1], 0] += weight * bent


@compiled
def _pixel(field: Field, terms: Terms, scales: Scales, out: Linear, at: tuple[int, int]) -> None:
    i, j = at
    f = (terms.focal[0] + terms.focal[1]) / 2
    way = terms.unit / f
    left = np.empty(6)
    data_residual(field, terms, i, j, left)
    z = max(left[4], 1e-3)
    slope = out.data[i, j]
    for k in range(2):
        aspect = terms.focal[k] / f
        slope[k, 1 + k] = aspect / z
        slope[k, 3] = -aspect * left[2 + k] / z**2
        for m in range(3):
            slope[k, 0] += slope[k, 1 + m] * field.translation[i, j, m] / way
    square = (left[0] ** 2 + left[1] ** 2) * terms.certain[i, j]
    weight = terms.certain[i, j] * gm_weight(square, scales.data)
    out.data_weight[i, j] = weight
    gradient = out.gradient[i, j]
    for m in range(4):
        gradient[m] += weight * (slope[0, m] * left[0] + slope[1, m] * left[1])
    region_residual(field, terms, i, j, left)
    label = terms.labels[i, j]
    weight = terms.region_certain[label] * gm_weight(np.sum(left**2), scales.region)
    out.region_weight[i, j] = weight
    for k in range(3):
        apart = (field.translation[i, j, k] - terms.region_translation[label, k]) / way
        out.region[i, j, k] = apart
        gradient[0] += weight * apart * left[k]
        gradient[1 + k] += weight * left[k]
        gradient[4 + k] += weight * left[3 + k]
    off = terms.unit * (field.inverse_depth[i, j] - terms.depth[i, j])
    gradient[0] += terms.depth_certain[i, j] * off


@compiled
def _edge(
    field: Field, terms: Terms, scales: Scales, out: Linear, edge: tuple[int, int, int]
) -> None:
    axis, i, j = edge
    here, there = (i, j), (i + 1 - axis, j + axis)
    f = (terms.focal[0] + terms.focal[1]) / 2
    left = np.empty(9)
    edge_residual(field, terms, here, there, left)
    weight = scales.field_certain * gm_weight(np.sum(left**2), scales.field)
    out.edge_weight[axis, i, j] = weight
    parts = out.edge[axis, i, j]
    one, other = field.inverse_depth[here], field.inverse_depth[there]
    parts[0] = min(max(one / other, 0.2), 5.0)
    parts[1] = min(max(other / one, 0.2), 5.0)
    apart, lever = np.empty(3), np.empty(3)
    for k in range(3):
        apart[k] = terms.key[here][k] / one - terms.key[there][k] / other
    turned_ray(field.rotation[there], apart, lever)
    for k in range(3):
        parts[2 + k] = f / terms.lever * min(max(one * lever[k], -CLIP), CLIP)
    turned_ray(field.rotation[here], apart, lever)
    for k in range(3):
        parts[5 + k] = -f / terms.lever * min(max(other * lever[k], -CLIP), CLIP)
        parts[8 + k] = (field.translation[here][k] - field.translation[there][k]) * f / terms.unit
    for k in range(9):
        left[k] *= weight
    _edge_transposed(parts, left, out.gradient[here], out.gradient[there])


@compiled
def _edge_forward(parts: Array, here: Array, there: Array, out: Array) -> None:
    """Write what the steps at both ends change of an edge's nine residuals."""
    for k in range(3):
        m, n = (k + 1) % 3, (k + 2) % 3
        swung = there[4 + m] * parts[2 + n] - there[4 + n] * parts[2 + m]
        own = here[4 + m] * parts[5 + n] - here[4 + n] * parts[5 + m]
        out[k] = here[1 + k] - parts[0] * there[1 + k] - swung + parts[8 + k] * here[0]
        out[3 + k] = parts[1] * here[1 + k] + own - there[1 + k] + parts[8 + k] * there[0]
        out[6 + k] = here[4 + k] - there[4 + k]


@compiled
def _edge_transposed(parts: Array, left: Array, here: Array, there: Array) -> None:
    """Add the transposed derivative times nine numbers to both ends."""
    for k in range(3):
        m, n = (k + 1) % 3, (k + 2) % 3
        here[0] += parts[8 + k] * left[k]
        there[0] += parts[8 + k] * left[3 + k]
        here[1 + k] += left[k] + parts[1] * left[3 + k]
        there[1 + k] -= parts[0] * left[k] + left[3 + k]
        here[4 + k] += left[6 + k] + parts[5 + m] * left[3 + n] - parts[5 + n] * left[3 + m]
        there[4 + k] -= left[6 + k] + parts[2 + m] * left[n] - parts[2 + n] * left[m]


@compiled
def times(at: Linear, damping: float, step: Array, out: Array) -> None:
    """Write (JᵀWJ + μ) step."""
    height, width = at.data_weight.shape
    left = np.empty(9)
    for i in range(height):
        for j in range(width):
            for k in range(7):
                out[i, j, k] = damping * step[i, j, k]
    for i in range(height):
        for j in range(width):
            _pixel_times(at, step, out, i, j)
            if i + 1 < height:
                _edge_times(at, step, out, (0, i, j), left)
            if j + 1 < width:
                _edge_times(at, step, out, (1, i, j), left)


@compiled
def _edge_times(
    at: Linear, step: Array, out: Array, edge: tuple[int, int, int], left: Array
) -> None:
    axis, i, j = edge
    m, n = i + 1 - axis, j + axis
    weight = at.edge_weight[axis, i, j]
    if weight > NOTHING:
        _edge_forward(at.edge[axis, i, j], step[i, j], step[m, n], left)
        for k in range(9):
            left[k] *= weight
        _edge_transposed(at.edge[axis, i, j], left, out[i, j], out[m, n])
    weight = at.bend_weight[axis, i, j]
    if weight > 0:
        p, q = 2 * i - m, 2 * j - n
        bent = weight * (step[p, q, 0] - 2 * step[i, j, 0] + step[m, n, 0])
        out[p, q, 0] += bent
        out[i, j, 0] -= 2 * bent
        out[m, n, 0] += bent


@compiled
def _pixel_times(at: Linear, step: Array, out: Array, i: int, j: int) -> None:
    weight = at.data_weight[i, j]
    for k in range(2):
        seen = 0.0
        for m in range(4):
            seen += at.data[i, j, k, m] * step[i, j, m]
        for m in range(4):
            out[i, j, m] += weight * seen * at.data[i, j, k, m]
    weight = at.region_weight[i, j]
    for k in range(3):
        off = step[i, j, 1 + k] + at.region[i, j, k] * step[i, j, 0]
        out[i, j, 0] += weight * at.region[i, j, k] * off
        out[i, j, 1 + k] += weight * off
        out[i, j, 4 + k] += weight * step[i, j, 4 + k]
    out[i, j, 0] += at.depth_weight[i, j] * step[i, j, 0]
