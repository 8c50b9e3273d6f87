"""The pinhole camera.

Pixel convention of the project: pixel centres lie at half integers and the origin is the image's
top left corner, so a principal point in the middle of a 640-pixel row is 320.
"""

from dataclasses import dataclass
from math import hypot

import torch
from jaxtyping import Bool, Float
from torch import Tensor

from flexdepth.runtime.depthmap import Intrinsics, diagonal_by_area


@dataclass(frozen=True, eq=False)
class Camera:
    """A pinhole camera, in pixels of the image it belongs to.

    Attributes:
        focal: Focal length across and down.
        centre: Principal point from the left and from the top.
    """

    focal: Float[Tensor, "*batch 2"]
    centre: Float[Tensor, "*batch 2"]

    @classmethod
    def of(cls, intrinsics: Intrinsics) -> "Camera":
        """Return the camera of one image as tensors."""
        return cls(
            torch.tensor([intrinsics.focal_x, intrinsics.focal_y]),
            torch.tensor([intrinsics.centre_x, intrinsics.centre_y]),
        )

    def resized(self, across: float, down: float) -> "Camera":
        """Return the camera of the same image with its width and height times these factors."""
        factors = self.focal.new_tensor([across, down])
        return Camera(self.focal * factors, self.centre * factors)

    def cropped(self, left: int, top: int) -> "Camera":
        """Return the camera of the image without its first columns and rows.

        Negative numbers are columns and rows added.
        """
        return Camera(self.focal, self.centre - self.centre.new_tensor([left, top]))

    def unproject(
        self, pixels: Float[Tensor, "*batch points 2"]
    ) -> Float[Tensor, "*batch points 3"]:
        """Return the rays K⁻¹ (u, v, 1) through points of the picture: z = 1."""
        across = (pixels - self.centre[..., None, :]) / self.focal[..., None, :]
        return torch.cat([across, torch.ones_like(across[..., :1])], -1)

    def project(
        self, points: Float[Tensor, "*batch points 3"]
    ) -> tuple[Float[Tensor, "*batch points 2"], Bool[Tensor, "*batch points"]]:
        """Return where points are in the picture, pixels, and whether they are ahead of the camera.

        Where a point is not ahead, its place means nothing; it is finite.
        """
        ahead = points[..., 2] > 0
        z = points[..., 2:].where(ahead[..., None], 1.0)
        place = points[..., :2] / z * self.focal[..., None, :] + self.centre[..., None, :]
        return place, ahead

    def focal_in_diagonals(self, width: int, height: int) -> Float[Tensor, "*batch"]:
        """Return the focal length divided by the image's diagonal: 0.6 for a typical phone.

        Where the two focal lengths differ it is their geometric mean. Resizing leaves it alone,
        cropping makes it larger.
        """
        return self.focal.prod(-1).sqrt() / hypot(width, height)

    def focal_by_area(self, width: int, height: int) -> Float[Tensor, "*batch"]:
        """Return the focal length divided by the diagonal of a 4:3 image of the same area.

        What depth is canonical for: a thing of so many pixels is as far away in a wide image as in
        a square one, and a network that looks at a part of either need not know which it is.
        """
        return self.focal.prod(-1).sqrt() / diagonal_by_area(width, height)
