"""What is asked of a model, beside what was measured."""

import operator
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Literal

from blind import BEST_CONSTANT, GROUND, RAMP
from boundaries import CEILING
from samples import RENDERED
from scores import Fit, Result

Sign = Literal["<=", ">=", "<", ">"]

_HOLDS: Mapping[Sign, Callable[[float, float], bool]] = MappingProxyType(
    {"<=": operator.le, ">=": operator.ge, "<": operator.lt, ">": operator.gt}
)

ABS_REL: Mapping[Fit, Mapping[str, float]] = MappingProxyType(
    {
        Fit.DISPARITY: {"7-Scenes": 0.15, "NYU": 0.13, "ICL-NUIM": 0.08, "KITTI": 0.115},
        Fit.MEDIAN: {"NYU": 0.16, "KITTI": 0.135},
        Fit.METRES: {"NYU": 0.20, "KITTI": 0.15},
    }
)
"""At most, by set."""

DELTA1: Mapping[Fit, Mapping[str, float]] = MappingProxyType(
    {
        Fit.DISPARITY: {"7-Scenes": 0.76, "NYU": 0.83, "ICL-NUIM": 0.93, "KITTI": 0.85},
        Fit.MEDIAN: {"NYU": 0.78, "KITTI": 0.81},
        Fit.METRES: {},
    }
)
"""At least, by set."""

SHARP = ("ICL-NUIM", RENDERED.name)
"""Where boundary F1 is asked for."""

OF_CEILING = 0.5
"""The part of what the reduced truth scores that boundary F1 has to reach."""

RIVALS = (BEST_CONSTANT, RAMP, GROUND)
"""Every figure has to be better than theirs, wherever they have one."""


@dataclass(frozen=True)
class Limit:
    """How a number has to stand to a value."""

    sign: Sign
    value: float

    def allows(self, number: float) -> bool:
        """Return whether a number is as asked."""
        return _HOLDS[self.sign](number, self.value)

    def __str__(self) -> str:
        """Return <= .15."""
        return f"{self.sign} {written(self.value)}"


IMAGE_SECONDS = Limit("<=", 0.35)
"""CPU time of rendering an image of 256x192 on one core, one sample a pixel."""


@dataclass(frozen=True)
class Bar:
    """One number beside what is asked of it.

    Attributes:
        name: Of the number.
        measured: None where the model does not say it.
        limit: What is asked.
    """

    name: str
    measured: float | None
    limit: Limit

    @property
    def met(self) -> bool:
        """Whether the number is as asked; what is not said is not."""
        return self.measured is not None and self.limit.allows(self.measured)

    def record(self) -> dict[str, str | float | bool | None]:
        """Return it for JSON."""
        return {
            "name": self.name,
            "asked": str(self.limit),
            "measured": self.measured,
            "met": self.met,
        }


def written(number: float) -> str:
    """Return a number the way papers write it, to the fourth decimal: .1234."""
    digits = f"{round(number, 4):g}"
    return digits[1:] if digits.startswith("0.") else digits


def asked(
    results: Mapping[str, Result], edges: Mapping[str, Mapping[str, float]], model: str
) -> Iterator[Bar]:
    """Yield the bars of the sets that were scored: AbsRel, delta1 and boundary F1.

    Args:
        results: By set.
        edges: Boundary F1 by set, then by who predicted.
        model: Who has to reach them.
    """
    for name, result in results.items():
        for fit in Fit:
            score = result.scores[fit].get(model)
            if name in ABS_REL[fit]:
                limit = Limit("<=", ABS_REL[fit][name])
                yield Bar(f"{name}, {fit}: AbsRel", None if score is None else score.abs_rel, limit)
            if name in DELTA1[fit]:
                limit = Limit(">=", DELTA1[fit][name])
                yield Bar(f"{name}, {fit}: delta1", None if score is None else score.delta1, limit)
        if name in SHARP and name in edges:
            limit = Limit(">=", OF_CEILING * edges[name][CEILING])
            yield Bar(f"{name}: boundary F1", edges[name].get(model), limit)


def beside_the_blind(results: Mapping[str, Result], model: str) -> Iterator[Bar]:
    """Yield a bar for each figure of a model: the best that `RIVALS` reach there."""
    for name, result in results.items():
        for fit, scores in result.scores.items():
            if model not in scores:
                continue
            blind = [scores[who] for who in RIVALS if who in scores]
            least = Limit("<", min(each.abs_rel for each in blind))
            yield Bar(f"{name}, {fit}: AbsRel beside the blind", scores[model].abs_rel, least)
            most = Limit(">", max(each.delta1 for each in blind))
            yield Bar(f"{name}, {fit}: delta1 beside the blind", scores[model].delta1, most)
