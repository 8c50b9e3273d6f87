from dataclasses import replace

import numpy as np
import pytest

from flexdepth.runtime.errors import InputError
from flexdepth.synth.correspondence import other_from_this
from flexdepth.synth.generate import SynthSettings
from flexdepth.synth.motion import Footing, Motion
from flexdepth.synth.sequence import LARGE_PAIRS, PAIRS, SequenceSettings, filmed, take
from flexdepth.synth.takes import pair_parallax, shares, shows_it

WORLD = SynthSettings(seed=3, width=80, height=60)
ASKED = replace(PAIRS.motion, frames=2, focal=70.0, parallax=(8.0, 12.0))
SETTINGS = SequenceSettings(WORLD, ASKED)


@pytest.fixture(scope="module")
def shot():
    return take(SETTINGS, 0)


@pytest.fixture(scope="module")
def frames(shot):
    longer = replace(shot, motion=replace(ASKED, frames=3))
    return tuple(filmed(longer, WORLD.seed, 0))


def test_a_take_shows_what_was_asked_for(shot, frames):
    shown = shares(shot, 0, 80 * 60)
    assert [mover.kind.flexible for mover in shot.play.movers] == [False, True]
    assert [footing is Footing.SEEN for footing in shot.footings] == list(shown.feet)
    for mover, footing in zip(shot.play.movers, shot.footings, strict=True):
        assert mover.kind.stands == (footing is not Footing.NONE)
    assert 0.1 <= frames[0].forward.moving.mean() <= 0.25
    assert shot.focal == 70
    assert min(frame.depth.min() for frame in frames[:2]) > 0.2
    assert 8 <= pair_parallax(shot, 0, 80 * 60) <= 12


def test_feet_that_are_to_be_hidden_stand_out_of_sight():
    any_motion = replace(ASKED, parallax=None, moving=(0.02, 0.6))
    shot = take(SequenceSettings(WORLD, any_motion), 3)
    assert shot.footings == (Footing.HIDDEN, Footing.SEEN)
    assert [mover.kind.stands for mover in shot.play.movers] == [True, True]
    shown = shares(shot, 0, 80 * 60)
    assert shown.feet == (False, True)
    assert (shown.mover > 0).all()


def test_a_take_with_another_stride_is_not_what_was_asked_for(shot):
    pixels = 80 * 60
    assert shows_it(shot, pixels, 1.0)
    for factor in (0.5, 2.0):
        assert not shows_it(replace(shot, path=shot.path.striding(factor)), pixels, 1.0)


def test_every_frame_knows_the_ones_beside_it(frames):
    assert [frame.backward is None for frame in frames] == [True, False, False]
    assert [frame.forward is None for frame in frames] == [False, False, True]
    for frame in frames:
        assert frame.picture.shape == (60, 80, 3)
        assert frame.depth.shape == frame.mover.shape == (60, 80)
        assert set(np.unique(frame.mover)) <= {0, 1, 2}


def test_besides_the_movers_flow_is_the_cameras(frames):
    for here, there, way in (
        (frames[0], frames[1], frames[0].forward),
        (frames[2], frames[1], frames[2].backward),
    ):
        still = here.mover == 0
        assert not way.moving[still].any()
        assert still.mean() > 0.2
        rotation, translation = other_from_this(here.camera.view, there.camera.view)
        row, column = np.mgrid[:60, :80] + 0.5
        ray = np.stack([(column - 40) / 70, (row - 30) / 70, np.ones_like(row)], -1)
        # A point at infinity has no parallax: dividing by the depth leaves the rotation alone.
        seen = ray @ rotation.T + translation / here.depth[..., None]
        flow = 70 * seen[..., :2] / seen[..., 2:] + (40, 30) - np.stack([column, row], -1)
        known = still & np.isfinite(way.flow).all(-1)
        assert np.abs(way.flow - flow)[known].max() < 1e-7


def test_the_same_number_is_the_same_picture_and_another_is_another(shot, frames):
    again, other = (next(filmed(shot, WORLD.seed, index)) for index in (0, 1))
    assert (again.picture == frames[0].picture).all()
    assert np.array_equal(again.forward.flow, frames[0].forward.flow, equal_nan=True)
    assert not np.array_equal(other.picture, frames[0].picture)


def test_a_shutter_that_is_open_blurs_by_the_flow_and_leaves_the_truth(shot, frames):
    """The median pixel goes by 10 pixels and more; what a column differs by from the next fades."""
    opened = replace(shot, motion=replace(ASKED, frames=3, shutter=1.0))
    for sharp, soft in zip(frames, filmed(opened, WORLD.seed, 0), strict=True):
        assert np.array_equal(soft.depth, sharp.depth)
        edges, left = (
            np.abs(np.diff(frame.picture.astype(float), axis=1)).mean() for frame in (sharp, soft)
        )
        assert left < 0.85 * edges


def test_the_pictures_follow_the_flow(frames):
    """Colours at both ends of the flow differ less than colours at one place."""
    here, there, way = frames[0], frames[1], frames[0].forward
    shown = ~way.occluded & (np.linalg.norm(way.flow, axis=-1) > 1.5)
    row, column = np.nonzero(shown)
    to = np.floor(way.flow[shown] + np.stack([column, row], 1) + 0.5).astype(int)
    to = np.clip(to, 0, (79, 59))
    first, second = here.picture.astype(float), there.picture.astype(float)
    along = np.abs(first[row, column] - second[to[:, 1], to[:, 0]]).mean()
    in_place = np.abs(first[row, column] - second[row, column]).mean()
    assert along < 0.8 * in_place


def test_what_no_scene_shows_is_refused(monkeypatch):
    monkeypatch.setattr("flexdepth.synth.sequence._SCENES", 1)
    monkeypatch.setattr("flexdepth.synth.sequence._TRIES", 2)
    impossible = Motion(2, moving=(0.98, 1.0), rigid=(1, 1), flexible=(0, 0))
    with pytest.raises(InputError, match=r"no scene of seed 3 shows what sequence 0"):
        take(SequenceSettings(WORLD, impossible), 0)


def test_the_pairs_to_measure_on_are_as_large_as_agreed():
    for settings, size, focal, span in (
        (PAIRS, (160, 120), 140, (2, 8)),
        (LARGE_PAIRS, (640, 480), 560, (10, 30)),
    ):
        assert (settings.world.width, settings.world.height) == size
        assert settings.motion.focal == focal
        assert settings.motion.parallax == span
        assert settings.motion.moving == (0.1, 0.25)
        assert (settings.motion.rigid, settings.motion.flexible) == ((1, 1), (1, 1))


def test_a_world_may_be_still_but_for_the_camera():
    still = Motion(frames=2, rigid=(0, 0), flexible=(0, 0), moving=(0.0, 1.0))
    first, second = filmed(take(SequenceSettings(WORLD, still), 0), WORLD.seed, 0)
    assert not first.mover.any()
    assert not first.forward.moving.any()
    assert np.linalg.norm(second.camera.view.eye - first.camera.view.eye) > 1e-4
