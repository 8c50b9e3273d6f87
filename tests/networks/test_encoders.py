import pytest
import timm
import torch
from timm.layers import create_conv2d
from torch.testing import assert_close

from flexdepth.networks.encoders import Encoder, EvenSameConv
from flexdepth.runtime.errors import InputError


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


@pytest.mark.parametrize("name", ["resnet18", "tf_efficientnet_lite0", "mobilenetv3_small_100"])
def test_an_output_stride_is_kept_and_its_features_see_as_far_as_before(name):
    with torch.device("meta"):
        dilated, strided = Encoder(name, 16).build(maps=4), Encoder(name).build(maps=4)
        image = torch.empty(1, 3, 64, 96)
        assert dilated.strides == (4, 8, 16, 16)
        assert tuple(dilated(image)[-1].shape[-2:]) == (4, 6)
        assert tuple(strided(image)[-1].shape[-2:]) == (2, 3)
    assert dilated.state_dict().keys() == strided.state_dict().keys()


def test_a_dilated_stage_gives_at_every_other_step_what_the_strided_one_gives():
    torch.manual_seed(0)
    strided, dilated = Encoder("resnet18").build().eval(), Encoder("resnet18", 16).build().eval()
    dilated.load_state_dict(strided.state_dict())
    image = torch.rand(1, 3, 224, 224)
    assert_close(dilated(image)[-1][..., ::2, ::2], strided(image)[-1], atol=1e-4, rtol=1e-4)


def test_features_that_timm_gives_with_channels_last_come_with_channels_first():
    with torch.device("meta"):
        encoder = Encoder("swin_tiny_patch4_window7_224").build(maps=4)
        shapes = [tuple(f.shape) for f in encoder(torch.empty(1, 3, 64, 96))]
    assert shapes == [(1, 96, 16, 24), (1, 192, 8, 12), (1, 384, 4, 6), (1, 768, 2, 3)]


@pytest.mark.parametrize(
    ("encoder", "maps"), [(Encoder("densenet121", 16), 4), (Encoder("convnext_atto"), 5)]
)
def test_an_encoder_without_such_maps_says_what_was_asked_of_it(encoder, maps):
    wanted = f"{encoder.name}.*{maps} feature maps with an output stride of {encoder.output_stride}"
    with torch.device("meta"), pytest.raises(InputError, match=wanted):
        encoder.build(maps)
