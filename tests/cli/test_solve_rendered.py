"""`flexdepth solve` on rendered frames in files, as a user has them, beside the truth."""

import json
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from flexdepth.cli.main import main
from flexdepth.runtime.depthmap import Space
from flexdepth.runtime.files import read_depth


@pytest.fixture
def solve(here, capsys):
    """Run `flexdepth solve` on a film; return what it says, the depth and the other maps."""

    def run(shown, *arguments):
        for name in ("before", "key", "after", "right"):
            Image.fromarray(getattr(shown, name)).save(f"{name}.png")
        extra = ("--focal", shown.focal, "--json", "--overwrite", *arguments)
        code = main(["solve", "key.png", "after.png", *map(str, extra)])
        out, err = capsys.readouterr()
        assert (code, err) == (0, "")
        with np.load(here / "solution" / "solution.npz") as maps:
            arrays = {name: maps[name] for name in maps.files if name != "origin"}
        return json.loads(out), read_depth(Path("solution/depth.npz")), arrays

    return run


def scaled_errors(depth, shown):
    """Return |z / truth - 1| after one median scale over what is still; NaN without depth."""
    known = depth.valid & np.isfinite(shown.depth)
    ratio = np.full(known.shape, np.nan)
    ratio[known] = depth.depth[known] / shown.depth[known]
    return np.abs(ratio / np.median(ratio[known & (shown.mover == 0)]) - 1)


def test_the_default_way_finds_the_rendered_depth_and_says_what_it_knows(solve, garden):
    said, depth, maps = solve(garden)
    there = np.isfinite(garden.depth)  # The rest is sky.
    assert depth.valid[there].mean() > 0.98
    off = scaled_errors(depth, garden)[garden.mover == 0]
    assert np.nanmedian(off) < 0.12
    assert np.nanmean(off) < 0.2
    assert np.isposinf(depth.depth[~there]).mean() > 10 * np.isposinf(depth.depth[there]).mean()
    share = maps["prior_share"]
    assert ((share >= 0) & (share <= 1)).all()
    unmatched = ~np.isfinite(maps["flow_noise"]) & depth.valid & ~maps["inferred"]
    assert unmatched.sum() > 500
    assert share[unmatched].min() > 0.9
    assert share[there & (garden.mover == 0) & ~unmatched].mean() < 0.2
    assert said["prior_share"] == pytest.approx(share.mean(), abs=1e-5)
    assert (depth.space, said["unit"]) == (Space.METRIC, "m")
    assert sum(said["share_by_reason"].values()) == pytest.approx(1, abs=1e-4)
    assert sum(region["share"] for region in said["regions"]) == pytest.approx(1)
    position = -garden.rotation.T @ garden.translation
    found = np.array(said["camera_motion"]["position"])
    cosine = found @ position / np.linalg.norm(found) / np.linalg.norm(position)
    assert cosine > 0.99


def test_with_a_right_picture_the_truths_metres_come_out(solve, garden):
    stereo = ("--stereo", "right.png", "--baseline", garden.baseline)
    said, depth, maps = solve(garden, *stereo, "--prior", "none")
    assert (depth.space, said["unit"], said["prior_share"]) == (Space.METRIC, "m", None)
    for number in (0, 1, 2):
        inside = garden.mover == number
        inside &= np.isfinite(garden.depth)
        known = inside & depth.valid & ~maps["inferred"]
        assert known.sum() > 0.5 * inside.sum()
        assert np.median(depth.depth[known] / garden.depth[known]) == pytest.approx(1, abs=0.06)
    gone = np.linalg.norm(said["camera_motion"]["position"])
    assert gone == pytest.approx(np.linalg.norm(garden.translation), rel=0.1)


def test_a_third_frame_shows_more_of_what_the_target_hides(solve, garden):
    plain = ("--prior", "none", "--objective", "regions")
    two, _, before = solve(garden, *plain)
    three, depth, after = solve(garden, *plain, "--third", "before.png")
    assert two["share_by_reason"]["occluded"] > 0.05
    assert three["share_by_reason"]["occluded"] < 0.5 * two["share_by_reason"]["occluded"]
    gained = after["valid"] & ~before["valid"] & (garden.mover == 0) & np.isfinite(garden.depth)
    assert gained.mean() > 0.02
    off = scaled_errors(depth, garden)
    assert np.median(off[gained]) < 0.35
    assert np.nanmedian(off[garden.mover == 0]) < 0.12


def test_with_the_true_flow_both_things_are_found_and_named(solve, film):
    head = np.array([202021.25], "<f4").tobytes() + np.array([96, 72], "<i4").tobytes()
    flow = np.where(film.hidden[..., None], 1e10, film.flow).astype("<f4")
    Path("true.flo").write_bytes(head + flow.tobytes())
    said, depth, maps = solve(film, "--flow", "true.flo", "--flow-noise", 0.02)
    seen = ~film.hidden
    both, either = maps["moving"] & film.moving, maps["moving"] | film.moving
    assert (both & seen).sum() > 0.95 * (either & seen).sum()
    for number, kind in ((1, "rigid"), (2, "flexible")):
        inside = seen & (film.mover == number)
        region = said["regions"][int(np.median(maps["label"][inside]))]
        assert (region["kind"], region["scale_from"]) == (kind, "contact")
    off = scaled_errors(depth, film)
    for number, most in ((0, 0.005), (1, 0.02), (2, 0.15)):
        assert off[seen & (film.mover == number)].mean() < most
    share = maps["prior_share"]
    assert np.median(share[seen & (film.mover == 0)]) < 0.05
    assert share[film.hidden].min() > 0.9
