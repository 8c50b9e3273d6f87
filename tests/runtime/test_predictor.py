import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from PIL import Image

from flexdepth.runtime.depthmap import FocalSource, Space
from flexdepth.runtime.errors import InputError
from flexdepth.runtime.images import Photo
from flexdepth.runtime.lens import FieldOfView, FocalLength
from flexdepth.runtime.looks import mirrored_too, once
from flexdepth.runtime.model import load_model
from flexdepth.runtime.predictor import Predictor, photo_of


@pytest.fixture
def predictor(make_bundle):
    """A predictor whose canonical depth is 1 + brightness; canonical focal: half a diagonal."""
    return Predictor(load_model(make_bundle()))


def gray(width, height, level=0, focal_in_diagonals=None):
    return Photo(np.full((height, width, 3), level, np.uint8), focal_in_diagonals, ())


def test_a_photo_that_tells_its_lens_is_measured_in_metres(predictor):
    found = predictor.predict(gray(40, 30, 51, focal_in_diagonals=0.75))
    assert found.space is Space.METRIC
    assert found.intrinsics.source is FocalSource.EXIF
    assert found.intrinsics.focal_x == pytest.approx(0.75 * 50)
    assert found.values.shape == (30, 40)
    np.testing.assert_allclose(found.depth, 1.2 * 0.75 / 0.5, rtol=1e-5)
    assert found.model == "tiny 1.2"


def test_a_given_lens_comes_before_that_of_the_photo(predictor):
    given_one = Predictor(predictor.model, FocalLength(50))
    found = given_one.predict(gray(40, 30, 51, focal_in_diagonals=0.75))
    assert found.space is Space.METRIC
    assert found.intrinsics.source is FocalSource.GIVEN
    np.testing.assert_allclose(found.depth, 1.2 * 1.0 / 0.5, rtol=1e-5)
    wide = Predictor(predictor.model, FieldOfView(90)).predict(gray(40, 30, 51))
    np.testing.assert_allclose(wide.depth, 1.2 * (20 / 50) / 0.5, rtol=1e-5)


def test_a_photo_without_a_lens_has_no_metres(predictor):
    found = predictor.predict(gray(40, 30))
    assert found.space is Space.SCALE
    assert found.intrinsics.source is FocalSource.ASSUMED
    assert found.intrinsics.focal_x == pytest.approx(20 * 3**0.5)


def test_a_model_without_metres_gives_none(make_bundle):
    predictor = Predictor(load_model(make_bundle(space="scale")), FocalLength(50))
    found = predictor.predict(gray(40, 30))
    assert found.space is Space.SCALE
    assert found.intrinsics.source is FocalSource.GIVEN


def test_white_is_sky_and_infinitely_far(predictor):
    photo = gray(128, 96)
    photo.pixels[:48] = 255
    found = predictor.predict(photo)
    assert found.sky[:48].all()
    assert not found.sky[48:].any()
    assert np.isposinf(found.depth[:48]).all()


def test_a_map_lies_on_its_photo_without_a_shift(predictor):
    ramp = np.repeat(np.linspace(0, 240, 640, dtype=np.float32)[None], 480, axis=0)
    photo = Photo(np.repeat(ramp.astype(np.uint8)[..., None], 3, axis=2), 0.5, ())
    found = predictor.predict(photo).depth
    wanted = 1 + photo.pixels[..., 0] / 255
    pixel_step = 240 / 255 / 640
    np.testing.assert_allclose(found[:, 8:-8], wanted[:, 8:-8], atol=3 * pixel_step)
    both_ways = Predictor(predictor.model, look=mirrored_too)
    seen = both_ways.predict(photo).depth
    mirrored = both_ways.predict(Photo(photo.pixels[:, ::-1], 0.5, ())).depth
    np.testing.assert_allclose(mirrored[:, ::-1], seen, atol=1e-5)


@pytest.mark.usefixtures("edges_as_seen")
def test_between_two_depths_lies_their_geometric_mean(predictor):
    found = predictor.predict(gray(1, 1, 51, focal_in_diagonals=0.5)).depth
    assert found.shape == (1, 1)
    assert found[0, 0] == pytest.approx(1.2 * 24**0.5 / 5, rel=1e-5)
    steps = np.zeros((3072, 64, 3), np.uint8)
    steps[1536:] = 250
    long = Predictor(predictor.model, long_side=64).predict(Photo(steps, 0.5, ())).depth
    middle = long[1535:1537].mean()
    by_area = np.hypot(64, 3072) / (5 * (64 * 3072 / 12) ** 0.5)
    assert middle == pytest.approx((1 + 250 / 255) ** 0.5 * by_area, rel=1e-3)


@settings(suppress_health_check=[HealthCheck.function_scoped_fixture], max_examples=30)
@given(st.integers(1, 300), st.integers(1, 300), st.integers(0, 250))
def test_every_size_comes_back_as_it_went_in(predictor, width, height, level):
    found = predictor.predict(gray(width, height, level, focal_in_diagonals=0.5))
    assert found.values.shape == (height, width)
    by_area = (width * width + height * height) ** 0.5 / (5 * (width * height / 12) ** 0.5)
    np.testing.assert_allclose(found.depth, (1 + level / 255) * by_area, rtol=1e-5)


@pytest.mark.parametrize("size", [(1, 5000), (5000, 1), (1, 70000)])
def test_a_thread_of_a_picture_is_a_picture(predictor, size):
    found = predictor.predict(gray(*size))
    assert found.values.shape == size[::-1]
    assert found.valid.all()


def test_a_batch_is_its_pictures_one_by_one(predictor):
    rng = np.random.default_rng(0)
    sizes = [(40, 30), (80, 60), (30, 40), (64, 48)]
    photos = [
        Photo(rng.integers(0, 250, (height, width, 3), np.uint8), focal, ())
        for (width, height), focal in zip(sizes, (None, 0.6, 0.7, 0.8), strict=True)
    ]
    together = predictor.predict_all(photos)
    for photo, found in zip(photos, together, strict=True):
        alone = predictor.predict(photo)
        np.testing.assert_allclose(found.values, alone.values, rtol=1e-6)
        assert (found.space, found.intrinsics) == (alone.space, alone.intrinsics)


def test_no_photos_have_no_maps(predictor):
    assert predictor.predict_all([]) == []


def test_a_file_an_array_and_a_photo_are_one_picture(predictor, tmp_path):
    pixels = np.random.default_rng(1).integers(0, 250, (30, 40, 3), np.uint8)
    Image.fromarray(pixels).save(tmp_path / "a.png")
    wanted = predictor.predict(Photo(pixels, None, ())).values
    for picture in (tmp_path / "a.png", str(tmp_path / "a.png"), pixels, Image.fromarray(pixels)):
        assert (predictor.predict(picture).values == wanted).all()
    flipped = np.asfortranarray(pixels[::-1, ::-1])[::-1, ::-1]
    assert (predictor.predict(flipped).values == wanted).all()


def test_a_gray_array_is_a_picture(predictor):
    found = predictor.predict(np.full((30, 40), 51, np.uint8))
    assert found.values.shape == (30, 40)


@pytest.mark.parametrize(
    "array",
    [
        np.zeros((30, 40, 3), np.float32),
        np.zeros((30, 40, 4), np.uint8),
        np.zeros((3, 30, 40), np.uint8),
        np.zeros((0, 40, 3), np.uint8),
        np.zeros(3, np.uint8),
        None,
    ],
)
def test_an_array_that_is_no_picture_is_refused(predictor, array):
    with pytest.raises(InputError, match=r"a picture is a non-empty array of uint8, .* got shape"):
        predictor.predict(array)


@pytest.mark.usefixtures("edges_as_seen")
def test_a_look_in_the_mirror_is_joined_with_the_first(make_bundle, tiny_graph):
    """The network here takes what lies on the left for nearer: 1 in a third of it, 2 elsewhere."""
    graph = tiny_graph.replace(
        "depth = Add(mean, one)",
        """last = Constant<value: tensor = int64 {2}>()
        ones = Div(mean, mean)
        column = CumSum(ones, last)
        third = Constant<value: tensor = float[1] {43.0}>()
        leftmost = Less(column, third)
        nearer = Cast<to = 1>(leftmost)
        twos = Add(ones, one)
        depth = Sub(twos, nearer)""",
    )
    model = load_model(make_bundle(graph=graph))
    photo = gray(128, 96, 51, focal_in_diagonals=0.5)
    seen_once = Predictor(model, look=once).predict(photo).depth
    assert seen_once[0, 0] == pytest.approx(1)
    assert seen_once[0, -1] == pytest.approx(2)
    both = Predictor(model, look=mirrored_too).predict(photo).depth
    np.testing.assert_allclose(both[:, :32], 2**0.5, rtol=1e-5)
    np.testing.assert_allclose(both[:, -32:], 2**0.5, rtol=1e-5)
    np.testing.assert_allclose(both[:, 54:-54], 2, rtol=1e-5)


UNSURE = """
        half = Constant<value: tensor = float[1] {0.5}>()
        spread = Mul(mean, half)
        sides = Constant<value: tensor = int64[2] {1, 2}>()
        whole = ReduceMean<keepdims = 0>(depth, sides)
        focal = Mul(whole, half)"""
"""A spread of half the brightness, and a focal length of half the mean depth."""


@pytest.fixture
def unsure(make_bundle, tiny_graph):
    """The predictor of the tests above, which also says how sure it is and which lens it sees."""
    head, body = tiny_graph.split("{", 1)
    outputs = "float[batch, height, width] sky"
    more = ", float[batch, height, width] spread, float[batch] focal"
    assert outputs in head
    graph = head.replace(outputs, outputs + more) + "{" + body.rsplit("}", 1)[0] + UNSURE + "\n}"
    return Predictor(load_model(make_bundle(graph=graph, scale_spread=0.2)))


def test_a_network_that_sees_the_lens_gives_the_camera_but_no_metres(unsure):
    found = unsure.predict(gray(40, 30, 51))
    assert found.intrinsics.source is FocalSource.PREDICTED
    assert found.intrinsics.focal_x == pytest.approx(0.6 * 50, rel=1e-4)
    assert found.space is Space.SCALE
    assert found.scale_spread is None
    np.testing.assert_allclose(found.depth, 1.2 * 0.6 / 0.5, rtol=1e-4)


def test_how_sure_the_network_is_comes_with_the_depth_but_not_in_the_sky(unsure):
    photo = gray(128, 96, 102, focal_in_diagonals=0.5)
    photo.pixels[:48] = 255
    found = unsure.predict(photo)
    assert found.scale_spread == 0.2
    assert np.isnan(found.spread[:48]).all()
    np.testing.assert_allclose(found.spread[49:], 0.2, rtol=1e-5)


def test_two_looks_have_the_mean_of_their_spreads(unsure):
    photo = gray(128, 96, 102)
    photo.pixels[:, :64] = 51
    looks = [Predictor(unsure.model, look=look) for look in (once, mirrored_too)]
    one, both = (each.predict(photo) for each in looks)
    np.testing.assert_allclose(both.spread, one.spread, rtol=1e-4)
    np.testing.assert_allclose(both.intrinsics.focal_x, one.intrinsics.focal_x, rtol=1e-5)


def test_a_mirror_changes_nothing_for_a_network_that_knows_no_left(predictor):
    pixels = np.random.default_rng(2).integers(0, 250, (96, 128, 3), np.uint8)
    looks = [Predictor(predictor.model, look=look) for look in (once, mirrored_too)]
    one, both = (each.predict(pixels) for each in looks)
    np.testing.assert_allclose(both.values, one.values, rtol=1e-5)


@pytest.mark.parametrize(
    ("picture", "complaint"),
    [
        (Image.new("P", (4, 3)), "Pillow picture of mode P"),
        ([[1, 2], [3]], "this is no array"),
    ],
)
def test_what_would_be_read_wrongly_is_refused(picture, complaint):
    with pytest.raises(InputError, match=complaint):
        photo_of(picture)


def test_a_pillow_picture_in_rgb_is_a_picture():
    assert photo_of(Image.new("RGB", (4, 3), (7, 8, 9))).pixels[2, 3].tolist() == [7, 8, 9]
