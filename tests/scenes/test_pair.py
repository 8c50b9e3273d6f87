from dataclasses import dataclass, replace

import numpy as np
import pytest
from PIL import Image

from flexdepth.flow.dis import Dis
from flexdepth.flow.field import FlowField, given
from flexdepth.runtime.depthmap import DepthMap, FocalSource, Intrinsics, Space
from flexdepth.runtime.errors import InputError
from flexdepth.runtime.lens import FocalLength
from flexdepth.runtime.surface import rays
from flexdepth.scenes import origin as scene_origin
from flexdepth.scenes import pair as scene
from flexdepth.scenes.correspondence import FlowFile
from flexdepth.scenes.objective import Objective
from flexdepth.scenes.origin import origin
from flexdepth.scenes.own_motion import turned
from flexdepth.scenes.pair import PairSettings, solve
from flexdepth.scenes.prior import Told, told
from flexdepth.scenes.views import ViewFiles
from flexdepth.scenes.words import cautions
from flexdepth.solvers.two_frame import Unknown


@dataclass(frozen=True)
class Sideways:
    """Says that everything has gone to the left by 5 pixels."""

    def between(self, key, _target) -> FlowField:
        height, width = key.shape[:2]
        flow = np.zeros((height, width, 2), np.float32)
        flow[..., 0] = -5
        return given(flow, (width, height), 0.1)


@pytest.fixture
def files(pair):
    return ViewFiles(pair / "key.png", pair / "target.png")


@pytest.fixture
def settings(pair, files):
    return PairSettings(
        files,
        pair / "camera.json",
        FlowFile(pair / "flow.flo"),
        prior=None,
        objective=Objective.REGIONS,
    )


@pytest.fixture
def asked(monkeypatch, found):
    """Return the list of what the solver was asked, which answers without solving."""
    said = []

    def answer(_objective, seen, *_pictures):
        said.append(seen)
        return found

    monkeypatch.setattr(scene, "solved", answer)
    return said


def test_the_wall_and_what_moves_before_it_are_found(settings, hills):
    depth, _, moving = hills
    solution = solve(settings)
    known = solution.found.valid & ~moving
    assert known[~moving].mean() > 0.9
    error = np.abs(solution.depth.depth * 0.05 / depth - 1)[known]
    assert np.median(error) < 0.02
    assert solution.found.moving[moving].mean() > 0.8
    assert solution.found.moving[~moving].mean() < 0.05
    assert solution.depth.space is Space.SCALE


def test_the_solver_is_shown_all_that_was_given(settings, files, asked):
    more = replace(
        settings,
        files=replace(files, third=files.target, right=files.target),
        flow=Sideways(),
        baseline=0.3,
    )
    steps = []
    solve(more, steps.append)
    (seen,) = asked
    assert (seen.third.flow[..., 0] == -5).all()
    assert (seen.stereo.flow[..., 0] == -5).all()
    assert seen.stereo.baseline == 0.3
    assert seen.prior is None
    assert len(steps) == 5


def test_depth_of_the_key_frame_alone_is_the_prior(settings, asked, monkeypatch):
    asked_of = []

    def alone(model, picture, camera):
        asked_of.append((model, picture.shape, camera.focal_x))
        depth = np.full(picture.shape[:2], 2, np.float32)
        return DepthMap(depth, Space.METRIC, camera, "seer 1.0"), ()

    monkeypatch.setattr(scene, "single_image_depth", alone)
    solution = solve(replace(settings, prior="compact"))
    (seen,) = asked
    assert asked_of == [("compact", (120, 160, 3), 140.0)]
    assert seen.prior.metric
    assert (seen.prior.spread > 0).all()
    np.testing.assert_array_equal(seen.prior.depth, solution.prior.depth)


@pytest.mark.parametrize("said", [FocalSource.GIVEN, FocalSource.ASSUMED])
def test_a_focal_length_that_only_the_model_sees_is_taken_if_nobody_says_it(
    said, settings, asked, monkeypatch
):
    model_sees = Intrinsics(99.0, 99.0, 80.0, 60.0, FocalSource.PREDICTED)
    depth = DepthMap(np.ones((120, 160), np.float32), Space.SCALE, model_sees, "far seer 1.0")
    monkeypatch.setattr(scene, "single_image_depth", lambda *_: (depth, ("a licence",)))
    known = settings.camera if said is FocalSource.GIVEN else None
    solution = solve(replace(settings, prior="far seer", camera=known))
    assert asked[0].camera.focal_x == (140.0 if known else 99.0)
    assert "a licence" in solution.warnings
    if known is None:
        assert any(
            "99 px, a view of 78 degrees, is taken as far seer 1.0" in line
            for line in cautions(solution)
        )


def test_another_picture_than_the_target_is_named_where_it_cannot_be_matched(settings, files):
    class Lost:
        def between(self, *_):
            raise InputError("nothing in common")

    third = replace(settings, files=replace(files, third=files.target), flow=Lost())
    with pytest.raises(InputError, match=r"^nothing in common"):
        solve(third)
    with pytest.raises(InputError, match="from the key frame to the third frame: "):
        scene._named("the third frame", Lost(), np.zeros(1), np.zeros(1))


def test_what_the_solver_could_not_use_is_said(settings, monkeypatch, found):
    noted = replace(found, notes=("the third frame adds nothing",))
    monkeypatch.setattr(scene, "solved", lambda *_: noted)
    assert "the third frame adds nothing" in cautions(solve(settings))


def test_the_flow_that_is_kept_is_the_one_that_depth_and_motion_explain(settings):
    solution = solve(replace(settings, flow=Dis()))
    found, flow = solution.found, solution.flow
    seen = found.valid & ~found.inferred
    assert seen.mean() > 0.5
    assert np.isfinite(flow.noise[seen]).all()
    np.testing.assert_array_equal(flow.valid, np.isfinite(flow.noise))
    here = rays(*np.nonzero(seen), solution.camera) * found.depth[seen][:, None]
    there = turned(here, found.rotation[seen]) + found.translation[seen]
    place = there[:, :2] / there[:, 2:] - (here / here[:, 2:])[:, :2]
    left = np.linalg.norm(flow.flow[seen] - place * solution.camera.focal_x, axis=1)
    np.testing.assert_allclose(found.residual[seen], left, atol=1e-3)


@pytest.mark.parametrize("right", [True, False])
def test_akaze_is_asked_whether_the_flow_is_right(right, settings, hills, monkeypatch, found):
    flow = hills[1] if right else -hills[1]
    answered = replace(found, flow=flow.astype(float), noise=np.full(flow.shape[:2], 0.1))
    monkeypatch.setattr(scene, "solved", lambda *_: answered)
    solution = solve(settings)
    assert solution.borne_out.matches >= 20
    if right:
        assert solution.borne_out.share > 0.9
        assert solution.warnings == ()
    else:
        assert solution.borne_out.share < 0.1
        assert "AKAZE matches" in solution.warnings[0]


def test_frames_without_a_match_leave_the_flow_in_peace(settings, files, found, monkeypatch):
    ramp = np.tile(np.linspace(0, 255, 160).astype(np.uint8)[:, None], (120, 1, 3))
    for path in (files.key, files.target):
        Image.fromarray(ramp).save(path)
    answered = replace(found, flow=np.zeros((120, 160, 2)), noise=np.full((120, 160), 0.1))
    monkeypatch.setattr(scene, "solved", lambda *_: answered)
    solution = solve(replace(settings, flow=Sideways()))
    assert solution.borne_out.matches == 0
    assert not any("AKAZE" in line for line in solution.warnings)


@pytest.mark.parametrize(
    ("share", "sky", "model"),
    [
        ("part", True, "flexdepth solve (regions), seer 1.0"),
        ("none", True, "flexdepth solve (regions), sky by seer 1.0"),
        ("none", False, "flexdepth solve (regions)"),
    ],
)
def test_a_prior_is_named_only_for_what_is_its_own(share, sky, model, settings, found, monkeypatch):
    seen_alone = DepthMap(np.ones((120, 160), np.float32), Space.SCALE, None, "seer 1.0")
    unknown = found.unknown if sky else np.where(found.unknown == Unknown.SKY, 2, found.unknown)
    # The whole share is the prior's in the sky; where nothing has depth it does not count.
    shares = np.where(found.valid, 0.2 if share == "part" else 0.0, 1.0)
    answered = replace(found, unknown=unknown.astype(np.uint8), prior_share=shares)
    monkeypatch.setattr(scene, "single_image_depth", lambda *_: (seen_alone, ()))
    monkeypatch.setattr(scene, "solved", lambda *_: answered)
    assert solve(replace(settings, prior="seer")).depth.model == model


def test_a_prior_that_cannot_be_tied_to_what_the_frames_show_is_not_named(settings, monkeypatch):
    blind = DepthMap(np.full((120, 160), np.nan, np.float32), Space.METRIC, None, "seer 1.0")
    monkeypatch.setattr(scene, "single_image_depth", lambda *_: (blind, ()))
    solution = solve(replace(settings, prior="seer"))
    assert any("the single-image depth is left out" in line for line in solution.warnings)
    assert solution.depth.model == "flexdepth solve (regions)"
    assert told(solution.found) is Told.NOTHING


def test_half_a_stereo_camera_is_refused(files):
    with pytest.raises(InputError, match="belong together"):
        PairSettings(files, baseline=0.5)
    with pytest.raises(InputError, match="belong together"):
        PairSettings(replace(files, right=files.target))


def test_the_dissertations_objective_takes_two_frames(files):
    with pytest.raises(InputError, match="--objective dissertation takes two frames"):
        PairSettings(replace(files, third=files.target), objective=Objective.DISSERTATION)
    with pytest.raises(InputError, match="takes no prior: leave --prior far seer out"):
        PairSettings(files, prior="far seer", objective=Objective.CORRECTED)


def test_the_dissertations_objective_opens_no_prior_and_records_none(
    settings, files, asked, monkeypatch
):
    def opened(*_):
        raise AssertionError

    monkeypatch.setattr(scene_origin, "opened", opened)
    monkeypatch.setattr(scene, "single_image_depth", opened)
    chapter = PairSettings(files, flow=settings.flow, objective=Objective.DISSERTATION)
    assert origin(chapter)["prior"] == "none"
    assert solve(chapter).prior is None
    assert asked[0].prior is None


def test_the_origin_tells_every_setting_apart(settings, files, pair):
    every = [
        settings,
        replace(settings, camera=FocalLength(140)),
        replace(settings, camera=None),
        replace(settings, flow=Sideways()),
        replace(settings, flow=FlowFile(pair / "flow.flo", 0.3)),
        replace(settings, prior="compact"),
        replace(settings, objective=Objective.DENSE),
        replace(settings, long_side=640),
        replace(settings, files=replace(files, third=files.target)),
        replace(settings, files=replace(files, right=files.target), baseline=0.3),
        replace(settings, files=replace(files, right=files.target), baseline=0.4),
        replace(settings, files=ViewFiles(files.target, files.key)),
    ]
    said = [tuple(sorted(origin(each).items())) for each in every]
    assert len(set(said)) == len(every)
    copied = pair / "elsewhere.png"
    copied.write_bytes(files.key.read_bytes())
    assert origin(replace(settings, files=replace(files, key=copied))) == origin(settings)
