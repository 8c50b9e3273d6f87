"""How two-frame depth is scored, and what the table says of it."""

import json
from dataclasses import replace
from importlib import import_module
from pathlib import Path
from types import SimpleNamespace

import cv2
import numpy as np
import pytest

from flexdepth.runtime.errors import InputError
from flexdepth.synth.generate import SynthSettings
from flexdepth.synth.motion import Footing
from flexdepth.synth.sequence import LARGE_PAIRS, PAIRS

SOLVE = Path(__file__).parents[2] / "benchmarks" / "solve"
HEIGHT, WIDTH, FOCAL = 12, 16, 20.0


@pytest.fixture
def solve(monkeypatch):
    """The benchmark's modules by name."""
    monkeypatch.syspath_prepend(SOLVE)
    names = ("pairs", "scored_pairs", "rows", "table", "real", "two_frames", "speed_of_solving")
    return {name: import_module(name) for name in names}


@pytest.fixture
def pair(solve):
    """A wall at 4 m seen by a camera that goes .4 m aside: 2 pixels of parallax; no mover yet."""
    shape = (HEIGHT, WIDTH)
    flow = np.zeros((*shape, 2))
    flow[..., 0] = -2.0
    return solve["pairs"].Pair(
        key=np.zeros((*shape, 3), np.uint8),
        target=np.zeros((*shape, 3), np.uint8),
        depth=np.full(shape, 4.0),
        flow=flow,
        occluded=np.zeros(shape, bool),
        kind=np.zeros(shape, np.uint8),
        footing=np.zeros(3, np.uint8),
        rotation=np.eye(3),
        translation=np.array([-0.4, 0.0, 0.0]),
        focal=np.array(FOCAL),
    )


def with_movers(pair):
    """A rigid mover of 3 x 4 pixels at 2 m, and a flexible one in the air at 1 m."""
    depth, kind = pair.depth.copy(), pair.kind.copy()
    depth[2:5, 2:6], kind[2:5, 2:6] = 2.0, 1
    depth[6:9, 2:6], kind[6:9, 2:6] = 1.0, 2
    return replace(pair, depth=depth, kind=kind, footing=np.array([0, 0, 2], np.uint8))


def test_the_suite_is_that_of_synth_on_the_seeds_that_are_kept_for_it(solve):
    said = solve["pairs"].suite()
    assert said["small"]["seeds"] == list(range(20))
    assert said["large"]["seeds"] == list(range(10))
    settings = solve["pairs"].settings
    assert settings(said, "small", 7) == replace(PAIRS, world=SynthSettings(7, 160, 120))
    assert settings(said, "large", 7) == replace(LARGE_PAIRS, world=SynthSettings(7, 640, 480))


def test_a_pair_says_what_is_seen_of_each_movers_feet(solve):
    pairs = solve["pairs"]
    # Movers 2016 and 2017 of the row in which every third does not show its feet.
    found = pairs.rendered(pairs.settings(pairs.suite(), "small", 1008))
    told = [pairs.FOOTINGS[code] for code in found.footing]
    assert told == [Footing.SEEN, Footing.HIDDEN, Footing.SEEN]
    assert set(np.unique(found.kind)) == {pairs.STATIC, pairs.RIGID, pairs.FLEXIBLE}


def test_the_truth_scores_perfectly_whatever_its_scale(solve, pair):
    truth = with_movers(pair)
    for group, score in solve["scored_pairs"].scores(0.037 * truth.depth, truth).items():
        assert score.abs_rel == pytest.approx(0, abs=1e-12), group
        assert (score.delta1, score.coverage) == (1, 1)


def test_one_wrong_mover_worked_by_hand(solve, pair):
    truth = with_movers(pair)
    depth = truth.depth.copy()
    depth[truth.kind == 1] *= 1.5
    found = solve["scored_pairs"].scores(depth, truth)
    assert found["static"].abs_rel == found["flexible"].abs_rel == 0
    assert (found["rigid"].abs_rel, found["rigid"].delta1) == (pytest.approx(0.5), 0)
    assert (found["moving"].abs_rel, found["moving"].delta1) == (pytest.approx(0.25), 0.5)
    assert (found["feet seen"].abs_rel, found["in the air"].abs_rel) == (pytest.approx(0.5), 0)
    assert "feet hidden" not in found
    assert found["all"].abs_rel == pytest.approx(0.5 * 12 / (HEIGHT * WIDTH))
    assert found["rigid shape"].abs_rel == found["flexible shape"].abs_rel == 0


def test_the_shape_of_a_mover_is_scored_after_its_own_scale(solve, pair):
    truth = with_movers(pair)
    depth = truth.depth.copy()
    # Of the rigid mover's 12 pixels at 2 m, 3 are said to be at 9 m and 9 at 6 m.
    depth[truth.kind == 1] = 6.0
    depth[2:5, 2] = 9.0
    found = solve["scored_pairs"].scores(depth, truth)
    assert found["rigid"].abs_rel == pytest.approx((3 * 3.5 + 9 * 2) / 12)
    assert found["rigid shape"].abs_rel == pytest.approx(3 * 0.5 / 12)


def test_sky_what_is_hidden_and_what_shows_no_parallax_are_not_scored(solve, pair):
    truth = with_movers(pair)
    depth, occluded, flow = truth.depth.copy(), truth.occluded.copy(), truth.flow.copy()
    depth[0], occluded[1], flow[11] = np.inf, True, np.nan
    # .4 m at 20 pixels and 40 m: .2 pixels of parallax. A mover at that depth is scored.
    depth[10], depth[2, 2] = 40.0, 40.0
    truth = replace(truth, depth=depth, occluded=occluded, flow=flow)
    expected = np.ones((HEIGHT, WIDTH), bool)
    expected[[0, 1, 10, 11]] = False
    assert (solve["scored_pairs"].scored(truth) == expected).all()


def test_parallax_is_focal_times_travel_over_depth(solve, pair):
    assert solve["pairs"].parallax(pair) == pytest.approx(2.0)
    sky = replace(pair, depth=np.full((HEIGHT, WIDTH), np.inf))
    assert solve["pairs"].parallax(sky) == pytest.approx(0)


@pytest.mark.parametrize("nothing", [np.nan, np.inf, 0.0, -1.0])
def test_a_pixel_without_depth_stands_at_the_median(solve, pair, nothing):
    truth = with_movers(pair)
    depth = 10 * truth.depth
    depth[truth.kind == 2] = nothing
    found = solve["scored_pairs"].scores(depth, truth)
    # The median is the wall's 4 m; the flexible mover is at 1 m.
    assert (found["flexible"].abs_rel, found["flexible"].coverage) == (pytest.approx(3), 0)
    assert (found["moving"].coverage, found["static"].coverage) == (0.5, 1)
    assert found["rigid"].abs_rel == pytest.approx(0, abs=1e-12)


def test_saying_nothing_is_saying_one_depth(solve, pair):
    truth = with_movers(pair)
    nothing, one = (
        solve["scored_pairs"].scores(depth, truth)
        for depth in (np.full_like(truth.depth, np.nan), np.ones_like(truth.depth))
    )
    for group, score in nothing.items():
        assert score.abs_rel == pytest.approx(one[group].abs_rel)
        assert score.coverage == 0


def test_a_group_that_a_pair_lacks_is_not_counted(solve, pair):
    scores, mean = solve["scored_pairs"].scores, solve["scored_pairs"].mean
    alone, both = scores(pair.depth, pair), scores(np.ones_like(pair.depth), with_movers(pair))
    assert "rigid" not in alone
    together = mean([alone, both])
    assert together["rigid"] == both["rigid"]
    assert together["all"].abs_rel == pytest.approx(both["all"].abs_rel / 2)


def test_the_triangulated_baselines_find_a_still_world(solve):
    pairs, rows, scoring = (solve[name] for name in ("pairs", "rows", "scored_pairs"))
    row, column = np.mgrid[:60, :80] + 0.5
    depth = 4 + 2 * np.sin(column / 9) + row / 20
    ray = np.stack([(column - 40) / 100, (row - 30) / 100, np.ones_like(row)], -1)
    rotation, translation = np.asarray(cv2.Rodrigues(np.array([0.01, 0.02, 0]))[0]), (0.3, 0, 0.1)
    there = (depth[..., None] * ray) @ rotation.T + translation
    flow = 100 * (there[..., :2] / there[..., 2:] - ray[..., :2])
    truth = pairs.Pair(
        key=np.zeros((60, 80, 3), np.uint8),
        target=np.zeros((60, 80, 3), np.uint8),
        depth=depth,
        flow=flow,
        occluded=np.zeros((60, 80), bool),
        kind=np.zeros((60, 80), np.uint8),
        footing=np.zeros(3, np.uint8),
        rotation=rotation,
        translation=np.array(translation),
        focal=np.array(100.0),
    )
    given = rows.case(truth, 0, 0.0)
    for way, bar in ((rows.essential, 0.05), (rows.refined, 2e-4)):
        score = scoring.scores(way(given), truth)["all"]
        assert score.abs_rel < bar
        assert score.coverage > 0.99
    assert scoring.scores(rows.constant(given), truth)["all"].abs_rel > 0.1


def test_noise_is_as_large_as_it_is_said_and_the_same_every_time(solve, pair):
    flow_of = solve["pairs"].flow_of
    big = replace(pair, flow=np.zeros((100, 100, 2)), depth=np.ones((100, 100)))
    flow, said = flow_of(big, 3, 0.1)
    assert flow.std() == pytest.approx(0.1, rel=0.02)
    assert (said == np.float32(0.1)).all()
    assert (flow_of(big, 3, 0.1)[0] == flow).all()
    assert (flow_of(big, 4, 0.1)[0] != flow).any()
    exact, said = flow_of(big, 3, 0.0)
    assert not exact.any()
    assert (said > 0).all()


def line(solve, row, **scores):
    made = {group: solve["scored_pairs"].Score(*numbers) for group, numbers in scores.items()}
    return solve["table"].Line("exact", row, (0,), (made,), made, 1.0, 0.5)


def test_bars_are_met_from_the_side_they_ask_for(solve):
    full = line(solve, "dense", all=(0.019, 0.98, 1.0), moving=(0.07, 1.0, 0.9))
    base = line(solve, "essential matrix", moving=(0.2, 0.3, 1.0))
    bars = {
        "exact": {"all": 0.02, "all_delta1": 0.99, "moving": 0.07, "moving_coverage": 0.9},
        "DIS": {"static": 0.03},
    }
    bars["exact"]["moving_of_essential"] = 0.3333
    found = {each.what: each for each in solve["table"].verdicts([full, base], bars)}
    assert {name: each.passed for name, each in found.items()} == {
        "all": True,
        "all_delta1": False,
        "moving": True,
        "moving_coverage": True,
        "moving_of_essential": False,
    }
    assert found["moving_of_essential"].measured == pytest.approx(0.35)
    alone = solve["table"].verdicts([base], bars)
    assert alone == []


def test_the_table_names_every_method_and_group(solve):
    lines = [
        line(solve, "dense", all=(0.0191, 0.98, 1.0), static=(0.002, 1.0, 0.97)),
        line(solve, "constant depth", all=(1.834, 0.17, 1.0)),
    ]
    text = solve["table"].text(lines, solve["table"].verdicts(lines, {"exact": {"all": 0.02}}))
    assert ".019/98" in text
    assert "1.83/17" in text
    assert "97 %" in text
    assert "met" in text
    assert json.dumps(solve["table"].record(lines, []))


ISSUED = [
    "constant depth",
    "essential matrix",
    "essential, refined",
    "dissertation, as written",
    "as written, true motion",
    "dissertation, corrected",
    "corrected, true motion",
    "regions",
    "dense",
    "prior alone",
    "dense with prior",
]
"""The ways that the table compares, from the plainest to the fullest."""


def test_every_row_of_the_issue_is_there(solve):
    rows = solve["rows"]
    assert list(rows.ROWS) == ISSUED
    assert len(set(rows.ROWS.values())) == len(ISSUED)
    assert (rows.FULL, rows.BASELINE) == ("dense", "essential matrix")


def test_names_may_be_cut_short_and_keep_their_order(solve):
    chosen = solve["two_frames"].chosen
    assert chosen(ISSUED, ["dense"], "row") == ["dense"]
    assert chosen(ISSUED, ["regions", "diss"], "row") == [
        "dissertation, as written",
        "dissertation, corrected",
        "regions",
    ]
    assert chosen(ISSUED, None, "row") == ISSUED
    with pytest.raises(InputError, match="no row begins with 'sparse'"):
        chosen(ISSUED, ["dense", "sparse"], "row")


def test_the_line_through_the_times_is_theirs(solve):
    taken = solve["speed_of_solving"]
    times = [
        taken.Taken((side, side), "dense", 0.0, 0.5 + 2e-6 * side * side, None)
        for side in (100, 300, 700)
    ]
    start, slope, off = taken.line(times)
    assert (start, slope) == (pytest.approx(0.5), pytest.approx(2e-6))
    assert off < 1e-9


def test_a_resized_pair_keeps_its_angles(solve, pair):
    half = solve["speed_of_solving"].resized(with_movers(pair), (8, 6))
    assert half.depth.shape == (6, 8)
    assert half.flow[0, 0].tolist() == [-1.0, 0.0]
    assert half.focal == FOCAL / 2
    wide = solve["speed_of_solving"].resized(pair, (16, 6))
    assert wide.depth.shape == (6, 16)
    assert wide.focal == FOCAL


def test_half_of_a_box_is_half_its_area_about_its_middle(solve):
    boxed = solve["real"].boxed
    assert boxed([(100, 50, 300, 150)], (200, 400)).sum() == 200 * 100
    inner = boxed([(100, 50, 300, 150)], (200, 400), 0.5)
    assert inner.mean() * 200 * 400 == pytest.approx(10_000, rel=0.02)
    row, column = np.nonzero(inner)
    assert (column.mean() + 0.5, row.mean() + 0.5) == (pytest.approx(200), pytest.approx(100))


def test_what_lies_beside_counts_neither_way(solve):
    moving = np.zeros((100, 100), bool)
    moving[20:40, 20:40] = True  # the thing
    moving[50:60, 50:60] = True  # its arm
    moving[90:, 90:] = True  # wrong
    said = {"things": {"cat": [(20, 20, 40, 40)]}, "beside": [(50, 50, 60, 60)]}
    found = solve["real"].marked(moving, said)
    assert found.things == {"cat": 1.0}
    assert found.outside == pytest.approx(100 / (10_000 - 400 - 100))
    assert found.passed
    assert not solve["real"].marked(~moving, said).passed


def test_every_flow_asks_for_coverage_and_that_the_prior_spoils_nothing(solve):
    said = solve["pairs"].suite()
    assert said["bars"].keys() == said["flow"].keys()
    for asked in said["bars"].values():
        assert (asked["static_coverage"], asked["moving_coverage"]) == (0.95, 0.90)
        groups = ("all", "static", "rigid", "flexible", "moving")
        assert [asked[f"{group}_with_prior"] for group in groups] == [1.05] * 5


def test_the_prior_is_held_to_the_better_of_both_alone(solve):
    lines = [
        line(solve, "dense", all=(0.1, 1.0, 1.0), moving=(0.3, 1.0, 1.0)),
        line(solve, "prior alone", all=(0.4, 1.0, 1.0), moving=(0.19, 1.0, 1.0)),
        line(solve, "dense with prior", all=(0.105, 1.0, 1.0), moving=(0.2, 1.0, 1.0)),
    ]
    bars = {"exact": {"all_with_prior": 1.05, "moving_with_prior": 1.05, "rigid_with_prior": 1.05}}
    found = {each.what: each for each in solve["table"].verdicts(lines, bars)}
    assert {what: each.passed for what, each in found.items()} == {
        "all_with_prior": True,
        "moving_with_prior": False,
    }
    assert found["moving_with_prior"].measured == pytest.approx(0.2 / 0.19)
    for missing in lines:
        assert solve["table"].verdicts([each for each in lines if each is not missing], bars) == []


def called(monkeypatch, module, *words):
    """The exit code of a benchmark that is called with words."""
    monkeypatch.setattr("sys.argv", [module.__name__, *words])
    return module.main()


def test_the_ablation_leaves_out_each_innovation_and_both(solve, monkeypatch, pair):
    rows, asked = solve["rows"], []
    matches = SimpleNamespace(key=np.zeros((0, 2)), target=np.zeros((0, 2)))
    monkeypatch.setattr(rows, "Akaze", lambda: SimpleNamespace(between=lambda *_: matches))

    def first_order(_seen, settings, _clues):
        asked.append(settings)
        return SimpleNamespace(depth=None)

    def lines(_flow, offered, *_):
        for name, row in offered.items():
            row(rows.case(pair, 0, 0.0))
            yield line(solve, name)

    monkeypatch.setattr(rows, "first_order", first_order)
    monkeypatch.setattr(solve["two_frames"], "lines", lines)
    assert called(monkeypatch, solve["two_frames"], "--ablation", "--flow", "exact") == 0
    assert [str(each.form) for each in asked] == ["as-written"] * 4 + ["corrected"] * 4
    weighed = [(each.weights.motion_boundaries, each.weights.synchrony) for each in asked]
    assert weighed == [(1, 1), (0, 1), (1, 0), (0, 0)] * 2
    assert {each.weights.dense_perspective for each in asked} == {1.0}


@pytest.mark.parametrize("estimated", [False, True])
def test_chapter_5_is_shown_the_frames_where_flow_comes_from_them(
    solve, monkeypatch, pair, estimated
):
    rows, asked = solve["rows"], []
    monkeypatch.setattr(
        rows, "first_order", lambda *given: asked.append(given) or SimpleNamespace(depth=None)
    )
    noise = np.random.default_rng(0).integers(0, 255, (64, 80, 3)).astype(np.uint8)
    shown = replace(pair, key=noise, target=noise, depth=np.ones((64, 80)))
    flow = np.zeros((64, 80, 2), np.float32)
    rows.dissertation(rows.Form.AS_WRITTEN)(
        rows.Case(shown, flow, np.full((64, 80), 0.1, np.float32), estimated)
    )
    ((_, _, clues),) = asked
    assert (clues.frames is not None) is estimated


@pytest.mark.parametrize(("strict", "code"), [((), 0), (("--strict",), 1)])
def test_a_missed_bar_is_said_and_fails_the_run_only_where_that_is_asked(
    solve, monkeypatch, capsys, strict, code
):
    times, real, table = (solve[name] for name in ("speed_of_solving", "real", "two_frames"))

    def slow(method, size):
        # Dense is just in time at 512x218 and too large at 1024x436.
        seconds = {(160, 120): 0.3, (512, 218): 10.0}.get(size, 1.6)
        return times.Taken(size, method, seconds, 1.0, int(3.1e9))

    def lines(*_):
        yield line(solve, "dense", all=(0.03, 0.999, 1.0), static=(0.001, 1.0, 1.0))

    def marked(*_):
        return real.Marked({"car": 0.61, "girl": 0.59}, 0.04)

    monkeypatch.setattr(times, "measured", slow)
    monkeypatch.setattr(real, "measured", marked)
    monkeypatch.setattr(table, "lines", lines)
    for module, words, verdicts in (
        (times, (), ["pass", "pass", "pass", "MISS"]),
        (real, (), ["pass", "MISS", "pass"] * 2),
        (table, ("--flow", "exact"), ["pass", "MISS", "pass", "pass"]),
    ):
        assert called(monkeypatch, module, *words, *strict) == code
        said = [each.split()[-1] for each in capsys.readouterr().out.splitlines() if each]
        assert [each for each in said if each in ("pass", "MISS")] == verdicts


def test_bars_that_are_met_fail_no_run(solve, monkeypatch, capsys):
    times, real = solve["speed_of_solving"], solve["real"]
    # Memory that cannot be measured misses no bar.
    monkeypatch.setattr(
        times, "measured", lambda *asked: times.Taken(asked[1], asked[0], 0.4, 1, None)
    )
    monkeypatch.setattr(real, "measured", lambda *_: real.Marked({"car": 0.6}, 0.05))
    assert called(monkeypatch, times, "--strict") == 0
    assert called(monkeypatch, real, "--strict", "--json") == 0
    assert "MISS" not in capsys.readouterr().out


@pytest.mark.parametrize(
    ("rotation", "direction", "verdicts"),
    [(0.02, 0.9, ["pass", "pass"]), (0.02, 1.01, ["pass", "MISS"]), (0.06, 0.5, ["MISS", "pass"])],
)
def test_the_cameras_motion_is_held_to_figures_and_to_the_customary_way(
    monkeypatch, capsys, rotation, direction, verdicts
):
    monkeypatch.syspath_prepend(SOLVE.parent)
    ego = import_module("ego_motion")

    def measured(_folder, _pairs, find):
        ours = rotation, direction
        medians = (0.059, 1.2) if find is ego.by_sift else ours
        names = ("rotation", "direction", "worst_rotation", "worst_direction", "seconds")
        return dict(zip(names, (*medians, 9.0, 9.0, 1.0), strict=True))

    monkeypatch.setattr(ego, "measured", measured)
    missed = "MISS" in verdicts
    for words, code in (((), 0), (("--strict",), missed), (("--strict", "--json"), missed)):
        assert called(monkeypatch, ego, *words) == code
    told, _, record = capsys.readouterr().out.partition("{")
    assert [each.split()[-1] for each in told.splitlines() if " at most " in each] == verdicts * 2
    assert json.loads("{" + record)["passed"] is not missed
