"""Ray casting: what a viewpoint sees of a scene, in linear light, with exact depth."""

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.random import Generator

from flexdepth.synth.glass import passed
from flexdepth.synth.lighting import glazed, hazy, irradiance, mirrored, surface_colours
from flexdepth.synth.skylight import Dome
from flexdepth.synth.stage import OFFSET, Array, Hits, Stage
from flexdepth.synth.viewpoints import Viewpoint


@dataclass(frozen=True, eq=False)
class Rendering:
    """What a viewpoint sees.

    Attributes:
        light: Linear red, green, blue: height by width by 3.
        depth: z in metres; +inf where there is sky.
        focal: Focal length in pixels; the principal point is the image's middle.
    """

    light: Array
    depth: Array
    focal: float


def render(
    rng: Generator,
    stage: Stage,
    view: Viewpoint,
    width: int,
    height: int,
    weather: Generator | None = None,
) -> Rendering:
    """Return the image of a stage from a viewpoint, one ray a pixel.

    Light is the sum of what glows, lamps and sun with shadows, and ambient light that near
    surfaces block (ambient occlusion within the scene's reach). Clear surfaces show what is
    behind them, lit as what is before them is; depth is theirs. The few random rays a pixel
    leave noise, which a filter that keeps geometric edges removes. The clouds are drawn from
    `weather`, by default from `rng` as well: frames of a film share the sky, not the noise.
    """
    focal = view.focal * float(np.hypot(width, height))
    rays = _camera_rays(width, height, focal) @ view.world_from_camera.T.astype(np.float32)
    hits, depth = _first_hits(stage, view, rays, focal)
    bodies, panes = passed(stage, hits, depth, rays, focal)
    dome = Dome.drawn(weather or rng, stage.scene, stage.library.skies)
    light = dome.light(rays)
    emitted, albedo = surface_colours(stage, bodies)
    arriving, guide = np.zeros_like(light), np.zeros_like(light)
    seen = bodies.ray
    arriving[seen] = irradiance(rng, stage, bodies)
    ahead = (bodies.point - view.eye) @ view.world_from_camera[:, 2:]
    guide[seen] = 0.5 * bodies.shading + np.log(np.maximum(ahead, OFFSET))
    shape = height, width, 3
    smooth = _denoised(arriving.reshape(shape), guide.reshape(shape)).reshape(-1, 3)
    share, other = mirrored(stage, dome, bodies)
    own = emitted + (1 - share) * albedo * smooth[seen] + share * other
    light[seen] = hazy(dome, bodies, view.eye, own)
    for pane in reversed(panes):
        light[pane.ray] = glazed(stage, dome, pane, view.eye, light[pane.ray])
    return Rendering(light.reshape(height, width, 3), depth.reshape(height, width), focal)


def worth_taking(stage: Stage, view: Viewpoint, aspect: float) -> bool:
    """Return whether a photographer would press the button, from a coarse look at depth.

    The lens is not held against something, several things are in sight, and they are not all on
    one wall.
    """
    height = 30
    width = round(height * aspect)
    focal = view.focal * float(np.hypot(width, height))
    rays = _camera_rays(width, height, focal) @ view.world_from_camera.T.astype(np.float32)
    hits, depth = _first_hits(stage, view, rays, focal)
    if len(hits.ray) < (0.25 if stage.scene.outdoors else 0.4) * len(depth):
        return False
    near, middle, far = np.percentile(depth[hits.ray], (4, 50, 95))
    things = np.unique(stage.material[hits.triangle]).size
    nearest = stage.scene.nearest
    varied = far > 1.5 * near and things >= stage.scene.variety
    return bool(near > nearest and middle > 2.25 * nearest and varied)


def _camera_rays(width: int, height: int, focal: float) -> Array:
    """Return the direction with z = 1 through every pixel centre."""
    row, column = np.mgrid[:height, :width].reshape(2, -1)
    x, y = (column + 0.5 - width / 2) / focal, (row + 0.5 - height / 2) / focal
    return np.stack([x, y, np.ones_like(x)], 1).astype(np.float32)


def _first_hits(stage: Stage, view: Viewpoint, rays: Array, focal: float) -> tuple[Hits, Array]:
    """Return the surfaces that rays from the eye meet, and the depth of every ray.

    The rays have z = 1 in the camera, so Embree's ray parameter is the depth.
    """
    origins = np.broadcast_to(view.eye.astype(np.float32), rays.shape).copy()
    return stage.hits(origins, rays, focal)


def _denoised(irradiance: Array, guide: Array) -> Array:
    """Return the irradiance smoothed within surfaces."""
    ceiling = float(np.percentile(irradiance, 99.5)) + 1e-6
    bounded = np.minimum(irradiance, ceiling).astype(np.float32)
    return np.asarray(cv2.ximgproc.jointBilateralFilter(guide, bounded, 9, 0.15, 2.5), np.float32)
