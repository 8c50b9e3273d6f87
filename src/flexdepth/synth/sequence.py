"""Rendered sequences by number: the same (seed, index) is the same film, on every run."""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from flexdepth.runtime.errors import InputError
from flexdepth.synth.correspondence import Camera, Correspondence, correspondence
from flexdepth.synth.generate import VIEWS, SynthSettings, stage_of
from flexdepth.synth.lens import Film
from flexdepth.synth.moments import Moment, Sight
from flexdepth.synth.motion import Motion
from flexdepth.synth.placing import Surroundings
from flexdepth.synth.render import Rendering, render
from flexdepth.synth.shapes import Array
from flexdepth.synth.shutter import smeared
from flexdepth.synth.takes import Take, composed, owners

SEQUENCE_VERSION = 3
"""Raised when the same (seed, index) no longer gives the same sequence."""

_TRIES = 30
"""Compositions tried in a scene before the next is built."""

_SCENES = 40
"""Scenes built before it is given up."""


@dataclass(frozen=True)
class SequenceSettings:
    """What to film.

    Attributes:
        world: The scenes, and the size of the pictures.
        motion: What moves in them.
    """

    world: SynthSettings
    motion: Motion


PAIRS = SequenceSettings(
    SynthSettings(width=160, height=120),
    Motion(
        frames=3,
        focal=140.0,
        parallax=(2.0, 8.0),
        moving=(0.1, 0.25),
        rigid=(1, 1),
        flexible=(1, 1),
        feet=2 / 3,
    ),
)
"""Small frames with one mover that is rigid and one that bends, to measure two-frame depth on.

The first two are the pair; the third is another view. Two thirds of the movers, over a row of
seeds or of numbers, stand on the ground and show it; of the others half stand too, with their feet
behind something or below the picture, and half are in the air.
"""

LARGE_PAIRS = SequenceSettings(
    SynthSettings(width=640, height=480),
    replace(PAIRS.motion, focal=560.0, parallax=(10.0, 30.0)),
)
"""The same at four times the size and with more parallax, for flow that is estimated."""


@dataclass(frozen=True, eq=False)
class SequenceFrame:
    """One frame, with what becomes of its points in the frames beside it.

    Attributes:
        picture: Height by width by 3, uint8 sRGB.
        depth: z in metres, double; +inf is the sky.
        mover: Number of the mover that is seen, from 1; 0 is what is still, and the sky.
        camera: Where it was taken from.
        forward: To the next frame; None at the last.
        backward: To the frame before; None at the first.
    """

    picture: NDArray[np.uint8]
    depth: Array
    mover: NDArray[np.uint8]
    camera: Camera
    forward: Correspondence | None
    backward: Correspondence | None


@lru_cache(maxsize=1)
def _surroundings(world: SynthSettings, scene: int, retry: int) -> Surroundings:
    return Surroundings.of(stage_of(world, scene, retry))


def take(settings: SequenceSettings, index: int) -> Take:
    """Return sequence `index` of the world, composed but not yet rendered.

    Compositions that do not show what is asked for are drawn again; in a scene that offers none,
    the next is built.

    Raises:
        InputError: No scene shows what the settings ask for.
    """
    world = settings.world
    asked = settings.motion, world.width, world.height
    for retry in range(_SCENES):
        around = _surroundings(world, index // VIEWS, retry)
        rng = np.random.default_rng([world.seed, 4, index, retry])
        for _ in range(_TRIES):
            found = composed(rng, around, world.seed + index, asked)
            if found is not None:
                return found
    raise InputError(
        f"no scene of seed {world.seed} shows what sequence {index} is to show after "
        f"{_SCENES * _TRIES} compositions; ask for less than {settings.motion}"
    )


def filmed(shot: Take, seed: int, index: int) -> Iterator[SequenceFrame]:
    """Yield the frames of a take, in order; seed and index draw sky, camera and noise.

    Three frames' geometry is held at a time, whatever the length.
    """
    film = Film.drawn(np.random.default_rng([seed, 5, index]))
    before: tuple[Camera, Moment] | None = None
    now = _seen(shot, 0)
    for k in range(shot.motion.frames):
        after = _seen(shot, k + 1) if k + 1 < shot.motion.frames else None
        camera, moment, sight = now
        rng = np.random.default_rng([seed, 6, index, k])
        weather = np.random.default_rng([seed, 7, index])
        seen = render(rng, moment.stage, camera.view, shot.width, shot.height, weather)
        shape = shot.height, shot.width
        forward = None if after is None else correspondence(now, after[:2])
        backward = None if before is None else correspondence(now, before)
        light = _exposed(seen, forward, backward, shot.motion.shutter)
        yield SequenceFrame(
            picture=film.picture(rng, light),
            depth=sight.depth.reshape(shape),
            mover=(owners(shot.play, sight) + 1).astype(np.uint8).reshape(shape),
            camera=camera,
            forward=forward,
            backward=backward,
        )
        before = now[:2]
        if after is not None:
            now = after


def _exposed(
    seen: Rendering,
    forward: Correspondence | None,
    backward: Correspondence | None,
    share: float,
) -> NDArray[np.float32]:
    """Return the light of a frame while its shutter is open; the last frame's motion goes on."""
    if share == 0:
        return seen.light
    if forward is not None:
        flow = forward.flow
    elif backward is not None:
        flow = -backward.flow
    else:
        return seen.light
    return smeared(seen.light, seen.depth, lambda time: time * share / 2 * flow)


def _seen(shot: Take, frame: int) -> tuple[Camera, Moment, Sight]:
    camera, moment = shot.camera(frame), shot.play.at(shot.motion.time(frame))
    return camera, moment, moment.sight(camera.view, camera.rays(camera.pixels()))


def sequence(settings: SequenceSettings, index: int) -> tuple[SequenceFrame, ...]:
    """Return all frames of sequence `index` of the world.

    Raises:
        InputError: No scene shows what the settings ask for.
    """
    return tuple(filmed(take(settings, index), settings.world.seed, index))
