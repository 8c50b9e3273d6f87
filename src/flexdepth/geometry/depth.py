"""Depth in metres, and depth for a canonical focal length.

Seen through twice the focal length, a thing looks half as far away. A network that is not told
the focal length gives the depth that the image would have for one canonical focal length.
"""

from jaxtyping import Float
from torch import Tensor


def canonical_from_metres(
    depth: Float[Tensor, "*batch height width"],
    focal_in_diagonals: Float[Tensor, "*batch"],
    canonical_focal: float,
) -> Float[Tensor, "*batch height width"]:
    """Return `depth * canonical_focal / focal_in_diagonals`.

    Args:
        depth: In metres.
        focal_in_diagonals: Of the camera that took the image: focal length in pixels divided by
            the image's diagonal in pixels.
        canonical_focal: Of the camera that the result is meant for, likewise.

    References:
        Yin et al., Metric3D, ICCV 2023, section 3.2, with the focal length in image diagonals, so
        that the size of the image does not matter.
    """
    return depth * (canonical_focal / focal_in_diagonals)[..., None, None]


def metres_from_canonical(
    depth: Float[Tensor, "*batch height width"],
    focal_in_diagonals: Float[Tensor, "*batch"],
    canonical_focal: float,
) -> Float[Tensor, "*batch height width"]:
    """Return `depth * focal_in_diagonals / canonical_focal`: metres, from canonical depth.

    Args:
        depth: For a camera of `canonical_focal`.
        focal_in_diagonals: Of the camera that took the image.
        canonical_focal: As in `canonical_from_metres`, whose inverse this is.
    """
    return depth * (focal_in_diagonals / canonical_focal)[..., None, None]
