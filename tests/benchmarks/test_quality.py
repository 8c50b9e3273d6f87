import json
from importlib import import_module
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from flexdepth.runtime.depthmap import DepthMap, FocalSource, Intrinsics, Space

BENCHMARKS = Path(__file__).parents[2] / "benchmarks"
HEIGHT, WIDTH = 24, 32


@pytest.fixture
def quality(monkeypatch):
    monkeypatch.syspath_prepend(BENCHMARKS)
    return import_module("quality")


def truth_of(number):
    """A tilted wall, metres."""
    return np.broadcast_to(np.linspace(1, 3 + number, WIDTH), (HEIGHT, WIDTH))


def write_nyu(folder, count=3, missing=()):
    """Lay out made-up NYU frames as docs/samples.md does; those missing have no truth in range."""
    nyu = folder / "mixed_metric3d_kitti_nyu_wild" / "nyu_demo"
    for kind in ("rgb", "depth"):
        (nyu / kind).mkdir(parents=True, exist_ok=True)
    for number in range(count):
        shade = np.full((HEIGHT, WIDTH, 3), number, np.uint8)
        Image.fromarray(shade).save(nyu / "rgb" / f"rgb_{number:05}.jpg", quality=100)
        metres = np.zeros((HEIGHT, WIDTH)) if number in missing else truth_of(number)
        steps = (metres * 1000).round().astype(np.uint16)
        Image.fromarray(steps).save(nyu / "depth" / f"sync_depth_{number:05}.png")
    return folder


def knowing(path):
    """Predict the truth, up to scale."""
    number = int(path.stem.removeprefix("rgb_"))
    return DepthMap((truth_of(number) * 0.1).astype(np.float32), Space.SCALE)


def run(quality, monkeypatch, *arguments):
    monkeypatch.setattr("sys.argv", ["quality.py", *map(str, arguments)])
    monkeypatch.setattr(quality, "predictor", lambda _bundle: knowing)
    return quality.main()


def test_one_who_knows_is_perfect_and_the_blind_are_not(quality, monkeypatch, tmp_path, capsys):
    assert run(quality, monkeypatch, "--samples", write_nyu(tmp_path), "--json") == 0
    (result,) = json.loads(capsys.readouterr().out).values()
    assert result["scores"].keys() == {"model", "constant", "vertical ramp", "ground plane"}
    # Truth is stored to the millimetre.
    assert result["scores"]["model"]["abs_rel"] < 1e-3
    assert result["scores"]["model"]["delta1"] == 1
    assert result["passed"]
    assert result["scores"]["constant"]["abs_rel"] > 0.1


def test_the_table_names_the_sets_that_were_skipped(quality, monkeypatch, tmp_path, capsys):
    run(quality, monkeypatch, "--samples", write_nyu(tmp_path))
    printed = capsys.readouterr()
    assert "NYU" in printed.out
    assert "pass" in printed.out
    for name in ("7-Scenes", "ICL-NUIM", "KITTI"):
        assert name not in printed.out
        assert f"skipped {name}" in printed.err


def test_without_samples_it_skips_and_says_where_they_are_from(
    quality, monkeypatch, tmp_path, capsys
):
    assert run(quality, monkeypatch, "--samples", tmp_path / "nowhere") == 0
    assert "docs/samples.md" in capsys.readouterr().out


def test_a_set_with_too_few_frames_is_skipped(quality, monkeypatch, tmp_path, capsys):
    assert run(quality, monkeypatch, "--samples", write_nyu(tmp_path, count=2)) == 0
    assert "wanted 3 pictures with a truth, found 2" in capsys.readouterr().err


def test_a_frame_without_truth_is_left_out_and_counted(quality, monkeypatch, tmp_path, capsys):
    run(quality, monkeypatch, "--samples", write_nyu(tmp_path, missing={1}), "--json")
    (result,) = json.loads(capsys.readouterr().out).values()
    assert (result["frames"], result["unscored"]) == (3, 1)
    assert result["scores"]["model"]["abs_rel"] < 1e-3


def test_only_strict_makes_a_missed_bar_an_error(quality, monkeypatch, tmp_path, capsys):
    samples = write_nyu(tmp_path)
    monkeypatch.setattr(quality.Score, "reaches", lambda _score, _bar: False)
    assert run(quality, monkeypatch, "--samples", samples) == 0
    assert "MISS" in capsys.readouterr().out
    assert run(quality, monkeypatch, "--samples", samples, "--strict") == 1


def test_the_pictures_are_written_side_by_side(quality, monkeypatch, tmp_path):
    run(quality, monkeypatch, "--samples", write_nyu(tmp_path), "--pictures", tmp_path / "out")
    names = sorted(path.name for path in (tmp_path / "out").iterdir())
    assert names == ["NYU-rgb_00000.png", "NYU-rgb_00001.png", "NYU-rgb_00002.png"]
    with Image.open(tmp_path / "out" / names[0]) as sheet:
        assert sheet.width >= 3 * WIDTH


@pytest.mark.parametrize(
    ("score", "reached"), [((0.1, 0.9), True), ((0.11, 0.9), False), ((0.1, 0.89), False)]
)
def test_a_bar_asks_for_both_numbers(quality, score, reached):
    assert quality.Score(*score).reaches(quality.Score(0.1, 0.9)) is reached


def test_scores_are_written_as_in_papers(quality):
    assert str(quality.Score(0.1234, 1.0)) == ".123/1.000"
    assert str(quality.Score(10.5, 0.05)) == "10.500/.050"


@pytest.mark.parametrize(("metres", "scored"), [(0, 0), (0.001, 0), (0.002, 1), (9.9, 1), (10, 0)])
def test_truth_is_scored_between_a_millimetre_and_the_cap(quality, metres, scored):
    assert quality.scored_pixels(np.array([[float(metres)]]), 10.0).sum() == scored


def test_the_ground_is_seen_where_a_flat_road_is(quality):
    camera = Intrinsics(100.0, 100.0, 2.0, 20.5, FocalSource.GIVEN)
    ground = quality.blind((200, 4), camera)["ground plane"].disparity[:, 0]
    # Row 120 looks down by 100 pixels of focal length 100: the road, 1.65 m below, is 1.65 m off.
    assert 1 / ground[120] == pytest.approx(1.65, rel=1e-6)
    np.testing.assert_allclose(1 / ground[:21], 40, rtol=1e-6)


@pytest.mark.parametrize(
    ("name", "expected"),
    [
        ("NYU", {"vertical ramp": (0.228, 0.631), "constant": (0.239, 0.632)}),
        ("KITTI", {"vertical ramp": (0.210, 0.744), "ground plane": (0.127, 0.806)}),
    ],
)
def test_the_blind_reach_the_figures_of_an_independent_computation(
    quality, samples, name, expected
):
    (sample_set,) = (s for s in quality.SETS if s.name == name)

    def flat(path):
        with Image.open(path) as picture:
            return DepthMap(np.ones(picture.size[::-1], np.float32), Space.SCALE)

    found = quality.score_set(sample_set, quality.frames(samples, sample_set), flat).scores
    for predictor, numbers in expected.items():
        score = (found[predictor].abs_rel, found[predictor].delta1)
        assert score == pytest.approx(numbers, abs=6e-4)
    assert found["model"] == found["constant"]


def test_a_picture_needs_the_truth_of_its_own_number(quality, monkeypatch, tmp_path, capsys):
    (truth, *_) = sorted(write_nyu(tmp_path).rglob("sync_depth_*.png"))
    truth.rename(truth.with_name("sync_depth_00007.png"))
    assert run(quality, monkeypatch, "--samples", tmp_path) == 0
    assert "wanted 3 pictures with a truth, found 2" in capsys.readouterr().err


@pytest.mark.parametrize(("name", "nearest", "farthest"), [("NYU", 0.7, 8.3), ("KITTI", 5.1, 84.9)])
def test_real_truth_is_read_in_metres(quality, samples, name, nearest, farthest):
    (sample_set,) = (s for s in quality.SETS if s.name == name)
    truths = [
        quality.read_truth(frame.truth, sample_set.steps_per_metre)
        for frame in quality.frames(samples, sample_set)
    ]
    measured = np.concatenate([truth[truth > 0] for truth in truths])
    assert (measured.min(), measured.max()) == pytest.approx((nearest, farthest), abs=0.05)


def test_metres_are_too_large_by_the_factor_that_the_focal_length_leaves(quality):
    sample_set = quality.SETS[0]
    truth = np.full((480, 640), 2.0)
    half = Intrinsics.centred(640, 480, sample_set.camera.focal_x / 2, FocalSource.ASSUMED)
    seen = DepthMap(np.full((480, 640), 3.0, np.float32), Space.SCALE, half)
    assert quality.enlarged(truth, sample_set, seen) == pytest.approx(3.0)
    blind = DepthMap(np.ones((480, 640), np.float32), Space.AFFINE_DISPARITY, half)
    assert quality.enlarged(truth, sample_set, blind) is None
