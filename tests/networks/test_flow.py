import numpy as np
import pytest
import torch
from safetensors.torch import save_file
from torchvision.models.optical_flow import raft_small

from flexdepth.networks.flow import Raft
from flexdepth.runtime.errors import InputError


@pytest.fixture
def pictures():
    rng = np.random.default_rng(0)
    return [rng.integers(0, 255, (70, 90, 3)).astype(np.uint8) for _ in range(2)]


def test_weights_of_torchvision_give_flow_both_ways_at_the_frames_size(pictures, tmp_path):
    torch.manual_seed(0)
    weights = raft_small().state_dict()
    torch.save(weights, tmp_path / "small.pth")
    save_file(weights, tmp_path / "small.safetensors")
    forward, backward = Raft(tmp_path / "small.pth", updates=1).both_ways(*pictures)
    assert forward.shape == backward.shape == (70, 90, 2)
    assert forward.dtype == np.float32
    assert not np.array_equal(forward, backward)
    swapped = Raft(tmp_path / "small.safetensors", updates=1).both_ways(*pictures[::-1])
    np.testing.assert_allclose(swapped[0], backward, atol=1e-5)


def test_weights_of_another_network_are_refused(pictures, tmp_path):
    torch.save({"layer.weight": torch.zeros(3)}, tmp_path / "other.pth")
    with pytest.raises(InputError, match=r"other\.pth: wanted .* raft_large or raft_small"):
        Raft(tmp_path / "other.pth").both_ways(*pictures)


def test_weights_that_lack_some_are_refused_in_one_line(pictures, tmp_path):
    weights = raft_small().state_dict()
    del weights[next(reversed(weights))]
    torch.save(weights, tmp_path / "cut.pth")
    with pytest.raises(InputError, match=r"cut\.pth: does not fit torchvision's raft_small") as no:
        Raft(tmp_path / "cut.pth").both_ways(*pictures)
    assert "\n" not in str(no.value)
