"""What the benchmarks on real pairs say where the pictures are not there."""

import sys
from importlib import import_module
from pathlib import Path

import pytest
import yaml

BENCHMARKS = Path(__file__).parents[2] / "benchmarks"
DRIVE = Path("driving_kitti_odometry_gray51")
BOXES = yaml.safe_load((BENCHMARKS / "solve" / "boxes.yaml").read_text("utf-8"))


@pytest.fixture
def told(monkeypatch, tmp_path, capsys):
    """Return what runs a benchmark on the samples in a folder: its exit code and its one line."""
    for folder in (BENCHMARKS, BENCHMARKS / "solve"):
        monkeypatch.syspath_prepend(folder)

    def run(name, *words):
        monkeypatch.setattr(sys, "argv", [name, "--samples", str(tmp_path), *words])
        code = import_module(name).main()
        out, err = capsys.readouterr()
        assert err == ""
        (line,) = out.splitlines()
        return code, line

    return run


@pytest.mark.parametrize(("words", "code"), [((), 0), (("--strict",), 1), (("--json",), 0)])
@pytest.mark.parametrize(
    ("name", "lacking"), [("ego_motion", DRIVE / "calib.txt"), ("real", Path(BOXES[0]["key"]))]
)
def test_samples_that_are_not_there_are_named_in_one_line(
    name, lacking, words, code, told, tmp_path
):
    found, line = told(name, *words)
    assert found == code
    assert line.startswith(f"skipped: {tmp_path / lacking} is missing; docs/samples.md says where")


def test_a_frame_that_is_not_there_is_named(told, tmp_path):
    drive = tmp_path / DRIVE
    drive.mkdir()
    row = " ".join(map(str, (1.0, 0, 0, 0, 0, 1.0, 0, 0, 0, 0, 1.0, 0)))
    for name in ("calib.txt", "poses.txt"):
        (drive / name).write_text(f"{row}\n{row}\n")
    assert str(Path("image_l") / "000000.png") in told("ego_motion", "--pairs", "1")[1]
