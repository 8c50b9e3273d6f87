"""Values of a map between its pixels. The only caller of `grid_sample` in the project."""

import torch
from jaxtyping import Bool, Float
from torch import Tensor


def bilinear(
    maps: Float[Tensor, "*batch channels height width"], at: Float[Tensor, "*batch points 2"]
) -> Float[Tensor, "*batch points channels"]:
    """Return the maps at points by bilinear interpolation.

    It is exact at pixel centres and on functions linear in x and y. Beyond the outermost pixel
    centres the nearest edge goes on; what is NaN there must be left out by `inside`.

    Args:
        maps: With values at pixel centres.
        at: x and y, pixels; the first pixel's centre is 0.5.
    """
    batch, (channels, height, width) = maps.shape[:-3], maps.shape[-3:]
    size = maps.new_tensor([width, height])
    values = torch.nn.functional.grid_sample(
        maps.reshape(batch.numel(), channels, height, width),
        (2 * at / size - 1).reshape(batch.numel(), 1, at.shape[-2], 2),
        mode="bilinear",
        padding_mode="border",
        align_corners=False,
    )
    return values.squeeze(-2).mT.reshape(*batch, at.shape[-2], channels)


def inverse_distance(
    maps: Float[Tensor, "*batch channels height width"], at: Float[Tensor, "*batch points 2"]
) -> Float[Tensor, "*batch points channels"]:
    """Return the mean of the four pixels around each point, weighted by 1 / their distance.

    Kept for the dissertation's objective as it is written; use `bilinear`.

    References:
        Dissertation, (5.25). At a pixel centre its quotient is 0/0, though the text says that it is
        right there; this gives the pixel's value. Functions linear in x and y are not kept
        (f = x is 2.383 at (2.25, 3.5), counted from the first pixel's centre), and the result jumps
        where a point passes from four pixels to the next four.
    """
    height, width = maps.shape[-2:]
    place = at - 0.5
    last = maps.new_tensor([width - 2, height - 2]).clamp(min=0)
    corner = torch.minimum(place.detach().floor().clamp(min=0), last)
    total, weights = maps.new_zeros(*at.shape[:-1], maps.shape[-3]), torch.zeros_like(at[..., :1])
    for across, down in ((0, 0), (1, 0), (0, 1), (1, 1)):
        pixel = corner + maps.new_tensor([across, down])
        square = (place - pixel).square().sum(-1, keepdim=True)
        weight = square.clamp(min=1e-24).rsqrt()
        total = total + weight * _picked(maps, pixel)
        weights = weights + weight
    return total / weights


def _picked(
    maps: Float[Tensor, "*batch channels height width"], pixel: Float[Tensor, "*batch points 2"]
) -> Float[Tensor, "*batch points channels"]:
    """Return the maps at whole pixels, counted from 0; beyond the edge the last one."""
    height, width = maps.shape[-2:]
    column, row = pixel.long().unbind(-1)
    flat = row.clamp(0, height - 1) * width + column.clamp(0, width - 1)
    index = flat[..., None, :].expand(*maps.shape[:-2], flat.shape[-1])
    return maps.flatten(-2).gather(-1, index).mT


def inside(
    at: Float[Tensor, "*batch points 2"], height: int, width: int
) -> Bool[Tensor, "*batch points"]:
    """Return which points lie between the outermost pixels' centres: there nothing is guessed.

    A thousandth of a pixel beyond them still counts, so that rounding loses no edge.
    """
    slack = 1e-3
    last = at.new_tensor([width - 0.5 + slack, height - 0.5 + slack])
    return ((at >= 0.5 - slack) & (at <= last)).all(-1)


def pixel_centres(like: Float[Tensor, "*batch height width"]) -> Float[Tensor, "height width 2"]:
    """Return where the pixels are: x and y, the first at (0.5, 0.5)."""
    height, width = like.shape[-2:]
    row, column = (
        torch.arange(length, dtype=like.dtype, device=like.device) + 0.5
        for length in (height, width)
    )
    return torch.stack(torch.meshgrid(column, row, indexing="xy"), -1)
