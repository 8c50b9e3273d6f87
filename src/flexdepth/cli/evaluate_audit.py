"""`flexdepth evaluate audit PREDICTIONS SET`: one set of predictions under every protocol."""

import json
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any, Generic, TypeVar

import tyro

from flexdepth.cli.evaluate import Files
from flexdepth.cli.progress import counted
from flexdepth.cli.scores import audit_table
from flexdepth.cli.sets import named_set, parsed
from flexdepth.data.catalogue import DATASETS
from flexdepth.evaluation.audit import audit
from flexdepth.evaluation.catalogue import for_testing
from flexdepth.evaluation.evaluate import Pairs
from flexdepth.evaluation.predictions import prediction_folder
from flexdepth.evaluation.report import plain_fields
from flexdepth.runtime.atomic import replacing
from flexdepth.runtime.errors import InputError

Data = TypeVar("Data")


@dataclass(frozen=True)
class Audit(Generic[Data]):
    """Score predictions under every protocol that is for the set, and say why the numbers differ.

    Where a protocol's fit is too weak for the predictions, the weakest that is enough is taken
    and marked *. From the first protocol to each other one lead single changes, each with what it
    does to AbsRel.
    """

    predictions: Annotated[
        Path, tyro.conf.Positional, tyro.conf.arg(metavar="PREDICTIONS", help_behavior_hint="")
    ]
    """A folder of depth files."""
    data: Annotated[Data, tyro.conf.arg(name="")]
    """The set's own settings."""
    files: Annotated[Files, tyro.conf.arg(name="")]
    """For the predictions."""
    output: Annotated[
        Path | None, tyro.conf.arg(aliases=("-o",), metavar="FILE", help_behavior_hint="")
    ] = None
    """Also write everything as JSON."""


def run(arguments: Sequence[str]) -> int:
    """Audit the predictions that `arguments` name."""
    if len(arguments) < 2 or any(each.startswith("-") for each in arguments[:2]):
        raise InputError("name predictions and a set: flexdepth evaluate audit DIR SET (--help)")
    name, more = named_set(arguments[1])
    kind = DATASETS[name]

    default: Audit[Any] = Audit(tyro.MISSING, for_testing(kind(), None), Files())
    given = [arguments[0], *more, *arguments[2:]]
    command = f"flexdepth evaluate audit PREDICTIONS {name}"
    settings = parsed(Audit[kind], default, given, command)  # type: ignore[valid-type]
    images = len(settings.data.load())
    in_order = images if settings.files.match == "order" else None
    folder = prediction_folder(settings.predictions, settings.files.stated(), in_order)
    with counted("scoring", images) as watch:
        found = audit(settings.data, _loaded, folder, watch)
    if settings.output is not None:
        text = json.dumps(plain_fields(found), indent=1, ensure_ascii=False, allow_nan=False)
        with replacing(settings.output) as temporary:
            temporary.write_text(text + "\n", encoding="utf-8")
    sys.stdout.write(audit_table(found))
    return 0


def _loaded(settings: Any) -> Pairs:  # noqa: ANN401
    pairs: Pairs = settings.load()
    return pairs
