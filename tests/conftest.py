import json
import os
from collections.abc import Callable
from pathlib import Path

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
