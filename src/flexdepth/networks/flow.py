"""RAFT: optical flow by a network of torchvision, where the user has its weights.

Nothing is downloaded. The weights are a file that torchvision publishes, such as
raft_large_C_T_SKHT_V2-ff5fadd5.pth, or the same as safetensors; which of the two networks they
are of is seen from their shapes. No pickle is executed.

References:
    Teed and Deng, RAFT: Recurrent all-pairs field transforms for optical flow, ECCV 2020;
    torchvision.models.optical_flow.
"""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor
from torch.nn.functional import pad
from torchvision.models.optical_flow import raft_large, raft_small
from torchvision.models.optical_flow.raft import RAFT

from flexdepth.networks.pretrained import read_weights
from flexdepth.runtime.errors import InputError, reason

_MULTIPLE, _LEAST = 8, 128
"""Pixels: the sides of what the network takes are multiples of 8, and at least 128."""

_FIRST = "feature_encoder.convnormrelu.0.weight"
_WIDTHS = {64: raft_large, 32: raft_small}
"""The network by the channels of its first layer."""

Picture = NDArray[np.uint8]
Flow = NDArray[np.float32]


@dataclass(frozen=True)
class Raft:
    """A RAFT of torchvision.

    Attributes:
        weights: A .pth or .safetensors file of raft_large or raft_small.
        updates: How often the flow is refined.
    """

    weights: Path
    updates: int = 12

    def both_ways(self, key: Picture, target: Picture) -> tuple[Flow, Flow]:
        """Return the flow from key to target and that back: height x width x 2, pixels.

        Args:
            key: Height x width x 3 in RGB; 0 to 255.
            target: Another view of it, of the same size.

        Raises:
            InputError: The weights are missing, broken or of another network.
        """
        network = _network(self.weights)
        one, other = _shown(key), _shown(target)
        height, width = key.shape[:2]
        with torch.inference_mode():
            forward, backward = (
                _flow(network, *pair, self.updates)[:height, :width]
                for pair in ((one, other), (other, one))
            )
        return forward, backward


def _network(path: Path) -> RAFT:
    weights = read_weights(path)
    first = weights.get(_FIRST)
    build = None if first is None else _WIDTHS.get(len(first))
    if build is None:
        raise InputError(
            f"{path}: wanted the weights of torchvision's raft_large or raft_small, got "
            f"{len(weights)} tensors of another network, such as {next(iter(weights), 'none')!r}"
        )
    network = build()
    try:
        network.load_state_dict(weights)
    except RuntimeError as error:
        raise InputError(
            f"{path}: does not fit torchvision's {build.__name__}: {reason(error)}"
        ) from error
    return network.eval()


def _shown(picture: Picture) -> Tensor:
    """Return the picture as the network takes it: -1 to 1, edges repeated to a size that fits."""
    height, width = picture.shape[:2]
    values = torch.from_numpy(np.ascontiguousarray(picture)).permute(2, 0, 1)[None].float()
    right, below = (_fitting(side) - side for side in (width, height))
    return pad(values / 127.5 - 1, (0, right, 0, below), mode="replicate")


def _fitting(side: int) -> int:
    return max(_LEAST, -(-side // _MULTIPLE) * _MULTIPLE)


def _flow(network: RAFT, one: Tensor, other: Tensor, updates: int) -> Flow:
    found: Tensor = network(one, other, num_flow_updates=updates)[-1]
    return np.ascontiguousarray(found[0].permute(1, 2, 0).numpy(), np.float32)
