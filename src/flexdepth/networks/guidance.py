"""Local planar guidance: small planes in front of the camera, one for each patch of the image."""

from dataclasses import dataclass
from math import pi

import torch
from jaxtyping import Float
from torch import Tensor, nn
from torch.nn.functional import avg_pool2d, pad

from flexdepth.networks.blocks import start_as_xavier
from flexdepth.runtime.errors import InputError
from flexdepth.sample import Prediction

_STEEPEST = pi / 3
"""The largest angle between a plane's normal and the view, as published."""
_LEAST = 0.05
"""The denominator is kept above this, where a steep plane would pass behind the camera."""


def planes(
    raw: Float[Tensor, "batch 3 rows columns"], farthest: float
) -> Float[Tensor, "batch 4 rows columns"]:
    """Return a unit normal and a distance, (n₁, n₂, n₃, n₄), from three channels of any value.

    The channels are the normal's angle to the view, between 0 and 60 degrees, its angle around
    it, and the distance, between 0 and `farthest`, each through a sigmoid.

    References:
        Lee, Han, Ko and Suh, arXiv 1907.10326, section 3.3, and the published code.
    """
    tilt, turn, distance = raw.sigmoid().unbind(1)
    tilt, turn = _STEEPEST * tilt, 2 * pi * turn
    normal = (tilt.sin() * turn.cos(), tilt.sin() * turn.sin(), tilt.cos())
    return torch.stack([*normal, farthest * distance], 1)


def planar_depth(
    plane: Float[Tensor, "batch 4 _ _"],
    patch: int,
    height: int | torch.SymInt,
    width: int | torch.SymInt,
) -> Float[Tensor, "batch height width"]:
    """Return `n₄ / (n₁ u + n₂ v + n₃)` over each patch: the depth of its plane.

    (u, v) are the places of the pixels in their patch, across and down: its middle is 0, its
    borders are at one half. A plane that faces the camera is as far as its distance everywhere.

    Args:
        plane: The normal and the distance of each patch.
        patch: Its side, in pixels.
        height: Of the result; the last patches may reach beyond it.
        width: Of the result, likewise.

    References:
        Lee, Han, Ko and Suh, arXiv 1907.10326, section 3.3. Here the denominator is kept away
        from zero.
    """
    down, across = (torch.arange(side, device=plane.device) for side in (height, width))
    own = plane[:, :, down // patch][..., across // patch]
    v, u = (((x % patch).to(plane.dtype) + 0.5) / patch - 0.5 for x in (down, across))
    first, second, third, distance = own.unbind(1)
    return distance / (first * u + second * v[:, None] + third).clamp(min=_LEAST)


def means(
    features: Float[Tensor, "batch channels height width"], patch: int
) -> Float[Tensor, "batch channels rows columns"]:
    """Return the mean over each patch; those at the right and the lower border may be smaller.

    This is `avg_pool2d` with `ceil_mode`, which ties an exported network to one size.
    """
    beyond = (0, patch - 1, 0, patch - 1)
    there = torch.ones_like(features[:1, :1])
    total, share = (avg_pool2d(pad(x, beyond), patch) for x in (features, there))
    return total / share


@dataclass(frozen=True)
class PlanarGuidance:
    """Depth from the features, guided by the depth of planes over patches of several sizes.

    Attributes:
        patches: Sides of the patches, in pixels.
        width: Channels between the two last convolutions.
        nearest: The least depth, in metres.
        farthest: The largest depth, in metres.

    Raises:
        InputError: A patch has no side, or 0 < `nearest` < `farthest` does not hold.

    References:
        Lee, Han, Ko and Suh, arXiv 1907.10326, section 3.3 and Fig. 2. There the planes of each
        size come from a stage of the decoder of that size; here from the mean of the last
        features over each patch, so that any network can have this head. There the least depth
        is zero, to which a sigmoid can come so near that no depth is left.
    """

    patches: tuple[int, ...] = (8, 4, 2)
    width: int = 32
    nearest: float = 1e-3
    farthest: float = 10.0

    def __post_init__(self) -> None:
        if min(self.patches, default=1) < 1 or not 0 < self.nearest < self.farthest:
            raise InputError(
                f"planar guidance needs patches of at least 1 pixel and 0 < nearest < farthest, "
                f"got {self}"
            )

    def build(self, inputs: int) -> "PlanarGuidanceHead":
        """Return the head on features of `inputs` channels."""
        return PlanarGuidanceHead(self, inputs)


class PlanarGuidanceHead(nn.Module):
    """The module of `PlanarGuidance`: from features at the image's size."""

    def __init__(self, settings: PlanarGuidance, inputs: int) -> None:
        super().__init__()
        self.settings = settings
        self.planes = nn.ModuleList(nn.Conv2d(inputs, 3, 1) for _ in settings.patches)
        self.finest = nn.Conv2d(inputs, 1, 1)
        guides = 1 + len(settings.patches)
        self.fuse = nn.Sequential(
            nn.Conv2d(inputs + guides, settings.width, 3, padding=1, bias=False),
            nn.ELU(),
            nn.Conv2d(settings.width, 1, 3, padding=1),
        )
        start_as_xavier(self)

    def forward(
        self, features: Float[Tensor, "batch channels height width"]
    ) -> Float[Tensor, "batch height width"]:
        """Return depth in metres."""
        height, width = features.shape[-2:]
        guides = [self.finest(features).sigmoid()]
        for plane, patch in zip(self.planes, self.settings.patches, strict=True):
            seen = planes(plane(means(features, patch)), 1.0)
            guides.append(planar_depth(seen, patch, height, width)[:, None])
        share: Tensor = self.fuse(torch.cat([features, *guides], 1))[:, 0].sigmoid()
        near, far = self.settings.nearest, self.settings.farthest
        return near + (far - near) * share

    def predicted(self, features: Float[Tensor, "batch channels height width"]) -> Prediction:
        """Return depth."""
        return Prediction(self(features), None)
