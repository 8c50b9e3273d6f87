import errno
import json
import os
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from flexdepth.cli.main import main
from flexdepth.cli.predict import Predict
from flexdepth.runtime import photos
from flexdepth.runtime.depthmap import Space
from flexdepth.runtime.files import read_depth, read_meaning


def test_a_photo_becomes_a_depth_file_of_its_size(predict, photo):
    photo("a.png")
    code, out, err = predict("a.png", "--fov", 90)
    assert (code, out) == (0, f"{Path('depth/a.npz')}\n")
    assert err.startswith("flexdepth: 1 done in ")
    found = read_depth(Path("depth/a.npz"))
    assert (found.space, found.model) == (Space.METRIC, "tiny 1.2")
    assert found.depth.shape == (30, 40)
    np.testing.assert_allclose(found.depth, 1.2 * (20 / 50) / 0.5, rtol=1e-4)
    assert np.load("depth/a.npz")["depth"].shape == (30, 40)


def test_the_focal_length_of_the_photo_gives_metres(predict, photo):
    exif = Image.Exif()
    exif[0x8769] = {0xA405: 43}
    photo("a.jpg", exif=exif)
    assert predict("a.jpg")[0] == 0
    assert read_meaning(Path("depth/a.npz"))["space"] == "metric"
    assert read_meaning(Path("depth/a.npz"))["intrinsics"]["source"] == "exif"


def test_without_a_focal_length_depth_is_relative_and_that_is_said(predict, photo):
    photo("a.png")
    _, _, err = predict("a.png")
    assert "relative depth for 1 of 1" in err
    meaning = read_meaning(Path("depth/a.npz"))
    assert meaning["space"] == "scale"
    assert meaning["intrinsics"]["source"] == "assumed"


def test_a_bad_photo_leaves_the_others_alone(predict, photo, files):
    for name in "ac":
        photo(f"{name}.png")
    Path("b.png").write_bytes(Path("a.png").read_bytes()[:60])
    code, out, err = predict("a.png", "b.png", "c.png", "missing.png", "x*.png")
    assert code == 2
    assert files() == ["a.npz", "c.npz"]
    assert out.split() == [str(Path("depth/a.npz")), str(Path("depth/c.npz"))]
    failed = [line for line in err.splitlines() if line.startswith("flexdepth: failed: ")]
    assert [line.split(": ")[2] for line in failed] == ["x*.png", "b.png", "missing.png"]
    assert "2 done, 3 failed" in err


def test_a_batch_gives_what_single_runs_give(predict, photo):
    for name, size in zip("abcd", [(40, 30), (80, 60), (30, 40), (40, 30)], strict=True):
        photo(f"in/{name}.png", 10 + ord(name), size)
    Path("in/e.png").write_bytes(b"no picture")
    assert predict("in", "-o", "one")[0] == 2
    code, _, err = predict("in", "-o", "three", "--batch", 3)
    assert code == 2
    assert "4 done, 1 failed" in err
    for name in "abcd":
        one, three = (read_depth(Path(folder) / f"{name}.npz") for folder in ("one", "three"))
        np.testing.assert_allclose(one.values, three.values, rtol=1e-6)


def test_json_says_everything_in_one_document(predict, photo):
    photo("a.png")
    photo("b.jpg")
    Path("c.png").write_bytes(b"no picture")
    predict("b.jpg")
    Path("b.jpg").rename("b.png")
    code, out, err = predict("a.png", "b.png", "c.png", "--fov", 90, "--json")
    assert (code, err) == (2, "")
    said = json.loads(out)
    assert said["model"]["name"] == "tiny"
    assert said["counts"] == {"done": 1, "skipped": 0, "failed": 2, "in_part": 0, "not_tried": 0}
    first, second, third = said["results"]
    assert first["input"] == "a.png"
    assert first["outputs"] == [str(Path("depth/a.npz"))]
    assert (first["space"], first["unit"]) == ("metric", "m")
    assert (first["width"], first["height"], first["error"]) == (40, 30, None)
    assert first["intrinsics"]["focal_x"] == pytest.approx(20)
    assert "is there already" in second["error"]
    assert third["status"] == "failed"
    assert "c.png" in third["error"]


def test_a_photo_under_a_wrong_name_is_read_with_a_warning(predict, photo):
    photo("a.png").rename("a.jpg")
    code, _, err = predict("a.jpg")
    assert code == 0
    assert "flexdepth: a.jpg: " in err
    said = json.loads(predict("a.jpg", "-o", "other", "--json")[1])
    assert said["results"][0]["warnings"]


def test_ctrl_c_leaves_what_is_done(predict, monkeypatch, photo, files):
    for name in "abc":
        photo(f"{name}.png")
    read = photos.read_photo

    def interrupted(path, limit):
        if path.name == "b.png":
            raise KeyboardInterrupt
        return read(path, limit)

    monkeypatch.setattr(photos, "read_photo", interrupted)
    code, _, err = predict("a.png", "b.png", "c.png")
    assert code == 130
    assert files() == ["a.npz"]
    assert "stopped: 1 done, 2 not tried" in err


def test_a_full_disk_ends_the_work_and_leaves_nothing_half_written(
    predict, monkeypatch, photo, files
):
    for name in "abc":
        photo(f"{name}.png")

    def full(path, target):
        if target.name == "b.npz":
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
        replace(path, target)

    replace = os.replace
    monkeypatch.setattr(os, "replace", full)
    code, _, err = predict("a.png", "b.png", "c.png")
    assert code == 2
    assert files() == ["a.npz"]
    assert "b.npz: cannot be written: No space left on device" in err
    assert "1 done, 1 failed, 1 not tried" in err


def test_an_output_folder_that_is_a_file_is_refused(predict, photo):
    photo("a.png")
    Path("depth").touch()
    code, _, err = predict("a.png")
    assert (code, err) == (2, "flexdepth: --output-dir: depth is a file, wanted a folder\n")


def test_a_photo_of_sky_alone_has_no_points_but_its_depth(predict, photo, files):
    photo("a.png", 255)
    code, _, err = predict("a.png", "--points", "ply", "--normals")
    assert code == 2
    assert "there is nothing to write" in err
    assert files() == ["a.normals.png", "a.npz"]
    assert read_depth(Path("depth/a.npz")).sky.all()


def test_what_a_photo_that_fails_left_is_said(predict, photo):
    photo("a.png", 255)
    said = json.loads(predict("a.png", "--points", "ply", "--preview", "--json")[1])["results"][0]
    assert said["status"] == "failed"
    made = ["depth/a.npz", "depth/a.preview.png"]
    assert [Path(path).as_posix() for path in said["outputs"]] == made
    assert (said["width"], said["height"]) == (40, 30)


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["a.png", "--focal", "5", "--fov", "60"], "--focal and --fov say the same thing"),
        (["a.png", "--focal", "-5"], "a focal length is a number"),
        (["a.png", "--fov", "190"], "between 0 and 180"),
        (["a.png", "--long-side", "8"], "--long-side: wanted 32 to 4096 pixels, got 8"),
        (["a.png", "--long-side", "100000"], "--long-side: wanted 32 to 4096 pixels"),
        (["a.png", "--tiles", "0"], "--tiles: wanted a whole number >= 1, got 0"),
        (["a.png", "--batch", "0"], "--batch: wanted a whole number >= 1, got 0"),
        (["a.png", "--max-pixels", "0"], "--max-pixels: wanted"),
        (["a.png", "--max-pixels", "100"], "a.png"),
        (["a.png", "--threads", "0"], "--threads: wanted"),
        (["a.png", "--provider", "directml"], "--provider directml is not in the onnxruntime"),
        (["a.png", "--mesh"], "--mesh joins points"),
        ([], "name at least one photo"),
    ],
)
def test_a_setting_that_cannot_be_is_refused_in_a_line(predict, arguments, said, photo):
    photo("a.png")
    code, out, err = predict(*arguments)
    assert (code, out) == (2, "")
    assert said in err
    assert "Traceback" not in err
    assert not Path("depth").exists()


@pytest.mark.usefixtures("here")
def test_a_missing_bundle_is_named(capsys, photo):
    photo("a.png")
    assert main(["predict", "a.png", "--model", "nothing.onnx"]) == 2
    assert capsys.readouterr().err == ("flexdepth: nothing.onnx: does not exist; check the name\n")


def test_a_bar_shows_how_far_a_folder_is(predict, monkeypatch, photo, clip):
    for name in "abc":
        photo(f"in/{name}.png")
    clip("in/walk.mp4", [20, 60])
    monkeypatch.setenv("FORCE_COLOR", "1")
    code, out, err = predict("in", "--json")
    assert code == 0
    assert len(json.loads(out)["results"]) == 4
    assert "5/5" in err


def test_the_page_of_help_names_every_setting(capsys):
    with pytest.raises(SystemExit) as ended:
        main(["predict", "--help"])
    assert ended.value.code == 0
    page = capsys.readouterr().out
    for name in Predict.__annotations__:
        if name != "inputs":
            assert f"--{name.replace('_', '-')}" in page


def test_a_network_that_fails_is_said_of_every_photo(predict, photo, make_bundle, tiny_graph):
    make_bundle(graph=tiny_graph.replace("Add(mean, one)", "Sub(mean, one)"))
    photo("a.png")
    photo("b.png")
    code, _, err = predict("a.png", "b.png", "--batch", 2)
    assert code == 2
    assert err.count("failed: tiny.onnx: output `depth`: wanted numbers > 0") == 2


def test_a_photo_under_the_name_of_a_video_is_read_with_a_warning(predict, photo, files):
    photo("a.png").rename("a.mp4")
    code, _, err = predict("a.mp4")
    assert code == 0
    assert "flexdepth: a.mp4: holds a PNG picture in spite of its name" in err
    assert files() == ["a.npz"]


def test_a_line_end_in_a_name_leaves_the_message_one_line(predict):
    err = predict("a\nb.png")[2]
    assert err.splitlines()[0] == r"flexdepth: failed: a\nb.png: does not exist; check the name"


def test_where_no_output_can_be_looked_at_the_photo_fails(predict, photo):
    """A name may be too long for the output's suffix."""
    photo(f"{'a' * 250}.png")
    code, _, err = predict(f"{'a' * 250}.png", "--preview")
    assert code == 2
    assert "cannot be written: File name too long" in err


def test_nothing_is_predicted_for_a_folder_that_cannot_be_written(predict, photo, monkeypatch):
    photo("a.png")
    monkeypatch.setattr(os, "access", lambda *_: False)
    monkeypatch.setattr(photos, "read_photo", lambda *_: pytest.fail("read in vain"))
    code, _, err = predict("a.png")
    assert code == 2
    assert "permission denied; choose another --output-dir" in err
