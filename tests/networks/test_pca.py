from dataclasses import replace

import pytest
import torch
from torch import nn
from torch.testing import assert_close

from flexdepth.geometry.camera import Camera
from flexdepth.networks.depth_basis import Basis
from flexdepth.networks.encoders import Encoder
from flexdepth.networks.pca import PCA, Filter, PCANetwork
from flexdepth.sample import Frame, Sample, Truth

SMALL = PCA(
    encoder=Encoder("test_efficientnet"),
    basis=Basis(rows=6, columns=8, components=2, nearest=0.1, farthest=50.0),
    width=8,
    grid=(2, 2),
    hidden=16,
    filter=Filter(width=8, dilations=(1, 2)),
)


def sample(depth: torch.Tensor, sky: torch.Tensor | None = None, focal: float = 1.0) -> Sample:
    height, width = depth.shape
    diagonal = (height**2 + width**2) ** 0.5
    camera = Camera(torch.full((2,), focal * diagonal), torch.tensor([width / 2, height / 2]))
    if sky is None:
        sky = torch.zeros_like(depth, dtype=torch.bool)
    frame = Frame(torch.zeros(3, height, width), camera)
    return Sample("one", frame, Truth(depth, ~sky & (depth > 0), sky))


def tilted(steps: int = 9) -> list[Sample]:
    """Return floors that rise from left to right or from top to bottom, more or less."""
    across, down = torch.linspace(-1, 1, 8)[None], torch.linspace(-1, 1, 6)[:, None]
    slopes = torch.linspace(-1, 1, steps).tolist()
    return [sample(5 + 3 * a * across + b * down) for a in slopes for b in slopes]


@pytest.fixture(scope="module")
def small() -> PCANetwork:
    torch.manual_seed(0)
    network = SMALL.build().eval()
    network.adopt(SMALL.fit(tilted()))
    return network


def test_two_ways_to_tilt_a_floor_are_two_components():
    basis = SMALL.fit(tilted())
    assert_close(basis.mean, torch.full((6, 8), 5.0))
    assert_close(basis.explained()[1], torch.tensor(1.0))
    assert basis.components[0].var(0).max() < 1e-10
    assert basis.components[1].var(1).max() < 1e-10


def test_sky_is_as_far_as_the_basis_goes_and_the_unknown_is_no_depth():
    depth = torch.full((6, 8), 5.0)
    depth[:, 7] = torch.nan
    sky = torch.zeros(6, 8, dtype=torch.bool)
    sky[0] = True
    basis = SMALL.fit([sample(depth, sky), sample(depth, sky)])
    assert_close(basis.mean[0], torch.full((8,), 50.0))
    assert_close(basis.mean[2:], torch.full((4, 8), 5.0))


def test_a_canonical_basis_is_of_depth_as_one_camera_would_have_it():
    canonical = replace(SMALL, canonical_focal=0.5)
    flat = torch.full((6, 8), 4.0)
    basis = canonical.fit([sample(flat, focal=1.0), sample(2 * flat, focal=2.0)])
    assert_close(basis.mean, torch.full((6, 8), 2.0))
    assert basis.variances.max() < 1e-10
    assert canonical.build().eval()(torch.rand(1, 3, 32, 32)).canonical_focal == 0.5


def test_coefficients_of_zero_mean_the_mean_map(small):
    depth = small.coarse(torch.zeros(2, 2))
    assert_close(depth, torch.full((2, 6, 8), 5.0))
    assert_close(small.coarse(torch.tensor([[1e6, 0.0]])).max(), torch.tensor(50.0))


@pytest.mark.parametrize("scale", ["depth", "log"])
def test_coefficients_of_a_known_map_give_it_back(scale):
    settings = replace(SMALL, basis=replace(SMALL.basis, scale=scale, components=20))
    floors = tilted(5)
    basis = settings.fit(floors)
    network = settings.build().eval()
    network.adopt(basis)
    wanted = floors[3].truth.depth
    small = settings.basis.small(wanted, torch.ones(6, 8, dtype=torch.bool)).float()
    assert_close(network.coarse(basis.coefficients(small)[None])[0], wanted, atol=1e-3, rtol=0)


def test_the_last_layer_counts_in_deviations():
    basis = SMALL.fit(tilted())
    network = SMALL.build().eval()
    network.adopt(basis)
    nn.init.zeros_(network.predict[-1].weight)
    with torch.no_grad():
        network.predict[-1].bias.copy_(torch.tensor([1.0, -2.0]))
    expected = torch.tensor([1.0, -2.0]) * basis.variances[:2].sqrt()
    assert_close(network.coefficients(torch.rand(3, 3, 64, 96)), expected.expand(3, 2))


def test_the_filter_changes_nothing_at_first(small):
    image = torch.rand(2, 3, 37, 50)
    coarse = small.coarse(small.coefficients(image))[:, None]
    plain = nn.functional.interpolate(coarse, (37, 50), mode="bilinear", align_corners=True)
    assert_close(small(image).depth, plain[:, 0])


@pytest.mark.parametrize("size", [(64, 64), (65, 97), (33, 50)])
def test_any_size_goes_in_and_comes_out(small, size):
    depth = small(torch.rand(2, 3, *size)).depth
    assert depth.shape == (2, *size)
    assert ((depth >= 0.1 - 1e-6) & (depth <= 50 + 1e-4)).all()


def test_a_network_without_a_basis_has_no_depth():
    assert SMALL.build().eval()(torch.rand(1, 3, 32, 32)).depth.isnan().all()


def test_the_basis_travels_with_the_weights_and_is_not_learnt(small):
    other = SMALL.build().eval()
    other.load_state_dict(small.state_dict())
    image = torch.rand(1, 3, 64, 64)
    assert_close(other(image).depth, small(image).depth)
    learnt = {name for name, _ in small.named_parameters()}
    assert not learnt & {"mean", "components", "deviations"}


def test_four_images_are_learnt_by_heart():
    torch.manual_seed(0)
    network = SMALL.build().train()
    network.adopt(SMALL.fit(tilted()))
    floors = torch.stack([tilted(2)[n].truth.depth for n in range(4)])
    depth = nn.functional.interpolate(floors[:, None], (48, 64), mode="bilinear")[:, 0]
    depth[:, 20:28, 30:40] = 2.0
    image = (depth / 10)[:, None].repeat(1, 3, 1, 1)
    optimiser = torch.optim.AdamW(network.parameters(), 3e-3)
    history = []
    for _ in range(60):
        loss = (network(image).depth.log() - depth.log()).abs().mean()
        optimiser.zero_grad()
        loss.backward()
        optimiser.step()
        history.append(loss.item())
    assert history[-1] < 0.3 * history[0]


def test_every_parameter_learns():
    network = SMALL.build().train()
    network.adopt(SMALL.fit(tilted()))
    nn.init.normal_(network.filter.last.weight, std=0.1)
    network(torch.rand(2, 3, 64, 64)).depth.log().square().mean().backward()
    idle = [
        n for n, p in network.named_parameters() if p.grad is None or not p.grad.isfinite().all()
    ]
    assert idle == []


def test_one_exported_program_serves_every_size(small):
    class Depth(nn.Module):
        def __init__(self):
            super().__init__()
            self.network = small

        def forward(self, image):
            return self.network(image).depth

    rows, columns = (torch.export.Dim(name, min=33, max=512) for name in ("rows", "columns"))
    program = torch.export.export(
        Depth().eval(), (torch.rand(2, 3, 64, 96),), dynamic_shapes=({2: rows, 3: columns},)
    ).module()
    image = torch.rand(2, 3, 65, 97)
    assert_close(program(image), small(image).depth, atol=1e-4, rtol=1e-4)
