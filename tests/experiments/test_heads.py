"""The heads and losses of the survey, each chosen in a file like any other experiment."""

import pytest
import torch

from flexdepth.data.folder import Pair
from flexdepth.data.transforms import as_sample
from flexdepth.experiments.catalogue import experiment_named
from flexdepth.runtime.depthmap import DepthMap, FocalSource, Intrinsics, Space
from flexdepth.tensors import stacked
from flexdepth.training.loop import learn

SMALL = """
like: chapter3-small
network:
  encoder: {name: test_resnet}
  laterals: [8, 8, 8, 8]
  top: 8
  widths: [8, 8, 8, 8, 8]
  pyramid: {width: 4}
"""
NONE_OF_THE_BASE = "cross_entropy: null, virtual_normal: null, squared: null"
BINS = "bins: {count: 4, nearest: 0.00375, farthest: 1.5, unit: 80}"

CHOICES = {
    "ordinal": (f"{{_type: OrdinalDepth, {BINS}}}", "ordinal: {loss: {_type: Ordinal}}"),
    "ordinal with a gradient": (
        f"{{_type: OrdinalDepth, {BINS}, label: expected}}",
        "silog: {loss: {_type: Silog}}",
    ),
    "adaptive bins": (
        "{_type: AdaptiveBins}",
        "silog: {loss: {_type: Silog}}, bins: {loss: {_type: BinCentres}, weight: 0.1}",
    ),
    "planar guidance": ("{_type: PlanarGuidance}", "silog: {loss: {_type: Silog}}"),
    "berHu": (f"{{_type: BinnedDepth, {BINS}}}", "berhu: {loss: {_type: BerHu}}"),
}


def batch():
    torch.manual_seed(0)
    camera = Intrinsics.centred(64, 64, 60.0, FocalSource.GIVEN)
    depth = torch.linspace(1, 9, 64).expand(64, 64).numpy().copy()
    images = torch.randint(0, 255, (2, 64, 64, 3), dtype=torch.uint8).numpy()
    return stacked(
        [as_sample(Pair(str(n), images[n], DepthMap(depth, Space.METRIC, camera))) for n in (0, 1)]
    )


@pytest.mark.parametrize("name", CHOICES)
def test_a_file_chooses_the_head_and_the_loss_that_teaches_it(name, tmp_path):
    head, terms = CHOICES[name]
    path = tmp_path / "own.yaml"
    path.write_text(
        f"{SMALL}  head: {head}\nterms: {{{NONE_OF_THE_BASE}, {terms}}}\n", encoding="utf-8"
    )
    experiment = experiment_named(str(path))
    network = experiment.network.build()
    parts = learn(network, experiment.loop, experiment.terms, batch())
    assert parts["total"].isfinite()
    learnt = [weight.grad for weight in network.head.parameters() if weight.grad is not None]
    assert any((grad != 0).any() for grad in learnt)
    assert any((weight.grad != 0).any() for weight in network.encoder.parameters())
