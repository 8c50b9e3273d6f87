import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from flexdepth.runtime.errors import InputError
from flexdepth.runtime.images import Photo
from flexdepth.runtime.looks import once
from flexdepth.runtime.model import load_model
from flexdepth.runtime.predictor import Predictor
from flexdepth.runtime.sizes import resized
from flexdepth.runtime.tiles import Seen, closer, joined, strips, tiling

WIDTH, HEIGHT = 240, 180
GRID = (4, 3)
PLACES = np.zeros((HEIGHT, WIDTH, 3), np.uint8)
PLACES[..., 0], PLACES[..., 1] = np.arange(WIDTH), np.arange(HEIGHT)[:, None]
X, Y = (np.float32(each) for each in np.meshgrid(np.arange(WIDTH), np.arange(HEIGHT)))
HILLS = (np.sin(X / 40) + np.cos(Y / 50)).astype(np.float32)
NO_SKY = np.zeros_like(HILLS)


def at(pixels):
    """Return rows and columns of a part of the picture that tells its places."""
    left, top, _ = map(int, pixels[0, 0])
    return slice(top, top + pixels.shape[0]), slice(left, left + pixels.shape[1])


def with_tiles(log_depth, tile, whole_sky=NO_SKY, tile_sky=NO_SKY):
    """Join a whole that sees `log_depth` with tiles that see `tile(number, place)`."""
    places = []

    def look(pixels):
        places.append(at(pixels))
        return Seen(np.float32(tile(len(places) - 1, places[-1])), tile_sky[places[-1]])

    return joined(PLACES, Seen(log_depth, whole_sky), GRID, look)


def largest_step(values):
    return max(abs(np.diff(values, axis=0)).max(), abs(np.diff(values, axis=1)).max())


@given(st.integers(1, 700), st.integers(1, 12))
def test_the_weights_of_the_strips_sum_to_one_at_every_pixel(length, count):
    found = strips(length, count)
    total = np.zeros(length)
    for strip in found:
        total[strip.pixels] += strip.weights
    np.testing.assert_allclose(total, 1, atol=1e-6)
    assert len(found) == count
    assert len({len(strip.weights) for strip in found}) == 1


def test_two_strips_share_the_pixel_between_them():
    left, right = strips(5, 2)
    np.testing.assert_allclose(left.weights, [1, 1, 0.5])
    np.testing.assert_allclose(right.weights, [0.5, 1, 1])
    assert (left.pixels, right.pixels) == (slice(0, 3), slice(2, 5))


@given(st.integers(300, 3000), st.integers(1, 8))
def test_weights_rise_and_fall_without_a_step(length, count):
    for strip in strips(length, count):
        assert abs(np.diff(strip.weights)).max(initial=0) < 5 / len(strip.weights)
        assert strip.start == 0 or strip.weights[0] < 0.02
        assert strip.pixels.stop == length or strip.weights[-1] < 0.02


@pytest.mark.parametrize(
    ("picture", "most", "grid"),
    [
        ((4000, 3000), 4, (4, 3)),
        ((3000, 4000), 4, (3, 4)),
        ((4000, 3000), 1, (1, 1)),
        ((3000, 3000), 5, (5, 5)),
        ((6000, 1000), 4, (4, 1)),
        ((640, 480), 9, (2, 2)),
        ((600, 400), 9, (1, 1)),
        ((5000, 1), 9, (1, 1)),
        ((1, 1), 9, (1, 1)),
    ],
)
def test_tiles_are_nearly_square_and_as_many_as_the_pixels_are_worth(picture, most, grid):
    assert tiling(*picture, most, 384 * 288) == grid


def test_tiles_that_agree_with_the_whole_change_nothing():
    rough = HILLS + np.random.default_rng(0).normal(size=HILLS.shape).astype(np.float32)
    sky = np.random.default_rng(1).uniform(size=HILLS.shape).astype(np.float32)
    found = with_tiles(rough, lambda _, place: rough[place], sky, sky)
    np.testing.assert_allclose(found.log_depth, rough, atol=1e-5)
    np.testing.assert_allclose(found.sky, sky, atol=1e-5)


def test_a_factor_on_each_tile_leaves_no_trace():
    factors = np.random.default_rng(2).normal(size=12)
    found = with_tiles(HILLS, lambda number, place: HILLS[place] + factors[number])
    np.testing.assert_allclose(found.log_depth, HILLS, atol=1e-5)


def test_tiles_that_are_bent_and_tilted_leave_no_seam():
    rng = np.random.default_rng(3)
    bends, tilts, shifts = (
        rng.uniform(0.5, 2, 12),
        rng.uniform(-0.01, 0.01, 12),
        rng.normal(size=12),
    )

    def tile(number, place):
        return bends[number] * HILLS[place] + tilts[number] * X[place] + shifts[number]

    found = with_tiles(HILLS, tile).log_depth
    inner = (slice(12, -12), slice(12, -12))
    assert largest_step(found[inner]) < 1.2 * largest_step(HILLS[inner])
    np.testing.assert_allclose(found, HILLS, atol=0.1)


def test_what_only_tiles_see_is_in_the_result():
    posts = np.where(X % 40 == 20, np.float32(-0.5), np.float32(0))
    found = with_tiles(HILLS, lambda number, place: (HILLS + posts)[place] + number).log_depth
    np.testing.assert_allclose((found - HILLS)[posts < 0], -0.5, atol=0.1)
    np.testing.assert_allclose((found - HILLS)[posts == 0], 0, atol=0.1)


def test_what_a_blind_tile_does_not_see_stays():
    step = np.where(X < 100, np.float32(0), np.float32(1))
    found = with_tiles(step, lambda _, place: np.zeros_like(X[place])).log_depth
    np.testing.assert_allclose(found, step, atol=0.05)


def test_a_tile_takes_no_wall_for_sky_but_draws_the_wire_before_it():
    found = with_tiles(HILLS, lambda _, place: HILLS[place], NO_SKY, NO_SKY + 1)
    np.testing.assert_allclose(found.sky, 0, atol=1e-5)
    wire = np.where(X % 40 == 20, np.float32(0), np.float32(1))
    found = with_tiles(HILLS, lambda _, place: HILLS[place], NO_SKY + 1, wire)
    assert ((found.sky > 0.5) == (wire > 0.5)).all()


def test_rubbish_in_the_sky_does_not_touch_what_is_before_it():
    sky = np.where(Y < 70, np.float32(1), np.float32(0))
    rubbish = sky * np.float32(np.random.default_rng(4).normal(5, 3, HILLS.shape))
    found = with_tiles(HILLS, lambda _, place: (HILLS + rubbish)[place], sky, sky)
    np.testing.assert_allclose(found.log_depth[70:], HILLS[70:], atol=0.02)


def test_a_coarse_whole_lies_on_its_tiles_without_a_shift():
    """A ramp is seen at a sixth of its size and, in tiles, at half: means of the same pixels."""
    ramp = X / 10
    whole = Seen(resized(ramp, (40, 30)), np.zeros((30, 40), np.float32))

    def look(pixels):
        part = ramp[at(pixels)]
        small = resized(np.ascontiguousarray(part), (part.shape[1] // 2, part.shape[0] // 2))
        return Seen(small, np.zeros_like(small))

    found = joined(PLACES, whole, GRID, look).log_depth
    np.testing.assert_allclose(found[:, 12:-12], ramp[:, 12:-12], atol=0.02)


def seen(log_depth, sky=NO_SKY):
    """Return what is seen at full size, and at a half."""
    half = WIDTH // 2, HEIGHT // 2
    return Seen(log_depth, sky), Seen(resized(log_depth, half), resized(sky, half))


def test_the_same_picture_seen_larger_changes_nothing():
    larger, whole = seen(HILLS)
    found = closer(whole, larger)
    np.testing.assert_allclose(found.log_depth, HILLS, atol=0.02)
    np.testing.assert_array_equal(found.sky, 0)


def test_a_factor_and_a_slow_drift_of_the_larger_look_leave_no_trace():
    larger, whole = seen(HILLS)
    found = closer(whole, Seen(HILLS + 3 + 0.01 * X, larger.sky)).log_depth
    np.testing.assert_allclose(found[:, 32:-32], HILLS[:, 32:-32], atol=0.03)


def test_what_only_the_larger_look_sees_is_in_the_result():
    posts = np.where(X % 40 == 20, np.float32(-0.5), np.float32(0))
    _, whole = seen(HILLS)
    found = closer(whole, Seen(HILLS + posts + 2, NO_SKY)).log_depth
    np.testing.assert_allclose((found - HILLS)[posts < 0], -0.5, atol=0.12)
    np.testing.assert_allclose((found - HILLS)[posts == 0], 0, atol=0.1)


@pytest.fixture
def model(make_bundle):
    return load_model(make_bundle())


def striped(width, height):
    columns = np.where(np.arange(width) // 4 % 2, 60, 180).astype(np.uint8)
    return Photo(np.repeat(np.repeat(columns[None], height, 0)[..., None], 3, 2), 0.5, ())


def test_a_small_photo_is_looked_at_whole(model):
    photo = striped(150, 110)
    whole, tiled = (Predictor(model, tiles=tiles).predict(photo).values for tiles in (1, 4))
    assert (whole == tiled).all()


@pytest.mark.usefixtures("edges_as_seen")
def test_tiles_show_the_stripes_that_the_whole_blurs(model):
    photo = striped(1203, 901)
    truth = 1 + photo.pixels[..., 0] / 255
    whole, tiled = (
        abs(Predictor(model, tiles=tiles).predict(photo).depth - truth).mean() for tiles in (1, 8)
    )
    assert whole > 0.2
    assert tiled < 0.4 * whole


@pytest.mark.usefixtures("edges_as_seen")
def test_a_larger_look_shows_the_stripes_that_one_blurs(model):
    photo = striped(301, 226)
    truth = 1 + photo.pixels[..., 0] / 255
    one, two = (
        abs(Predictor(model, details=details).predict(photo).depth - truth).mean()
        for details in (1, 3)
    )
    assert one > 0.1
    assert two < 0.5 * one


@pytest.mark.parametrize(
    ("size", "long_side"), [((110, 80), None), ((400, 300), 160)], ids=["small", "shown large"]
)
def test_no_larger_look_where_one_shows_all(size, long_side, model):
    photo = striped(*size)
    one, two = (
        Predictor(model, long_side=long_side, details=details).predict(photo).values
        for details in (1, 2)
    )
    assert (one == two).all()


def test_the_larger_look_is_not_larger_than_the_photo(model, monkeypatch):
    seen, run = [], type(model).run
    monkeypatch.setattr(type(model), "run", lambda self, x: seen.append(x.shape) or run(self, x))
    Predictor(model, look=once, details=9).predict(striped(301, 226))
    multiple = model.description.multiple
    assert seen[0][-1] < 301 - multiple
    assert abs(seen[1][-1] - 301) <= multiple / 2
    assert abs(seen[1][-2] - 226) <= multiple / 2


def test_photos_that_share_a_run_have_the_details_that_each_has_alone(model):
    photos = [striped(301, 226), Photo(striped(301, 226).pixels[:, ::-1].copy(), 0.5, ())]
    together = Predictor(model).predict_all(photos)
    for photo, found in zip(photos, together, strict=True):
        alone = Predictor(model).predict(photo)
        np.testing.assert_allclose(found.values, alone.values, rtol=1e-4)


def test_a_smooth_photo_is_the_same_in_tiles(model):
    levels = (np.sin(np.arange(801) / 130) * 100 + 120)[None] * np.ones((603, 1))
    photo = Photo(np.repeat(levels.astype(np.uint8)[..., None], 3, 2), 0.5, ())
    found = Predictor(model, tiles=5).predict(photo).depth
    np.testing.assert_allclose(found, Predictor(model).predict(photo).depth, rtol=0.01)


@pytest.mark.parametrize("name", ["tiles", "details"])
def test_none_are_no_way_to_look(name, model):
    with pytest.raises(InputError, match=f"--{name}: wanted a whole number >= 1, got 0"):
        Predictor(model, **{name: 0})
