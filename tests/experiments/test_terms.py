import pytest
import torch

from flexdepth.experiments import terms
from flexdepth.geometry.camera import Camera
from flexdepth.geometry.depth import KITTI_BINS, NYU_BINS
from flexdepth.sample import Frame, Prediction, Sample, Truth
from flexdepth.training.objective import objective


@pytest.mark.parametrize(
    ("base", "whole", "bins", "focal"),
    [
        (terms.NYU_BASE, terms.NYU, NYU_BINS, 519.0),
        (terms.KITTI_BASE, terms.KITTI, KITTI_BINS, 357.3),
    ],
)
def test_the_three_losses_are_weighted_one_to_six_to_twentyfive(base, whole, bins, focal):
    generator = torch.Generator().manual_seed(1)
    logits = torch.randn(1, bins.count, 40, 40, generator=generator)
    metres = bins.unit * (0.2 + 0.5 * torch.rand(1, 40, 40, generator=generator))
    camera = Camera(torch.full((1, 2), 50.0), torch.full((1, 2), 20.0))
    known = torch.ones(1, 40, 40, dtype=torch.bool)
    sample = Sample(("a",), Frame(torch.zeros(1, 3, 40, 40), camera), Truth(metres, known, ~known))
    prediction = Prediction(bins.depth(logits), None, logits=logits, bins=bins)
    total, parts = objective(whole, prediction, sample)
    weighted = parts["cross_entropy"] + 6 * parts["virtual_normal"] + 25 * parts["squared"]
    assert total.item() == pytest.approx(weighted.item())
    assert objective(base, prediction, sample)[0].item() == pytest.approx(
        weighted.item() - 25 * parts["squared"].item(), rel=1e-5
    )
    assert whole["virtual_normal"].loss.focal == focal
