"""Land: a height field that is level around the middle and rises to hills and mountains."""

from dataclasses import dataclass
from math import cos, pi, sin

import numpy as np
from numpy.random import Generator

from flexdepth.synth.shapes import Array, Mesh, draped

_OCTAVES = 9


@dataclass(frozen=True, eq=False)
class Terrain:
    """Heights over a plane, metres.

    Attributes:
        level: Metres around the middle that are exactly level, at y = 0.
        gentle: Metres over which the land gains its full relief after that.
        waves: Wave vectors of the land's swell, radians a metre: octaves by two.
        phase: Of each, radians.
        relief: Height of each, metres.
        peaks: Height of what closes the view, metres.
        rim: Distance at which that begins and the one at which it is highest.
        basin: Heading of a lake or a sea, distance of its shore, width and depth, metres; depth
            0 is none.
    """

    level: float
    gentle: float
    waves: Array
    phase: Array
    relief: Array
    peaks: float
    rim: tuple[float, float]
    basin: tuple[float, float, float, float] = (0.0, 0.0, 0.0, 0.0)

    @classmethod
    def drawn(cls, rng: Generator, relief: float, peaks: float, level: float) -> "Terrain":
        """Return random land.

        Args:
            rng: Draws it.
            relief: Height of its swell where it is strongest, metres.
            peaks: Height of hills or mountains around, metres.
            level: Metres around the middle that are level.
        """
        length = np.geomspace(7, 500, _OCTAVES) * rng.uniform(0.8, 1.25, _OCTAVES)
        heading = rng.uniform(0, 2 * pi, _OCTAVES)
        number = 2 * pi / length
        near = rng.uniform(60, 400)
        highest = near + rng.uniform(150, 700)
        return cls(
            level=level,
            gentle=float(rng.uniform(10, 80)),
            waves=np.stack([number * np.cos(heading), number * np.sin(heading)], 1),
            phase=rng.uniform(0, 2 * pi, _OCTAVES),
            relief=relief * (length / 500) ** rng.uniform(0.7, 1.1),
            # What closes the view leaves sky above it.
            peaks=min(peaks, 0.33 * highest),
            rim=(float(near), float(highest)),
        )

    def height(self, x: Array, z: Array) -> Array:
        """Return the height of the land at points of the plane."""
        place = np.stack([x, z], -1)
        swell = (np.sin(place @ self.waves.T + self.phase) * self.relief).sum(-1)
        distance = np.hypot(x, z)
        rises = _smooth((distance - self.level) / self.gentle)
        far = _smooth((distance - self.rim[0]) / (self.rim[1] - self.rim[0]))
        land = rises * swell + self.peaks * far * self._ridges(place)
        heading, shore, width, depth = self.basin
        if depth == 0:
            return np.asarray(land)
        out = place @ (sin(heading), cos(heading)) - shore - 0.05 * swell
        wet = _smooth(out / 25) * (1 - _smooth((out - width) / 60))
        return np.asarray(land * (1 - wet) - depth * wet)

    def _ridges(self, place: Array) -> Array:
        """Return sharp crests, 0 to about 1."""
        crest = np.zeros(place.shape[:-1])
        weight = 1.0
        for k in range(6):
            number = self.waves[-1 - k] * (1.4, 0.8)
            other = self.waves[-1 - k][::-1] * (-1.1, 1.2)
            fold = np.sin(place @ number + self.phase[k]) + np.sin(place @ other + self.phase[-k])
            crest = crest + weight * (1 - np.abs(fold) / 1.2)
            weight *= 0.55
        return np.maximum(0.5 * crest + 0.2, 0.02 * crest)

    def mesh(self, near: float, far: float, sectors: int = 160) -> Mesh:
        """Return the land between two distances from the middle, ever coarser outwards."""
        rings = max(4, int(sectors / 2 / pi * np.log(far / max(near, 0.5)) * 1.2))
        radius = np.geomspace(max(near, 0.5), far, rings)
        if near < 0.5:
            radius = np.r_[0.0, radius]
        angle = np.linspace(0, 2 * pi, sectors + 1)
        x, z = radius[:, None] * np.cos(angle), radius[:, None] * np.sin(angle)
        land = draped(np.stack([x, self.height(x, z), z], -1))
        return Mesh(land.corners, land.uv + self._wander(land.uv))

    def _wander(self, place: Array) -> Array:
        """Return by how many metres textures are shifted, so that their repeats make no grid."""
        angle = place @ self.waves.T + self.phase
        # All waves together shift less than one metre in a metre: nothing folds.
        reach = 0.2 / np.linalg.norm(self.waves, axis=1) / _OCTAVES**0.5
        return np.stack(
            [(np.sin(angle) * reach).sum(-1), (np.cos(1.3 * angle) * reach).sum(-1)], -1
        )

    def spots(self, rng: Generator, count: int, reach: tuple[float, float]) -> Array:
        """Return points on the land between two distances, evenly thick in their logarithm."""
        radius = np.exp(rng.uniform(np.log(reach[0]), np.log(reach[1]), count))
        angle = rng.uniform(0, 2 * pi, count)
        x, z = radius * np.cos(angle), radius * np.sin(angle)
        return np.stack([x, self.height(x, z), z], 1)


def _smooth(share: Array) -> Array:
    share = np.clip(share, 0, 1)
    return np.asarray(share * share * (3 - 2 * share))
