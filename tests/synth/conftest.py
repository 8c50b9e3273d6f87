from dataclasses import dataclass

import numpy as np
import pytest

from flexdepth.synth.library import Library
from flexdepth.synth.materials import Material, Part
from flexdepth.synth.moments import Play
from flexdepth.synth.movers import Ground, Kind, Mover
from flexdepth.synth.scene import Scene
from flexdepth.synth.shapes import Mesh
from flexdepth.synth.stage import Stage

GREY = Material("plain", np.full((3, 3), 0.5), (1.0, 1.0))


@dataclass(frozen=True, eq=False)
class Shifted:
    """A mesh that goes along a straight line, or grows."""

    mesh: Mesh
    velocity: np.ndarray
    growth: float = 0.0

    @property
    def looks(self):
        return (GREY,)

    def meshes(self, time):
        grown = self.mesh.corners * (1 + self.growth * time)
        return [Mesh(grown + time * np.asarray(self.velocity, float), self.mesh.uv)]


def mover(body):
    return Mover(Kind("thing", False, True, (Ground.OPEN,), (0, 0), 1, 1.0, lambda *_: body), body)


def scene(meshes):
    return Scene(
        parts=[Part(mesh, GREY) for mesh in meshes],
        lamps=[],
        sun=None,
        ambient=np.ones(3),
        occlusion_reach=1.0,
        horizon=np.ones(3),
        zenith=np.ones(3),
        clouds=0.0,
        eyes=(np.zeros(3), np.ones(3)),
        outdoors=True,
    )


@pytest.fixture(scope="session")
def library():
    return Library.made(np.random.default_rng(0), 1)


@pytest.fixture(scope="session")
def play(library):
    """Return a function that puts (mesh, velocity, growth) that move among meshes that do not."""

    def made(still, moving=()):
        stage = Stage.built(np.random.default_rng(1), scene(still), library)
        corners = np.concatenate([mesh.corners for mesh in still])
        movers = tuple(mover(Shifted(*each)) for each in moving)
        return Play.of(np.random.default_rng(2), stage, corners, movers)

    return made
