import subprocess
import sys

import numpy as np
import pytest

import flexdepth
from flexdepth.runtime import model
from flexdepth.runtime.errors import InputError


@pytest.fixture
def bundled(make_bundle, monkeypatch):
    """Take the tiny bundle for the one that comes with flexdepth."""
    path = make_bundle()
    monkeypatch.setattr(model, "bundled_file", lambda: path)
    flexdepth._bundled.cache_clear()
    yield path
    flexdepth._bundled.cache_clear()


@pytest.mark.usefixtures("bundled")
def test_one_call_gives_the_depth_of_a_picture():
    found = flexdepth.predict(np.full((30, 40, 3), 51, np.uint8), flexdepth.FieldOfView(90))
    assert found.space is flexdepth.Space.METRIC
    assert found.depth.shape == (30, 40)
    np.testing.assert_allclose(found.depth, 1.2 * (20 / 50) / 0.5, rtol=1e-5)


@pytest.mark.usefixtures("bundled")
def test_the_bundled_model_is_loaded_once():
    assert flexdepth.load().model is flexdepth.load("compact", flexdepth.FocalLength(5)).model


def test_a_bundle_is_loaded_by_its_path(make_bundle):
    assert flexdepth.load(make_bundle()).model.title == "tiny 1.2"
    assert flexdepth.load(str(make_bundle())).model.title == "tiny 1.2"
    with pytest.raises(InputError, match=r"nothing\.onnx: does not exist"):
        flexdepth.load("nothing.onnx")


def test_every_public_name_is_there():
    for name in flexdepth.__all__:
        assert getattr(flexdepth, name).__name__ == name
    with pytest.raises(AttributeError, match="no attribute 'depht'"):
        _ = flexdepth.depht


def test_importing_flexdepth_loads_nothing_heavy():
    script = "import sys, flexdepth; print(*sys.modules)"
    loaded = subprocess.run(
        [sys.executable, "-c", script], capture_output=True, text=True, check=True
    ).stdout.split()
    assert not {"torch", "onnxruntime", "cv2", "numpy", "PIL", "av", "trimesh"} & set(loaded)


def test_predicting_loads_no_torch(make_bundle):
    script = (
        "import sys, numpy, flexdepth\n"
        f"flexdepth.load({str(make_bundle())!r}).predict(numpy.zeros((3, 4, 3), numpy.uint8))\n"
        "print(*sys.modules)"
    )
    loaded = subprocess.run(
        [sys.executable, "-c", script], capture_output=True, text=True, check=True
    ).stdout.split()
    assert "onnxruntime" in loaded
    assert not {"torch", "onnx", "av", "trimesh", "tyro"} & set(loaded)
