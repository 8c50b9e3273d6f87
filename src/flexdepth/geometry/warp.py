"""What a depth and a motion of each pixel make of a picture: where points go, how it looks."""

from jaxtyping import Bool, Float
from torch import Tensor

from flexdepth.geometry.camera import Camera
from flexdepth.geometry.pose import rotated
from flexdepth.geometry.sampling import bilinear, inside, pixel_centres


def moved(
    rays: Float[Tensor, "*batch 3"],
    depth: Float[Tensor, "*batch"],
    n: Float[Tensor, "*batch 3"],
    t: Float[Tensor, "*batch 3"],
) -> Float[Tensor, "*batch 3"]:
    """Return the points X_target = R (D x) + t.

    Args:
        rays: x, z = 1.
        depth: D, z in the key camera.
        n: Rotation vectors.
        t: Translations, in the unit of depth.

    References:
        Dissertation, (5.6), corrected: R (D x - t), as written there, does not go with the
        essential matrix of its (5.3).
    """
    return rotated(n, depth[..., None] * rays) + t


def induced_flow(
    depth: Float[Tensor, "*batch height width"],
    n: Float[Tensor, "*batch height width 3"],
    t: Float[Tensor, "*batch height width 3"],
    camera: Camera,
) -> tuple[Float[Tensor, "*batch height width 2"], Bool[Tensor, "*batch height width"]]:
    """Return by how many pixels each pixel's point moves, and whether it stays ahead of the camera.

    The flow of a point that is then behind the camera means nothing; it is finite.
    """
    at = pixel_centres(depth).flatten(0, 1).expand(*depth.shape[:-2], -1, 2)
    points = moved(camera.unproject(at), depth.flatten(-2), n.flatten(-3, -2), t.flatten(-3, -2))
    seen, ahead = camera.project(points)
    return (seen - at).reshape(*depth.shape, 2), ahead.reshape(depth.shape)


def warped(
    target: Float[Tensor, "*batch channels height width"],
    flow: Float[Tensor, "*batch height width 2"],
) -> tuple[Float[Tensor, "*batch channels height width"], Bool[Tensor, "*batch height width"]]:
    """Return the target as the key frame would see it, and where the flow ends inside the picture.

    Flow of zero gives the picture itself.
    """
    height, width = target.shape[-2:]
    at = (pixel_centres(target[..., 0, :, :]) + flow).flatten(-3, -2)
    values = bilinear(target, at).mT.reshape(target.shape)
    return values, inside(at, height, width).reshape(flow.shape[:-1])
