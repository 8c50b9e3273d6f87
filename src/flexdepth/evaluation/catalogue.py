"""The protocols by name: those that papers report, and plain ones for any set.

A number that a protocol would give otherwise than before gets a new version.
"""

from collections.abc import Mapping
from dataclasses import dataclass, fields, replace
from difflib import get_close_matches
from pathlib import Path
from types import MappingProxyType
from typing import TypeVar

from flexdepth.evaluation.alignment import Alignment
from flexdepth.evaluation.protocols import Averaging, DataSettings, Scope, ScoringProtocol
from flexdepth.evaluation.published import PUBLISHED
from flexdepth.runtime.errors import InputError

Settings = TypeVar("Settings", bound=DataSettings)

_METRIC = ScoringProtocol(
    name="metric",
    version=1,
    summary="Any set: every pixel from 1 mm to 80 m, as predicted",
    source="flexdepth docs/protocols.md",
)

_PLAIN = (
    _METRIC,
    replace(
        _METRIC,
        name="scale",
        summary="Any set: every pixel from 1 mm to 80 m, times the ratio of medians",
        alignment=Alignment.MEDIAN,
    ),
    replace(
        _METRIC,
        name="affine-depth",
        summary="Any set: every pixel from 1 mm to 80 m, least squares in depth per image",
        alignment=Alignment.LEAST_SQUARES,
    ),
    replace(
        _METRIC,
        name="affine-disparity",
        summary="Any set: every pixel from 1 mm to 80 m, least squares in 1/depth per image",
        alignment=Alignment.LEAST_SQUARES_DISPARITY,
    ),
    replace(
        _METRIC,
        name="boundary",
        summary="Any set with dense truth: F1 of the edges of depth, blind to scale",
        source="apple/ml-depth-pro src/depth_pro/eval/boundary_metrics.py, SI_boundary_F1",
        alignment=Alignment.MEDIAN,
        metrics=("boundary_f1",),
    ),
)

_WHDR = ScoringProtocol(
    name="whdr",
    version=1,
    summary="Depth in the Wild and its like: which of two points is nearer; only the order counts",
    source="Chen, Fu, Yang and Deng, Depth in the Wild, NeurIPS 2016",
    sets=("Diw",),
    metrics=("whdr",),
)

PROTOCOLS: Mapping[str, ScoringProtocol] = MappingProxyType(
    {each.name: each for each in (*PUBLISHED, _WHDR, *_PLAIN)}
)
"""Every protocol by name. The first that is made for a set is the set's own."""


def protocol_named(name: str) -> ScoringProtocol:
    """Return a protocol.

    Raises:
        InputError: There is none of that name.
    """
    if name not in PROTOCOLS:
        near = get_close_matches(name, PROTOCOLS, n=1)
        hint = f"did you mean {near[0]}?" if near else f"choose one of {', '.join(PROTOCOLS)}"
        raise InputError(f"--protocol: there is no {name!r}; {hint}")
    return PROTOCOLS[name]


def protocols_for(settings: object) -> tuple[ScoringProtocol, ...]:
    """Return the protocols that can score a set, its own ones first.

    Args:
        settings: The settings of the set.
    """
    return tuple(each for each in PROTOCOLS.values() if each.is_for(settings))


@dataclass(frozen=True)
class Changes:
    """What a user wants otherwise than a protocol has it; None leaves it.

    Attributes:
        alignment: How predictions are fitted.
        per: Over what.
        farthest: In metres: farther truth is not scored, and no prediction comes out farther.
        averaging: How the images become one number.
    """

    alignment: Alignment | None = None
    per: Scope | None = None
    farthest: float | None = None
    averaging: Averaging | None = None


def changed(protocol: ScoringProtocol, changes: Changes) -> ScoringProtocol:
    """Return the protocol with the changes, each of them named: `nyu-eigen+median`.

    Raises:
        InputError: The farthest depth is not beyond the nearest.
    """
    for name in ("alignment", "per", "averaging"):
        value = getattr(changes, name)
        if value is not None and value != getattr(protocol, name):
            protocol = _renamed(protocol, f"{value}", f"{name} {value}")
            protocol = replace(protocol, **{name: value})
    if changes.farthest is None:
        return protocol
    nearest, farthest = protocol.scored.nearest, changes.farthest
    if not nearest < farthest:
        raise InputError(f"--farthest: wanted metres beyond {nearest:g}, got {farthest:g}")
    return replace(
        _renamed(protocol, f"{farthest:g}m", f"farthest {farthest:g} m"),
        scored=replace(protocol.scored, farthest=farthest),
        clip=None if protocol.clip is None else (protocol.clip[0], farthest),
        sky=farthest,
    )


def _renamed(protocol: ScoringProtocol, mark: str, words: str) -> ScoringProtocol:
    name, summary = f"{protocol.name}+{mark}", f"{protocol.summary}; changed: {words}"
    return replace(protocol, name=name, summary=summary)


def suited(settings: Settings, protocol: ScoringProtocol) -> Settings:
    """Return the settings of a set with the split and the truth that a protocol is for.

    A file or folder that is not the one by default stays: the user has named it.
    """
    wanted = dict(protocol.settings)
    fitting = {}
    for each in fields(settings):
        given = getattr(settings, each.name)
        if each.name in wanted and not (isinstance(given, Path) and given != each.default):
            fitting[each.name] = type(given)(wanted[each.name])
    return replace(settings, **fitting)


def for_testing(settings: Settings, protocol: ScoringProtocol | None) -> Settings:
    """Return the settings with which a set is tested.

    Args:
        settings: As they are by default.
        protocol: By which; where it does not say, the set's own says.
    """
    own = suited(settings, protocols_for(settings)[0])
    return own if protocol is None else suited(own, protocol)


def deviations(settings: DataSettings, protocol: ScoringProtocol) -> list[str]:
    """Return in words where the settings of a set are not those that a protocol is for."""
    said = []
    for name, value in protocol.settings:
        for each in fields(settings):
            given = getattr(settings, name) if each.name == name else value
            if (given.name if isinstance(given, Path) else str(given)) != value:
                said.append(f"--{name} is {given}, and {protocol.name} is for {value}")
    return said
