import pytest
import timm
import torch
import torchvision
from safetensors.torch import save_file
from torch.testing import assert_close

from flexdepth.networks.encoders import Encoder
from flexdepth.networks.pretrained import load_imagenet
from flexdepth.networks.torchvision_names import timm_names
from flexdepth.runtime.errors import InputError

ALIKE = {
    "resnet18": "resnet18",
    "mobilenet_v2": "mobilenetv2_100",
    "efficientnet_b0": "efficientnet_b0",
}


def network_of_torchvision(name):
    """A network whose normalisation has been somewhere, so that its weights matter."""
    torch.manual_seed(3)
    network = torchvision.models.get_model(name, weights=None).eval()
    with torch.no_grad():
        for weight in network.state_dict().values():
            if weight.ndim == 1:
                weight.add_(0.2 * torch.rand_like(weight))
    return network


@pytest.mark.parametrize(("theirs", "ours"), ALIKE.items())
def test_torchvision_s_network_and_timm_s_under_the_new_names_see_the_same(theirs, ours):
    network = network_of_torchvision(theirs)
    weights = network.state_dict()
    names = timm_names(ours, weights)
    plain = timm.create_model(ours, pretrained=False).eval()
    plain.load_state_dict({names[key]: weight for key, weight in weights.items()})
    image = torch.rand(1, 3, 224, 224)
    with torch.no_grad():
        assert_close(plain(image), network(image), atol=1e-5, rtol=1e-4)


@pytest.mark.parametrize("name", ["vgg11", "vgg16_bn"])
def test_vgg_differs_in_the_names_of_its_classifier(name):
    with torch.device("meta"):
        theirs = torchvision.models.get_model(name, weights=None).state_dict()
        ours = timm.create_model(name, pretrained=False).state_dict()
    names = timm_names(name, theirs)
    # Two layers of the classifier are convolutions in timm, of as many weights.
    counts = {names[key]: weight.numel() for key, weight in theirs.items()}
    assert counts == {key: weight.numel() for key, weight in ours.items()}


@pytest.mark.parametrize(("theirs", "ours"), [("mobilenet_v2", "mobilenetv2_100")])
def test_an_encoder_starts_from_a_file_of_torchvision_s(theirs, ours, tmp_path):
    network = network_of_torchvision(theirs)
    # As parallel training saves it.
    file = tmp_path / "theirs.safetensors"
    save_file({f"module.{key}": each for key, each in network.state_dict().items()}, file)
    encoder = Encoder(ours).build().eval()
    load_imagenet(encoder, file)
    image = torch.rand(1, 3, 64, 64)
    with torch.no_grad():
        features = encoder(image)[-1]
        theirs_last = network.features[:-1]((image - encoder.mean) / encoder.deviation)
    assert_close(features, theirs_last, atol=1e-5, rtol=1e-4)


def test_names_that_are_timm_s_already_stay():
    names = list(timm.create_model("mobilenetv2_100", pretrained=False).state_dict())
    assert timm_names("mobilenetv2_100", names) == {name: name for name in names}


def test_a_network_that_differs_between_the_two_is_refused(tmp_path):
    network = torchvision.models.get_model("mobilenet_v3_small", weights=None)
    save_file(network.state_dict(), tmp_path / "small.safetensors")
    with pytest.raises(InputError, match="not the weights of mobilenetv3_small_100"):
        load_imagenet(Encoder("mobilenetv3_small_100").build(), tmp_path / "small.safetensors")
