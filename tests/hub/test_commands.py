"""hub: models where a user names them."""

import json
import shutil

import numpy as np
import pytest
from PIL import Image

from flexdepth.cli.main import main
from flexdepth.runtime.depthmap import DepthMap, FocalSource, Intrinsics, Space
from flexdepth.runtime.files import read_depth, write_depth


@pytest.fixture
def here(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    return tmp_path


def test_predict_writes_the_disparity_of_a_photo_at_its_own_size(here, saved, picture, capsys):
    Image.fromarray(picture).save("photo.png")
    shutil.copytree(saved("depth_anything"), here / "mine")
    assert main(["predict", "photo.png", "--model", "hub:./mine", "--preview"]) == 0
    found = read_depth(here / "depth" / "photo.npz")
    assert found.disparity.shape == picture.shape[:2]
    assert found.model == "mine"
    with Image.open("depth/photo.preview.png") as preview:
        assert preview.width == picture.shape[1]
    capsys.readouterr()
    main(["predict", "photo.png", "--model", "hub:./mine"])
    assert "1 skipped" in capsys.readouterr().err


def test_the_licence_is_printed_before_the_work(here, saved, picture, capsys):
    Image.fromarray(picture).save(here / "photo.png")
    arguments = ["predict", "photo.png", "--model", f"hub:{saved('depth_pro')}", "--json"]
    capsys.readouterr()
    assert main(arguments) == 0
    said = capsys.readouterr()
    assert said.err.startswith("flexdepth: depth_pro: the licence apple-amlr of its weights forb")
    assert json.loads(said.out)["model"]["licence"] == "apple-amlr"


def write_set(folder, count):
    """A plain folder of noise, a tilted wall in front of a known camera."""
    random = np.random.default_rng(0)
    camera = Intrinsics.centred(48, 32, 40, FocalSource.GIVEN)
    wall = np.tile(np.linspace(2, 5, 48, dtype=np.float32), (32, 1))
    for number in range(count):
        (folder / "image").mkdir(parents=True, exist_ok=True)
        pixels = random.integers(0, 256, (32, 48, 3), np.uint8)
        Image.fromarray(pixels).save(folder / "image" / f"{number}.png")
        write_depth(folder / "depth" / f"{number}.npz", DepthMap(wall, Space.METRIC, camera))


def test_evaluate_fits_disparity_as_its_space_needs_and_keeps_the_predictions(here, saved, capsys):
    write_set(here / "walls", 2)
    model = f"hub:{saved('depth_anything')}"
    assert main(["evaluate", model, "walls"]) == 2
    assert "--alignment, or a protocol that fits so" in capsys.readouterr().err
    assert main(["evaluate", model, "walls", "--protocol", "affine-disparity"]) == 0
    (result,) = here.rglob("result.json")
    record = json.loads(result.read_text())
    assert record["predictions"]["name"] == "depth_anything"
    assert record["predictions"]["sizes"] == {"48x32 affine_disparity": 2}
    assert len(list(here.rglob("predictions/whole/*.npz"))) == 2


def test_evaluate_notes_a_licence_that_forbids_commercial_use(here, saved, capsys):
    write_set(here / "walls", 1)
    assert main(["evaluate", f"hub:{saved('depth_pro')}", "walls", "--worst", "0"]) == 0
    assert "apple-amlr" in capsys.readouterr().out
    (result,) = here.rglob("result.json")
    assert any("apple-amlr" in each for each in json.loads(result.read_text())["remarks"])
