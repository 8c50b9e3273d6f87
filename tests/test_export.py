import numpy as np
import pytest
import torch

from flexdepth.export import compared, export
from flexdepth.networks.compact import Compact
from flexdepth.runtime.bundle import Description
from flexdepth.runtime.depthmap import Space
from flexdepth.runtime.errors import InputError
from flexdepth.runtime.model import Provider, load_model

ABOUT = Description("small", "1.2", "MIT", Space.METRIC, (96, 64), 32, 0.8, "a test")
SMALL = Compact(widths=(32, 32, 32, 32))


@pytest.fixture(scope="module")
def network():
    torch.manual_seed(0)
    return SMALL.build().eval()


@pytest.fixture(scope="module")
def bundle(network, tmp_path_factory):
    path = tmp_path_factory.mktemp("export") / "new" / "small.onnx"
    parity = export(network, ABOUT, path)
    return path, parity


def test_a_bundle_says_what_it_was_told_to_say(bundle):
    assert load_model(bundle[0], Provider.CPU, 1).description == ABOUT


def test_a_bundle_gives_the_depth_of_the_network_at_sizes_never_seen_in_the_export(network, bundle):
    model = load_model(bundle[0], Provider.CPU, 1)
    image = torch.rand(3, 3, 64, 160, generator=torch.Generator().manual_seed(1))
    with torch.no_grad():
        wanted = network(image)
    found = model.run(image.numpy())
    assert np.abs(found.depth / wanted.depth.numpy() - 1).mean() < 0.01
    assert np.abs(found.sky - wanted.sky_logit.sigmoid().numpy()).mean() < 0.01
    assert np.abs(found.spread / wanted.spread.numpy() - 1).mean() < 0.01
    assert np.abs(found.focal / wanted.focal.numpy() - 1).max() < 0.01


def test_weights_are_stored_in_half_precision(network, bundle):
    single = 4 * sum(weight.numel() for weight in network.parameters())
    assert bundle[0].stat().st_size < 0.65 * single


def test_a_bundle_tells_nothing_of_the_machine_that_wrote_it(bundle):
    content = bundle[0].read_bytes()
    assert b"site-packages" not in content
    assert b".py" not in content


def test_parity_is_that_of_the_written_file(network, bundle):
    path, parity = bundle
    assert compared(network, path) == parity
    assert 0 < parity.median < parity.high < 0.02


def test_a_bundle_of_another_network_is_noticed(bundle):
    torch.manual_seed(1)
    assert compared(SMALL.build().eval(), bundle[0]).high > 0.02


def test_a_graph_that_differs_from_the_network_is_never_written(network, tmp_path, monkeypatch):
    monkeypatch.setattr("flexdepth.export.GRAPH_TOLERANCE", -1.0)
    with pytest.raises(InputError, match=r"small\.onnx: the bundle's depth differs"):
        export(network, ABOUT, tmp_path / "small.onnx")
    assert list(tmp_path.iterdir()) == []
