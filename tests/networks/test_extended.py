import copy
from dataclasses import replace

import pytest
import torch
from torch import nn
from torch.testing import assert_close

from flexdepth.networks.blocks import BatchNorm, DilatedResidual
from flexdepth.networks.extended import (
    Activations,
    DenseBranch,
    ExtendedResidual,
    GroupedBranch,
    averaging,
)
from flexdepth.runtime.errors import InputError

BOTH = [DenseBranch(), GroupedBranch(groups=2)]


def parameters(module: nn.Module) -> int:
    return sum(p.numel() for p in module.parameters())


def test_without_repetitions_and_stride_it_is_the_dilated_residual_block_to_the_bit():
    block = DilatedResidual().build(5, 8)
    extended = ExtendedResidual(DilatedResidual()).build(5, 8)
    extended.load_state_dict(block.state_dict())
    ours, theirs = (torch.randn(2, 5, 9, 7).requires_grad_(True) for _ in range(2))
    theirs.data.copy_(ours.data)
    out, wanted = extended(ours), block(theirs)
    assert torch.equal(out, wanted)
    for x in (out, wanted):
        x.square().sum().backward()
    assert torch.equal(ours.grad, theirs.grad)
    assert all(
        torch.equal(p.grad, q.grad)
        for p, q in zip(extended.parameters(), block.parameters(), strict=True)
    )
    assert all(torch.equal(p, q) for p, q in zip(extended.buffers(), block.buffers(), strict=True))


@pytest.mark.parametrize(("inputs", "repeats", "stride"), [(3, 4, 2), (256, 4, 2), (512, 1, 1)])
def test_each_repetition_costs_two_convolutions_and_a_normalisation(inputs, repeats, stride):
    with torch.device("meta"):
        block = ExtendedResidual().build(inputs, 512, repeats, stride)
    assert parameters(block) == inputs * 512 + (repeats + 1) * (18 * 512**2 + 3 * 512)


@pytest.mark.parametrize("size", [(9, 8), (33, 50), (1, 1), (2, 5)])
@pytest.mark.parametrize("stride", [1, 2, 3])
@pytest.mark.parametrize("branch", BOTH, ids=repr)
def test_sizes_are_divided_by_the_stride_and_rounded_up(branch, stride, size):
    block = ExtendedResidual(branch=branch).build(3, 8, 1, stride).eval()
    out = block(torch.rand(2, 3, *size))
    assert out.shape == (2, 8, -(-size[0] // stride), -(-size[1] // stride))
    assert (out >= 0).all()


def test_the_mean_has_its_windows_where_the_convolution_has_them():
    ramp = torch.arange(9.0).expand(1, 1, 9, 9)
    assert_close(averaging(2)(ramp)[0, 0, 0], torch.tensor([0.5, 2.0, 4.0, 6.0, 7.5]))
    assert_close(averaging(2)(torch.ones(1, 1, 6, 6)), torch.ones(1, 1, 3, 3))


@pytest.mark.parametrize("branch", BOTH, ids=repr)
def test_what_the_branches_do_not_add_is_the_averaged_projection(branch):
    block = ExtendedResidual(branch=branch).build(3, 8, 2, 2)
    for part in (block.refine, *block.again):
        nn.init.zeros_(part[-1].weight)
    features = torch.randn(2, 3, 7, 9)
    assert_close(block(features), averaging(2)(block.project(features)).relu())


def test_every_part_dilates_by_two_and_the_first_alone_strides():
    block = ExtendedResidual().build(3, 8, 2, 2)
    convolutions = [part[n] for part in (block.refine, *block.again) for n in (0, 3)]
    assert {conv.dilation for conv in convolutions} == {(2, 2)}
    assert [conv.stride for conv in convolutions] == [(2, 2), *([(1, 1)] * 5)]
    assert {m.momentum for m in block.modules() if isinstance(m, nn.BatchNorm2d)} == {0.01}


def test_a_grouped_branch_has_the_parameters_of_a_resnext_block():
    block = ExtendedResidual(branch=GroupedBranch()).build(512, 512)
    inner = 256 * 512 * 2 + 256 * 8 * 9 + 2 * 2 * 256
    assert parameters(block) == 512 * 512 + inner
    assert block.refine[3].groups == 32


def test_a_group_sees_its_own_channels_only():
    branch = GroupedBranch(groups=4).build(DilatedResidual(), 16, 1)
    features = torch.randn(1, 8, 5, 5, requires_grad=True)
    (gradient,) = torch.autograd.grad(branch[3](features)[0, :2, 2, 2].sum(), features)
    assert gradient[0, :2].any()
    assert not gradient[0, 2:].any()


@pytest.mark.parametrize("branch", BOTH, ids=repr)
def test_recomputed_activations_change_neither_values_nor_gradients_nor_statistics(branch):
    settings = ExtendedResidual(branch=branch)
    kept = settings.build(3, 8, 2, 2)
    again = replace(settings, activations=Activations.RECOMPUTED).build(3, 8, 2, 2)
    again.load_state_dict(kept.state_dict())
    for _ in range(2):
        features = torch.randn(2, 3, 9, 7)
        losses = [module(features).square().mean() for module in (kept, again)]
        assert torch.equal(*losses)
        for loss in losses:
            loss.backward()
    for one, other in zip(kept.parameters(), again.parameters(), strict=True):
        assert torch.equal(one.grad, other.grad)
    for one, other in zip(kept.buffers(), again.buffers(), strict=True):
        assert torch.equal(one, other)
    assert {m.momentum for m in again.modules() if isinstance(m, nn.BatchNorm2d)} == {0.01}


def test_recomputed_activations_hold_less_for_the_backward_pass():
    held = {}
    for activations in Activations:
        block = ExtendedResidual(activations=activations).build(3, 8, 4)
        saved = []
        with torch.autograd.graph.saved_tensors_hooks(
            lambda x, saved=saved: (saved.append(x), x)[1], lambda x: x
        ):
            block(torch.randn(2, 3, 32, 32))
        # Weights and views of one storage count once.
        held[activations] = sum({x.data_ptr(): x.numel() for x in saved}.values())
    assert held[Activations.RECOMPUTED] < 0.5 * held[Activations.KEPT]


def test_a_copy_of_a_block_is_a_block_of_its_own():
    block = ExtendedResidual(activations=Activations.RECOMPUTED).build(3, 8, 1).train()
    before = {name: x.clone() for name, x in block.state_dict().items()}
    copy.deepcopy(block)(torch.rand(2, 3, 8, 8)).sum().backward()
    assert all(torch.equal(x, before[name]) for name, x in block.state_dict().items())


@pytest.mark.parametrize("share", [0.0, 0.01, 1.5])
def test_a_branch_without_channels_or_with_more_than_the_block_has_is_refused(share):
    with pytest.raises(InputError, match="between 1 and 16 channels"):
        ExtendedResidual(branch=DenseBranch(share)).build(3, 16)


def test_groups_that_do_not_divide_the_channels_are_named():
    with pytest.raises(InputError, match=r"0\.5 of 40 channels are 20, and there are 32 groups"):
        ExtendedResidual(branch=GroupedBranch()).build(3, 40)


def test_the_normalisation_is_built_as_it_is_set():
    settings = ExtendedResidual(DilatedResidual(norm=BatchNorm(0.3, 1e-3)), GroupedBranch(2))
    norms = [m for m in settings.build(3, 8, 1).modules() if isinstance(m, nn.BatchNorm2d)]
    assert {(norm.momentum, norm.eps) for norm in norms} == {(0.3, 1e-3)}
    assert len(norms) == 4
