import json
import shutil

import numpy as np
import pytest
import torch
import transformers
from PIL import Image
from safetensors.torch import load_file, save_file

import flexdepth
from flexdepth.hub.network import network
from flexdepth.runtime.depthmap import FocalSource, Space
from flexdepth.runtime.errors import InputError
from flexdepth.runtime.named import Wishes, named_estimator
from flexdepth.runtime.session import Provider

FAMILIES = {
    "depth_anything": Space.AFFINE_DISPARITY,
    "depth_anything_metric": Space.METRIC,
    "dpt": Space.AFFINE_DISPARITY,
    "dpt_dinov2": Space.METRIC,
    "glpn": Space.METRIC,
    "zoedepth": Space.METRIC,
    "depth_pro": Space.METRIC,
}


def by_the_library(folder, picture):
    """What transformers' own pipeline says, from the file to the float depth."""
    pipeline = transformers.pipeline("depth-estimation", model=str(folder))
    with np.errstate(all="ignore"):
        return pipeline(Image.fromarray(picture))["predicted_depth"].numpy()


@pytest.mark.parametrize("name", FAMILIES)
def test_a_model_says_what_its_own_library_makes_of_it_in_float(name, saved, picture):
    folder = saved(name)
    found = network(str(folder)).look(picture).values
    assert found.dtype == np.float32
    assert found.std() > 1e-3
    np.testing.assert_array_equal(found, by_the_library(folder, picture))


@pytest.mark.parametrize(("name", "space"), FAMILIES.items())
def test_each_family_means_by_its_numbers_what_its_authors_say(name, space, saved):
    assert network(str(saved(name))).space is space


def test_metres_stay_metres_and_disparity_is_never_called_depth(saved, picture):
    metric = flexdepth.load(f"hub:{saved('zoedepth')}").predict(picture)
    assert metric.space is Space.METRIC
    assert metric.depth.shape == picture.shape[:2]
    # Interpolation overshoots: what lies behind the camera is unknown.
    told = by_the_library(saved("zoedepth"), picture)
    np.testing.assert_array_equal(metric.depth, np.where(told > 0, told, np.nan))
    relative = flexdepth.load(f"hub:{saved('dpt')}").predict(picture)
    assert relative.disparity.shape == picture.shape[:2]
    with pytest.raises(InputError, match="affine disparity"):
        _ = relative.depth


@pytest.mark.filterwarnings("ignore:.*apple-amlr")
def test_depth_pro_brings_its_field_of_view_and_yields_to_one_that_is_known(saved, picture):
    name = f"hub:{saved('depth_pro')}"
    alone = flexdepth.load(name).predict(picture)
    assert (alone.space, alone.intrinsics.source) == (Space.METRIC, FocalSource.PREDICTED)
    seen = alone.intrinsics.focal_x
    known = flexdepth.load(name, flexdepth.FocalLength(2 * seen)).predict(picture)
    assert known.intrinsics.focal_x == pytest.approx(2 * seen)
    # Its numbers are 1/depth for a focal length of one width: depth grows with the focal length.
    np.testing.assert_allclose(known.depth, 2 * alone.depth, rtol=1e-6)
    np.testing.assert_allclose(
        seen, 71 / 2 / np.tan(np.radians(field_of_view(saved("depth_pro"), picture)) / 2), rtol=1e-5
    )


def field_of_view(folder, picture):
    model = transformers.AutoModelForDepthEstimation.from_pretrained(folder).eval()
    shown = transformers.AutoImageProcessor.from_pretrained(folder)(picture, return_tensors="pt")
    return float(model(**shown).field_of_view.detach()[0])


@pytest.mark.filterwarnings("ignore:.*apple-amlr")
def test_depth_pro_without_its_field_of_view_has_metres_only_for_a_known_camera(saved, picture):
    name = f"hub:{saved('depth_pro_without_fov')}"
    unknown = flexdepth.load(name).predict(picture)
    assert (unknown.space, unknown.intrinsics.source) == (Space.SCALE, FocalSource.ASSUMED)
    one_width = flexdepth.load(name, flexdepth.FocalLength(71)).predict(picture)
    assert one_width.space is Space.METRIC
    sight = network(str(saved("depth_pro_without_fov"))).look(picture)
    np.testing.assert_allclose(one_width.depth, sight.values, rtol=1e-6)


def test_the_digest_tells_weights_and_settings_apart(saved, tmp_path):
    folder = saved("glpn")
    first = network(str(folder)).about.digest
    assert network(str(folder)).about.digest == first
    copy = shutil.copytree(folder, tmp_path / "copy")
    assert network(str(copy)).about.digest == first
    change_json(copy / "config.json", max_depth=80)
    assert network(str(copy)).about.digest != first


def change_json(path, **changes):
    path.write_text(json.dumps(json.loads(path.read_text()) | changes))


def refusal(name, **options):
    with pytest.raises(InputError) as caught:
        network(name, **options)
    assert "\n" not in str(caught.value)
    return str(caught.value)


def test_pickled_weights_are_refused(saved, tmp_path):
    folder = shutil.copytree(saved("dpt"), tmp_path / "pickled")
    weights = folder / "model.safetensors"
    torch.save(load_file(weights), folder / "pytorch_model.bin")
    weights.unlink()
    said = refusal(str(folder))
    assert "safetensors" in said
    assert str(folder) in said


def test_broken_weights_are_refused(saved, tmp_path):
    folder = shutil.copytree(saved("glpn"), tmp_path / "broken")
    (folder / "model.safetensors").write_bytes(b"no weights at all")
    assert refusal(str(folder)).startswith(f"hub:{folder}: ")


def test_a_model_without_its_processor_is_refused(saved, tmp_path):
    folder = shutil.copytree(saved("glpn"), tmp_path / "lacking")
    (folder / "preprocessor_config.json").unlink()
    assert "load image processor" in refusal(str(folder))


def test_a_model_that_brings_its_own_code_is_refused_and_the_code_not_run(saved, tmp_path):
    folder = shutil.copytree(saved("glpn"), tmp_path / "trap")
    (folder / "trap.py").write_text(f"open({str(tmp_path / 'sprung')!r}, 'w')\n")
    change_json(folder / "config.json", model_type="trap", auto_map={"AutoConfig": "trap.Trap"})
    assert "custom code" in refusal(str(folder))
    assert not (tmp_path / "sprung").exists()


def test_weights_that_are_not_all_there_are_refused(saved, tmp_path):
    folder = shutil.copytree(saved("dpt"), tmp_path / "lacking")
    weights = load_file(folder / "model.safetensors")
    del weights["head.head.0.weight"]
    save_file(weights, folder / "model.safetensors", {"format": "pt"})
    assert "1 weights are missing or of another shape, such as head.head.0.weight" in refusal(
        str(folder)
    )


def test_weights_that_no_output_depends_on_may_be_missing(saved, tmp_path, picture, capsys):
    """As they are in Intel's published files of DPT, where transformers draws them at random."""
    whole, folder = saved("dpt"), shutil.copytree(saved("dpt"), tmp_path / "published")
    weights = load_file(folder / "model.safetensors")
    unused = [name for name in weights if "fusion_stage.layers.0.residual_layer1." in name]
    assert len(unused) == 4
    for name in unused:
        del weights[name]
    save_file(weights, folder / "model.safetensors", {"format": "pt"})
    capsys.readouterr()
    found = network(str(folder))
    assert capsys.readouterr() == ("", "")
    np.testing.assert_array_equal(
        found.look(picture).values, network(str(whole)).look(picture).values
    )
    assert found.about.digest == network(str(whole)).about.digest


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"model_type": "prompt_depth_anything"}, "whose numbers flexdepth does not know"),
        ({"model_type": "no such thing"}, "no such thing"),
        ({"head_in_index": "last"}, "head_in_index"),
        ({"depths": {"first": 2}}, "depths"),
        ({"decoder_hidden_size": [64]}, "decoder_hidden_size"),
    ],
)
def test_a_model_of_another_kind_is_refused(changes, said, saved, tmp_path):
    folder = shutil.copytree(saved("glpn"), tmp_path / "other")
    change_json(folder / "config.json", **changes)
    assert said in refusal(str(folder))


def test_a_folder_that_holds_no_model_is_refused(tmp_path):
    assert "wanted a folder with config.json" in refusal(str(tmp_path))
    assert "wanted a folder with config.json" in refusal("./nowhere")
    assert "wanted OWNER/MODEL, or a folder such as ./nowhere" in refusal("nowhere")


def test_a_model_runs_on_cpu_or_cuda():
    assert "hub models run on cpu or cuda" in refusal("a/b", provider=Provider.COREML)


@pytest.mark.parametrize("option", [{"long_side": 64}, {"tiles": 2}, {"threads": 1}])
def test_what_only_our_own_models_can_do_is_refused(option, saved):
    with pytest.raises(InputError, match="--"):
        named_estimator(f"hub:{saved('dpt')}", Wishes(**option))


def test_a_licence_that_forbids_commercial_use_is_told(saved):
    with pytest.warns(UserWarning, match="licence apple-amlr of its weights forbids commercial"):
        flexdepth.load(f"hub:{saved('depth_pro')}")


def test_the_licence_of_the_card_comes_before_what_is_known_of_the_family(saved, tmp_path):
    folder = shutil.copytree(saved("depth_anything"), tmp_path / "stated")
    assert network(str(folder)).about.licence == "apache-2.0"
    (folder / "README.md").write_text("---\nlicense: cc-by-nc-4.0\n---\n# Mine\n")
    assert network(str(folder)).about.licence == "cc-by-nc-4.0"
