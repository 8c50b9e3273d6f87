import json
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import flexdepth
from flexdepth.runtime import named
from flexdepth.runtime.depthmap import FocalSource, Space
from flexdepth.runtime.errors import InputError
from flexdepth.runtime.foreign import ForeignPredictor
from flexdepth.runtime.lens import FocalLength
from flexdepth.runtime.looks import mirrored_too
from flexdepth.runtime.named import Wishes, named_estimator
from flexdepth.runtime.predictor import Predictor

onnx = pytest.importorskip("onnx")

RED = """
<ir_version: 10, opset_import: ["" : 18]>
red (float[1, 3, height, width] image) => (float[1, 1, height, width] z, float[1] other)
{
    first = Constant<value: tensor = int64[1] {0}>()
    red = Gather<axis = 1>(image, first)
    z = Identity(red)
    other = Constant<value: tensor = float[1] {7.0}>()
}
"""
"""A network that gives the first of the three colours it is shown."""

REST = "input: {size: [8, 6]}\noutput: {name: z, space: affine_disparity}\n"


@pytest.fixture
def make_network(tmp_path) -> Callable[..., Path]:
    """Return a function that writes an ONNX file, and a card beside it unless it is None."""

    def make(card=REST, graph=RED, file="net.onnx"):
        onnx.save(onnx.parser.parse_model(graph), tmp_path / file)
        if card is not None:
            (tmp_path / "net.yaml").write_text(card)
        return tmp_path / file

    return make


def gray(height, width, red, rest=0):
    picture = np.full((height, width, 3), rest, np.uint8)
    picture[..., 0] = red
    return picture


def test_any_network_with_a_card_beside_it_gives_its_numbers_at_the_size_of_the_picture(
    make_network,
):
    path = make_network()
    for name in (path, path.with_suffix(".yaml")):
        found = flexdepth.load(str(name)).predict(gray(30, 40, 51))
        assert found.space is Space.AFFINE_DISPARITY
        assert found.disparity.shape == (30, 40)
        np.testing.assert_allclose(found.disparity, 0.2, rtol=1e-6)
        assert found.model == "net"


def test_colours_are_normalised_as_the_card_says(make_network):
    path = make_network(
        "input: {size: [8, 6], colours: bgr}\n"
        "normalisation: {scale: 1, mean: [1, 2, 3], std: [10, 1, 1]}\n"
        "output: {name: z, space: affine_disparity}"
    )
    # Blue comes first: (31 - 1) / 10.
    found = flexdepth.load(path).predict(gray(6, 8, red=200, rest=31))
    np.testing.assert_allclose(found.disparity, 3, rtol=1e-6)


def test_the_last_axis_may_hold_the_colours(make_network):
    graph = RED.replace("3, height, width] image", "height, width, 3] image")
    graph = graph.replace("axis = 1", "axis = 3").replace(
        "[1, 1, height, width] z", "[a, b, c, d] z"
    )
    path = make_network(REST.replace("[8, 6]", "[8, 6], layout: nhwc"), graph)
    found = flexdepth.load(path).predict(gray(30, 40, 51))
    np.testing.assert_allclose(found.disparity, 0.2, rtol=1e-6)


def test_a_network_of_free_size_keeps_the_shape_of_the_picture(make_network):
    path = make_network(REST.replace("size: [8, 6]", "area: [64, 48], multiple: 16"))
    shown = []
    estimator = named_estimator(path)

    class Watched:
        digest = "0"
        opened = estimator.network.session.opened

        def run(self, _outputs, inputs, _size):
            shown.append(inputs["image"].shape[2:])
            return [inputs["image"][:, 0]]

    watched = ForeignPredictor(replace(estimator.network, session=Watched()))
    for size in ((375, 1242), (480, 640)):
        watched.predict(gray(*size, 51))
    # KITTI's 3.3:1 at about 3072 pixels, and 4:3.
    assert shown == [(32, 96), (48, 64)]


def test_inverse_depth_is_turned_over_in_the_unit_of_the_card(make_network):
    path = make_network(
        "input: {size: [8, 6]}\noutput: {name: z, space: metric, inverse: true, unit: 0.5}"
    )
    found = flexdepth.load(path).predict(gray(6, 8, 51))
    assert found.space is Space.METRIC
    np.testing.assert_allclose(found.depth, 0.5 / 0.2, rtol=1e-6)


def test_depth_that_is_not_above_zero_is_unknown(make_network):
    path = make_network("input: {size: [8, 6]}\noutput: {name: z, space: metric}")
    picture = gray(6, 8, 51)
    picture[:3] = 0
    found = flexdepth.load(path).predict(picture)
    assert np.isnan(found.depth[:3]).all()
    assert found.valid[3:].all()
    with pytest.raises(InputError, match="holds no usable number"):
        flexdepth.load(path).predict(gray(6, 8, 0))


def test_metres_stay_metres_where_nothing_is_known_of_the_camera(make_network):
    path = make_network("input: {size: [8, 6]}\noutput: {name: z, space: metric}")
    found = flexdepth.load(path).predict(gray(30, 40, 51))
    assert (found.space, found.intrinsics.source) == (Space.METRIC, FocalSource.ASSUMED)
    np.testing.assert_allclose(found.depth, 0.2, rtol=1e-6)


def test_metres_of_a_canonical_camera_need_the_real_one(make_network):
    path = make_network(
        "input: {size: [8, 6]}\noutput: {name: z, space: metric, canonical_focal: 4}"
    )
    assert flexdepth.load(path).predict(gray(30, 40, 51)).space is Space.SCALE
    # 4 pixels of the 8 that the network sees are 20 of the picture's 40.
    found = flexdepth.load(path, FocalLength(60)).predict(gray(30, 40, 51))
    assert found.space is Space.METRIC
    np.testing.assert_allclose(found.depth, 0.2 * 3, rtol=1e-6)


@pytest.mark.parametrize(
    ("card", "said"),
    [
        (REST.replace("z,", "y,"), "`output.name`: wanted one of z, other, got 'y'"),
        (REST.replace("name: z, ", ""), "`output.name`: wanted one of z, other, got nothing"),
        (REST.replace("name: z", "name: other"), "wanted a map of real numbers, got `other`"),
        (REST.replace("{size", "{name: pixels, size"), "`input.name`: wanted one of image"),
    ],
)
def test_a_card_that_does_not_fit_its_network_is_refused(card, said, make_network):
    path = make_network(card)
    with pytest.raises(InputError, match="yaml") as caught:
        flexdepth.load(path).predict(gray(6, 8, 9))
    assert said in str(caught.value)


def test_a_network_of_more_inputs_than_the_picture_is_refused(make_network):
    graph = RED.replace("image) =>", "image, float[1] focal) =>")
    with pytest.raises(InputError, match="only input, got the inputs image, focal"):
        flexdepth.load(make_network(graph=graph))


@pytest.mark.parametrize(
    ("axes", "card", "said"),
    [
        ("1, 3, 5, 5", REST, r"`input.size`: wanted the network's own, \[5, 5\]"),
        ("1, 3, 6, width", REST.replace("8, 6", "8, 5"), r"`input.size`: .* \[None, 6\]"),
        ("1, 3, 6, 8", REST.replace("size: [8, 6]", "area: [8, 6], multiple: 2"), "`input.size`"),
        ("1, 6, 8, 3", REST, "`input.layout`: nchw makes 6 colours"),
        ("1, 3, 6, 8", REST.replace("[8, 6]", "[8, 6], layout: nhwc"), "nhwc makes 8 colours"),
    ],
)
def test_a_card_that_does_not_fit_the_axes_is_refused_before_any_picture(
    axes, card, said, make_network
):
    graph = RED.replace("1, 3, height, width] image", f"{axes}] image")
    graph = graph.replace("[1, 1, height, width] z", "[a, b, c, d] z")
    with pytest.raises(InputError, match=said):
        flexdepth.load(make_network(card, graph))


def test_a_network_that_fails_is_told_in_one_line(make_network):
    # Six rows cannot be looked at as seven.
    graph = RED.replace(
        "z = Identity(red)",
        "seven = Constant<value: tensor = int64[2] {7, 8}>()\n    z = Reshape(red, seven)",
    )
    graph = graph.replace("[1, 1, height, width] z", "[a, b] z")
    estimator = flexdepth.load(make_network(graph=graph))
    with pytest.raises(InputError, match="cannot run at 8 x 6 pixels") as caught:
        estimator.predict(gray(6, 8, 9))
    assert "\n" not in str(caught.value)


def test_without_a_card_the_way_to_one_is_named(make_network):
    with pytest.raises(InputError, match=r"docs/models.md says how a \.yaml file beside it"):
        flexdepth.load(make_network(card=None))


def test_what_a_bundle_says_of_itself_counts_before_a_card(make_bundle):
    path = make_bundle()
    path.with_suffix(".yaml").write_text("seed: 3\n")
    assert isinstance(flexdepth.load(path), Predictor)


def test_the_digest_is_that_of_the_network_and_of_what_the_card_says_of_its_numbers(make_network):
    first, licensed, metric = (
        flexdepth.load(make_network(card)).about.digest
        for card in (REST, REST + "licence: MIT", REST.replace("affine_disparity", "metric"))
    )
    assert first == licensed != metric


def test_a_card_s_licence_is_told_where_it_forbids_commercial_use(make_network):
    path = make_network(REST + "licence: CC-BY-NC-SA-4.0\n")
    with pytest.warns(UserWarning, match="net: the licence CC-BY-NC-SA-4.0 of its weights forbids"):
        flexdepth.load(path)


@pytest.mark.parametrize(
    ("wishes", "said"),
    [
        (Wishes(look=mirrored_too), "--looks, --look, --details and --tiles"),
        (Wishes(details=2), "--looks, --look, --details and --tiles"),
        (Wishes(tiles=2), "--looks, --look, --details and --tiles"),
        (Wishes(long_side=64), "--long-side: .*net.yaml says that the network has one size, 8 x 6"),
    ],
)
def test_what_a_network_cannot_do_is_refused(wishes, said, make_network):
    with pytest.raises(InputError, match=said):
        named_estimator(make_network(), wishes)


def test_the_bundled_model_has_two_names():
    digests = {named_estimator(name).about.digest for name in ("compact", "bundled")}
    assert len(digests) == 1


def test_a_name_that_is_none_is_refused_with_those_there_are(tmp_path):
    with pytest.raises(InputError, match=r"no model 'midas': wanted `bundled`, an \.onnx network"):
        named_estimator("midas")
    (tmp_path / "config.json").write_text(json.dumps({}))
    with pytest.raises(InputError, match=f"say hub:{tmp_path}"):
        named_estimator(tmp_path)


def test_a_room_whose_packages_are_missing_is_told_with_the_line_that_installs_it(monkeypatch):
    def missing(_module):
        raise ModuleNotFoundError("No module named 'transformers'", name="transformers")

    monkeypatch.setattr(named, "import_module", missing)
    with pytest.raises(InputError, match=r'transformers.*: pip install "flexdepth\[hub\]"'):
        named_estimator("hub:a/b")
