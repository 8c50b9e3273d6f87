"""Rotations and rigid motions of points: X_target = R X_key + t, with R = exp([n]x).

A rotation is kept as n: its direction is the axis, its length the angle in radians, right-handed.
"""

from math import factorial

import torch
from jaxtyping import Float
from torch import Tensor

_SMALL = 0.5
"""Radians below which the series are summed. Their first omitted term is then below 1e-19."""


def rotation_exp(n: Float[Tensor, "*batch 3"]) -> Float[Tensor, "*batch 3 3"]:
    """Return R = I + sin θ [n̂]x + (1 - cos θ) [n̂]x², with θ = |n| and n̂ = n / θ.

    It has every derivative everywhere, at n = 0 too.

    References:
        Dissertation, (5.7) to (5.18). There n̂ = n / |n|, which is 0/0 at n = 0, where optimisation
        commonly begins; here sin θ / θ and (1 - cos θ) / θ² stand before [n]x and [n]x².
    """
    first, second = _rodrigues(n.square().sum(-1))
    matrix = cross_matrix(n)
    identity = torch.eye(3, dtype=n.dtype, device=n.device)
    first, second = first[..., None, None], second[..., None, None]
    return identity + first * matrix + second * (matrix @ matrix)


def rotated(
    n: Float[Tensor, "*batch 3"], v: Float[Tensor, "*batch 3"]
) -> Float[Tensor, "*batch 3"]:
    """Return exp([n]x) v, without the matrix: (5.11)."""
    first, second = _rodrigues(n.square().sum(-1, keepdim=True))
    once = torch.linalg.cross(n, v)
    turned: Tensor = v + first * once + second * torch.linalg.cross(n, once)
    return turned


def rotation_log(rotation: Float[Tensor, "*batch 3 3"]) -> Float[Tensor, "*batch 3"]:
    """Return n with exp([n]x) = R and |n| <= π; at π, where n and -n serve, it is one of them.

    By way of the unit quaternion (w, v), of whose four forms the one is taken that divides by its
    largest component.

    References:
        Dissertation, (5.15), which does not determine n at an angle of π: R - Rᵀ is then 0.
    """
    quaternion = _quaternion(rotation)
    quaternion = torch.where(quaternion[..., :1] < 0, -quaternion, quaternion)
    w, v = quaternion[..., :1], quaternion[..., 1:]
    square = v.square().sum(-1, keepdim=True)
    small = square < 1e-8
    length = square.where(~small, 1.0).sqrt()
    # θ = 2 atan(|v| / w), and its series in |v| / w.
    ratio = square.where(small, 0.0) / w.where(small, 1.0).square()
    series = 2 * (1 - ratio / 3) / w.where(small, 1.0)
    return v * torch.where(small, series, 2 * torch.atan2(length, w) / length)


def cross_matrix(v: Float[Tensor, "*batch 3"]) -> Float[Tensor, "*batch 3 3"]:
    """Return [v]x, the matrix with [v]x w = v x w: (5.4)."""
    x, y, z = v.unbind(-1)
    zero = torch.zeros_like(x)
    rows = [zero, -z, y, z, zero, -x, -y, x, zero]
    return torch.stack(rows, -1).reshape(*v.shape, 3)


def _rodrigues(
    square: Float[Tensor, "*batch"],
) -> tuple[Float[Tensor, "*batch"], Float[Tensor, "*batch"]]:
    """Return sin θ / θ and (1 - cos θ) / θ² from θ².

    Each is the series Σ (-θ²)ᵏ / (2k + m)! for m = 1, 2. Near the identity it is summed, for there
    the closed forms lose every digit: in float32, 1 - cos 1e-4 is 0.
    """
    small = square < _SMALL**2
    near = square.where(small, 0.0)
    far = square.where(~small, 1.0)
    angle = far.sqrt()
    closed = angle.sin() / angle, (1 - angle.cos()) / far
    first, second = (
        torch.where(small, _series(near, order), exact)
        for order, exact in zip((1, 2), closed, strict=True)
    )
    return first, second


def _series(square: Float[Tensor, "*batch"], order: int) -> Float[Tensor, "*batch"]:
    """Return Σ (-s)ᵏ / (2k + order)!, by Horner's rule."""
    total = torch.zeros_like(square)
    for k in range(8, -1, -1):
        total = 1 / factorial(2 * k + order) - square * total
    return total


def _quaternion(rotation: Float[Tensor, "*batch 3 3"]) -> Float[Tensor, "*batch 4"]:
    """Return the unit quaternion (w, x, y, z) of a rotation, up to its sign.

    The matrix Q = 4 q qᵀ is linear in R; each of its rows is a multiple of q.
    """
    (a, b, c), (d, e, f), (g, h, i) = (row.unbind(-1) for row in rotation.unbind(-2))
    rows = [
        [1 + a + e + i, h - f, c - g, d - b],
        [h - f, 1 + a - e - i, b + d, c + g],
        [c - g, b + d, 1 - a + e - i, f + h],
        [d - b, c + g, f + h, 1 - a - e + i],
    ]
    matrix = torch.stack([torch.stack(row, -1) for row in rows], -2)
    largest = torch.diagonal(matrix, dim1=-2, dim2=-1).argmax(-1)
    index = largest[..., None, None].expand(*largest.shape, 1, 4)
    row = matrix.gather(-2, index).squeeze(-2)
    return row / row.square().sum(-1, keepdim=True).sqrt()
