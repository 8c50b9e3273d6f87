import os
from concurrent.futures import ThreadPoolExecutor
from hashlib import sha256

import numpy as np
import pytest

from flexdepth.runtime.depthmap import Space
from flexdepth.runtime.errors import InputError
from flexdepth.runtime.model import Provider, load_model

onnx = pytest.importorskip("onnx")


def refusal(path, **changes):
    with pytest.raises(InputError) as caught:
        load_model(path, **changes)
    assert "\n" not in str(caught.value)
    return str(caught.value)


def test_a_bundle_says_what_it_is(make_bundle):
    path = make_bundle()
    model = load_model(path)
    assert model.title == "tiny 1.2"
    assert model.digest == sha256(path.read_bytes()).hexdigest()
    about = model.description
    assert (about.space, about.area, about.multiple) == (Space.METRIC, (128, 96), 32)
    assert (about.canonical_focal, about.licence, about.source) == (0.5, "MIT", "a test")


def test_a_run_gives_depth_and_sky_of_each_picture(make_bundle):
    images = np.zeros((2, 3, 32, 64), np.float32)
    images[1] = 1
    answer = load_model(make_bundle(), threads=1).run(images)
    depth, sky = answer.depth, answer.sky
    assert answer.spread is None
    assert answer.focal is None
    assert depth.shape == sky.shape == (2, 32, 64)
    assert (depth[0] == 1).all()
    assert (depth[1] == 2).all()
    assert not sky[0].any()
    assert sky[1].all()


def test_threads_may_share_a_model(make_bundle):
    model = load_model(make_bundle())

    def depth_of(brightness):
        return model.run(np.full((1, 3, 32, 32), brightness, np.float32)).depth.mean()

    brightness = np.linspace(0, 0.9, 40)
    with ThreadPoolExecutor(8) as pool:
        found = list(pool.map(depth_of, brightness))
    np.testing.assert_allclose(found, 1 + brightness, atol=1e-5)


@pytest.mark.parametrize(
    ("name", "value", "wanted"),
    [
        ("format", 2, "wanted 1, got 2"),
        ("format", None, "wanted 1, got None"),
        ("name", None, "a line of text, got nothing"),
        ("name", "two\nlines", "a line of text"),
        ("licence", 7, "a line of text, got 7"),
        ("space", "affine_disparity", "'metric' or 'scale'"),
        ("space", [], "'metric' or 'scale'"),
        ("area", [384], "[width, height]"),
        ("area", [384, 10**9], "[width, height]"),
        ("area", [384, 288.5], "[width, height]"),
        ("multiple", 0, "a whole number"),
        ("multiple", True, "a whole number"),
        ("canonical_focal", 0, "a number > 0"),
        ("canonical_focal", float("nan"), "a number > 0"),
        ("canonical_focal", float("inf"), "a number > 0"),
        ("canonical_focal", "1", "a number > 0, got '1'"),
        ("scale_spread", 0, "a number > 0"),
        ("scale_spread", "wide", "a number > 0, got 'wide'"),
    ],
)
def test_a_wrong_field_is_named_with_what_was_wanted_and_what_came(
    name, value, wanted, make_bundle
):
    path = make_bundle(**{name: value})
    said = refusal(path)
    assert said.startswith(f"{path}: metadata `{name}`: ")
    assert wanted in said


@pytest.mark.parametrize(
    ("properties", "said"),
    [
        ({}, "wanted a bundle with the metadata `flexdepth`"),
        ({"flexdepth": "{"}, "no JSON"),
        ({"flexdepth": "[]"}, "wanted an object, got '[]'"),
    ],
)
def test_a_model_that_is_no_bundle_is_refused(properties, said, make_bundle):
    path = make_bundle()
    model = onnx.load(path)
    onnx.helper.set_model_props(model, properties)
    onnx.save(model, path)
    assert said in refusal(path)


def test_fields_of_the_future_do_no_harm(make_bundle):
    assert load_model(make_bundle(trained_on="rooms")).title == "tiny 1.2"


GRAPHS = {
    "inputs: wanted `image` alone, got ['picture']": "<o> g (float[b,3,h,w] picture) => "
    "(float[b,h,w] depth, float[b,h,w] sky) { a = Constant<value_ints: ints = [1]>()"
    " depth = ReduceMean<keepdims=0>(picture, a) sky = Identity(depth) }",
    "outputs: wanted `depth` and `sky`, got ['depth']": "<o> g (float[b,3,h,w] image) => "
    "(float[b,h,w] depth) { a = Constant<value_ints: ints = [1]>()"
    " depth = ReduceMean<keepdims=0>(image, a) }",
    "`depth`: wanted tensor(float) of 3 axes, got tensor(float) of [": "<o> g (float[b,3,h,w] "
    "image) => (float[b,1,h,w] depth, float[b,h,w] sky) { a = Constant<value_ints: ints = [1]>()"
    " depth = ReduceMean<keepdims=1>(image, a) sky = ReduceMean<keepdims=0>(image, a) }",
    "`image`: wanted (batch, 3, height, width) with batch, height and width free": "<o> g "
    "(float[1,3,h,w] image) => (float[b,h,w] depth, float[b,h,w] sky)"
    " { a = Constant<value_ints: ints = [1]>() depth = ReduceMean<keepdims=0>(image, a)"
    " sky = Identity(depth) }",
}


@pytest.mark.parametrize("said", GRAPHS)
def test_a_network_with_other_inputs_and_outputs_is_refused(said, make_bundle):
    graph = GRAPHS[said].replace("<o>", '<ir_version: 10, opset_import: ["" : 18]>')
    assert said in refusal(make_bundle(graph=graph))


@pytest.mark.parametrize("place", ["weights", "constant", "branch", "function", "sparse"])
def test_a_model_that_reaches_for_other_files_is_never_opened(place, make_bundle, tmp_path):
    path = make_bundle()
    model = onnx.load(path)
    (tmp_path / "secret.bin").write_bytes(bytes(4))
    outside = onnx.TensorProto(
        name="outside", data_type=1, dims=[1], data_location=onnx.TensorProto.EXTERNAL
    )
    outside.external_data.add(key="location", value="secret.bin")
    constant = onnx.NodeProto(op_type="Constant", output=["secret"])
    constant.attribute.add(name="value", type=onnx.AttributeProto.TENSOR).t.CopyFrom(outside)
    match place:
        case "weights":
            model.graph.initializer.append(outside)
        case "constant":
            model.graph.node.append(constant)
        case "branch":
            branch = model.graph.node.add(op_type="If").attribute.add(name="then_branch")
            branch.type = onnx.AttributeProto.GRAPH
            branch.g.node.append(constant)
        case "function":
            model.functions.add(name="f").node.append(constant)
        case "sparse":
            model.graph.sparse_initializer.add().values.CopyFrom(outside)
    path.write_bytes(model.SerializeToString())
    assert "keeps weights in other files" in refusal(path)


@pytest.mark.parametrize(
    ("content", "said"),
    [
        (b"no model at all", "wanted an ONNX model"),
        (b"\x89PNG\r\n\x1a\n" + bytes(64), "cannot open the model"),
        (b"\x08\x0a", "cannot open the model"),
        (b"", "empty"),
        (None, "does not exist"),
    ],
)
def test_a_file_that_is_no_model_is_refused_by_name(content, said, tmp_path):
    path = tmp_path / "weights.onnx"
    if content is not None:
        path.write_bytes(content)
    refused = refusal(path)
    assert refused.startswith(f"{path}: ")
    assert said in refused


def test_a_checkpoint_is_answered_with_the_command_that_makes_a_bundle_of_it(tmp_path):
    path = tmp_path / "best.safetensors"
    path.write_bytes(b"\x10\0\0\0\0\0\0\0{}              ")
    assert f"make a bundle of the checkpoint first: flexdepth export {path}" in refusal(path)


def test_a_truncated_bundle_is_refused(make_bundle):
    path = make_bundle()
    os.truncate(path, path.stat().st_size // 2)
    assert str(path) in refusal(path)


def test_a_folder_is_no_model(tmp_path):
    assert "is a folder" in refusal(tmp_path)


def test_a_provider_that_is_not_there_is_answered_with_those_that_are(make_bundle):
    said = refusal(make_bundle(), provider=Provider.DIRECTML)
    assert "--provider directml" in said
    assert "has cpu" in said
    assert "pip install onnxruntime-directml" in said


def test_a_run_needs_a_thread(make_bundle):
    assert "--threads: wanted a number of threads >= 1, got 0" in refusal(make_bundle(), threads=0)


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (("Add(mean, one)", "Sub(mean, one)"), "output `depth`: wanted numbers > 0, got values"),
        (("Add(mean, one)", "Div(one, mean)"), "output `depth`: wanted numbers > 0, got values"),
        (("Add(mean, one)", "Div(mean, mean)"), "output `depth`: wanted numbers > 0, got values"),
        (("Cast<to = 1>(white)", "Sub(mean, one)"), "output `sky`: wanted probabilities"),
        (("Cast<to = 1>(white)", "Div(mean, mean)"), "output `sky`: wanted probabilities"),
        (("ints = [1]", "ints = [3]"), "output `depth`: wanted the shape"),
    ],
)
def test_numbers_that_are_no_depth_are_refused(change, said, make_bundle, tiny_graph):
    model = load_model(make_bundle(graph=tiny_graph.replace(*change)))
    with pytest.raises(InputError, match=said):
        model.run(np.zeros((1, 3, 32, 32), np.float32))


def test_what_the_network_cannot_do_is_said_with_the_size(make_bundle, tiny_graph):
    graph = tiny_graph.replace("Add(mean, one)", "Reshape(mean, sevens)").replace(
        "    axes", "    sevens = Constant<value_ints: ints = [-1, 7, 7]>()\n    axes", 1
    )
    model = load_model(make_bundle(graph=graph))
    with pytest.raises(InputError, match="cannot run at 64 x 32 pixels"):
        model.run(np.zeros((1, 3, 32, 64), np.float32))
