import json
import os
from pathlib import Path

import cv2
import numpy as np
import pytest
from PIL import Image

from flexdepth.cli.main import main
from flexdepth.runtime.files import read_depth
from flexdepth.scenes import files as scene_files

FILES = [
    "borders.png",
    "cloud.glb",
    "depth.npz",
    "motion.npz",
    "motion.png",
    "moving.png",
    "solution.json",
    "solution.npz",
    "solution.png",
]


@pytest.fixture
def frames(here):
    """Write two frames of a rolling wall as the camera goes to the right, and their flow."""
    row, column = np.mgrid[:72, :96].astype(np.float32)
    depth = 2 + 0.5 * np.sin(column / 11) * np.cos(row / 9)
    flow = np.zeros((72, 96, 2), np.float32)
    flow[..., 0] = -80 * 0.08 / depth
    noise = np.random.default_rng(1).uniform(0, 255, (72, 96, 3)).astype(np.float32)
    key = cv2.normalize(cv2.GaussianBlur(noise, (0, 0), 1.2), None, 0, 255, cv2.NORM_MINMAX)
    target = cv2.remap(
        key, column - flow[..., 0], row, cv2.INTER_LINEAR, borderMode=cv2.BORDER_REFLECT
    )
    for name, picture in (("a", key), ("b", target)):
        Image.fromarray(picture.astype(np.uint8)).save(f"{name}.png")
    head = np.array([202021.25], "<f4").tobytes() + np.array([96, 72], "<i4").tobytes()
    Path("a.flo").write_bytes(head + flow.tobytes())
    np.save("truth.npy", depth)
    return here


@pytest.fixture
def solve(frames, capsys):  # noqa: ARG001 - the frames lie in the current folder
    """Run `flexdepth solve a.png b.png` by geometry alone; return exit code, stdout, stderr."""

    def run(*arguments, pair=("a.png", "b.png"), prior="none"):
        extra = ("--objective", "regions", "--prior", prior)
        code = main(["solve", *pair, *extra, *map(str, arguments)])
        return code, *capsys.readouterr()

    return run


def stamps():
    return {path.name: path.stat().st_mtime_ns for path in Path("solution").iterdir()}


def test_two_frames_become_depth_motion_pictures_and_a_cloud(solve, files):
    code, out, err = solve("--flow", "a.flo", "--focal", 80)
    assert code == 0
    assert files("solution") == FILES
    assert sorted(Path(line).name for line in out.split()) == FILES
    assert "The camera went right" in err
    depth = read_depth(Path("solution/depth.npz"))
    truth = np.load("truth.npy") / 0.08  # in units of the camera's way
    known = depth.valid
    assert known.mean() > 0.9
    error = np.abs(depth.depth / truth - 1)[known]
    assert np.median(error) < 0.03


@pytest.mark.parametrize("way", ["--focal", "--fov", "--camera"])
def test_the_camera_may_be_said_in_three_ways(way, solve):
    # 48 pixels at 80 on either side of the middle; files count from the first pixel's centre.
    Path("camera.txt").write_text("80 80 47.5 35.5")
    said = {"--focal": 80, "--fov": np.degrees(2 * np.arctan(48 / 80)), "--camera": "camera.txt"}
    code, _, err = solve("--flow", "a.flo", way, said[way])
    assert code == 0
    assert "focal length" not in err
    depth = read_depth(Path("solution/depth.npz"))
    camera = depth.intrinsics
    assert (camera.focal_x, camera.focal_y) == (pytest.approx(80), pytest.approx(80))
    assert (camera.centre_x, camera.centre_y) == (pytest.approx(48), pytest.approx(36))
    error = np.abs(depth.depth * 0.08 / np.load("truth.npy") - 1)[depth.valid]
    assert np.median(error) < 0.03


def test_nothing_lies_outside_the_folder(solve):
    before = sorted(os.listdir())
    assert solve("--flow", "a.flo", "-o", "deep/er")[0] == 0
    assert sorted(os.listdir()) == sorted([*before, "deep"])


def test_what_is_there_is_not_made_again_nor_replaced_unasked(solve):
    assert solve("--flow", "a.flo", "--focal", 80)[0] == 0
    made = stamps()
    code, out, err = solve("--flow", "a.flo", "--focal", 80)
    assert (code, len(out.split())) == (0, len(FILES))
    assert "made before" in err
    assert stamps() == made
    code, _, err = solve("--flow", "a.flo", "--focal", 81)
    assert code == 2
    assert "is there already" in err
    assert stamps() == made
    assert solve("--flow", "a.flo", "--focal", 81, "--overwrite")[0] == 0
    assert all(stamps()[name] > made[name] for name in FILES)


def test_json_is_the_record_and_the_outputs(solve):
    code, out, err = solve("--flow", "a.flo", "--json")
    assert (code, err) == (0, "")
    said = json.loads(out)
    assert sorted(Path(each).name for each in said["outputs"]) == FILES
    del said["outputs"]
    assert said == json.loads(Path("solution/solution.json").read_text())
    assert said["camera_motion"]["kind"] == "general"
    assert any("the focal length is not known" in line for line in said["warnings"])


def test_ctrl_c_while_writing_leaves_no_half_file(solve, monkeypatch, files):
    def interrupted(*_):
        raise KeyboardInterrupt

    monkeypatch.setattr(scene_files, "record", interrupted)
    code, _, err = solve("--flow", "a.flo")
    assert (code, err) == (130, "flexdepth: interrupted\n")
    assert files("solution") == [name for name in FILES if name != "solution.json"]
    monkeypatch.undo()


def test_the_same_frame_twice_gives_no_depth_and_says_so(solve):
    code, _, err = solve("--focal", 80, pair=("a.png", "a.png"))
    assert code == 0
    assert "is the same picture as the key frame" in err
    assert "The camera has stood still" in err
    assert not read_depth(Path("solution/depth.npz")).valid.any()


def test_unknown_flow_is_unknown_depth_and_says_why(solve):
    content = bytearray(Path("a.flo").read_bytes())
    content[12 : 12 + 8 * 96 * 20] = np.full(2 * 96 * 20, np.nan, "<f4").tobytes()
    Path("holes.flo").write_bytes(content)
    assert solve("--flow", "holes.flo", "--focal", 80)[0] == 0
    assert not read_depth(Path("solution/depth.npz")).valid[:20].any()
    with np.load("solution/solution.npz") as maps:
        assert (maps["unknown"][:20] == 1).all()


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["--focal", 80, "--fov", 60], "--focal and --fov say the same thing"),
        (["--fov", 60, "--camera", "c.txt"], "--fov and --camera say the same thing"),
        (["--camera", "c.txt"], "c.txt: does not exist"),
        (["--flow-weights", "w.pth"], "say --flow-method raft too"),
        (["--flow-method", "raft"], "needs --flow-weights"),
        (["--flow-method", "raft", "--flow-weights", "w.pth"], "w.pth: does not exist"),
        (["--flow", "a.flo", "--flow-method", "raft"], "are two flows"),
        (["--flow", "b.flo"], "b.flo: does not exist"),
        (["--flow-noise", 2], "--flow-noise is of the flow in --flow"),
        (["--flow", "a.flo", "--flow-noise", -1], "noise is wanted in pixels, above 0"),
        (["--stereo", "b.png"], "--stereo and --baseline belong together"),
        (["--baseline", 0.5], "--stereo and --baseline belong together"),
        (["--stereo", "b.png", "--baseline", 0], "--baseline: wanted metres, above 0"),
        (["--third", "c.png"], "c.png: does not exist"),
        (["--long-side", 3], "--long-side: wanted at least 64"),
        (["-o", "a.png"], "--output-dir: a.png is a file"),
        (["--objective", "magic"], "invalid choice 'magic'"),
    ],
)
def test_a_mistake_is_told_in_one_line(arguments, said, solve):
    code, out, err = solve(*arguments)
    assert (code, out) == (2, "")
    assert said in err
    assert err.count("\n") == 1
    assert not Path("solution").exists()


def test_a_target_of_another_size_a_missing_one_and_a_video_are_told(solve, clip):
    Image.new("RGB", (50, 50)).save("small.png")
    Path("notes.txt").write_text("no picture")
    clip("film.mp4", [10, 20])
    for name, said in (
        ("small.png", "small.png: is 50x50"),
        ("none.png", "none.png: does not exist"),
        ("notes.txt", "notes.txt: is no picture"),
        ("film.mp4", "film.mp4: is a video"),
    ):
        code, _, err = solve(pair=("a.png", name))
        assert code == 2
        assert said in err
        assert err.count("\n") == 1


def test_frames_without_texture_or_with_a_cut_are_told(solve):
    Image.new("RGB", (96, 72), (90, 90, 90)).save("gray.png")
    noise = np.random.default_rng(9).uniform(0, 255, (72, 96, 3)).astype(np.uint8)
    Image.fromarray(cv2.GaussianBlur(noise, (0, 0), 2)).save("elsewhere.png")
    for name, said in (("gray.png", "no texture"), ("elsewhere.png", "is there a cut")):
        code, _, err = solve(pair=("a.png", name))
        assert code == 2
        assert said in err


@pytest.mark.usefixtures("here")
def test_one_argument_alone_asks_for_the_other(capsys):
    assert main(["solve", "a.png"]) == 2
    assert "TARGET" in capsys.readouterr().err


def test_help_fits_a_terminal_and_names_every_choice(capsys):
    with pytest.raises(SystemExit):
        main(["solve", "--help"])
    said = capsys.readouterr().out
    for word in ("--prior", "--stereo", "--baseline", "--third", "--flow-noise", "--objective"):
        assert word in said
