import json
import re

import numpy as np
import pytest
from PIL import Image

from flexdepth.data.folder import Pair
from flexdepth.runtime.depthmap import DepthMap, FocalSource, Intrinsics, Space
from flexdepth.runtime.files import write_depth
from flexdepth.runtime.images import Photo

HEIGHT, WIDTH = 24, 32


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


def exact(photo):
    """Predict the truth."""
    found = knowing(photo)
    return DepthMap(found.values / 2, Space.METRIC)


MODELS = {"compact": knowing, "other": disparity, "exact": exact}


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


def test_only_strict_makes_a_missed_bar_an_error(room, quality, monkeypatch, tmp_path):
    samples = write_nyu(tmp_path)
    assert run(quality, monkeypatch, "--samples", samples) == 0
    assert run(quality, monkeypatch, "--samples", samples, "--strict") == 1
    assert run(quality, monkeypatch, "--samples", samples, "--strict", "--model", "exact") == 0
    bars = room("bars")
    missed = bars.Bar("no better than the blind", 0.2, bars.Limit("<", 0.2))
    monkeypatch.setattr(quality, "beside_the_blind", lambda *_: [missed])
    assert run(quality, monkeypatch, "--samples", samples, "--strict", "--model", "exact") == 1


def test_the_bars_follow_the_tables(quality, monkeypatch, tmp_path, capsys):
    samples = write_nyu(tmp_path)
    run(quality, monkeypatch, "--samples", samples, "--model", "compact", "--model", "exact")
    head, *rows = capsys.readouterr().out.strip().split("\n\n")[-1].split("\n")
    assert head.split() == ["bars", "for", "compact", "asked", "measured"]
    said = [re.split("  +", row) for row in rows]
    # Twice as large as the truth: worse than the blind in metres, and best once it is fitted.
    assert [(name, limit, mark) for name, limit, _, mark in said[:-2]] == [
        ("NYU, fitted in disparity: AbsRel", "<= .13", "pass"),
        ("NYU, fitted in disparity: delta1", ">= .83", "pass"),
        ("NYU, median scale only: AbsRel", "<= .16", "pass"),
        ("NYU, median scale only: delta1", ">= .78", "pass"),
        ("NYU, metres, nothing fitted: AbsRel", "<= .2", "MISS"),
        ("figures better than best constant, ramp and ground plane", ">= 6", "MISS"),
    ]
    assert said[5][2] == "4"
    assert [(name, mark) for name, _, _, mark in said[-2:]] == [
        ("NYU, metres, nothing fitted: AbsRel beside the blind", "MISS"),
        ("NYU, metres, nothing fitted: delta1 beside the blind", "MISS"),
    ]
    run(quality, monkeypatch, "--samples", samples, "--markdown")
    assert "bars" not in capsys.readouterr().out


def test_the_record_holds_every_bar_of_the_first_model(quality, monkeypatch, tmp_path, capsys):
    samples = write_nyu(tmp_path)
    run(quality, monkeypatch, "--samples", samples, "--model", "other", "--json")
    said = json.loads(capsys.readouterr().out)
    bars = {each["name"]: each for each in said["bars"]}
    # Five that are asked, and two for the one figure that disparity allows.
    assert len(bars) == 7
    fitted = bars["NYU, fitted in disparity: AbsRel"]
    (found,) = (each["scores"]["fitted in disparity"] for each in said["sets"].values())
    assert fitted["measured"] == found["other"]["abs_rel"]
    assert (fitted["asked"], fitted["met"]) == ("<= .13", True)
    metres = bars["NYU, metres, nothing fitted: AbsRel"]
    assert (metres["measured"], metres["met"]) == (None, False)


def result_of(room, scores):
    """Return a result: AbsRel and delta1 by fit, then by who predicted."""
    score_of = room("samples").Score
    fits = ("fitted in disparity", "median scale only", "metres, nothing fitted")
    return room("scores").Result(
        frames=1,
        unscored=0,
        scores={
            fit: {who: score_of(*numbers) for who, numbers in scores.get(fit, {}).items()}
            for fit in fits
        },
        enlarged={},
    )


ASKED = {
    ("7-Scenes", "fitted in disparity"): (0.15, 0.76),
    ("NYU", "fitted in disparity"): (0.13, 0.83),
    ("ICL-NUIM", "fitted in disparity"): (0.08, 0.93),
    ("KITTI", "fitted in disparity"): (0.115, 0.85),
    ("NYU", "median scale only"): (0.16, 0.78),
    ("KITTI", "median scale only"): (0.135, 0.81),
    ("NYU", "metres, nothing fitted"): (0.2, 0),
    ("KITTI", "metres, nothing fitted"): (0.15, 0),
}


@pytest.mark.parametrize(("worse", "met"), [(0.0, True), (1e-4, False)])
def test_what_is_asked_is_met_exactly_and_not_beyond(room, worse, met):
    results = {
        name: result_of(
            room,
            {
                fit: {"model": (abs_rel + worse, delta1 - worse)}
                for (of, fit), (abs_rel, delta1) in ASKED.items()
                if of == name
            },
        )
        for name in dict.fromkeys(name for name, _ in ASKED)
    }
    bars = list(room("bars").asked(results, {}, "model"))
    names = [f"{name}, {fit}: AbsRel" for name, fit in ASKED]
    names += [f"{name}, {fit}: delta1" for (name, fit), (_, delta1) in ASKED.items() if delta1]
    assert sorted(each.name for each in bars) == sorted(names)
    assert {each.met for each in bars} == {met}


def test_what_is_asked_is_asked_of_sets_that_there_are(room):
    bars = room("bars")
    names = {each.name for each in room("samples").SETS} | {"rendered"}
    asked = [*bars.ABS_REL.values(), *bars.DELTA1.values(), bars.SHARP]
    assert names.issuperset(name for each in asked for name in each)


@pytest.mark.parametrize("name", ["ICL-NUIM", "rendered"])
@pytest.mark.parametrize(("f1", "met"), [(0.2, True), (0.199, False)])
def test_edges_have_to_be_half_as_sharp_as_those_of_the_reduced_truth(room, name, f1, met):
    edges = {name: {"model": f1, "truth, reduced": 0.4}}
    bars = room("bars").asked({name: result_of(room, {})}, edges, "model")
    (found,) = (each for each in bars if each.name == f"{name}: boundary F1")
    assert (found.measured, found.met) == (f1, met)


@pytest.mark.parametrize(
    ("model", "met"),
    [
        ((0.1, 0.9), (True, True)),
        ((0.2, 0.9), (False, True)),
        ((0.1, 0.7), (True, False)),
        ((0.25, 0.65), (False, False)),
    ],
)
def test_each_figure_has_to_beat_all_who_never_look(room, model, met):
    blind = {"best constant": (0.3, 0.7), "ground plane": (0.2, 0.6), "ramp": (0.4, 0.5)}
    # A fitted constant is shown, but is not who has to be beaten.
    scores = {"model": model, **blind, "constant": (0.05, 0.95)}
    # Where there is no figure of the model there is nothing to beat.
    result = result_of(room, {"fitted in disparity": blind, "median scale only": scores})
    bars = list(room("bars").beside_the_blind({"TUM": result}, "model"))
    assert [each.name for each in bars] == [
        "TUM, median scale only: AbsRel beside the blind",
        "TUM, median scale only: delta1 beside the blind",
    ]
    assert tuple(each.met for each in bars) == met


@pytest.mark.parametrize(("sign", "allowed"), [("<=", 1), ("<", 0), (">=", 1), (">", 0)])
def test_a_limit_says_whether_it_may_be_met_exactly(room, sign, allowed):
    bars = room("bars")
    limit = bars.Limit(sign, 0.5)
    outside = 0.6 if "<" in sign else 0.4
    assert limit.allows(0.5) == allowed
    assert limit.allows(1 - outside)
    assert not limit.allows(outside)
    assert not bars.Bar("nothing said", None, limit).met
    assert str(limit) == f"{sign} .5"


def test_the_pictures_are_written_side_by_side(quality, monkeypatch, tmp_path):
    run(quality, monkeypatch, "--samples", write_nyu(tmp_path), "--pictures", tmp_path / "out")
    names = sorted(path.name for path in (tmp_path / "out").iterdir())
    assert names == ["NYU-rgb_00000.png", "NYU-rgb_00001.png", "NYU-rgb_00002.png"]
    with Image.open(tmp_path / "out" / names[0]) as sheet:
        assert sheet.width >= 3 * WIDTH


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
