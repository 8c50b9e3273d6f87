import hashlib
import json
from dataclasses import replace

import cv2
import numpy as np
import pytest

from flexdepth.runtime.errors import InputError
from flexdepth.runtime.files import read_depth
from flexdepth.runtime.images import read_photo
from flexdepth.synth.generate import SynthSettings
from flexdepth.synth.motion import Motion
from flexdepth.synth.sequence import SequenceSettings, sequence
from flexdepth.synth.sequence_files import write_sequence, write_sequences
from flexdepth.synth.sheet import write_sequence_sheet

SETTINGS = SequenceSettings(
    SynthSettings(seed=3, width=64, height=48),
    Motion(frames=2, parallax=(1.0, 4.0), rigid=(1, 1), flexible=(0, 1)),
)


def read_flow(path):
    return cv2.readOpticalFlow(str(path))


def digests(folder):
    files = sorted(path for path in folder.rglob("*") if path.is_file())
    return {p.relative_to(folder): hashlib.sha256(p.read_bytes()).hexdigest() for p in files}


@pytest.fixture(scope="module")
def world(tmp_path_factory):
    folder = tmp_path_factory.mktemp("sequences")
    assert list(write_sequences(SETTINGS, 2, folder, 1)) == [2]
    return folder


def test_two_runs_give_the_same_bytes_and_an_incomplete_sequence_is_written_again(world, tmp_path):
    write_sequence(SETTINGS, 1, tmp_path)
    assert digests(tmp_path) == digests(world / "000001")
    (tmp_path / "sequence.json").unlink()
    (tmp_path / "flow" / "0000.flo").unlink()
    write_sequence(SETTINGS, 1, tmp_path)
    assert digests(tmp_path) == digests(world / "000001")


def test_a_complete_sequence_is_left_alone(world):
    said = world / "000000" / "sequence.json"
    before = said.stat().st_mtime_ns
    write_sequence(SETTINGS, 0, said.parent)
    assert said.stat().st_mtime_ns == before


def test_the_files_hold_the_sequence(world):
    folder = world / "000000"
    frames = sequence(SETTINGS, 0)
    poses = np.loadtxt(folder / "poses.txt").reshape(-1, 3, 4)
    for number, frame in enumerate(frames):
        name = f"{number:04d}"
        depth = read_depth(folder / "depth" / f"{name}.npz")
        assert depth.values == pytest.approx(frame.depth, rel=1e-7)
        assert depth.intrinsics.focal_x == pytest.approx(frame.camera.focal)
        assert read_photo(folder / "image" / f"{name}.jpg").pixels.shape == (48, 64, 3)
        mover = cv2.imread(str(folder / "mover" / f"{name}.png"), cv2.IMREAD_UNCHANGED)
        assert (mover == frame.mover).all()
        assert (poses[number, :, 3] == frame.camera.view.eye).all()
        assert (poses[number, :, :3] == frame.camera.view.world_from_camera).all()
    for suffix, name, way in (
        ("", "0000", frames[0].forward),
        ("_back", "0001", frames[1].backward),
    ):
        flow = read_flow(folder / f"flow{suffix}" / f"{name}.flo")
        assert flow == pytest.approx(np.nan_to_num(way.flow, nan=1e10), rel=1e-6, abs=1e-6)
        with np.load(folder / f"points{suffix}" / f"{name}.npz") as points:
            assert (points["occluded"] == way.occluded).all()
            assert (points["moving"] == way.moving).all()
            assert points["motion"] == pytest.approx(way.motion, abs=1e-6)
    assert not (folder / "flow" / "0001.flo").exists()


def test_the_files_agree_by_reprojection_to_a_ten_thousandth_of_a_pixel(world):
    """As somebody would who has only the files and their description."""
    for folder in (world / "000000", world / "000001"):
        said = json.loads((folder / "sequence.json").read_text())
        poses = np.loadtxt(folder / "poses.txt").reshape(-1, 3, 4)
        for suffix, here, there in (("", 0, 1), ("_back", 1, 0)):
            depth = read_depth(folder / "depth" / f"{here:04d}.npz").values.astype(float)
            motion = np.load(folder / f"points{suffix}" / f"{here:04d}.npz")["motion"]
            flow = read_flow(folder / f"flow{suffix}" / f"{here:04d}.flo")
            row, column = np.mgrid[:48, :64].astype(float)
            place = np.stack([column, row], -1)
            ray = np.append((place - said["centre"]) / said["focal"], np.ones((48, 64, 1)), axis=2)
            near = np.isfinite(depth) & (np.abs(flow) < 1e9).all(-1)
            point = (ray * depth[..., None] + motion)[near]
            world_point = point @ poses[here, :, :3].T + poses[here, :, 3]
            seen = (world_point - poses[there, :, 3]) @ poses[there, :, :3]
            image = said["focal"] * seen[:, :2] / seen[:, 2:] + said["centre"]
            # Where a point nearly passes the camera its flow is long, and single precision ends.
            short = np.linalg.norm(flow[near], axis=1) < 64
            assert np.abs(image - place[near] - flow[near])[short].max() < 1e-4
            assert short.mean() > 0.9


def test_what_moves_is_named(world):
    said = json.loads((world / "000000" / "sequence.json").read_text())
    assert said["centre"] == [31.5, 23.5]
    assert all(1 <= value <= 4 for value in said["parallax"])
    assert said["movers"][0]["flexible"] is False
    assert said["camera"] in ("hand", "robot", "car")
    filled = cv2.imread(str(world / "000000" / "mover" / "0000.png"), cv2.IMREAD_UNCHANGED) == 1
    assert said["movers"][0]["share"] == pytest.approx(filled.mean())


def test_sequences_of_two_worlds_do_not_mix(world):
    other = replace(SETTINGS, motion=replace(SETTINGS.motion, rate=5.0))
    with pytest.raises(InputError, match=r"world\.json: the images here are of another world"):
        list(write_sequences(other, 1, world, 1))


def test_a_sheet_has_a_row_for_each_sequence(world):
    sheet = read_photo(write_sequence_sheet(world, 2)).pixels
    assert sheet.shape == (2 * 120, 5 * 160, 3)
    assert (sheet[:120] != sheet[120:]).any()
