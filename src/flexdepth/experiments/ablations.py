"""Ablations: changes that make one experiment of another."""

from collections.abc import Callable
from dataclasses import replace
from typing import TypeAlias

from flexdepth.experiments.experiment import Experiment, Untrained
from flexdepth.networks import AGA, EDRB, PCA, Compact, Network
from flexdepth.networks.attention import ChannelAttention
from flexdepth.networks.edrb import Rows
from flexdepth.networks.merge import VARIANTS, Coefficient, SpatialAttention
from flexdepth.runtime.errors import InputError

Change: TypeAlias = Callable[[Experiment], Experiment]


def merged_by(variant: str) -> Change:
    """Merge encoder and decoder as a published variant does, with the bottlenecks at hand.

    Args:
        variant: A name in `networks.merge.VARIANTS`.
    """

    def change(experiment: Experiment) -> Experiment:
        network = experiment.network
        found = _coefficient(network)
        other = _as_narrow(VARIANTS[variant], found)
        match network:
            case AGA():
                return replace(experiment, network=network.merged_by(other))
            case EDRB(rows):
                return replace(
                    experiment, network=replace(network, rows=replace(rows, coefficient=other))
                )
            case Compact():
                return replace(experiment, network=replace(network, coefficient=other))
        raise TypeError(f"a network with merges was expected, got {network!r}")

    return change


def without(term: str) -> Change:
    """Drop one term of the objective."""

    def change(experiment: Experiment) -> Experiment:
        if term not in experiment.terms:
            raise InputError(
                f"no term {term!r} to drop; the experiment's terms are {sorted(experiment.terms)}"
            )
        return replace(experiment, terms={k: v for k, v in experiment.terms.items() if k != term})

    return change


def as_edrb(experiment: Experiment) -> Experiment:
    """Put an EDRB network, which nothing has taught yet, into the place of an AGA network.

    The head and the merges stay. The first row is as wide as the decoder's last stage and the
    others twice that: of the published AGA network, the published 256 and 512.
    """
    network = experiment.network
    if not isinstance(network, AGA):
        raise InputError(
            f"the EDRB network takes the widths of an AGA network, got {type(network).__name__}: "
            f"choose an experiment of chapter 3"
        )
    width = network.widths[-1]
    rows = Rows((width, *4 * (2 * width,)), coefficient=_coefficient(network))
    return replace(
        experiment,
        network=EDRB(rows, network.head, network.canonical_focal),
        start=Untrained(),
    )


def seeded(number: int) -> Change:
    """Draw other first weights, another order and other crops: repetition `number`."""

    def change(experiment: Experiment) -> Experiment:
        batches = experiment.loop.batches
        drawn = replace(batches, seed=batches.seed + number)
        return replace(
            experiment,
            seed=experiment.seed + number,
            loop=replace(experiment.loop, batches=drawn),
        )

    return change


def changed(experiment: Experiment, changes: tuple[Change, ...]) -> Experiment:
    """Return the experiment after one change after the other."""
    for change in changes:
        experiment = change(experiment)
    return experiment


def _coefficient(network: Network) -> Coefficient:
    match network:
        case AGA():
            return network.coefficients[0]
        case EDRB(rows):
            return rows.coefficient
        case Compact():
            return network.coefficient
        case PCA():
            raise InputError(
                "the PCA network has no merges to be changed: choose an experiment whose network "
                "is AGA, EDRB or Compact"
            )


def _as_narrow(wanted: Coefficient, found: Coefficient) -> Coefficient:
    """Return the coefficient with the ratios of another, as far as both have them."""
    if isinstance(wanted, ChannelAttention):
        return _channel(found) or wanted
    ratio = wanted.ratio if isinstance(found, ChannelAttention) else found.ratio
    if isinstance(wanted, SpatialAttention):
        return replace(wanted, ratio=ratio)
    return replace(wanted, ratio=ratio, channel=_channel(found) or wanted.channel)


def _channel(coefficient: Coefficient) -> ChannelAttention | None:
    match coefficient:
        case ChannelAttention():
            return coefficient
        case SpatialAttention():
            return None
    return coefficient.channel
