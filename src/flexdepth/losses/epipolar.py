"""The epipolar terms of chapter 5: rays to one point obey yᵀ E x = 0, with a motion per point."""

import torch
from jaxtyping import Float
from torch import Tensor

from flexdepth.geometry.epipolar import epipolar_product, sampson


def epipolar(
    key: Float[Tensor, "*batch points 3"],
    target: Float[Tensor, "*batch points 3"],
    n: Float[Tensor, "*batch points 3"],
    t: Float[Tensor, "*batch points 3"],
) -> Float[Tensor, "*batch points"]:
    """Return Sampson's distance of each point without its sign, in focal lengths.

    It does not change with |t|. A motion along the point's own epipolar line costs nothing, and
    neither does a wrong depth: the term is what the PnP term says once depth is eliminated.

    Args:
        key: Rays x, z = 1.
        target: Rays y, z = 1.
        n: Rotation vectors.
        t: Translations.

    References:
        Dissertation, (5.26), corrected: `epipolar_as_written`.
    """
    ones = torch.ones_like(key[..., :2])
    return sampson(key, target, n, t, ones).abs()


def epipolar_as_written(
    key: Float[Tensor, "*batch points 3"],
    target: Float[Tensor, "*batch points 3"],
    n: Float[Tensor, "*batch points 3"],
    t: Float[Tensor, "*batch points 3"],
) -> Float[Tensor, "*batch points"]:
    """Return |yᵀ [t]x R x| of each point.

    It grows with |t| and is 0 at t = 0 whatever the flow: it rewards the trivial solution in which
    each pixel turns onto its match and nothing is said of depth.

    Args:
        key: Rays x, z = 1.
        target: Rays y, z = 1.
        n: Rotation vectors.
        t: Translations.

    References:
        Dissertation, (5.26). E = [t]x R is that of X_target = R X_key + t, not that of its (5.6).
    """
    return epipolar_product(key, target, n, t).abs()
