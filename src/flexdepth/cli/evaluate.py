"""`flexdepth evaluate MODEL SET`: how good predictions are; `audit` and `compare` explain it."""

import sys
import time
from collections.abc import Sequence
from dataclasses import dataclass, fields
from importlib import import_module
from pathlib import Path
from types import MappingProxyType
from typing import Annotated, Any, Generic, Literal, TypeVar

import tyro

from flexdepth.cli.progress import counted
from flexdepth.cli.scores import table
from flexdepth.cli.sets import listed_sets, named_set, parsed
from flexdepth.data.catalogue import DATASETS
from flexdepth.evaluation.alignment import Alignment
from flexdepth.evaluation.catalogue import (
    PROTOCOLS,
    Changes,
    changed,
    for_testing,
    protocol_named,
    protocols_for,
)
from flexdepth.evaluation.evaluate import evaluate
from flexdepth.evaluation.looks import LOOKS
from flexdepth.evaluation.pictures import write_worst
from flexdepth.evaluation.predictions import (
    ModelPredictions,
    Predictions,
    Stated,
    prediction_folder,
)
from flexdepth.evaluation.protocols import Averaging, Scope, ScoringProtocol
from flexdepth.evaluation.report import Report, check_place, remarks, write_report
from flexdepth.runtime.atomic import check_writable
from flexdepth.runtime.depthmap import Space
from flexdepth.runtime.errors import InputError
from flexdepth.runtime.licences import remark
from flexdepth.runtime.named import Wishes, named_estimator

_PAGE = """\
usage: flexdepth evaluate MODEL SET [options]              score a model or predictions on a set
       flexdepth evaluate audit PREDICTIONS SET [options]  under every protocol, with the reasons
       flexdepth evaluate compare RESULT RESULT            whether two results differ

MODEL is `bundled`, an .onnx network, hub:NAME (docs/models.md), or a folder of predictions. SET is
a folder of image/ and depth/, or one of the sets below, whose --root is the folder it lies in;
flexdepth evaluate MODEL SET --help lists what a set takes. Sets:
{sets}

protocols (docs/protocols.md):
{protocols}
"""

_OTHERS = MappingProxyType(
    {"audit": "flexdepth.cli.evaluate_audit", "compare": "flexdepth.cli.evaluate_compare"}
)

Data = TypeVar("Data")
_Shown = tyro.conf.arg(help_behavior_hint="")


@dataclass(frozen=True)
class Files:
    """What is said of a folder of predictions."""

    space: Annotated[Space | None, _Shown] = None
    """What the numbers in a folder of predictions mean, where its files do not say it."""
    scale: Annotated[float, tyro.conf.arg(metavar="X")] = 1.0
    """With --space: the value of the stored number 1, in metres for metric depth."""
    match: Literal["name", "order"] = "name"
    """How the files of a folder belong to images: NAME.npz to the image NAME, or by their order."""

    def stated(self) -> Stated | None:
        """Return what the user says of the numbers."""
        return None if self.space is None else Stated(self.space, self.scale)


@dataclass(frozen=True)
class Evaluate(Generic[Data]):
    """Score a model, or predictions that any program has made, by a named protocol.

    Writes DIR/PROTOCOL/result.json (all it takes to repeat the numbers), images.csv (one row an
    image) and the worst images as pictures; predictions of a model are kept in DIR and made once.
    """

    model: Annotated[
        str, tyro.conf.Positional, tyro.conf.arg(metavar="MODEL", help_behavior_hint="")
    ]
    """`bundled`, any .onnx network that says what it is or has a .yaml card, hub:NAME, or a
    folder of depth files."""
    data: Annotated[Data, tyro.conf.arg(name="")]
    """The set's own settings."""
    files: Annotated[Files, tyro.conf.arg(name="")]
    """For a folder of predictions."""
    protocol: Annotated[str | None, tyro.conf.arg(metavar="NAME", help_behavior_hint="")] = None
    """How it is scored; the set's own protocol without it (flexdepth evaluate -h lists them)."""
    alignment: Annotated[Alignment | None, _Shown] = None
    """Fit predictions to the truth in this way instead of the protocol's."""
    per: Annotated[Scope | None, _Shown] = None
    """Fit each image, or each video as a whole, instead of the protocol's way."""
    farthest: Annotated[float | None, tyro.conf.arg(metavar="METRES", help_behavior_hint="")] = None
    """Score no truth beyond this, instead of the protocol's end."""
    averaging: Annotated[Averaging | None, _Shown] = None
    """How images become one number, instead of the protocol's way; `pixels` pools them."""
    look: Annotated[Literal["once", "flip", "flip-mean", "flip-ramp", "sizes"] | None, _Shown] = (
        None
    )
    """How a model looks: once, or in a mirror too, and the geometric mean, the mean, or
    monodepth's ramps of both, or at three sizes. Without it, as in `flexdepth predict`: sizes."""
    long_side: Annotated[int | None, tyro.conf.arg(metavar="PIXELS", help_behavior_hint="")] = None
    """Longer side of what a model sees."""
    output_dir: Annotated[
        Path | None, tyro.conf.arg(aliases=("-o",), metavar="DIR", help_behavior_hint="")
    ] = None
    """Where results go; without it, evaluation/MODEL-SET."""
    worst: Annotated[int, tyro.conf.arg(metavar="N")] = 4
    """How many of the worst images are drawn."""
    overwrite: Annotated[bool, tyro.conf.FlagCreatePairsOff, _Shown] = False
    """Replace what lies in the place of a result or a prediction."""


def run(arguments: Sequence[str]) -> int:
    """Do what the arguments say: score, audit or compare."""
    match list(arguments):
        case ["compare", *rest]:
            return int(import_module(_OTHERS["compare"]).run(rest))
        case ["-h" | "--help", *_] | [_, "-h" | "--help", *_]:
            protocols = "".join(f"  {each.name:<27}{each.summary}\n" for each in PROTOCOLS.values())
            sys.stdout.write(_PAGE.format(sets=listed_sets(), protocols=protocols.rstrip()))
            raise SystemExit(0)
        case ["audit", *rest]:
            return int(import_module(_OTHERS["audit"]).run(rest))
        case [model, name, *rest] if not model.startswith("-") and not name.startswith("-"):
            name, more = named_set(name)
            return _evaluate(name, [model, *more, *rest])
    raise InputError(
        "name a model and a set: flexdepth evaluate bundled SET --root DIR (or --help)"
    )


def _evaluate(name: str, arguments: Sequence[str]) -> int:
    begin = time.monotonic()
    settings, protocol = _settings(name, arguments)
    pairs = settings.data.load()
    folder = settings.output_dir or _place(settings.model, name, settings.data)
    check_writable(folder)
    predictions = _predictions(settings, folder, len(pairs))
    place = folder / protocol.name
    check_place(place, name, settings.data, predictions.about, settings.overwrite)
    with counted("scoring", len(pairs)) as watch:
        found = evaluate(pairs, predictions, protocol, watch)
    said = (*remarks(found, settings.data), *_licence(predictions))
    command = ("flexdepth", "evaluate", *arguments[:1], name, *arguments[1:])
    seconds = time.monotonic() - begin
    report = Report(found, name, settings.data, predictions.about, said, command, seconds)
    write_report(place, report)
    sys.stdout.write(table(found, said))
    write_worst(place / "worst", found, pairs, predictions, settings.worst)
    sys.stdout.write(f"{place}: result.json, images.csv, worst/; {seconds:.1f} s\n")
    return 0


def _settings(name: str, arguments: Sequence[str]) -> tuple[Evaluate[Any], ScoringProtocol]:
    """Return what was asked for, where the protocol says which split and which truth it is for."""
    kind = DATASETS[name]
    command = f"flexdepth evaluate MODEL {name}"

    def asked(protocol: ScoringProtocol | None) -> Evaluate[Any]:
        default: Evaluate[Any] = Evaluate(tyro.MISSING, for_testing(kind(), protocol), Files())
        return parsed(Evaluate[kind], default, arguments, command)  # type: ignore[valid-type]

    first = asked(None)
    chosen = (
        protocols_for(first.data)[0] if first.protocol is None else protocol_named(first.protocol)
    )
    if not chosen.is_for(first.data):
        apt = ", ".join(each.name for each in protocols_for(first.data))
        raise InputError(
            f"--protocol: {chosen.name} is not for the set {name}; choose one of {apt}"
        )
    settings = asked(chosen)
    if settings.worst < 0:
        raise InputError(f"--worst: wanted a whole number >= 0, got {settings.worst}")
    names = [each.name for each in fields(Changes)]
    return settings, changed(chosen, Changes(**{each: getattr(settings, each) for each in names}))


def _predictions(settings: Evaluate[Any], folder: Path, images: int) -> Predictions:
    path = Path(settings.model)
    if path.is_dir():
        in_order = images if settings.files.match == "order" else None
        return prediction_folder(path, settings.files.stated(), in_order)
    if settings.files != Files():
        raise InputError("--space, --scale and --match are for a folder of predictions")
    wishes = Wishes(
        None, settings.long_side, None if settings.look is None else LOOKS[settings.look]
    )
    estimator = named_estimator(settings.model, wishes)
    return ModelPredictions(estimator, folder / "predictions", settings.overwrite)


def _licence(predictions: Predictions) -> tuple[str, ...]:
    """Return what must be known of the licence of a model's weights."""
    if not isinstance(predictions, ModelPredictions):
        return ()
    said = remark(predictions.predictor.about)
    return () if said is None else (said,)


def _place(model: str, name: str, data: Any) -> Path:  # noqa: ANN401
    """Return the folder of the results by default."""
    dataset = data.root.resolve().name if name == "folder" else name
    return Path("evaluation") / f"{Path(model).resolve().stem}-{dataset}"
