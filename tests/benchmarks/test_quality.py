import json
from importlib import import_module
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from flexdepth.data.folder import Pair
from flexdepth.runtime.depthmap import DepthMap, FocalSource, Intrinsics, Space
from flexdepth.runtime.files import write_depth
from flexdepth.runtime.images import Photo

BENCHMARKS = Path(__file__).parents[2] / "benchmarks"
HEIGHT, WIDTH = 24, 32


@pytest.fixture
def room(monkeypatch):
    """Return a function that imports one of the benchmark's modules."""
    monkeypatch.syspath_prepend(BENCHMARKS)
    return import_module


@pytest.fixture
def quality(room):
    return room("quality")


def truth_of(number):
    """A tilted wall, metres."""
    return np.broadcast_to(np.linspace(1, 3 + number, WIDTH), (HEIGHT, WIDTH))


def write_nyu(folder, count=3, missing=()):
    """Lay out made-up NYU frames as docs/samples.md does; those missing have no truth in range."""
    nyu = folder / "mixed_metric3d_kitti_nyu_wild" / "nyu_demo"
    for kind in ("rgb", "depth"):
        (nyu / kind).mkdir(parents=True, exist_ok=True)
    for number in range(count):
        shade = np.full((HEIGHT, WIDTH, 3), 40 * number, np.uint8)
        Image.fromarray(shade).save(nyu / "rgb" / f"rgb_{number:05}.jpg", quality=100)
        metres = np.zeros((HEIGHT, WIDTH)) if number in missing else truth_of(number)
        steps = (metres * 1000).round().astype(np.uint16)
        Image.fromarray(steps).save(nyu / "depth" / f"sync_depth_{number:05}.png")
    return folder


def knowing(photo):
    """Predict the truth twice as large, in metres."""
    number = round(float(photo.pixels.mean()) / 40)
    return DepthMap((truth_of(number) * 2).astype(np.float32), Space.METRIC)


def disparity(photo):
    """Predict the inverse of the truth, times 5 and 3 too large."""
    found = knowing(photo)
    return DepthMap(5 / found.values + 3, Space.AFFINE_DISPARITY)


MODELS = {"compact": knowing, "other": disparity}


def run(quality, monkeypatch, *arguments):
    monkeypatch.setattr("sys.argv", ["quality.py", *map(str, arguments)])
    monkeypatch.setattr(quality, "predictor", MODELS.__getitem__)
    return quality.main()


def test_one_who_knows_is_perfect_and_the_blind_are_not(quality, monkeypatch, tmp_path, capsys):
    assert run(quality, monkeypatch, "--samples", write_nyu(tmp_path), "--json") == 0
    ((name, result),) = json.loads(capsys.readouterr().out)["sets"].items()
    assert name == "NYU"
    fits = result["scores"]
    assert set(fits["fitted in disparity"]) == {
        "compact",
        "constant",
        "best constant",
        "ramp",
        "ground plane",
    }
    # Truth is stored to the millimetre.
    for fit in ("fitted in disparity", "median scale only"):
        assert fits[fit]["compact"]["abs_rel"] < 1e-3
        assert fits[fit]["compact"]["delta1"] == 1
        assert fits[fit]["best constant"]["abs_rel"] > 0.1
    # Twice as large, and nothing is fitted.
    metres = fits["metres, nothing fitted"]
    assert metres["compact"]["abs_rel"] == pytest.approx(1, abs=1e-3)
    assert metres.keys() == {"compact", "best constant", "ground plane"}
    assert result["enlarged"] == {"compact": pytest.approx(2, abs=1e-3)}


def test_each_model_is_scored_as_far_as_its_numbers_go(quality, monkeypatch, tmp_path, capsys):
    arguments = ("--samples", write_nyu(tmp_path), "--model", "compact", "--model", "other")
    assert run(quality, monkeypatch, *arguments, "--json") == 0
    (result,) = json.loads(capsys.readouterr().out)["sets"].values()
    fits = result["scores"]
    assert fits["fitted in disparity"]["other"]["abs_rel"] < 1e-3
    assert "other" not in fits["median scale only"]
    assert "other" not in result["enlarged"]
    run(quality, monkeypatch, *arguments, "--markdown")
    head, rule, row = capsys.readouterr().out.strip().split("\n")
    assert head.count("|") == rule.count("|") == row.count("|")
    assert row.startswith("| NYU | 3 | .0")


def test_the_table_names_the_sets_that_were_skipped(quality, monkeypatch, tmp_path, capsys):
    run(quality, monkeypatch, "--samples", write_nyu(tmp_path))
    printed = capsys.readouterr()
    assert "NYU" in printed.out
    assert "pass" in printed.out
    for name in ("7-Scenes", "ICL-NUIM", "KITTI", "KITTI laser", "TUM", "SUN RGB-D", "Motorcycle"):
        assert name not in printed.out
        assert f"skipped {name}" in printed.err


def test_without_samples_it_skips_and_says_where_they_are_from(
    quality, monkeypatch, tmp_path, capsys
):
    assert run(quality, monkeypatch, "--samples", tmp_path / "nowhere") == 0
    assert "docs/samples.md" in capsys.readouterr().out


def test_sets_may_be_chosen_by_name(quality, monkeypatch, tmp_path, capsys):
    samples = write_nyu(tmp_path)
    assert run(quality, monkeypatch, "--samples", samples, "--only", "NYU") == 0
    assert capsys.readouterr().err.count("skipped") == 0
    with pytest.raises(
        quality.InputError, match="--only: no set 'Nyu'; choose some of 7-Scenes, N"
    ):
        run(quality, monkeypatch, "--samples", samples, "--only", "Nyu")


def test_a_folder_of_renders_is_scored_alone(quality, monkeypatch, tmp_path, capsys):
    (tmp_path / "image").mkdir()
    for number in range(2):
        shade = np.full((HEIGHT, WIDTH, 3), 40 * number, np.uint8)
        Image.fromarray(shade).save(tmp_path / "image" / f"{number}.png")
        camera = Intrinsics.centred(WIDTH, HEIGHT, 30.0, FocalSource.GIVEN)
        truth = DepthMap(truth_of(number).astype(np.float32), Space.METRIC, camera)
        write_depth(tmp_path / "depth" / f"{number}.npz", truth, None)
    assert run(quality, monkeypatch, "--rendered", tmp_path, "--json") == 0
    printed = capsys.readouterr()
    said = json.loads(printed.out)
    assert "skipped" not in printed.err
    assert said["sets"]["rendered"]["scores"]["median scale only"]["compact"]["delta1"] == 1
    assert said["sets"]["rendered"]["enlarged"]["compact"] == pytest.approx(2)


def test_a_set_with_too_few_frames_is_skipped(quality, monkeypatch, tmp_path, capsys):
    assert run(quality, monkeypatch, "--samples", write_nyu(tmp_path, count=2)) == 0
    assert "wanted 3 pictures with a truth, found 2" in capsys.readouterr().err


def test_a_frame_without_truth_is_left_out_and_counted(quality, monkeypatch, tmp_path, capsys):
    run(quality, monkeypatch, "--samples", write_nyu(tmp_path, missing={1}), "--json")
    (result,) = json.loads(capsys.readouterr().out)["sets"].values()
    assert (result["frames"], result["unscored"]) == (3, 1)
    assert result["scores"]["median scale only"]["compact"]["abs_rel"] < 1e-3


def test_only_strict_makes_a_missed_bar_an_error(quality, monkeypatch, tmp_path, capsys):
    samples = write_nyu(tmp_path)
    monkeypatch.setattr(quality.Result, "passed", lambda _result, _model: False)
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
def test_a_bar_asks_for_both_numbers(room, score, reached):
    score_of = room("samples").Score
    assert score_of(*score).reaches(score_of(0.1, 0.9)) is reached


def test_scores_are_written_as_in_papers(room):
    score_of = room("samples").Score
    assert str(score_of(0.1234, 1.0)) == ".123/1.000"
    assert str(score_of(10.5, 0.05)) == "10.500/.050"


@pytest.mark.parametrize(("metres", "scored"), [(0, 0), (0.001, 0), (0.002, 1), (9.9, 1), (10, 0)])
def test_truth_is_scored_between_a_millimetre_and_the_cap(room, metres, scored):
    assert room("samples").scored_pixels(np.array([[float(metres)]]), 10.0).sum() == scored


def test_the_ground_is_seen_where_a_flat_road_is(room):
    camera = Intrinsics(100.0, 100.0, 2.0, 20.5, FocalSource.GIVEN)
    ground = room("blind").ground(200, camera)
    assert ground.space is Space.METRIC
    # Row 120 looks down by 100 pixels of focal length 100: the road, 1.65 m below, is 1.65 m off.
    assert ground.depth[120, 0] == pytest.approx(1.65, rel=1e-6)
    np.testing.assert_allclose(ground.depth[:21, 0], 40, rtol=1e-6)


def test_no_other_constant_is_better_than_the_best_one(room):
    truth = np.random.default_rng(0).lognormal(0, 1, 99)
    best = room("blind").best_constant(truth)

    def error(level):
        return np.mean(abs(level - truth) / truth)

    assert all(error(best) <= error(other) for other in [*truth, best * 0.999, best * 1.001])


@pytest.mark.parametrize(
    ("name", "expected"),
    [
        ("NYU", {"ramp": (0.228, 0.631), "constant": (0.239, 0.632)}),
        ("KITTI", {"ramp": (0.210, 0.744), "ground plane": (0.127, 0.806)}),
    ],
)
def test_the_blind_reach_the_figures_of_an_independent_computation(room, samples, name, expected):
    sample_set = set_of(room, name)
    scores = room("scores")

    def flat(photo):
        return DepthMap(np.ones(photo.pixels.shape[:2], np.float32), Space.SCALE)

    pictures = scores.looked_at(sample_set.load(samples), {"model": flat})
    found = scores.score_set(sample_set, pictures).scores["fitted in disparity"]
    for predictor, numbers in expected.items():
        score = (found[predictor].abs_rel, found[predictor].delta1)
        assert score == pytest.approx(numbers, abs=6e-4)
    assert found["model"] == found["constant"]


def set_of(room, name):
    (sample_set,) = (s for s in room("samples").SETS if s.name == name)
    return sample_set


def test_a_picture_needs_the_truth_of_its_own_number(quality, monkeypatch, tmp_path, capsys):
    (truth, *_) = sorted(write_nyu(tmp_path).rglob("sync_depth_*.png"))
    truth.rename(truth.with_name("sync_depth_00007.png"))
    assert run(quality, monkeypatch, "--samples", tmp_path) == 0
    assert "wanted 3 pictures with a truth, found 2" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("name", "frames", "nearest", "farthest"),
    [
        # The ranges that ../shared/data/README.md states, or that an independent reading gives.
        ("NYU", 3, 0.7, 8.3),
        ("KITTI", 3, 5.1, 84.9),
        ("SUN RGB-D", 1, 1.06, 9.87),
        ("Motorcycle", 1, None, None),
        ("KITTI laser", 3, None, 79.0),
    ],
)
def test_real_truth_is_read_in_metres(room, samples, name, frames, nearest, farthest):
    files = set_of(room, name).load(samples)
    assert len(files) == frames
    measured = np.concatenate([each.depth.values().ravel() for each in files])
    measured = measured[np.isfinite(measured)]
    if nearest is not None:
        assert measured.min() == pytest.approx(nearest, abs=0.05)
    if farthest is not None:
        assert measured.max() == pytest.approx(farthest, abs=1 if nearest is None else 0.05)


def test_the_motorcycle_is_as_far_as_its_formula_says(room, samples):
    (file,) = set_of(room, "Motorcycle").load(samples)
    disparity = read_pfm(file.depth.path)
    expected = 0.193001 * 999.421 / (disparity + 32.778)
    known = np.isfinite(disparity)
    found = file.depth.values()
    np.testing.assert_allclose(found[known], expected[known], rtol=1e-5)
    assert np.isnan(found[~known]).all()


def read_pfm(path):
    kind, size, scale, rest = path.read_bytes().split(b"\n", 3)
    width, height = map(int, size.split())
    assert (kind, float(scale) < 0) == (b"Pf", True)
    return np.frombuffer(rest, "<f4").reshape(height, width)[::-1].astype(np.float64)


def test_an_edge_that_is_kept_scores_one_and_the_ceiling_is_below_it(room):
    truth = np.full((96, 128), 4.0)
    truth[20:70, 31:77] = 2.0
    camera = Intrinsics.centred(128, 96, 100, FocalSource.GIVEN)
    pair = Pair("step", np.zeros((96, 128, 3), np.uint8), depth_map(truth, camera))
    seen = room("scores").Seen(
        pair, {"knows": depth_map(3 * truth, camera), "flat": depth_map(np.ones_like(truth))}
    )
    found = room("boundaries").boundaries(seen, 10.0, Small())
    assert found["knows"] == pytest.approx(1)
    assert found["flat"] == 0
    assert 0.05 < found["truth, reduced"] < 0.95


class Small:
    area = (64, 48)
    multiple = 16


def depth_map(values, camera=None):
    return DepthMap(values.astype(np.float32), Space.METRIC, camera)


def test_truth_that_is_brought_back_keeps_plains_and_fills_what_is_unknown(room):
    truth = np.full((40, 60), 3.0)
    valid = np.ones((40, 60), bool)
    valid[5:9, 5:9] = False
    truth[~valid] = 0
    back = room("boundaries").there_and_back(truth, valid, (30, 20))
    np.testing.assert_allclose(back, 3.0, rtol=1e-9)


def test_the_predictors_are_told_the_true_focal_length(room):
    camera = Intrinsics.centred(WIDTH, HEIGHT, 77, FocalSource.GIVEN)
    told = []

    class File:
        def read(self):
            image = np.zeros((HEIGHT, WIDTH, 3), np.uint8)
            return Pair("one", image, depth_map(truth_of(0), camera))

    def watch(photo):
        assert isinstance(photo, Photo)
        told.append(photo.focal_in_diagonals)
        return depth_map(truth_of(0))

    list(room("scores").looked_at([File()], {"model": watch}))
    assert told == [pytest.approx(77 / np.hypot(WIDTH, HEIGHT))]
