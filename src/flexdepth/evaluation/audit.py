"""The same predictions under every protocol that applies, and where the differences come from.

From the first protocol to each other one leads a chain of small changes: the truth, the range,
the region, the fit, the clipping, the resizing, the averaging, in that order. Each link is scored,
so the difference of two published-looking numbers is the sum of differences with a name. Another
order would divide it otherwise.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from types import MappingProxyType

from flexdepth.evaluation.alignment import Alignment, check_alignment, weakest
from flexdepth.evaluation.catalogue import protocols_for, suited
from flexdepth.evaluation.evaluate import Evaluation, Pairs, Watch, evaluate_all
from flexdepth.evaluation.predictions import Predictions
from flexdepth.evaluation.protocols import STANDARD, DataSettings, ScoringProtocol
from flexdepth.evaluation.score import BOUNDARY_F1, WHDR
from flexdepth.evaluation.summary import Estimate
from flexdepth.runtime.depthmap import Space
from flexdepth.runtime.errors import InputError

METRICS = (*STANDARD[:6], "silog_half", "silog_sample", *STANDARD[6:])
"""What every protocol is scored by here, whatever it calls its own."""

LINKS: Mapping[str, tuple[str, ...]] = MappingProxyType(
    {
        "images": ("frames", "videos"),
        "truth": ("settings", "recoded"),
        "range": ("scored",),
        "region": ("region",),
        "fit": ("alignment", "per", "least_disparity"),
        "clipping": ("clip", "sky", "unknown"),
        "resizing": ("view", "resize"),
        "averaging": ("averaging",),
    }
)
"""The links of a chain, by name, and the fields that each of them changes."""

_NONE = MappingProxyType(
    {
        "frames": "all frames",
        "clip": "not clipped",
        "unknown": "the unknown refused",
        "least_disparity": "disparity as it is",
    }
)
_PREFIX = MappingProxyType(
    {
        "frames": "frames ",
        "per": "per ",
        "unknown": "the unknown at ",
        "sky": "sky at ",
        "least_disparity": "disparity at least ",
        "view": "seen: ",
    }
)

Load = Callable[[DataSettings], Pairs]
"""Returns the images of a set from its settings."""


@dataclass(frozen=True)
class Link:
    """One change on the way from one protocol to another.

    Attributes:
        name: Of `LINKS`.
        before: What it was, in the words of the fields.
        after: What it is.
        change: By how much the metric grew.
    """

    name: str
    before: str
    after: str
    change: float


@dataclass(frozen=True)
class Row:
    """What the predictions come to under one protocol.

    Attributes:
        protocol: As it was applied.
        replaced: The alignment that the protocol has and that was too weak; None where it holds.
        scored: How many images have a score.
        left_out: How many have none.
        results: Each metric with its interval.
        chain: From the first row to this one, in `explained`; empty in the first.
    """

    protocol: ScoringProtocol
    replaced: Alignment | None
    scored: int
    left_out: int
    results: Mapping[str, Estimate]
    chain: tuple[Link, ...]


@dataclass(frozen=True)
class Audit:
    """All of them.

    Attributes:
        rows: One for each protocol; the first is what the others are explained from.
        refused: Protocols that could not be applied, and why.
        explained: The metric of the chains.
    """

    rows: tuple[Row, ...]
    refused: Mapping[str, str]
    explained: str = "abs_rel"


def audit(settings: DataSettings, load: Load, predictions: Predictions, watch: Watch) -> Audit:
    """Return the predictions' scores under every protocol that is made for a set.

    A protocol whose fit is too weak for the predictions is applied with the weakest that is
    enough, and says so.

    Args:
        settings: Of the set; split and truth are those of each protocol.
        load: Loads the set.
        predictions: To be scored.
        watch: Is told of each image of each part of the work.

    Raises:
        InputError: A file is missing or broken, or no protocol can be applied.
    """
    applicable = [
        each for each in protocols_for(settings) if not {BOUNDARY_F1, WHDR} & set(each.metrics)
    ]
    if not applicable:
        raise InputError("no protocol scores depth on this set")
    space = _space(load(suited(settings, applicable[0])), predictions, applicable[0])
    whole = [replace(p, settings=p.settings or applicable[0].settings) for p in applicable]
    chosen = [_strong_enough(each, space) for each in whole]
    chains = [_chain(chosen[0], each) for each in chosen]
    found = _Scores(settings, load, predictions, watch).of([p for c in chains for p in c])
    rows = [
        _row(published, chain, found)
        for published, chain in zip(applicable, chains, strict=True)
        if isinstance(found[chain[-1]], Evaluation)
    ]
    if not rows:
        raise InputError(f"no protocol can be applied: {next(iter(found.values()))}")
    refused = {
        chain[-1].name: str(reason)
        for chain in chains
        if isinstance(reason := found[chain[-1]], InputError)
    }
    return Audit(tuple(rows), refused)


def _space(pairs: Pairs, predictions: Predictions, protocol: ScoringProtocol) -> Space:
    if not len(pairs):
        raise InputError("the set is empty")
    return predictions.of(pairs[0], 0, protocol.view).space


def _strong_enough(protocol: ScoringProtocol, space: Space) -> ScoringProtocol:
    protocol = replace(protocol, metrics=METRICS)
    try:
        check_alignment(space, protocol.alignment)
    except InputError:
        return replace(protocol, alignment=weakest(space))
    return protocol


def _chain(first: ScoringProtocol, last: ScoringProtocol) -> list[ScoringProtocol]:
    """Return the protocols from one to another, each a link from the one before."""
    chain = [first]
    for names in LINKS.values():
        changes = {name: getattr(last, name) for name in names}
        linked = replace(chain[-1], **changes)
        if linked != chain[-1]:
            chain.append(linked)
    chain[-1] = last
    return chain


def _row(
    published: ScoringProtocol,
    chain: Sequence[ScoringProtocol],
    found: Mapping[ScoringProtocol, Evaluation | InputError],
) -> Row:
    last = found[chain[-1]]
    if isinstance(last, InputError):
        raise TypeError("only what has a score is a row")
    links = []
    for before, after in pairwise(chain):
        values = [found[each] for each in (before, after)]
        scores = [v.results["abs_rel"].value for v in values if isinstance(v, Evaluation)]
        change = scores[1] - scores[0] if len(scores) == 2 else float("nan")
        links.append(Link(*_named(before, after), change))
    weak = chain[-1].alignment != published.alignment
    return Row(
        chain[-1],
        published.alignment if weak else None,
        len(last.scores),
        len(last.left_out),
        last.results,
        tuple(links),
    )


def _named(before: ScoringProtocol, after: ScoringProtocol) -> tuple[str, str, str]:
    """Return the name of the link between two protocols, what was and what is."""
    for name, names in LINKS.items():
        fields = [each for each in names if getattr(before, each) != getattr(after, each)]
        if fields:
            old, new = (
                ", ".join(_words(each, getattr(protocol, each)) for each in fields)
                for protocol in (before, after)
            )
            return name, old, new
    return "name", before.name, after.name


def _words(field: str, value: object) -> str:
    """Return what a field holds, in words."""
    if field == "settings" and isinstance(value, tuple):
        return ", ".join(f"{name} {each}" for name, each in value)
    if field == "videos" and isinstance(value, tuple):
        return f"{len(value)} videos" if value else "all videos"
    if field == "clip" and isinstance(value, tuple):
        return f"clipped to {value[0]:g} to {value[1]:g} m"
    if value is None:
        return _NONE[field]
    return f"{_PREFIX.get(field, '')}{value}"


@dataclass(frozen=True, eq=False)
class _Scores:
    """What scores protocols, those that see the same images together."""

    settings: DataSettings
    load: Load
    predictions: Predictions
    watch: Watch

    def of(
        self, protocols: Sequence[ScoringProtocol]
    ) -> dict[ScoringProtocol, Evaluation | InputError]:
        found: dict[ScoringProtocol, Evaluation | InputError] = {}
        groups: dict[object, list[ScoringProtocol]] = {}
        for each in dict.fromkeys(protocols):
            key = (repr(suited(self.settings, each)), each.frames, each.videos)
            groups.setdefault(key, []).append(each)
        for group in groups.values():
            found |= self._group(group)
        return found

    def _group(
        self, group: Sequence[ScoringProtocol]
    ) -> dict[ScoringProtocol, Evaluation | InputError]:
        try:
            pairs = self.load(suited(self.settings, group[0]))
            scored = evaluate_all(pairs, self.predictions, group, self.watch)
            return dict(zip(group, scored, strict=True))
        except InputError as error:
            if len(group) == 1:
                return {group[0]: error}
        return {each: self._group([each])[each] for each in group}
