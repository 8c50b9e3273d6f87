"""Sequences in files: a folder for each, which tools for Sintel and for posed images can read.

ROOT/world.json                 what was asked for
ROOT/000003/                    sequence 3
    image/0000.jpg              the frames
    depth/0000.npz              z in metres, +inf for sky, with the camera
    mover/0000.png              0 what is still, else the number of the mover, 8-bit gray
    poses.txt                   world from camera, 3 x 4 numbers for each frame
    flow/0000.flo               to the next frame, pixels, right and down
    points/0000.npz             `occluded`, `moving`, `motion` on the way to the next frame
    flow_back/0001.flo          to the frame before
    points_back/0001.npz        the same on the way there
    sequence.json               camera, movers, parallax; written last
"""

import json
from collections.abc import Iterator
from dataclasses import asdict
from functools import partial
from pathlib import Path

import cv2
import numpy as np

from flexdepth.runtime.atomic import replacing
from flexdepth.runtime.depthmap import DepthMap, FocalSource, Intrinsics, Space
from flexdepth.runtime.files import write_depth
from flexdepth.synth.correspondence import Correspondence
from flexdepth.synth.generate import VERSION, claim, in_scenes, stated
from flexdepth.synth.sequence import (
    SEQUENCE_VERSION,
    SequenceFrame,
    SequenceSettings,
    filmed,
    take,
)
from flexdepth.synth.shapes import Array
from flexdepth.synth.takes import Take, pair_parallax, shares

_TAG = 202021.25
"""What a .flo file begins with."""

_UNKNOWN = 1e10
"""Flow of a point that is then behind the camera."""

_PARALLAX_PIXELS = 20_000
"""How many pixels a stated median parallax is taken over, at most."""

_SAID = "sequence.json"


def write_sequences(
    settings: SequenceSettings, count: int, folder: Path, processes: int
) -> Iterator[int]:
    """Write sequences 0 to `count` - 1, and yield how many are done after each scene.

    Interrupted runs go on with the first sequence that is not complete. The bytes do not depend
    on `processes`.

    Raises:
        InputError: The folder cannot be written or holds something else, or no scene shows what
            the settings ask for.
    """
    claim(
        folder,
        {
            "version": VERSION,
            "sequence_version": SEQUENCE_VERSION,
            **stated(settings.world),
            "motion": json.loads(json.dumps(asdict(settings.motion))),
        },
    )
    yield from in_scenes(partial(_write_scene, settings, folder), count, processes)


def _write_scene(settings: SequenceSettings, folder: Path, indices: range) -> int:
    for index in indices:
        write_sequence(settings, index, sequence_folder(folder, index))
    return len(indices)


def sequence_folder(folder: Path, index: int) -> Path:
    """Return where sequence `index` of a world is."""
    return folder / f"{index:06d}"


def write_sequence(settings: SequenceSettings, index: int, folder: Path) -> None:
    """Write sequence `index`; does nothing where it is complete.

    Raises:
        InputError: The folder cannot be written, or no scene shows what the settings ask for.
    """
    if (folder / _SAID).exists():
        return
    shot = take(settings, index)
    quality = int(np.random.default_rng([settings.world.seed, 8, index]).integers(75, 97))
    poses = []
    for number, frame in enumerate(filmed(shot, settings.world.seed, index)):
        _write_frame(frame, f"{number:04d}", folder, quality)
        view = frame.camera.view
        poses.append(np.column_stack([view.world_from_camera, view.eye]).ravel())
    lines = [" ".join(repr(float(number)) for number in pose) for pose in poses]
    with replacing(folder / "poses.txt") as path:
        path.write_text("\n".join(lines) + "\n", encoding="ascii")
    with replacing(folder / _SAID) as path:
        path.write_text(json.dumps(_said(shot), indent=1) + "\n", encoding="ascii")


def _said(shot: Take) -> dict[str, object]:
    """Return what `sequence.json` says: the camera by OpenCV's convention, and what moves."""
    camera = shot.camera(0)
    shown = shares(shot, 0, shot.width * shot.height)
    return {
        "version": SEQUENCE_VERSION,
        "width": shot.width,
        "height": shot.height,
        "focal": shot.focal,
        "centre": (camera.middle - 0.5).tolist(),
        "frames": shot.motion.frames,
        "rate": shot.motion.rate,
        "camera": shot.path.name,
        "parallax": [
            pair_parallax(shot, frame, _PARALLAX_PIXELS) for frame in range(shot.motion.frames - 1)
        ],
        "movers": [
            {
                "number": number + 1,
                "kind": mover.kind.name,
                "flexible": mover.kind.flexible,
                "stands": mover.kind.stands,
                "feet_seen": shown.feet[number],
                "share": float(shown.mover[number]),
            }
            for number, mover in enumerate(shot.play.movers)
        ],
    }


def _write_frame(frame: SequenceFrame, name: str, folder: Path, quality: int) -> None:
    camera = frame.camera
    pinhole = Intrinsics.centred(camera.width, camera.height, camera.focal, FocalSource.GIVEN)
    depth = frame.depth.astype(np.float32)
    truth = DepthMap(depth, Space.METRIC, pinhole, f"synth {VERSION}.{SEQUENCE_VERSION}")
    write_depth(folder / "depth" / f"{name}.npz", truth, None)
    coded = [cv2.IMWRITE_JPEG_QUALITY, quality]
    _write_bytes(
        folder / "image" / f"{name}.jpg",
        cv2.imencode(".jpg", frame.picture[..., ::-1], coded)[1].tobytes(),
    )
    _write_bytes(folder / "mover" / f"{name}.png", cv2.imencode(".png", frame.mover)[1].tobytes())
    for suffix, way in (("", frame.forward), ("_back", frame.backward)):
        if way is not None:
            _write_bytes(folder / f"flow{suffix}" / f"{name}.flo", _flo(way.flow))
            _write_points(folder / f"points{suffix}" / f"{name}.npz", way)


def _write_points(file: Path, way: Correspondence) -> None:
    with replacing(file) as path:
        np.savez_compressed(
            path,
            occluded=way.occluded,
            moving=way.moving,
            motion=way.motion.astype(np.float32),
        )


def _flo(flow: Array) -> bytes:
    """Return a Middlebury flow file."""
    height, width = flow.shape[:2]
    numbers = np.where(np.isnan(flow), _UNKNOWN, flow).astype("<f4")
    header = np.array([_TAG], "<f4").tobytes() + np.array([width, height], "<i4").tobytes()
    return header + numbers.tobytes()


def _write_bytes(file: Path, content: bytes) -> None:
    with replacing(file) as path:
        path.write_bytes(content)
