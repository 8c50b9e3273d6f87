"""Maps of vectors: how long they are, and how they change from pixel to pixel."""

import torch
from jaxtyping import Float
from torch import Tensor


def slopes(
    maps: Float[Tensor, "*batch channels height width"],
) -> tuple[
    Float[Tensor, "*batch channels height-1 width-1"],
    Float[Tensor, "*batch channels height-1 width-1"],
]:
    """Return how much each map rises to the next pixel across and to the next one down."""
    here = maps[..., :-1, :-1]
    return maps[..., :-1, 1:] - here, maps[..., 1:, :-1] - here


def norm(vectors: Float[Tensor, "*batch size"]) -> Float[Tensor, "*batch"]:
    """Return the lengths, whose gradient is 0 at 0."""
    square = vectors.square().sum(-1)
    zero = square == 0
    return torch.where(zero, 0.0, square.where(~zero, 1.0).sqrt())


def unit(vectors: Float[Tensor, "*batch size"]) -> Float[Tensor, "*batch size"]:
    """Return the vectors divided by their lengths; 0 stays 0."""
    length = norm(vectors)
    return vectors / length.where(length > 0, 1.0)[..., None]
