"""The synchrony term of chapter 5: the six components of motion change across the same lines.

With V = (n, t) its slopes V_x and V_y are parallel at a step between two constant motions, in any
direction, and wherever V depends on one number of the pixel. That is a prior on motion, not a
theorem: n₁ = x with t₂ = y is a smooth motion whose slopes are orthogonal.
"""

import torch
from jaxtyping import Float
from torch import Tensor


def synchrony(
    across: Float[Tensor, "*batch channels height width"],
    down: Float[Tensor, "*batch channels height width"],
    floor: float = 1e-12,
) -> Float[Tensor, "*batch height width"]:
    """Return `√(det JᵀJ / (tr JᵀJ + floor) + floor) - √floor` at each pixel, with J = [V_x V_y].

    0 where the slopes are parallel or one of them vanishes: inside rigid things, on steps of any
    direction. With singular values σ₁ >= σ₂ of J, both well above √floor, it lies between σ₂ / √2
    and σ₂. The determinant is the sum of the squared minors f_x g_y - f_y g_x over all pairs of
    components (Lagrange), so that it is never below 0. The gradient is finite everywhere, and 0
    where V does not change.

    Args:
        across: V_x, in one unit for all components.
        down: V_y.
        floor: In that unit, squared: slopes that are as good as none.

    References:
        Dissertation, (5.36) to (5.42), corrected: `synchrony_as_written`. (5.37) is what this asks;
        (5.38) divides by slopes that may be 0, and the denominators of the last three terms of
        (5.39) are t₁y, t₂y, t₃y.
    """
    minors = across.unsqueeze(-3) * down.unsqueeze(-4)
    minors = minors - minors.transpose(-3, -4)
    determinant = minors.square().sum((-3, -4)) / 2
    trace = across.square().sum(-3) + down.square().sum(-3)
    shared: Tensor = (determinant / (trace + floor) + floor).sqrt() - floor**0.5
    return shared


def synchrony_as_written(
    across: Float[Tensor, "*batch channels height width"],
    down: Float[Tensor, "*batch channels height width"],
) -> Float[Tensor, "*batch height width"]:
    """Return `1 - |cos(V_x, V_y)|` at each pixel.

    Undefined where a slope vanishes, which is in the whole of every rigid thing and on every
    border along a row or a column; torch's cosine is 0 there, so that a rigid scene costs 1, the
    most there is. On noise of size e its gradient grows as 1 / e.

    Args:
        across: V_x; radians beside lengths, so that the value depends on the unit of length.
        down: V_y.

    References:
        Dissertation, (5.41) and (5.42), whose |cos| - 1 under the L1 measure is this.
    """
    return 1 - torch.cosine_similarity(across, down, dim=-3).abs()
