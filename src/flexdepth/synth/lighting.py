"""Light on surfaces: lamps, sun and sky with shadows, what glows, and what shines."""

import numpy as np
from numpy.random import Generator
from numpy.typing import NDArray

from flexdepth.synth.glass import passed, unblocked
from flexdepth.synth.patterns import SIZE
from flexdepth.synth.scene import AreaLight, Beam, Spot, Sun
from flexdepth.synth.skylight import Dome
from flexdepth.synth.stage import Array, Hits, Stage, dot, unit

AMBIENT_RAYS = 2
SHADOW_RAYS = 2
_SOFTNESS = 0.15
"""Square metres added to a lamp's square distance: no lamp is a point."""

_FAINT = 5e-4
"""Irradiance of a spot light below which nothing is lit: no night is so dark that it is seen."""

_DENTS = [
    (np.array(number, np.float32), np.array(way, np.float32))
    for number, way in (
        ((130, 40, 90), (0.3, 0.1, 0.5)),
        ((-210, 160, 50), (0.1, 0.3, -0.15)),
        ((60, -330, 280), (-0.15, 0.1, 0.06)),
        ((25, 31, -44), (0.7, -0.4, 0.6)),
    )
]
"""Radians a metre along x, y and z, and the way in which normals are tipped."""

_FAR = 1e5
"""Metres beyond which there is nothing."""

_GLANCE = 400.0
"""Pixels of focal length that decide how fine a texture is when seen in a mirror."""
_WAVES = np.array([(2.1, 9.0), (-5.3, 14.0), (13.0, 31.0), (0.7, 3.1), (-23.0, 47.0)])
"""Waves of water, as radians a metre along x and z."""


def surface_colours(stage: Stage, hits: Hits) -> tuple[Array, Array]:
    """Return the emitted light and the albedo at each hit."""
    material = stage.material[hits.triangle]
    size = stage.size[material]
    texels = (SIZE * hits.footprint / size.mean(1)).astype(np.float32)
    shares = stage.library.shares(stage.layer[material], hits.uv / size, texels)
    colour = np.einsum("nk,nkc->nc", shares, stage.colours[material, :3])
    glow = stage.glow[material][:, None]
    return glow * colour, np.where(glow > 0, 0, colour)


def irradiance(rng: Generator, stage: Stage, hits: Hits) -> Array:
    """Return the light that arrives at each hit, with shadows and some noise."""
    total = _ambient(rng, stage, hits)
    for lamp in stage.scene.lamps:
        total += _from_lamp(rng, stage, hits, lamp)
    if stage.scene.sun is not None:
        total += _from_sun(rng, stage, hits, stage.scene.sun)
    for beam in stage.scene.beams:
        total += _from_beam(stage, hits, beam)
    for spot in stage.scene.spots:
        total += _from_spot(stage, hits, spot)
    return total


def mirrored(stage: Stage, dome: Dome, hits: Hits) -> tuple[Array, Array]:
    """Return the share of light that each hit mirrors, and that light.

    The share follows Schlick, An inexpensive BRDF model for physically-based rendering, 1994.
    What is seen in a mirror has no shadows of its own, and panes before it no gloss.
    """
    material = stage.material[hits.triangle]
    share = np.zeros((len(hits.ray), 1), np.float32)
    light = np.zeros((len(hits.ray), 3), np.float32)
    shiny = np.flatnonzero(stage.gloss[material] > 0)
    if not shiny.size:
        return share, light
    gloss, rough = stage.gloss[material[shiny], None], stage.rough[material[shiny], None]
    dents = 0.5 * rough * _dents(hits, shiny)
    waves = _waves(hits, shiny, stage.ripple[material[shiny]])
    normal = unit(hits.shading[shiny] + dents + waves)
    towards = hits.towards[shiny]
    cosine = np.clip(dot(normal, towards), 0, 1)[:, None]
    share[shiny] = gloss + np.maximum(0, 1 - rough * 2) * (1 - gloss) * (1 - cosine) ** 5
    away = (2 * cosine * normal - towards).astype(np.float32)
    # Neither a wave nor a smooth normal may send light into the triangle itself.
    away -= np.minimum(dot(away, hits.normal[shiny]) - 0.01, 0)[:, None] * hits.normal[shiny]
    seen, panes = passed(stage, *stage.hits(hits.point[shiny], away, _GLANCE), away, _GLANCE)
    other = dome.light(away)
    emitted, albedo = surface_colours(stage, seen)
    # One stray ray that meets a lamp would be a spark.
    other[seen.ray] = np.minimum(emitted, 6) + albedo * _plain_light(stage, seen)
    for pane in panes:
        other[pane.ray] *= stage.passing(pane.triangle)
    light[shiny] = other
    return share, light


def glazed(stage: Stage, dome: Dome, pane: Hits, eye: NDArray[np.float64], behind: Array) -> Array:
    """Return the light from clear surfaces, given the light from behind them.

    A pane mirrors its share, scatters what its dust does in light without shadows, and lets the
    rest pass. `behind` has the air before the pane in it already.
    """
    share, other = mirrored(stage, dome, pane)
    _, albedo = surface_colours(stage, pane)
    through = (1 - share) * stage.passing(pane.triangle)
    own = share * other + (1 - share) * albedo * _plain_light(stage, pane)
    kept = np.maximum(1 - through, 1e-6)
    return np.asarray(through * behind + kept * hazy(dome, pane, eye, own / kept), np.float32)


def _dents(hits: Hits, which: NDArray[np.intp]) -> Array:
    """Return the uneven part of normals, of spread 1: a rough mirror without a grain of noise."""
    place = hits.point[which]
    tip = np.zeros((len(which), 3), np.float32)
    for number, way in _DENTS:
        seen = np.clip(np.pi / np.linalg.norm(number) / hits.footprint[which], 0, 1) ** 2
        tip += (np.sin(place @ number) * seen)[:, None] * way
    return tip


def _waves(hits: Hits, which: NDArray[np.intp], ripple: Array) -> Array:
    """Return what waves add to the normals, where a surface has them."""
    tip = np.zeros((len(which), 3), np.float32)
    if not ripple.any():
        return tip
    place = hits.point[which][:, [0, 2]]
    for number in _WAVES:
        # Waves shorter than two pixels are not seen as such.
        length = 2 * np.pi / np.hypot(*number)
        seen = np.clip(length / (2 * hits.footprint[which]), 0, 1) ** 2
        tip[:, [0, 2]] += (np.cos(place @ number) * seen)[:, None] * (0.3, 1.0)
    return np.asarray(ripple[:, None] * tip, np.float32)


def hazy(dome: Dome, hits: Hits, eye: NDArray[np.float64], light: Array) -> Array:
    """Return the light that is left after the air between, and what the air adds of its own."""
    haze = dome.scene.haze
    if haze == 0 or not hits.ray.size:
        return light
    path = hits.point - eye
    distance = np.linalg.norm(path, axis=1, keepdims=True)
    kept = np.exp(-haze * distance)
    level = path / distance * (1, 0, 1) + (0, 0.03, 0)
    return np.asarray(kept * light + (1 - kept) * dome.light(level.astype(np.float32)), np.float32)


def _ambient(rng: Generator, stage: Stage, hits: Hits) -> Array:
    """Return ambient irradiance: the open share of a cosine-weighted hemisphere."""
    reach = stage.scene.occlusion_reach
    openness = np.zeros((len(hits.ray), 3), np.float32)
    for _ in range(AMBIENT_RAYS):
        ball = unit(rng.standard_normal(hits.point.shape, np.float32))
        path = hits.normal + np.float32(0.999) * ball
        distance, share = unblocked(stage, hits.point, path)
        openness += share * np.minimum(distance * np.sqrt(dot(path, path)) / reach, 1)[:, None]
    return (openness / AMBIENT_RAYS * stage.scene.ambient).astype(np.float32)


def _from_lamp(rng: Generator, stage: Stage, hits: Hits, lamp: AreaLight) -> Array:
    """Return the irradiance from a lamp, sampled at random points of it."""
    rays = max(1, SHADOW_RAYS // len(stage.scene.lamps))
    total = np.zeros((len(hits.ray), 3), np.float32)
    for _ in range(rays):
        jitter = rng.random(hits.point.shape, np.float32) - 0.5
        target = lamp.centre + lamp.side * jitter * (1, 0, 1)
        path = (target - hits.point).astype(np.float32)
        distance, share = unblocked(stage, hits.point, path, 0.995)
        total += share * np.where(distance > 0.995, _falling(hits.shading, path), 0)[:, None]
    return (total / rays * lamp.power).astype(np.float32)


def _falling(shading: Array, path: Array) -> Array:
    """Return what arrives from the end of each path, unshadowed, for a lamp of unit power."""
    square = dot(path, path)
    facing = np.maximum(dot(shading, path) / np.sqrt(square), 0)
    return np.asarray(facing / (square + _SOFTNESS), np.float32)


def _from_sun(rng: Generator, stage: Stage, hits: Hits, sun: Sun) -> Array:
    """Return the irradiance from the sun, with shadows as soft as half a degree makes them."""
    total = np.zeros((len(hits.ray), 3), np.float32)
    for _ in range(SHADOW_RAYS):
        path = (sun.towards + rng.normal(0, 0.01, hits.point.shape)).astype(np.float32)
        distance, share = unblocked(stage, hits.point, path)
        facing = np.maximum(dot(hits.shading, path), 0)
        total += share * np.where(distance > _FAR, facing, 0)[:, None]
    return (total / SHADOW_RAYS * sun.power).astype(np.float32)


def _from_beam(stage: Stage, hits: Hits, beam: Beam) -> Array:
    """Return the irradiance from sunlight through one window."""
    normal = np.cross(beam.along, beam.up)
    distance = ((beam.corner - hits.point) @ normal) / (beam.towards @ normal)
    place = hits.point + distance[:, None] * beam.towards - beam.corner
    u = place @ beam.along / (beam.along @ beam.along)
    v = place @ beam.up / (beam.up @ beam.up)
    facing = (hits.shading @ beam.towards).astype(np.float32)
    bars = (u * beam.panes % 1 > 0.06) & (v * beam.panes % 1 > 0.04)
    inside = (distance > 0) & (u > 0) & (u < 1) & (v > 0) & (v < 1) & bars & (facing > 0)
    lit = np.flatnonzero(inside)
    path = (distance[lit, None] * beam.towards).astype(np.float32)
    way, share = unblocked(stage, hits.point[lit], path, 0.97)
    total = np.zeros((len(hits.ray), 3), np.float32)
    total[lit] = share * np.where(way > 0.97, facing[lit], 0)[:, None]
    return (total * beam.power).astype(np.float32)


def _from_spot(stage: Stage, hits: Hits, spot: Spot) -> Array:
    """Return the irradiance from a spot light, with sharp shadows."""
    lit, path, arriving = _in_cone(hits, spot)
    distance, share = unblocked(stage, hits.point[lit], path, 0.995)
    total = np.zeros((len(hits.ray), 3), np.float32)
    total[lit] = share * np.where(distance[:, None] > 0.995, arriving, 0)
    return total


def _in_cone(hits: Hits, spot: Spot) -> tuple[NDArray[np.intp], Array, Array]:
    """Return which hits a spot light can light, the paths to it, and what arrives unshadowed."""
    path = spot.place.astype(np.float32) - hits.point
    cosine = path @ -spot.ahead.astype(np.float32) / np.sqrt(dot(path, path))
    rim = np.cos(spot.half_angle)
    inside = np.flatnonzero(cosine > rim)
    path = path[inside]
    inwards = (cosine[inside] - rim) / (1 - rim)
    arriving = inwards**2 * (3 - 2 * inwards) * _falling(hits.shading[inside], path)
    bright = arriving * spot.power.max() > _FAINT
    light = (arriving[bright, None] * spot.power).astype(np.float32)
    return inside[bright], path[bright], light


def _plain_light(stage: Stage, hits: Hits) -> Array:
    """Return the irradiance without any shadow."""
    total = np.zeros((len(hits.ray), 3), np.float32) + 0.7 * stage.scene.ambient
    for lamp in stage.scene.lamps:
        path = (lamp.centre - hits.point).astype(np.float32)
        total += 0.7 * _falling(hits.shading, path)[:, None] * lamp.power
    for spot in stage.scene.spots:
        lit, _, arriving = _in_cone(hits, spot)
        total[lit] += 0.7 * arriving
    if stage.scene.sun is not None:
        facing = np.maximum(hits.shading @ stage.scene.sun.towards, 0)
        total += 0.7 * facing[:, None] * stage.scene.sun.power
    return np.asarray(total, np.float32)
