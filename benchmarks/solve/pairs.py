"""The pinned pairs of `suite.yaml`: rendered once by `flexdepth synth`, then kept in build/."""

from dataclasses import dataclass, fields
from pathlib import Path
from typing import Any

import numpy as np
import yaml
from numpy.typing import NDArray

from flexdepth.flow.dis import Dis
from flexdepth.runtime.depthmap import FocalSource, Intrinsics
from flexdepth.synth.correspondence import other_from_this
from flexdepth.synth.generate import VERSION, SynthSettings
from flexdepth.synth.motion import Footing, Motion
from flexdepth.synth.sequence import SEQUENCE_VERSION, SequenceSettings, filmed, take

HERE = Path(__file__).parent
SYNTH = f"{VERSION}.{SEQUENCE_VERSION}"
PAIR_VERSION = 3
"""Raised when a pair holds something else."""
KEPT = HERE.parents[1] / "build" / "solve-suite" / f"{SYNTH}-{PAIR_VERSION}"
SAID_OF_EXACT = 0.01
"""Pixels: a solver must be told some noise."""

STATIC, RIGID, FLEXIBLE = 0, 1, 2
FOOTINGS = tuple(Footing)
Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Pair:
    """A key and a target frame with all that is true of them.

    Attributes:
        key: Height x width x 3, RGB.
        target: Likewise.
        depth: z of the key frame in metres, +inf in the sky.
        flow: Key to target, pixels; NaN where the point is then behind the camera.
        occluded: Where the target does not show the point.
        kind: 0 what is still, 1 the rigid mover, 2 the flexible one.
        footing: Of each kind, what the key frame shows of its feet: its number in `FOOTINGS`.
        rotation: Of the camera's `target_from_key`.
        translation: Metres.
        focal: Pixels; the camera looks through the middle.
    """

    key: NDArray[np.uint8]
    target: NDArray[np.uint8]
    depth: Array
    flow: Array
    occluded: NDArray[np.bool_]
    kind: NDArray[np.uint8]
    footing: NDArray[np.uint8]
    rotation: Array
    translation: Array
    focal: Array

    @property
    def camera(self) -> Intrinsics:
        """Of both frames."""
        height, width = self.depth.shape
        return Intrinsics.centred(width, height, float(self.focal), FocalSource.GIVEN)


def suite() -> dict[str, Any]:
    """Return what `suite.yaml` says."""
    said: dict[str, Any] = yaml.safe_load((HERE / "suite.yaml").read_text(encoding="utf-8"))
    return said


def settings(said: dict[str, Any], name: str, seed: int) -> SequenceSettings:
    """Return what is rendered for a seed of the set `small` or `large`."""
    one = said[name]
    width, height = one["size"]
    motion = Motion(
        frames=3,
        focal=one["focal"],
        parallax=tuple(one["parallax"]),
        moving=tuple(said["moving"]),
        rigid=(1, 1),
        flexible=(1, 1),
        feet=said["feet"],
    )
    return SequenceSettings(SynthSettings(seed=seed, width=width, height=height), motion)


def pair(said: dict[str, Any], name: str, seed: int, kept: Path = KEPT) -> Pair:
    """Return a pair of the suite; what has been rendered before is read from where it is kept."""
    path = kept / f"{name}-{seed:04d}.npz"
    if not path.exists():
        path.parent.mkdir(parents=True, exist_ok=True)
        found = rendered(settings(said, name, seed))
        unfinished = path.with_suffix(".part.npz")
        np.savez_compressed(unfinished, **{f.name: getattr(found, f.name) for f in fields(Pair)})
        unfinished.replace(path)
    with np.load(path) as read:
        return Pair(**{field.name: read[field.name] for field in fields(Pair)})


def rendered(wanted: SequenceSettings) -> Pair:
    """Return the first two frames of sequence 0 of a world."""
    shot = take(wanted, 0)
    frames = filmed(shot, wanted.world.seed, 0)
    key, target = next(frames), next(frames)
    if key.forward is None:
        raise ValueError("a sequence of at least two frames is wanted")
    movers = [mover.kind for mover in shot.play.movers]
    kinds = np.array([STATIC, *(FLEXIBLE if kind.flexible else RIGID for kind in movers)])
    footing = np.full(len(kinds), FOOTINGS.index(Footing.SEEN), np.uint8)
    footing[kinds[1:]] = [FOOTINGS.index(each) for each in shot.footings]
    rotation, translation = other_from_this(key.camera.view, target.camera.view)
    return Pair(
        key.picture,
        target.picture,
        key.depth,
        key.forward.flow,
        key.forward.occluded,
        kinds[key.mover].astype(np.uint8),
        footing,
        rotation,
        translation,
        np.array(shot.focal),
    )


def parallax(truth: Pair) -> Array:
    """Return by how many pixels the camera's travel moves each point that is still; 0 for sky."""
    height, width = truth.depth.shape
    row, column = np.mgrid[:height, :width] + 0.5
    middle = np.array([width / 2, height / 2])
    rays = np.ones((height, width, 3))
    rays[..., :2] = (np.stack([column, row], -1) - middle) / truth.focal
    turned = rays @ truth.rotation.T
    travelled = turned + truth.translation / truth.depth[..., None]
    with np.errstate(divide="ignore", invalid="ignore"):
        shift = travelled[..., :2] / travelled[..., 2:] - turned[..., :2] / turned[..., 2:]
    return np.asarray(truth.focal * np.linalg.norm(shift, axis=-1))


def flow_of(
    truth: Pair, seed: int, noise: float | None
) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    """Return flow and its noise as a solver is given them.

    Args:
        truth: The pair.
        seed: Of the pair; draws the noise.
        noise: Pixels of white noise on the true flow, 0 for none; None estimates flow by DIS.
    """
    if noise is None:
        found = Dis().between(truth.key, truth.target)
        return found.flow, found.noise
    drawn = np.random.default_rng([seed, 9]).standard_normal(truth.flow.shape)
    flow = (truth.flow + noise * drawn).astype(np.float32)
    known = np.isfinite(flow).all(axis=-1)
    said = np.where(known, max(noise, SAID_OF_EXACT), np.nan)
    return flow, said.astype(np.float32)
