"""Two rendered frames in which one thing is rigid and one bends: every answer beside its truth."""

from dataclasses import replace

import cv2
import numpy as np
import pytest

from flexdepth.runtime.depthmap import FocalSource, Intrinsics
from flexdepth.solvers.two_frame import (
    Evidence,
    Kind,
    Prior,
    Seen,
    Stereo,
    ThirdFrame,
    TwoFrameSettings,
    two_frame,
)

REGIONS = TwoFrameSettings(dense=None)
NOISE = 0.1
"""Pixels of white noise on the true flow, where there is any."""


def seen(film, noise=0.0, **more):
    """Return what the solver is given: the true flow with noise, not trusted where it is hidden."""
    drawn = noise * np.random.default_rng(7).standard_normal(film.flow.shape)
    said = np.where(film.hidden, np.nan, max(noise, 0.01)).astype(np.float32)
    height, width = said.shape
    camera = Intrinsics.centred(width, height, float(film.focal), FocalSource.GIVEN)
    return Seen((film.flow + drawn).astype(np.float32), said, camera, film.key, **more)


def rays(film):
    height, width = film.depth.shape
    row, column = np.mgrid[:height, :width] + 0.5
    x, y = (column - width / 2) / film.focal, (row - height / 2) / film.focal
    return np.stack([x, y, np.ones_like(x)], -1)


@pytest.fixture(scope="module")
def shown(film):
    """Return the pixels that both frames show: of what is still, of each thing, and both."""
    turned = rays(film) @ film.rotation.T
    still_flow = film.focal * (turned[..., :2] / turned[..., 2:] - rays(film)[..., :2])
    # Half a pixel of parallax, as benchmarks/solve has it: less of it shows no depth.
    clear = np.linalg.norm(film.flow - still_flow, axis=-1) > 0.5
    return {
        "still": ~film.hidden & (film.mover == 0) & clear,
        "rigid": ~film.hidden & (film.mover == 1),
        "flexible": ~film.hidden & (film.mover == 2),
        "both": ~film.hidden,
    }


@pytest.fixture(scope="module")
def errors(film, shown):
    """Return a function that gives mean |z / truth - 1| of what is still and of each thing.

    After one scale for all, the median over what is still. No depth is an error of 1.
    """

    def measured(found):
        truth = film.depth
        scale = np.nanmedian((truth / found.depth)[shown["still"]])
        off = np.nan_to_num(np.abs(scale * found.depth / truth - 1), nan=1.0)
        return {name: float(off[shown[name]].mean()) for name in ("still", "rigid", "flexible")}

    return measured


@pytest.fixture(scope="module")
def exact(film):
    """The default way, dense, from exact flow."""
    return two_frame(seen(film))


@pytest.fixture(scope="module")
def noisy(film):
    """Regions alone, and the default way, from the same flow with noise."""
    given = seen(film, NOISE)
    return two_frame(given, REGIONS), two_frame(given)


def regions_of(found, inside):
    """Return the regions that a tenth or more of some pixels belong to, largest first."""
    count = np.bincount(found.labels[inside], minlength=len(found.regions))
    return [found.regions[k] for k in np.argsort(-count) if count[k] >= 0.1 * inside.sum()]


def test_exact_flow_gives_the_rendered_depth(exact, errors, shown):
    off = errors(exact)
    assert off["still"] < 0.002
    assert off["rigid"] < 0.01
    assert off["flexible"] < 0.15
    assert exact.valid[shown["both"]].mean() > 0.98


def test_what_moves_is_what_the_renderer_moved(exact, film, shown):
    said, true = exact.moving & shown["both"], film.moving & shown["both"]
    assert (said & true).sum() / (said | true).sum() > 0.95


def test_the_box_is_rigid_and_the_dog_bends_and_both_stand_on_the_floor(exact, shown):
    (box,) = regions_of(exact, shown["rigid"])
    assert (box.kind, box.evidence) == (Kind.RIGID, Evidence.CONTACT)
    dog = regions_of(exact, shown["flexible"])
    assert {(each.kind, each.evidence) for each in dog} == {(Kind.FLEXIBLE, Evidence.CONTACT)}
    assert box.label not in {each.label for each in dog}


def test_parts_that_bend_and_touch_are_one_thing_with_one_scale(exact, shown):
    dog = regions_of(exact, shown["flexible"])
    assert len(dog) > 1
    assert len({(each.scale_spread, each.confidence) for each in dog}) == 1


def test_the_cameras_motion_is_the_renderers(exact, film):
    pose = exact.camera_motion.pose
    np.testing.assert_allclose(pose.rotation, film.rotation, atol=1e-5)
    way = film.translation / np.linalg.norm(film.translation)
    np.testing.assert_allclose(pose.translation, way, atol=1e-4)


def test_the_dense_step_halves_what_noise_does_to_the_still_world(noisy, errors):
    before, after = map(errors, noisy)
    assert after["still"] < 0.6 * before["still"]
    for name in ("rigid", "flexible"):
        assert after[name] < before[name] + 0.02


@pytest.fixture(scope="module")
def flow_errors(film, shown):
    """Return a function that gives the pixels by which depth and motion miss the true flow."""

    def measured(found):
        turns = [cv2.Rodrigues(each)[0] for each in found.rotation.reshape(-1, 3)]
        rotation = np.reshape(turns, (*found.depth.shape, 3, 3))
        key = rays(film)
        there = np.einsum("hwab,hwb->hwa", rotation, key)
        there += found.translation / found.depth[..., None]
        said = film.focal * (there[..., :2] / there[..., 2:] - key[..., :2])
        off = np.linalg.norm(said - film.flow, axis=-1)
        return {name: float(off[shown[name] & found.valid].mean()) for name in shown}

    return measured


def test_depth_and_motion_say_the_true_flow_better_than_it_was_given(noisy, flow_errors):
    before, after = map(flow_errors, noisy)
    # Noise of .1 in both components is off by .1 √(π / 2) = .125 pixels on average.
    for name in ("still", "rigid"):
        assert after[name] < 0.5 * NOISE * np.sqrt(np.pi / 2)
        assert after[name] < 0.6 * before[name]
    # What bends is smoothed more than noise asks for, but less than regions do it.
    assert after["flexible"] < 0.85 * before["flexible"]


def test_a_prior_carries_what_is_hidden_and_leaves_alone_what_is_seen(exact, film, shown, errors):
    wave = 1 + 0.1 * np.sin(20 * rays(film)[..., 0])
    truth = film.depth
    prior = Prior(3 * truth * wave, np.full(truth.shape, 0.1))
    found = two_frame(seen(film, prior=prior))
    assert found.valid.all()
    assert found.prior_share[film.hidden].min() > 0.9
    assert np.median(found.prior_share[shown["still"]]) < 0.01
    assert errors(found)["still"] < 0.002
    assert errors(found)["flexible"] < 0.9 * errors(exact)["flexible"]
    scale = np.median((truth / found.depth)[shown["still"]])
    assert np.abs(scale * found.depth / truth - 1)[film.hidden].mean() < 0.08


def test_a_right_view_puts_both_things_where_they_are_in_metres(film, shown):
    depth = film.depth
    flow = np.zeros((*depth.shape, 2), np.float32)
    flow[..., 0] = -film.focal * film.baseline / depth
    stereo = Stereo(flow, np.full(depth.shape, 0.05, np.float32), float(film.baseline))
    found = two_frame(seen(film, stereo=stereo))
    assert found.metric
    assert {each.evidence for each in found.regions[1:]} == {Evidence.STEREO}
    for name, most in (("still", 0.002), ("rigid", 0.002), ("flexible", 0.01)):
        off = np.abs(found.depth / depth - 1)[shown[name]]
        assert off.mean() < most, name
    way = np.median(found.translation[shown["still"]], axis=0)
    most = 0.005 * np.linalg.norm(film.translation)
    np.testing.assert_allclose(way, film.translation, atol=most)


def test_the_frame_before_shows_what_the_one_after_hides(film, exact):
    noise = np.where(film.hidden_before, np.nan, 0.01).astype(np.float32)
    found = two_frame(seen(film, third=ThirdFrame(film.flow_before, noise)))
    truth = film.depth
    hidden = film.hidden & ~film.hidden_before & (film.mover == 0)
    assert hidden.sum() > 300
    assert not exact.valid[hidden].any()
    assert found.valid[hidden].mean() > 0.98
    still = (film.mover == 0) & found.valid
    scale = np.median((truth / found.depth)[still])
    assert np.abs(scale * found.depth / truth - 1)[hidden & found.valid].mean() < 0.001


def test_spread_is_less_by_what_smoothing_takes_from_independent_errors(noisy, film, shown):
    before, after = noisy
    inside = shown["still"] & before.valid & after.valid
    assert np.median(after.spread[inside] / before.spread[inside]) < 0.8
    for found in noisy:
        scale = np.median((film.depth / found.depth)[inside])
        off = np.abs(np.log(scale * found.depth / film.depth))[inside]
        assert 0.6 < (off < found.spread[inside]).mean() < 0.95


def test_spread_stays_where_neighbours_err_alike(film, shown):
    drawn = np.random.default_rng(7).standard_normal(film.flow.shape)
    alike = cv2.GaussianBlur(drawn, (0, 0), 6.0)
    alike *= NOISE / alike.std()
    given = replace(seen(film, NOISE), flow=(film.flow + alike).astype(np.float32))
    before, after = two_frame(given, REGIONS), two_frame(given)
    inside = shown["still"] & before.valid & after.valid
    # But for the noise that what moves by itself makes of it.
    most = 1 / before.camera_motion.noise_factor
    assert np.median(after.spread[inside] / before.spread[inside]) > 0.9 * most
