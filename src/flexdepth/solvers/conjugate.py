"""Conjugate gradients on the field, without its matrix, preconditioned by each pixel's own block.

The cost of an iteration is linear in the pixels.
"""

import numpy as np
from numpy.typing import NDArray

from flexdepth.compiled import compiled
from flexdepth.solvers.curvature import NOTHING, Linear, times

Array = NDArray[np.float64]


def solved(at: Linear, damping: float, iterations: int, tolerance: float) -> tuple[Array, int]:
    """Return the step δ with (JᵀWJ + μ) δ = -g, and how many iterations it took.

    Args:
        at: The derivatives.
        damping: μ.
        iterations: The most that are made.
        tolerance: What may be left of the residual, in the preconditioner's norm.
    """
    factors = np.zeros((*at.data_weight.shape, 28))
    _factorise(at, damping, factors)
    step, left = np.zeros_like(at.gradient), -at.gradient
    eased = np.empty_like(left)
    _ease(factors, left, eased)
    way, product = eased.copy(), np.empty_like(left)
    first = now = float(np.vdot(left, eased))
    for count in range(iterations):
        if now <= tolerance**2 * first or now == 0:
            return step, count
        times(at, damping, way, product)
        length = now / float(np.vdot(way, product))
        step += length * way
        left -= length * product
        _ease(factors, left, eased)
        before, now = now, float(np.vdot(left, eased))
        way *= now / before
        way += eased
    return step, iterations


@compiled
def _factorise(at: Linear, damping: float, factors: Array) -> None:
    """Write the Cholesky factor of each pixel's 7 x 7 block, row by row."""
    height, width = at.data_weight.shape
    blocks = np.zeros((height, width, 28))
    for i in range(height):
        for j in range(width):
            _own_block(at, damping, blocks[i, j], (i, j))
            for axis in range(2):
                m, n = i + 1 - axis, j + axis
                if m >= height or n >= width:
                    continue
                weight = at.edge_weight[axis, i, j]
                if weight > NOTHING:
                    _edge_blocks(at.edge[axis, i, j], weight, blocks[i, j], blocks[m, n])
                weight = at.bend_weight[axis, i, j]
                blocks[2 * i - m, 2 * j - n, 0] += weight
                blocks[i, j, 0] += 4 * weight
                blocks[m, n, 0] += weight
    for i in range(height):
        for j in range(width):
            _cholesky(blocks[i, j], factors[i, j])


@compiled
def _own_block(at: Linear, damping: float, block: Array, pixel: tuple[int, int]) -> None:
    data, apart = at.data[pixel], at.region[pixel]
    for m in range(7):
        block[m * (m + 1) // 2 + m] += damping
    for m in range(4):
        for n in range(m + 1):
            product = data[0, m] * data[0, n] + data[1, m] * data[1, n]
            block[m * (m + 1) // 2 + n] += at.data_weight[pixel] * product
    weight = at.region_weight[pixel]
    block[0] += at.depth_weight[pixel]
    for k in range(3):
        block[0] += weight * apart[k] ** 2
        block[(k + 1) * (k + 2) // 2] += weight * apart[k]
        for m in (k + 1, k + 4):
            block[m * (m + 1) // 2 + m] += weight


@compiled
def _edge_blocks(parts: Array, weight: float, here: Array, there: Array) -> None:
    """Add the diagonal of an edge's block to both ends, and c's and a's products with the turn."""
    for k in range(3):
        m, n = (k + 1) % 3, (k + 2) % 3
        here[0] += weight * parts[8 + k] ** 2
        there[0] += weight * parts[8 + k] ** 2
        _add(here, 1 + k, 1 + k, weight * (1 + parts[1] ** 2))
        _add(there, 1 + k, 1 + k, weight * (1 + parts[0] ** 2))
        _add(here, 1 + k, 0, weight * parts[8 + k])
        _add(there, 1 + k, 0, -weight * parts[8 + k])
        _add(here, 4 + k, 4 + k, weight * (1 + parts[5 + m] ** 2 + parts[5 + n] ** 2))
        _add(there, 4 + k, 4 + k, weight * (1 + parts[2 + m] ** 2 + parts[2 + n] ** 2))
        _add(here, 4 + m, 1 + k, weight * parts[1] * parts[5 + n])
        _add(here, 4 + n, 1 + k, -weight * parts[1] * parts[5 + m])
        _add(there, 4 + m, 1 + k, weight * parts[0] * parts[2 + n])
        _add(there, 4 + n, 1 + k, -weight * parts[0] * parts[2 + m])
        if k > 0:
            for other in range(k):
                _add(here, 4 + k, 4 + other, -weight * parts[5 + k] * parts[5 + other])
                _add(there, 4 + k, 4 + other, -weight * parts[2 + k] * parts[2 + other])


@compiled
def _add(block: Array, row: int, column: int, value: float) -> None:
    block[row * (row + 1) // 2 + column] += value


@compiled
def _cholesky(block: Array, factor: Array) -> None:
    for m in range(7):
        for n in range(m + 1):
            total = block[m * (m + 1) // 2 + n]
            for k in range(n):
                total -= factor[m * (m + 1) // 2 + k] * factor[n * (n + 1) // 2 + k]
            if m == n:
                factor[m * (m + 1) // 2 + m] = np.sqrt(max(total, 1e-12))
            else:
                factor[m * (m + 1) // 2 + n] = total / factor[n * (n + 1) // 2 + n]


@compiled
def _ease(factors: Array, left: Array, out: Array) -> None:
    """Write the preconditioned residual: each pixel's block solved for its part."""
    height, width = left.shape[:2]
    for i in range(height):
        for j in range(width):
            factor, value = factors[i, j], out[i, j]
            for m in range(7):
                total = left[i, j, m]
                for k in range(m):
                    total -= factor[m * (m + 1) // 2 + k] * value[k]
                value[m] = total / factor[m * (m + 1) // 2 + m]
            for m in range(6, -1, -1):
                total = value[m]
                for k in range(m + 1, 7):
                    total -= factor[k * (k + 1) // 2 + m] * value[k]
                value[m] = total / factor[m * (m + 1) // 2 + m]
