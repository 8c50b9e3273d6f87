"""The extended dilated residual block (EDRB), and what its parts are made of.

Section 3.5.2 of the dissertation extends the DRB by a stride and by repetitions (Fig. 3.10), and
proposes two ways to fewer parameters: blocks as in ResNeXt, which are `GroupedBranch`, and
pruning, which is in `flexdepth.networks.pruning`.
"""

from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager, nullcontext
from dataclasses import dataclass, field
from enum import Enum
from types import MappingProxyType

from jaxtyping import Float
from torch import Tensor, nn
from torch.utils.checkpoint import checkpoint

from flexdepth.networks.blocks import BatchNorm, DilatedResidual, refinement
from flexdepth.runtime.errors import InputError


class Activations(Enum):
    """What becomes of a block's activations between the forward and the backward pass.

    Values, gradients and weights are the same; a network built with one takes the weights of one
    built with the other.
    """

    KEPT = "kept"
    """They stay in memory."""
    RECOMPUTED = "recomputed"
    """Of each part of a block only the input stays; the rest is made again, for a third more time.
    """


@dataclass(frozen=True)
class DenseBranch:
    """Two full 3x3 convolutions, as in the dilated residual block.

    Attributes:
        share: The channels between the two, as a share of the block's. One as published; less is
            what pruning leaves.
    """

    share: float = 1.0

    def build(self, block: DilatedResidual, width: int, stride: int) -> nn.Sequential:
        """Return the branch of a block of `width` channels."""
        return refinement(block, width, inner_width(width, self.share), stride)


@dataclass(frozen=True)
class GroupedBranch:
    """A 3x3 convolution in groups between two 1x1 convolutions, as in ResNeXt.

    Batch normalisation and ReLU follow the first two; the last has neither bias nor
    normalisation, as in the dilated residual block.

    Attributes:
        groups: Of the 3x3 convolution.
        share: The channels between the 1x1 convolutions, as a share of the block's.

    References:
        Xie, Girshick, Dollár, Tu and He, CVPR 2017, Fig. 3c (32 groups, half of the channels).
    """

    groups: int = 32
    share: float = 0.5

    def build(self, block: DilatedResidual, width: int, stride: int) -> nn.Sequential:
        """Return the branch of a block of `width` channels.

        Raises:
            InputError: The groups do not divide the channels between the 1x1 convolutions.
        """
        inner, reach = inner_width(width, self.share), block.dilation
        if inner % self.groups:
            raise InputError(
                f"a grouped branch needs channels that its groups divide, but {self.share:g} of "
                f"{width} channels are {inner}, and there are {self.groups} groups: choose "
                f"another width, share or number of groups"
            )
        return nn.Sequential(
            nn.Conv2d(width, inner, 1, bias=False),
            block.norm.build(inner),
            nn.ReLU(),
            nn.Conv2d(
                *(inner, inner, 3, stride, reach, reach, self.groups),
                bias=False,
                padding_mode=block.padding,
            ),
            block.norm.build(inner),
            nn.ReLU(),
            nn.Conv2d(inner, width, 1, bias=False),
        )


Branch = DenseBranch | GroupedBranch
"""What is added to the residual."""


@dataclass(frozen=True)
class ExtendedResidual:
    """The extended dilated residual block (EDRB).

    A 1x1 convolution to the new width; to it, averaged over the stride, the branch is added, whose
    first 3x3 convolution has the stride; ReLU follows. The second part adds another branch to what
    came out, and again ReLU; it is repeated. Without repetitions and with stride 1 this is the
    dilated residual block.

    Attributes:
        block: Dilation, padding and normalisation of the branches.
        branch: What is added to the residual in every part.
        activations: Whether they wait for the backward pass or are made again.

    References:
        The dissertation, Fig. 3.10, which says neither which convolution has the stride nor how
        large the average pool is: here its windows are centred where the convolution's are.
    """

    block: DilatedResidual = field(
        default_factory=lambda: DilatedResidual(norm=BatchNorm(momentum=0.01))
    )
    branch: Branch = DenseBranch()
    activations: Activations = Activations.KEPT

    def build(
        self, inputs: int, width: int, repeats: int = 0, stride: int = 1
    ) -> "ExtendedResidualBlock":
        """Return the block that takes `inputs` channels to `width` channels.

        Args:
            inputs: Channels that come in.
            width: Channels that go out.
            repeats: How often the second part follows.
            stride: By which sizes are divided, and rounded up.
        """
        return ExtendedResidualBlock(self, inputs, width, repeats, stride)


class ExtendedResidualBlock(nn.Module):
    """The module of `ExtendedResidual`; the first part is named as in `DilatedResidualBlock`."""

    def __init__(
        self, settings: ExtendedResidual, inputs: int, width: int, repeats: int, stride: int
    ) -> None:
        super().__init__()
        block, branch = settings.block, settings.branch
        self.project = nn.Conv2d(inputs, width, 1, bias=False)
        self.refine = branch.build(block, width, stride)
        self.shrink = averaging(stride)
        self.again = nn.ModuleList(branch.build(block, width, 1) for _ in range(repeats))
        self.part = _PARTS[settings.activations]

    def forward(
        self, features: Float[Tensor, "batch inputs height width"]
    ) -> Float[Tensor, "batch outputs rows columns"]:
        """Return the refined features, none of them negative."""
        features = self.part(self.refine, self.shrink, self.project(features))
        for branch in self.again:
            features = self.part(branch, nn.Identity(), features)
        return features


def averaging(stride: int) -> nn.Module:
    """Return the mean over windows that lie as those of a 3x3 convolution of this stride.

    Sizes are divided by the stride and rounded up. What lies beyond the border does not count.
    """
    if stride == 1:
        return nn.Identity()
    return nn.AvgPool2d(2 * stride - 1, stride, stride - 1, count_include_pad=False)


def inner_width(width: int, share: float) -> int:
    """Return how many channels a share of `width` is.

    Raises:
        InputError: It is none of them, or more than all.
    """
    inner = round(width * share)
    if not 1 <= inner <= width:
        raise InputError(
            f"a branch needs between 1 and {width} channels inside a block of {width}, "
            f"but a share of {share:g} makes {inner}"
        )
    return inner


def _kept(
    branch: nn.Module, shortcut: nn.Module, features: Float[Tensor, "batch width _ _"]
) -> Float[Tensor, "batch width rows columns"]:
    out: Tensor = (shortcut(features) + branch(features)).relu()
    return out


def _recomputed(
    branch: nn.Module, shortcut: nn.Module, features: Float[Tensor, "batch width _ _"]
) -> Float[Tensor, "batch width rows columns"]:
    out: Tensor = checkpoint(
        *(_kept, branch, shortcut, features),
        use_reentrant=False,
        preserve_rng_state=False,
        context_fn=lambda: (nullcontext(), _statistics_as_they_are(branch)),
    )
    return out


_PARTS: Mapping[Activations, Callable[[nn.Module, nn.Module, Tensor], Tensor]] = MappingProxyType(
    {Activations.KEPT: _kept, Activations.RECOMPUTED: _recomputed}
)


@contextmanager
def _statistics_as_they_are(module: nn.Module) -> Iterator[None]:
    """Let a second pass over the same batch leave the running statistics alone."""
    before = [
        (norm, norm.momentum, count, count.clone())
        for norm in module.modules()
        if isinstance(norm, nn.BatchNorm2d) and (count := norm.num_batches_tracked) is not None
    ]
    for norm, *_ in before:
        norm.momentum = 0.0
    try:
        yield
    finally:
        for norm, momentum, count, batches in before:
            norm.momentum = momentum
            count.copy_(batches)
