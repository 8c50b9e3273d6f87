import cv2
import numpy as np
import pytest

import flexdepth
from flexdepth.cli.main import main
from flexdepth.data.catalogue import DATASETS
from flexdepth.data.folder import Folder


@pytest.fixture
def scene(tmp_path, monkeypatch):
    """Three frames of 7-Scenes, ten times as deep as the model sees them, in the current folder."""
    monkeypatch.chdir(tmp_path)
    folder = tmp_path / "redkitchen" / "seq-01"
    folder.mkdir(parents=True)
    rng = np.random.default_rng(3)
    for number in range(3):
        stem = folder / f"frame-{number:06d}"
        image = cv2.resize(rng.integers(0, 255, (6, 8, 3)).astype(np.uint8), (640, 480))
        cv2.imwrite(f"{stem}.color.png", image)
        seen = flexdepth.predict(image[..., ::-1].copy(), flexdepth.FocalLength(585.0)).values
        codes = np.clip(10 * 1000 * seen, 5000, 65000).astype(np.uint16)
        codes[0, 0] = 5000 + number
        cv2.imwrite(f"{stem}.depth.png", codes)
    (tmp_path / "redkitchen" / "TrainSplit.txt").write_text("sequence1\n")
    return tmp_path


def test_check_says_what_is_wrong_and_draws_a_sheet(scene, capsys):
    assert main(["data", "check", "7-scenes", "--root", "redkitchen", "--sheet", "s.png"]) == 2
    out, errors = capsys.readouterr()
    assert errors == ""
    lines = out.splitlines()
    assert lines[0] == "7-scenes: 3 of 3 pairs"
    assert any(line.startswith("FOUND       depth scale") for line in lines)
    assert any(line.startswith("fine        files") for line in lines)
    assert lines[-1] == "s.png: 3 of them to look at"
    assert cv2.imread(str(scene / "s.png")).shape[1] > 1400


def test_convert_makes_a_folder_that_the_folder_loader_reads(scene, capsys):
    command = ["data", "convert", "7-scenes", "--root", "redkitchen", "-o", "out"]
    assert main([*command, "--format", "png16"]) == 0
    assert capsys.readouterr().out == "out: 3 of 3 pairs written\n"
    pairs = Folder(scene / "out").load()
    assert len(pairs) == 3
    assert pairs[1].truth.values[0, 0] == np.float32(5.001)
    assert main([*command, "--format", "png16"]) == 0
    assert capsys.readouterr().out == "out: 0 of 3 pairs written\n"


@pytest.mark.parametrize(
    ("arguments", "complaint"),
    [
        (["check", "seven-scenes"], "did you mean '7-scenes'?"),
        (["check", "redkitchen"], "redkitchen/image: no such folder"),
        (["convert", "xyzzy"], "no data set 'xyzzy', and no such folder; choose one of folder"),
        ([], "say what to do with which set"),
        (["check"], "say what to do with which set"),
        (["check", "tum", "--root", "."], "its name does not say which camera"),
        (["check", "tum", "--camera", "freiburg9"], "freiburg9"),
        (["check", "7-scenes", "--root", "redkitchen", "--pairs", "0"], "--pairs is a whole"),
    ],
)
@pytest.mark.usefixtures("scene")
def test_a_slip_is_told_in_one_line(arguments, complaint, capsys):
    assert main(["data", *arguments]) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert complaint in line


def test_a_set_without_depth_is_refused(tmp_path, capsys):
    images = tmp_path / "sequences" / "00" / "image_2"
    images.mkdir(parents=True)
    cv2.imwrite(str(images / "000000.png"), np.zeros((4, 4, 3), np.uint8))
    (tmp_path / "sequences/00/calib.txt").write_text("P2: 7 0 2 0 0 7 2 0 0 0 1 0\n")
    (tmp_path / "poses").mkdir()
    (tmp_path / "poses/00.txt").write_text("1 0 0 0 0 1 0 0 0 0 1 0\n")
    assert main(["data", "check", "kitti-odometry", "--root", str(tmp_path)]) == 2
    assert "this set holds PosedImage and no images with depth maps" in capsys.readouterr().err


def test_the_help_lists_every_set(capsys):
    with pytest.raises(SystemExit):
        main(["data", "--help"])
    page = capsys.readouterr().out
    assert set(DATASETS) <= set(page.split())
    assert max(map(len, page.splitlines())) <= 80


@pytest.mark.parametrize("verb", ["check", "convert"])
@pytest.mark.parametrize("name", DATASETS)
def test_a_sets_own_settings_are_options(name, verb, capsys):
    with pytest.raises(SystemExit):
        main(["data", verb, name, "--help"])
    page = capsys.readouterr().out
    assert "--root" in page
    assert f"flexdepth data {verb} {name}" in page
