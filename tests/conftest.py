import json
import os
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest
from hypothesis import settings

settings.register_profile("house", derandomize=True, deadline=None)
settings.load_profile("house")

BESIDE_THE_REPOSITORY = Path(__file__).parents[2] / "shared" / "data"


@pytest.fixture(scope="session")
def samples() -> Path:
    """The folder of real pictures with measured depth; they are not part of the repository."""
    folder = Path(os.environ.get("FLEXDEPTH_SAMPLES") or BESIDE_THE_REPOSITORY)
    if not folder.is_dir():
        pytest.skip(f"no real samples in {folder}; docs/samples.md says where to take them from")
    return folder


TINY = """
<ir_version: 10, opset_import: ["" : 18]>
tiny (float[batch, 3, height, width] image)
    => (float[batch, height, width] depth, float[batch, height, width] sky)
{
    axes = Constant<value_ints: ints = [1]>()
    one = Constant<value: tensor = float[1] {1.0}>()
    bright = Constant<value: tensor = float[1] {0.99}>()
    mean = ReduceMean<keepdims = 0>(image, axes)
    depth = Add(mean, one)
    white = Greater(mean, bright)
    sky = Cast<to = 1>(white)
}
"""
"""A network whose depth is 1 + the mean of red, green and blue, and whose sky is white."""

TINY_SAYS = {
    "format": 1,
    "name": "tiny",
    "version": "1.2",
    "licence": "MIT",
    "space": "metric",
    "area": [128, 96],
    "multiple": 32,
    "canonical_focal": 0.5,
    "source": "a test",
}


@pytest.fixture
def tiny_graph() -> str:
    """The text of the tiny network, to be changed."""
    return TINY


@pytest.fixture
def make_bundle(tmp_path) -> Callable[..., Path]:
    """Return a function that writes a tiny model bundle; None leaves a field of the JSON out."""
    onnx = pytest.importorskip("onnx")

    def make(file: str = "tiny.onnx", graph: str = TINY, **says: object) -> Path:
        model = onnx.parser.parse_model(graph)
        said = {name: value for name, value in (TINY_SAYS | says).items() if value is not None}
        onnx.helper.set_model_props(model, {"flexdepth": json.dumps(said)})
        path = tmp_path / file
        onnx.save(model, path)
        return path

    return make


RECORDED = Path(__file__).parent / "recorded"


@dataclass(frozen=True, eq=False)
class Film:
    """Three frames of a place in which something rigid and something that bends move, with truth.

    `flexdepth.synth.sequence` rendered them, at a tenth of a second: sequence 0 of its seed, with
    all feet in sight, else as PAIRS has it; synth 3.2 as it was on 27 November 2026. They are
    kept, for the worlds of a seed change with synth, and its textures alone take ten seconds.

    Attributes:
        before: The frame before the key frame: height x width x 3, RGB.
        key: The frame whose depth is sought.
        after: The one after it.
        right: What a camera beside that of the key frame sees.
        depth: z of the key frame, metres.
        mover: 1 where it shows what is rigid, 2 what bends.
        rotation: Of after_from_key.
        translation: Metres.
        focal: Pixels; the cameras look through the middle.
        baseline: Metres from the camera of `key` to that of `right`.
        flow: From `key` to `after`, pixels.
        hidden: Where `after` does not show the point.
        moving: Where the point itself moves until then.
        flow_before: From `key` to `before`.
        hidden_before: Where `before` does not show it.
    """

    before: np.ndarray
    key: np.ndarray
    after: np.ndarray
    right: np.ndarray
    depth: np.ndarray
    mover: np.ndarray
    rotation: np.ndarray
    translation: np.ndarray
    focal: np.ndarray
    baseline: np.ndarray
    flow: np.ndarray | None = None
    hidden: np.ndarray | None = None
    moving: np.ndarray | None = None
    flow_before: np.ndarray | None = None
    hidden_before: np.ndarray | None = None


@pytest.fixture(scope="session")
def film() -> Film:
    """Return 96 x 72 pixels of a box that is pushed and a dog that walks, with flow (seed 1015).

    The focal length is 84 pixels, the parallax asked for 1.5 to 6.
    """
    with np.load(RECORDED / "film.npz") as stored:
        return Film(**stored)


@pytest.fixture(scope="session")
def garden() -> Film:
    """Return 128 x 96 pixels of a ball that rolls and a person who walks, without flow (seed 1008).

    The focal length is 112 pixels, the parallax asked for 2 to 8: enough for estimated flow.
    """
    with np.load(RECORDED / "garden.npz") as stored:
        return Film(**stored)
