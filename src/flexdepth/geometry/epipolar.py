"""How far two rays are from being rays to one point, when each point has a motion of its own.

For X_target = R X_key + t the rays x and y to a point obey yᵀ E x = 0 with E = [t]x R.
"""

import torch
from jaxtyping import Float
from torch import Tensor

from flexdepth.geometry.field import norm, unit
from flexdepth.geometry.pose import rotated


def epipolar_product(
    key: Float[Tensor, "*batch 3"],
    target: Float[Tensor, "*batch 3"],
    n: Float[Tensor, "*batch 3"],
    t: Float[Tensor, "*batch 3"],
) -> Float[Tensor, "*batch"]:
    """Return yᵀ [t]x R x: an error without a unit, which grows with |t| and vanishes at t = 0.

    Args:
        key: Rays x, z = 1.
        target: Rays y, z = 1.
        n: Rotation vectors.
        t: Translations.

    References:
        Dissertation, (5.3) and (5.26). Its E belongs to X_target = R X_key + t, while its (5.6)
        moves points by X_target = R (X_key - t), whose E is -R [t]x.
    """
    product: Tensor = (target * torch.linalg.cross(t, rotated(n, key))).sum(-1)
    return product


def sampson(
    key: Float[Tensor, "*batch 3"],
    target: Float[Tensor, "*batch 3"],
    n: Float[Tensor, "*batch 3"],
    t: Float[Tensor, "*batch 3"],
    focal: Float[Tensor, "*#batch 2"],
) -> Float[Tensor, "*batch"]:
    """Return Sampson's distance: how far the four coordinates are from obeying yᵀ E x = 0.

    It does not change with |t|. Its sign says on which side of the line the point is. Where E
    vanishes it is 0.

    Args:
        key: Rays x, z = 1.
        target: Rays y, z = 1.
        n: Rotation vectors.
        t: Translations.
        focal: Across and down, pixels, for a distance in pixels; ones, for one in rays.

    References:
        Hartley and Zisserman, Multiple view geometry, 2nd edition, 11.4.3.
    """
    way = unit(t)
    line = torch.linalg.cross(way, rotated(n, key))
    back = rotated(-n, torch.linalg.cross(target, way))
    gradient = norm(torch.cat([line[..., :2] / focal, back[..., :2] / focal], -1))
    distance: Tensor = (target * line).sum(-1) / gradient.where(gradient > 0, 1.0)
    return distance
