from dataclasses import replace

import pytest
import torch

from flexdepth.experiments.experiment import Bundled
from flexdepth.experiments.start import give_weights
from flexdepth.export import compared, export
from flexdepth.networks.compact import Compact
from flexdepth.networks.encoders import Encoder
from flexdepth.runtime.bundle import Description
from flexdepth.runtime.depthmap import Space
from flexdepth.runtime.errors import InputError
from flexdepth.runtime.model import bundled_file

SMALL = Compact(encoder=Encoder("mobilenetv3_small_050"), widths=(16, 16, 8, 8))
ABOUT = Description("small", "0", "MIT", Space.METRIC, (64, 64), 32, 0.8, "a test")


@pytest.fixture(scope="module")
def trained():
    torch.manual_seed(0)
    network = SMALL.build()
    with torch.no_grad():
        network(torch.rand(4, 3, 64, 64))
    return network.eval()


@pytest.fixture(scope="module")
def bundle(trained, tmp_path_factory):
    path = tmp_path_factory.mktemp("bundle") / "small.onnx"
    export(trained, ABOUT, path)
    return path


def test_a_bundle_gives_back_the_weights_that_it_was_made_from(trained, bundle):
    network = SMALL.build()
    give_weights(network, Bundled(bundle))
    given, wanted = network.state_dict(), trained.state_dict()
    norms = [name for name in wanted if name.endswith(("running_mean", "running_var"))]
    assert norms
    for name in norms:
        assert torch.equal(given[name], wanted[name])
    for name, weight in trained.named_parameters():
        # Half precision keeps eleven bits, and steps of 2**-24 near zero.
        torch.testing.assert_close(given[name], weight, rtol=2**-11, atol=2**-24)


def test_a_bundle_of_another_network_is_refused_with_what_differs(bundle):
    wider = replace(SMALL, widths=(16, 16, 16, 8)).build()
    with pytest.raises(InputError, match=r"small\.onnx: holds the weights of another network.*lev"):
        give_weights(wider, Bundled(bundle))


def test_training_can_start_from_the_model_that_comes_along():
    network = Compact().build().eval()
    give_weights(network, Bundled())
    assert compared(network, bundled_file()).high < 1e-3
