import json
import os
from contextlib import suppress
from pathlib import Path

import av
import numpy as np
import pytest

from flexdepth.runtime.depthmap import Space
from flexdepth.runtime.errors import InputError
from flexdepth.runtime.files import read_depth
from flexdepth.runtime.video import read_frames, writing_video


def test_a_video_becomes_a_folder_of_depth_files(predict, clip, files):
    clip("in/walk.mp4", [20, 60, 100])
    code, out, err = predict("in", "--fov", 90, "--preview")
    assert code == 0
    assert out.split() == [str(Path("depth/walk")), str(Path("depth/walk.preview.mp4"))]
    assert files() == ["walk.preview.mp4", *(f"walk/00000{index}.npz" for index in range(3))]
    for index, level in enumerate([20, 60, 100]):
        found = read_depth(Path(f"depth/walk/00000{index}.npz"))
        assert found.space is Space.METRIC
        wanted = (1 + level / 255) * (32 / 80) / 0.5
        np.testing.assert_allclose(found.depth, wanted, atol=0.02)
    assert "1 done" in err


def test_one_colour_scale_holds_over_a_clip(predict, clip):
    clip("walk.mp4", [20, 120, 220])
    assert predict("walk.mp4", "--preview")[0] == 0
    brightness = [frame[:40].mean() for frame in read_frames(Path("depth/walk.preview.mp4"))]
    assert brightness[0] > brightness[1] + 20 > brightness[2] + 40


def test_a_video_that_was_interrupted_is_taken_up_where_it_was_left(predict, clip, stamps):
    clip("walk.mp4", [20, 60, 100, 140])
    predict("walk.mp4", "--preview", "--batch", 3)
    before = stamps()
    assert "1 skipped" in predict("walk.mp4", "--preview")[2]
    assert stamps() == before
    Path("depth/walk/000002.npz").unlink()
    assert "1 done" in predict("walk.mp4", "--preview")[2]
    after = stamps()
    changed = {path.name for path in after if after[path] != before[path]}
    assert changed == {"000002.npz", "walk.preview.mp4"}
    code, _, err = predict("walk.mp4", "--fov", 70)
    assert code == 2
    assert "000000.npz: is there already" in err


@pytest.fixture
def stopped_at(monkeypatch):
    """Return a function that lets Ctrl-C come when a file of this name is to be written."""

    def stop(name):
        def interrupted(path, target):
            if target.name == name:
                raise KeyboardInterrupt
            replace(path, target)

        replace = os.replace
        monkeypatch.setattr(os, "replace", interrupted)

    return stop


def test_ctrl_c_in_a_video_leaves_and_tells_its_frames_so_far(predict, clip, photo, stopped_at):
    clip("walk.mp4", [20, 60, 100, 140])
    photo("a.png")
    stopped_at("000002.npz")
    code, out, _ = predict("walk.mp4", "a.png", "--json")
    assert code == 130
    said = json.loads(out)
    (result,) = said["results"]
    assert (result["status"], result["frames"]) == ("in part", 2)
    assert [Path(path).as_posix() for path in result["outputs"]] == ["depth/walk"]
    assert (said["stopped"], said["counts"]["in_part"], said["counts"]["not_tried"]) == (True, 1, 1)
    assert "stopped: 1 in part, 1 not tried" in predict("walk.mp4", "a.png")[2]


def test_ctrl_c_before_the_first_frame_leaves_a_video_untried(predict, clip, stopped_at):
    clip("walk.mp4", [20, 60])
    stopped_at("000000.npz")
    code, _, err = predict("walk.mp4")
    assert code == 130
    assert "stopped: 1 not tried" in err


@pytest.mark.parametrize("terminal", [False, True])
def test_ctrl_c_in_a_preview_leaves_the_frames(
    terminal, predict, clip, files, stopped_at, monkeypatch
):
    if terminal:
        monkeypatch.setenv("FORCE_COLOR", "1")
    clip("walk.mp4", [20, 60])
    stopped_at("walk.preview.mp4")
    code, _, err = predict("walk.mp4", "--preview")
    assert code == 130
    assert "stopped: 1 in part" in err
    assert files() == ["walk/000000.npz", "walk/000001.npz"]


def test_a_shorter_clip_leaves_no_frame_of_the_longer_one_it_replaces(predict, clip, files):
    outputs = ("--format", "npy", "--normals")
    clip("walk.mp4", [20, 60, 100, 140])
    predict("walk.mp4", *outputs)
    Path("depth/walk/000004.npy").write_bytes(b"somebody's")
    clip("walk.mp4", [140, 60])
    assert predict("walk.mp4", *outputs, "--overwrite")[0] == 0
    made = [
        f"walk/00000{index}.{end}" for index in (0, 1) for end in ("json", "normals.png", "npy")
    ]
    assert files() == [*made, "walk/000004.npy"]


def test_a_clip_without_overwrite_removes_nothing(predict, clip, files):
    clip("walk.mp4", [20, 60, 100])
    predict("walk.mp4")
    before = files()
    clip("walk.mp4", [20])
    assert predict("walk.mp4")[0] == 2
    assert files() == before


@pytest.mark.parametrize("batch", [1, 7])
def test_the_frames_before_a_break_are_kept(predict, batch, photo, files):
    rng = np.random.default_rng(0)
    with writing_video(Path("walk.mkv"), 10) as video:
        for _ in range(60):
            video.write(rng.integers(0, 250, (48, 64, 3), np.uint8))
    with av.open("walk.mkv") as source, av.open("cut.mkv", "w") as target:
        stream = target.add_stream_from_template(source.streams.video[0])
        for packet in source.demux(video=0):
            if packet.dts is not None:
                packet.stream = stream
                target.mux(packet)
    whole = Path("cut.mkv").read_bytes()
    Path("cut.mkv").write_bytes(whole[: len(whole) // 2])
    photo("a.png")
    code, _, err = predict("cut.mkv", "a.png", "--preview", "--batch", batch)
    assert code == 2
    assert "failed: cut.mkv: the video breaks off after" in err
    assert "1 done, 1 failed" in err
    kept = len(files("depth/cut"))
    assert 10 < kept < 60
    assert kept == good_frames("cut.mkv")
    assert len(list(read_frames(Path("depth/cut.preview.mp4")))) == kept
    said = json.loads(predict("cut.mkv", "--preview", "--json")[1])["results"][0]
    assert (said["status"], said["frames"]) == ("failed", kept)


def test_a_file_that_is_no_video_is_refused(predict):
    Path("walk.mp4").write_bytes(b"no video" * 100)
    code, _, err = predict("walk.mp4")
    assert code == 2
    assert "failed: walk.mp4: is no video" in err
    assert not Path("depth").exists()


def good_frames(path):
    count = 0
    with suppress(InputError):
        for _ in read_frames(Path(path)):
            count += 1
    return count
