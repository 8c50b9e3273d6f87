"""Ray casting: what a viewpoint sees of a scene, in linear light, with exact depth."""

from dataclasses import dataclass

import cv2
import numpy as np
from embreex.mesh_construction import TriangleMesh
from embreex.rtcore_scene import EmbreeScene
from numpy.random import Generator
from numpy.typing import NDArray

from flexdepth.synth.patterns import SIZE, Library
from flexdepth.synth.scene import AreaLight, Scene, Sun
from flexdepth.synth.skylight import Dome
from flexdepth.synth.viewpoints import Viewpoint

Array = NDArray[np.float32]

AMBIENT_RAYS = 4
SHADOW_RAYS = 3
_OFFSET = 2e-3
"""Metres by which a secondary ray starts off its surface, so that it does not hit it."""


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


@dataclass(frozen=True, eq=False)
class _Hits:
    """The first surface along each ray that meets one.

    Attributes:
        pixel: Flat index of the ray.
        point: Position, moved off the surface towards the viewer.
        normal: Unit normal, towards the viewer.
        triangle: Index of the triangle.
        uv: Texture coordinates, metres.
        footprint: Metres of surface that one pixel covers.
    """

    pixel: NDArray[np.intp]
    point: Array
    normal: Array
    triangle: NDArray[np.intp]
    uv: Array
    footprint: Array


@dataclass(frozen=True, eq=False)
class Stage:
    """A scene made ready for rays: one mesh, one table of materials."""

    scene: Scene
    tracer: EmbreeScene
    uv: Array
    material: NDArray[np.intp]
    colours: Array
    size: Array
    glow: Array
    gloss: Array
    ripple: Array
    layer: NDArray[np.intp]
    library: Library

    @classmethod
    def built(cls, rng: Generator, scene: Scene, library: Library) -> "Stage":
        """Return the scene with its acceleration structure built."""
        corners = np.concatenate([part.mesh.corners for part in scene.parts]).astype(np.float32)
        tracer = EmbreeScene()
        TriangleMesh(tracer, corners)
        materials = [part.material for part in scene.parts]
        counts = [len(part.mesh.corners) for part in scene.parts]
        return cls(
            scene=scene,
            tracer=tracer,
            uv=np.concatenate([part.mesh.uv for part in scene.parts]).astype(np.float32),
            material=np.repeat(np.arange(len(counts)), counts),
            colours=np.array([m.colours for m in materials], np.float32),
            size=np.array([m.size for m in materials], np.float32),
            glow=np.array([m.glow for m in materials], np.float32),
            gloss=np.array([m.gloss for m in materials], np.float32),
            ripple=np.array([m.ripple for m in materials], np.float32),
            layer=np.array([library.layer(rng, m.pattern) for m in materials]),
            library=library,
        )


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
    surfaces block (ambient occlusion within the scene's reach). The few random rays a pixel
    leave noise, which a filter that keeps geometric edges removes. The clouds are drawn from
    `weather`, by default from `rng` as well: frames of a film share the sky, not the noise.
    """
    focal = view.focal * float(np.hypot(width, height))
    rays = _camera_rays(width, height, focal)
    hits, depth = _first_hits(stage, view, rays, focal)
    directions = rays @ view.world_from_camera.T.astype(np.float32)
    dome = Dome.drawn(weather or rng, stage.scene)
    light = dome.light(directions)
    emitted, albedo = _surface_colours(stage, hits)
    irradiance = np.zeros_like(light)
    irradiance[hits.pixel] = _ambient(rng, stage, hits)
    for lamp in stage.scene.lamps:
        irradiance[hits.pixel] += _from_lamp(rng, stage, hits, lamp)
    if stage.scene.sun is not None:
        irradiance[hits.pixel] += _from_sun(rng, stage, hits, stage.scene.sun)
    guide = np.zeros_like(light)
    guide[hits.pixel] = 0.5 * hits.normal + np.log(depth.reshape(-1)[hits.pixel, None])
    smooth = _denoised(irradiance.reshape(height, width, 3), guide.reshape(height, width, 3))
    own = emitted + albedo * smooth.reshape(-1, 3)[hits.pixel]
    own = _mirrored(stage, dome, hits, directions[hits.pixel], own)
    light[hits.pixel] = _hazy(stage.scene, dome, hits, view.eye, own)
    return Rendering(light.reshape(height, width, 3), depth.reshape(height, width), focal)


def worth_taking(stage: Stage, view: Viewpoint, aspect: float) -> bool:
    """Return whether a photographer would press the button, from a coarse look at depth.

    The lens is not held against something, several things are in sight, and they are not all on
    one wall.
    """
    height = 30
    width = round(height * aspect)
    focal = view.focal * float(np.hypot(width, height))
    hits, depth = _first_hits(stage, view, _camera_rays(width, height, focal), focal)
    if len(hits.pixel) < (0.25 if stage.scene.outdoors else 0.4) * len(depth):
        return False
    near, middle, far = np.percentile(depth[hits.pixel], (4, 50, 95))
    things = np.unique(stage.material[hits.triangle]).size
    nearest = stage.scene.nearest
    varied = far > 1.5 * near and things >= stage.scene.variety
    return bool(near > nearest and middle > 2.3 * nearest and varied)


def _camera_rays(width: int, height: int, focal: float) -> Array:
    """Return the direction with z = 1 through every pixel centre."""
    row, column = np.mgrid[:height, :width].reshape(2, -1)
    x, y = (column + 0.5 - width / 2) / focal, (row + 0.5 - height / 2) / focal
    return np.stack([x, y, np.ones_like(x)], 1).astype(np.float32)


def _first_hits(stage: Stage, view: Viewpoint, rays: Array, focal: float) -> tuple[_Hits, Array]:
    """Return the surfaces that the camera sees and the depth of every ray.

    The directions have z = 1 in the camera, so Embree's ray parameter is the depth.
    """
    directions = rays @ view.world_from_camera.T.astype(np.float32)
    origins = np.broadcast_to(view.eye.astype(np.float32), directions.shape).copy()
    return _met(stage, origins, directions, focal)


def _met(stage: Stage, origins: Array, directions: Array, focal: float) -> tuple[_Hits, Array]:
    """Return the surfaces that rays meet and each ray's parameter there; +inf where none is."""
    found = stage.tracer.run(origins, directions, output=1)
    pixel = np.flatnonzero(found["primID"] >= 0)
    depth = np.full(len(origins), np.inf, np.float32)
    depth[pixel] = found["tfar"][pixel]
    normal = found["Ng"][pixel]
    normal /= np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), 1e-20)
    towards = (normal * directions[pixel]).sum(1, keepdims=True)
    normal = np.where(towards > 0, -normal, normal)
    slant = np.abs(towards[:, 0]) / np.linalg.norm(directions[pixel], axis=1)
    triangle = found["primID"][pixel].astype(np.intp)
    u, v = found["u"][pixel, None], found["v"][pixel, None]
    corner = stage.uv[triangle]
    hits = _Hits(
        pixel=pixel,
        point=origins[pixel] + depth[pixel, None] * directions[pixel] + _OFFSET * normal,
        normal=normal,
        triangle=triangle,
        uv=corner[:, 0] * (1 - u - v) + corner[:, 1] * u + corner[:, 2] * v,
        footprint=depth[pixel] / focal / np.sqrt(np.maximum(slant, 0.02)),
    )
    return hits, depth


def _surface_colours(stage: Stage, hits: _Hits) -> tuple[Array, Array]:
    """Return the emitted light and the albedo at each hit."""
    material = stage.material[hits.triangle]
    size = stage.size[material]
    texels = (SIZE * hits.footprint / size.mean(1)).astype(np.float32)
    weights = stage.library.weights(stage.layer[material], hits.uv / size, texels)
    first, second, third = np.moveaxis(stage.colours[material], 1, 0)
    colour = first + weights[:, :1] * (second - first)
    colour += weights[:, 1:] * (third - colour)
    glow = stage.glow[material][:, None]
    return glow * colour, np.where(glow > 0, 0, colour)


def _ambient(rng: Generator, stage: Stage, hits: _Hits) -> Array:
    """Return ambient irradiance: the open share of a cosine-weighted hemisphere."""
    reach = stage.scene.occlusion_reach
    openness = np.zeros(len(hits.pixel), np.float32)
    for _ in range(AMBIENT_RAYS):
        ball = rng.standard_normal(hits.point.shape, np.float32)
        ball /= np.linalg.norm(ball, axis=1, keepdims=True)
        distance = stage.tracer.run(hits.point, hits.normal + 0.999 * ball, query="DISTANCE")
        openness += np.minimum(distance * np.linalg.norm(hits.normal + ball, axis=1) / reach, 1)
    return (openness[:, None] / AMBIENT_RAYS * stage.scene.ambient).astype(np.float32)


def _from_lamp(rng: Generator, stage: Stage, hits: _Hits, lamp: AreaLight) -> Array:
    """Return the irradiance from a lamp, sampled at random points of it."""
    rays = max(1, SHADOW_RAYS // len(stage.scene.lamps))
    total = np.zeros(len(hits.pixel), np.float32)
    for _ in range(rays):
        jitter = rng.random(hits.point.shape, np.float32) - 0.5
        target = lamp.centre + lamp.side * jitter * (1, 0, 1)
        path = (target - hits.point).astype(np.float32)
        distance = np.linalg.norm(path, axis=1)
        free = stage.tracer.run(hits.point, path, query="DISTANCE") > 0.995
        facing = np.maximum((hits.normal * path).sum(1) / distance, 0)
        total += np.where(free, facing / (distance**2 + 0.15), 0)
    return (total[:, None] / rays * lamp.power).astype(np.float32)


def _from_sun(rng: Generator, stage: Stage, hits: _Hits, sun: Sun) -> Array:
    """Return the irradiance from the sun, with shadows as soft as half a degree makes them."""
    total = np.zeros(len(hits.pixel), np.float32)
    for _ in range(SHADOW_RAYS - 1):
        path = (sun.towards + rng.normal(0, 0.01, hits.point.shape)).astype(np.float32)
        free = stage.tracer.run(hits.point, path, query="OCCLUDED") < 0
        total += np.where(free, np.maximum((hits.normal * path).sum(1), 0), 0)
    return (total[:, None] / (SHADOW_RAYS - 1) * sun.power).astype(np.float32)


def _denoised(irradiance: Array, guide: Array) -> Array:
    """Return the irradiance smoothed within surfaces."""
    ceiling = float(np.percentile(irradiance, 99.5)) + 1e-6
    bounded = np.minimum(irradiance, ceiling).astype(np.float32)
    return np.asarray(cv2.ximgproc.jointBilateralFilter(guide, bounded, 7, 0.15, 2.0), np.float32)


def _mirrored(stage: Stage, dome: Dome, hits: _Hits, directions: Array, own: Array) -> Array:
    """Return the light of the surfaces with what smooth ones mirror; more, the flatter the look.

    References:
        Schlick, Computer Graphics Forum 1994, eq. 15, for the share that is mirrored.
    """
    smooth = np.flatnonzero(stage.gloss[stage.material[hits.triangle]] > 0)
    if not smooth.size:
        return own
    kind = stage.material[hits.triangle[smooth]]
    unit = directions[smooth] / np.linalg.norm(directions[smooth], axis=1, keepdims=True)
    normal = _rippled(hits, smooth, stage.ripple[kind])
    facing = (unit * normal).sum(1, keepdims=True)
    away = (unit - 2 * facing * normal).astype(np.float32)
    # A ripple may not send light into its own surface.
    away -= (
        np.minimum((away * hits.normal[smooth]).sum(1, keepdims=True) - 0.01, 0)
        * (hits.normal[smooth])
    )
    seen = dome.light(away)
    others, _ = _met(stage, hits.point[smooth], away, 1.0)
    emitted, albedo = _surface_colours(stage, others)
    lit = 0.8 * stage.scene.ambient
    if stage.scene.sun is not None:
        lit = lit + np.maximum(others.normal @ stage.scene.sun.towards, 0)[:, None] * (
            0.8 * stage.scene.sun.power
        )
    seen[others.pixel] = emitted + albedo * lit
    least = stage.gloss[kind][:, None]
    share = least + (1 - least) * (1 - np.clip(np.abs(facing), 0, 1)) ** 5
    mixed = own.copy()
    mixed[smooth] += share * (seen - own[smooth])
    return mixed


def _rippled(hits: _Hits, which: NDArray[np.intp], ripple: Array) -> Array:
    """Return normals, tipped by waves where a surface has them."""
    normal = hits.normal[which]
    if not ripple.any():
        return normal
    place = hits.point[which][:, [0, 2]]
    tip = np.zeros_like(normal)
    for number in np.array([(2.1, 9.0), (-5.3, 14.0), (13.0, 31.0), (0.7, 3.1), (-23.0, 47.0)]):
        # Waves shorter than two pixels are not seen as such.
        length = 2 * np.pi / np.hypot(*number)
        seen = np.clip(length / (2 * hits.footprint[which]), 0, 1) ** 2
        tip[:, [0, 2]] += (np.cos(place @ number) * seen)[:, None] * (0.3, 1.0)
    tipped = normal + ripple[:, None] * tip
    return np.asarray(tipped / np.linalg.norm(tipped, axis=1, keepdims=True), np.float32)


def _hazy(scene: Scene, dome: Dome, hits: _Hits, eye: NDArray[np.float64], light: Array) -> Array:
    """Return the light that is left after the air between, and what the air adds of its own."""
    if scene.haze == 0 or not hits.pixel.size:
        return light
    path = hits.point - eye
    distance = np.linalg.norm(path, axis=1, keepdims=True)
    kept = np.exp(-scene.haze * distance)
    level = path / distance * (1, 0, 1) + (0, 0.03, 0)
    return np.asarray(kept * light + (1 - kept) * dome.light(level.astype(np.float32)), np.float32)
