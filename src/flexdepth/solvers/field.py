"""Depth and one rigid motion at every pixel: the energy, its gradient and its curvature.

Every residual is in pixels over its standard deviation. With x = K⁻¹ (u, v, 1), ρ = 1/z, X = x/ρ,
f the focal length and |t₀| the camera's way, a step at a pixel is seven numbers, pixels all:

    c = f |t₀| dρ     nearer or farther
    a = f ρ dY        of the place Y = R X + t itself
    b = r dω          a turn about that place, with a lever r

and the energy is the sum of

    data      f (π(R x + ρ t) - y)                            what flow shows
    field     f ((Rᵢ - Rⱼ) xᵢ + ρᵢ (tᵢ - tⱼ)), the same at xⱼ, and r log Rᵢ Rⱼᵀ
    planar    f |t₀| (ρ₋ - 2 ρ + ρ₊)                          planes have affine inverse depth
    region    f ((R - Rₖ) x + ρ (t - tₖ)) and r log R Rₖᵀ     the motion of the pixel's region
    depth     f |t₀| (ρ - ρₖ)                                 the depth that it began with

each through Geman and McClure's function ½ s² e² / (s² + e²), whose weight falls off again. One
weight serves all parts of a field residual, so that the components of the motion break at the
same borders: that carries both the detection of moving things and the synchrony of the
dissertation's chapter 5 (5.33-5.42, which penalises rigid scenes as it is written). Differences
of motions are taken at the points that move, so they do not depend on where the origin is.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from flexdepth.compiled import compiled

Array = NDArray[np.float64]

CLIP = 0.3
"""Levers between neighbours are at most so long, in depths: beyond it another surface begins."""


class Field(NamedTuple):
    """The state: height x width, x 3 x 3 and x 3."""

    inverse_depth: Array
    rotation: Array
    translation: Array


class Terms(NamedTuple):
    """What does not change while the field is solved; maps are height x width.

    Attributes:
        key: Rays x 3.
        target: Where the flow leads, x 2, as rays.
        focal: Across and down, pixels.
        unit: f |t₀|.
        lever: r, pixels.
        certain: 1/σ² of flow; 0 where it is not trusted.
        labels: Regions.
        region_rotation: Rₖ.
        region_translation: tₖ.
        region_certain: 1/σ² of a region's pixels about its motion.
        depth: ρₖ.
        depth_certain: 1/σ² of f |t₀| (ρ - ρₖ).
    """

    key: Array
    target: Array
    focal: Array
    unit: float
    lever: float
    certain: Array
    labels: NDArray[np.int32]
    region_rotation: Array
    region_translation: Array
    region_certain: Array
    depth: Array
    depth_certain: Array


class Scales(NamedTuple):
    """How strongly the terms pull, and where they let go.

    Attributes:
        data: Standard deviations of flow at which it is an outlier.
        field: Pixels at which neighbours move apart.
        planar: Pixels at which a surface ends.
        region: Pixels at which a pixel leaves its region.
        field_certain: 1/σ² of neighbours' motions.
        planar_certain: 1/σ² of planes.
    """

    data: float
    field: float
    planar: float
    region: float
    field_certain: float
    planar_certain: float


@compiled
def gm(square: float, scale: float) -> float:
    """Return s² e² / (s² + e²)."""
    return scale * scale * square / (scale * scale + square)


@compiled
def gm_weight(square: float, scale: float) -> float:
    """Return its derivative by e²."""
    share = scale * scale / (scale * scale + square)
    return share * share


@compiled
def turned_ray(rotation: Array, ray: Array, out: Array) -> None:
    """Write R x."""
    for k in range(3):
        out[k] = rotation[k, 0] * ray[0] + rotation[k, 1] * ray[1] + rotation[k, 2] * ray[2]


@compiled
def log_between(one: Array, other: Array, out: Array) -> None:
    """Write the axis times the angle of R₁ R₂ᵀ."""
    trace = 0.0
    product = np.empty((3, 3))
    for k in range(3):
        for m in range(3):
            product[k, m] = (
                one[k, 0] * other[m, 0] + one[k, 1] * other[m, 1] + one[k, 2] * other[m, 2]
            )
        trace += product[k, k]
    out[0] = (product[2, 1] - product[1, 2]) / 2
    out[1] = (product[0, 2] - product[2, 0]) / 2
    out[2] = (product[1, 0] - product[0, 1]) / 2
    sine = np.sqrt(out[0] ** 2 + out[1] ** 2 + out[2] ** 2)
    if sine > 1e-9:
        factor = np.arctan2(sine, (trace - 1) / 2) / sine
        for k in range(3):
            out[k] *= factor


@compiled
def data_residual(field: Field, terms: Terms, i: int, j: int, out: Array) -> None:
    """Write the residual in pixels (0, 1), and R x + ρ t (2, 3, 4)."""
    turned_ray(field.rotation[i, j], terms.key[i, j], out[2:5])
    for k in range(3):
        out[2 + k] += field.inverse_depth[i, j] * field.translation[i, j, k]
    z = max(out[4], 1e-3)
    for k in range(2):
        out[k] = terms.focal[k] * (out[2 + k] / z - terms.target[i, j, k])


@compiled
def edge_residual(
    field: Field, terms: Terms, here: tuple[int, int], there: tuple[int, int], out: Array
) -> None:
    """Write f ((Rᵢ - Rⱼ) xᵢ + ρᵢ (tᵢ - tⱼ)), the same at xⱼ, and r log Rᵢ Rⱼᵀ."""
    f = (terms.focal[0] + terms.focal[1]) / 2
    one, other = np.empty(3), np.empty(3)
    for end in range(2):
        at = here if end == 0 else there
        turned_ray(field.rotation[here], terms.key[at], one)
        turned_ray(field.rotation[there], terms.key[at], other)
        for k in range(3):
            apart = field.translation[here][k] - field.translation[there][k]
            out[3 * end + k] = f * (one[k] - other[k] + field.inverse_depth[at] * apart)
    log_between(field.rotation[here], field.rotation[there], out[6:9])
    for k in range(6, 9):
        out[k] *= terms.lever


@compiled
def region_residual(field: Field, terms: Terms, i: int, j: int, out: Array) -> None:
    """Write f ((R - Rₖ) x + ρ (t - tₖ)) and r log R Rₖᵀ."""
    f = (terms.focal[0] + terms.focal[1]) / 2
    label = terms.labels[i, j]
    own = np.empty(3)
    turned_ray(field.rotation[i, j], terms.key[i, j], own)
    turned_ray(terms.region_rotation[label], terms.key[i, j], out[:3])
    for k in range(3):
        apart = field.translation[i, j, k] - terms.region_translation[label, k]
        out[k] = f * (own[k] - out[k] + field.inverse_depth[i, j] * apart)
    log_between(field.rotation[i, j], terms.region_rotation[label], out[3:6])
    for k in range(3, 6):
        out[k] *= terms.lever


@compiled
def bend(field: Field, terms: Terms, at: tuple[int, int], way: tuple[int, int]) -> float:
    """Return f |t₀| (ρ₋ - 2 ρ + ρ₊), or NaN where the three are not of one region."""
    before, after = (at[0] - way[0], at[1] - way[1]), (at[0] + way[0], at[1] + way[1])
    if terms.labels[before] != terms.labels[at] or terms.labels[after] != terms.labels[at]:
        return np.nan
    rho = field.inverse_depth
    return float(terms.unit * (rho[before] - 2 * rho[at] + rho[after]))


@compiled
def pixel_energy(field: Field, terms: Terms, scales: Scales, i: int, j: int) -> float:
    """Return the energy of a pixel's own terms."""
    out = np.empty(6)
    data_residual(field, terms, i, j, out)
    total = gm((out[0] ** 2 + out[1] ** 2) * terms.certain[i, j], scales.data)
    region_residual(field, terms, i, j, out)
    total += terms.region_certain[terms.labels[i, j]] * gm(np.sum(out**2), scales.region)
    off = terms.unit * (field.inverse_depth[i, j] - terms.depth[i, j])
    return float(total + terms.depth_certain[i, j] * off**2)


@compiled
def energy(field: Field, terms: Terms, scales: Scales) -> float:
    """Return half the sum of all terms."""
    height, width = field.inverse_depth.shape
    out = np.empty(9)
    total = 0.0
    for i in range(height):
        for j in range(width):
            total += pixel_energy(field, terms, scales, i, j)
            for axis in range(2):
                way = (1 - axis, axis)
                if i + way[0] >= height or j + way[1] >= width:
                    continue
                edge_residual(field, terms, (i, j), (i + way[0], j + way[1]), out)
                total += scales.field_certain * gm(np.sum(out**2), scales.field)
                if i < way[0] or j < way[1]:
                    continue
                bent = bend(field, terms, (i, j), way)
                if not np.isnan(bent):
                    total += scales.planar_certain * gm(bent**2, scales.planar)
    return total / 2
