"""Rendered images by number: the same (seed, index) is the same image, on every run."""

import json
import os
from collections.abc import Callable, Iterator, Mapping
from concurrent.futures import ProcessPoolExecutor
from dataclasses import asdict, dataclass
from functools import lru_cache, partial
from multiprocessing import get_context
from pathlib import Path

import cv2
import numpy as np
from numpy.random import Generator
from numpy.typing import NDArray

from flexdepth.runtime.atomic import replacing
from flexdepth.runtime.depthmap import DepthMap, FocalSource, Intrinsics, Space
from flexdepth.runtime.errors import InputError
from flexdepth.runtime.files import write_depth
from flexdepth.runtime.opening import open_input
from flexdepth.synth.lens import photograph
from flexdepth.synth.library import Library
from flexdepth.synth.photographs import Photo, digest, photograph_files, photographs
from flexdepth.synth.render import Rendering, render, worth_taking
from flexdepth.synth.stage import Stage
from flexdepth.synth.unrest import unsteady
from flexdepth.synth.viewpoints import Viewpoint, viewpoint
from flexdepth.synth.worlds import drawn

VERSION = 4
"""Raised when the same (seed, index) no longer gives the same image."""

VIEWS = 4
"""Images of one scene, in a row."""

_VARIANTS = 16
_ATTEMPTS = 40


@dataclass(frozen=True)
class SynthSettings:
    """What to render.

    Attributes:
        seed: The world; images of different seeds share nothing.
        width: Pixels.
        height: Pixels.
        outdoor_share: Share of scenes under the sky; `worlds.py` says which kinds there are.
        photographs: A folder of photographs to hang on walls, to see from windows, and for their
            skies. None by default.
    """

    seed: int = 0
    width: int = 384
    height: int = 288
    outdoor_share: float = 0.4
    photographs: Path | None = None

    def __post_init__(self) -> None:
        """Refuse what cannot be rendered."""
        if min(self.width, self.height) < 32 or not 0 <= self.outdoor_share <= 1 or self.seed < 0:
            raise InputError(
                f"a world needs width and height >= 32, an outdoor share from 0 to 1 and a seed "
                f">= 0, got {self}"
            )


def stated(settings: SynthSettings) -> dict[str, object]:
    """Return what is rendered, for JSON: the photographs by what they show and not by their place.

    Raises:
        InputError: There are no such photographs, or one cannot be read.
    """
    said = asdict(settings)
    folder = said.pop("photographs")
    return said if folder is None else said | {"photographs": digest(photograph_files(folder))}


@lru_cache(maxsize=1)
def _library(seed: int, folder: Path | None) -> Library:
    shown: list[Photo] = []
    if folder is not None:
        shown = photographs(np.random.default_rng([seed, 9]), photograph_files(folder))
    return Library.made(np.random.default_rng([seed, 0]), _VARIANTS, shown)


@lru_cache(maxsize=1)
def stage_of(settings: SynthSettings, scene: int, retry: int) -> Stage:
    """Return a scene ready for rays."""
    rng = np.random.default_rng([settings.seed, 1, scene, retry])
    make = drawn(rng, settings.outdoor_share)
    return Stage.built(rng, make(rng), _library(settings.seed, settings.photographs))


def rendered(settings: SynthSettings, index: int) -> tuple[Rendering, NDArray[np.uint8]]:
    """Return image `index` of the world: linear light with depth, and the photograph of it.

    Viewpoints that show nothing are drawn again; a scene that offers none is built again.
    """
    aspect = settings.width / settings.height
    scene = index // VIEWS
    for retry in range(_ATTEMPTS):
        stage = stage_of(settings, scene, retry)
        rng = np.random.default_rng([settings.seed, 2, index, retry])
        for _ in range(_ATTEMPTS):
            view = viewpoint(rng, stage.scene, aspect)
            if worth_taking(stage, view, aspect):
                return taken(rng, stage, view, (settings.width, settings.height))
    raise RuntimeError(f"no viewpoint of scene {scene} of seed {settings.seed} shows anything")


def taken(
    rng: Generator, stage: Stage, view: Viewpoint, size: tuple[int, int]
) -> tuple[Rendering, NDArray[np.uint8]]:
    """Return what is seen from a viewpoint, width by height pixels, and a photograph of it."""
    seen = render(rng, stage, view, *size)
    light = unsteady(rng, stage.scene, view, seen)
    return seen, photograph(rng, light, seen.depth, seen.focal)


def write_image(settings: SynthSettings, index: int, folder: Path) -> None:
    """Write `image/INDEX.jpg` and `depth/INDEX.npz`; does nothing where both exist."""
    picture_path = folder / "image" / f"{index:06d}.jpg"
    depth_path = folder / "depth" / f"{index:06d}.npz"
    if picture_path.exists() and depth_path.exists():
        return
    seen, picture = rendered(settings, index)
    quality = int(np.random.default_rng([settings.seed, 3, index]).integers(75, 97))
    camera = Intrinsics.centred(settings.width, settings.height, seen.focal, FocalSource.GIVEN)
    truth = DepthMap(seen.depth, Space.METRIC, camera, f"synth {VERSION}")
    write_depth(depth_path, truth, None)
    encoded = cv2.imencode(".jpg", picture[..., ::-1], [cv2.IMWRITE_JPEG_QUALITY, quality])[1]
    with replacing(picture_path) as path:
        path.write_bytes(encoded.tobytes())


def _write_scene(settings: SynthSettings, folder: Path, indices: range) -> int:
    for index in indices:
        write_image(settings, index, folder)
    return len(indices)


def claim(folder: Path, world: Mapping[str, object]) -> None:
    """Write `world.json`, what the folder's images show; refuse a folder of another world.

    Raises:
        InputError: The folder cannot be written, or holds images of another world.
    """
    file_of_world = folder / "world.json"
    if not os.path.exists(file_of_world):
        with replacing(file_of_world) as path:
            path.write_text(json.dumps(world) + "\n", encoding="ascii")
        return
    with open_input(file_of_world) as file:
        found = file.read().decode("ascii", "replace")
    if found.strip() != json.dumps(world):
        raise InputError(
            f"{file_of_world}: the images here are of another world, {found.strip()}; wanted "
            f"{json.dumps(world)}; take another folder"
        )


def in_scenes(write: Callable[[range], int], count: int, processes: int) -> Iterator[int]:
    """Write numbers 0 to `count` - 1 scene by scene, and yield how many are done after each.

    Args:
        write: Writes the numbers of one scene and returns how many they are; it can be pickled.
        count: How many.
        processes: How many write at once.
    """
    scenes = [range(first, min(first + VIEWS, count)) for first in range(0, count, VIEWS)]
    done = 0
    # A forked child inherits the locks of threads that it does not have, and can wait for ever.
    pool = ProcessPoolExecutor(processes, mp_context=get_context("spawn"))
    try:
        jobs = [pool.submit(write, scene) for scene in scenes]
        for job in jobs:
            done += job.result()
            yield done
    finally:
        pool.shutdown(cancel_futures=True)


def write_images(
    settings: SynthSettings, count: int, folder: Path, processes: int
) -> Iterator[int]:
    """Write images 0 to `count` - 1, and yield how many are done after each scene.

    Interrupted runs go on where they stopped. The bytes do not depend on `processes`.

    Raises:
        InputError: The folder cannot be written, or holds images of other settings.
    """
    claim(folder, {"version": VERSION, **stated(settings)})
    yield from in_scenes(partial(_write_scene, settings, folder), count, processes)
