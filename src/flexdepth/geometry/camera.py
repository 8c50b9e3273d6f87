"""The pinhole camera.

Pixel convention of the project: pixel centres lie at half integers and the origin is the image's
top left corner, so a principal point in the middle of a 640-pixel row is 320.
"""

from dataclasses import dataclass
from math import hypot

import torch
from jaxtyping import Float
from torch import Tensor


@dataclass(frozen=True, eq=False)
class Camera:
    """A pinhole camera, in pixels of the image it belongs to.

    Attributes:
        focal: Focal length across and down.
        centre: Principal point from the left and from the top.
    """

    focal: Float[Tensor, "*batch 2"]
    centre: Float[Tensor, "*batch 2"]

    def resized(self, across: float, down: float) -> "Camera":
        """Return the camera of the same image with its width and height times these factors."""
        factors = self.focal.new_tensor([across, down])
        return Camera(self.focal * factors, self.centre * factors)

    def cropped(self, left: int, top: int) -> "Camera":
        """Return the camera of the image without its first columns and rows.

        Negative numbers are columns and rows added.
        """
        return Camera(self.focal, self.centre - self.centre.new_tensor([left, top]))

    def flipped(self, width: int) -> "Camera":
        """Return the camera of the image, `width` pixels wide, mirrored left to right."""
        across, down = self.centre.unbind(-1)
        return Camera(self.focal, torch.stack([width - across, down], -1))

    def focal_in_diagonals(self, width: int, height: int) -> Float[Tensor, "*batch"]:
        """Return the focal length divided by the image's diagonal: 0.6 for a typical phone.

        Where the two focal lengths differ it is their geometric mean. Resizing leaves it alone,
        cropping makes it larger.
        """
        return self.focal.prod(-1).sqrt() / hypot(width, height)
