"""The PnP terms of chapter 5: a point that has moved must be seen where the flow, or a match, says.

Dense, the points are all pixels; sparse, they are matches.
"""

import torch
from jaxtyping import Float
from torch import Tensor

from flexdepth.geometry.camera import Camera
from flexdepth.geometry.field import norm, unit
from flexdepth.geometry.pose import rotated
from flexdepth.geometry.warp import moved


def perspective(
    key: Float[Tensor, "*batch points 3"],
    target: Float[Tensor, "*batch points 3"],
    depth: Float[Tensor, "*batch points"],
    n: Float[Tensor, "*batch points 3"],
    t: Float[Tensor, "*batch points 3"],
) -> Float[Tensor, "*batch points"]:
    """Return the chord √(2 - 2 cos(y, R D x + t)) of each point: a small angle in radians.

    2 for a point straight behind the camera. It is computed as |u - v| of unit vectors, which keeps
    in float32 what 1 - cos loses below 3.5e-4 radians.

    Args:
        key: Rays x, z = 1.
        target: Rays y, z = 1.
        depth: D, z in the key camera.
        n: Rotation vectors.
        t: Translations, in the unit of depth.

    References:
        Dissertation, (5.22) and (5.23), corrected. There X_target = R (X_key - t), to which the
        essential matrix of (5.3) does not belong, and the cosine is between pixel coordinates:
        `perspective_as_written`. |1 - cos| is quadratic in the angle, so the L1 measure makes
        nothing robust there; here the root is taken.
    """
    return norm(unit(moved(key, depth, n, t)) - unit(target))


def perspective_as_written(
    key: Float[Tensor, "*batch points 2"],
    target: Float[Tensor, "*batch points 2"],
    depth: Float[Tensor, "*batch points"],
    n: Float[Tensor, "*batch points 3"],
    t: Float[Tensor, "*batch points 3"],
    camera: Camera,
) -> Float[Tensor, "*batch points"]:
    """Return `1 - cos(p, K R (K⁻¹ D p_k - t))` of each point, with pixels p = (u, v, 1).

    Beside the convention, which `perspective` names, the angle between pixel coordinates is
    ill-conditioned: at |p| pixels from the top left corner an error of one pixel across the ray
    from that corner costs 1 / 2|p|², one along it 1 / 2|p|⁴. At |p| = 500 these are 2e-6 and 8e-12,
    and float32, which tells 1 - cos from 0 above 6e-8, does not see errors of 87 pixels along it.

    Args:
        key: Pixels.
        target: Pixels.
        depth: D, z in the key camera.
        n: Rotation vectors.
        t: Translations, in the unit of depth.
        camera: Of both frames.

    References:
        Dissertation, (5.22) and (5.23).
    """
    point = rotated(n, depth[..., None] * camera.unproject(key) - t)
    focal, centre = camera.focal[..., None, :], camera.centre[..., None, :]
    seen = torch.cat([point[..., :2] * focal + point[..., 2:] * centre, point[..., 2:]], -1)
    homogeneous = torch.cat([target, torch.ones_like(target[..., :1])], -1)
    return 1 - torch.cosine_similarity(homogeneous, seen, dim=-1)
