"""What an evaluation leaves on disk: `result.json`, to repeat it by, and `images.csv`.

A number in `result.json` belongs to the protocol, the set, the truth and the predictions that
stand beside it. `images.csv` has a row for each image, those without a score as well.
"""

import csv
import json
import math
from collections.abc import Mapping
from dataclasses import dataclass, fields, is_dataclass
from enum import Enum
from importlib.metadata import version
from pathlib import Path

from flexdepth.evaluation.catalogue import deviations
from flexdepth.evaluation.evaluate import Evaluation
from flexdepth.evaluation.protocols import DataSettings
from flexdepth.evaluation.score import ALL_METRICS
from flexdepth.evaluation.summary import CONFIDENCE, RESAMPLES, SEED
from flexdepth.runtime.atomic import replacing
from flexdepth.runtime.errors import InputError

RESULT, IMAGES = "result.json", "images.csv"
_FIRST = ("name", "number", "pixels", "factor", "offset")
_LAST = "left_out"
_LIBRARIES = ("numpy", "opencv-contrib-python-headless", "onnxruntime", "pillow")


@dataclass(frozen=True)
class Report:
    """An evaluation and where it came from.

    Attributes:
        evaluation: The scores.
        dataset: The set's name.
        settings: The set's settings.
        predictions: What was scored (`Predictions.about`).
        remarks: What a reader of the numbers must know.
        command: What was typed.
        seconds: How long it took.
    """

    evaluation: Evaluation
    dataset: str
    settings: object
    predictions: Mapping[str, object]
    remarks: tuple[str, ...]
    command: tuple[str, ...]
    seconds: float

    def record(self) -> dict[str, object]:
        """Return everything but the images, as JSON has it."""
        found = self.evaluation
        protocol = found.protocol
        return {
            "flexdepth": version("flexdepth"),
            "command": list(self.command),
            "protocol": plain(protocol),
            "dataset": {
                "name": self.dataset,
                "settings": plain(self.settings),
                "images": len(found.scores) + len(found.left_out),
                "truth": f"sha256:{found.truth}",
            },
            "predictions": {**self.predictions, "sizes": found.sizes},
            "results": {
                name: {
                    **{key: plain(value) for key, value in plain_fields(estimate).items()},
                    "title": ALL_METRICS[name].title,
                    "formula": ALL_METRICS[name].formula,
                    "better": "higher" if ALL_METRICS[name].higher_is_better else "lower",
                }
                for name, estimate in found.results.items()
            },
            "intervals": {"confidence": CONFIDENCE, "resamples": RESAMPLES, "seed": SEED},
            "scored": len(found.scores),
            "left_out": [plain_fields(each) for each in found.left_out],
            "remarks": list(self.remarks),
            "libraries": {name: version(name) for name in _LIBRARIES},
            "seconds": round(self.seconds, 1),
        }


@dataclass(frozen=True)
class Stored:
    """A result read back.

    Attributes:
        path: Its folder.
        record: What `result.json` says.
        images: The metrics of each scored image, by its name.
    """

    path: Path
    record: Mapping[str, object]
    images: Mapping[str, Mapping[str, float]]


def write_report(folder: Path, report: Report) -> None:
    """Write `result.json` and `images.csv`; each appears whole or not at all.

    Raises:
        InputError: They cannot be written.
    """
    with (
        replacing(folder / IMAGES) as temporary,
        temporary.open("w", encoding="utf-8", newline="") as file,
    ):
        writer = csv.DictWriter(file, [*_FIRST, *report.evaluation.results, _LAST])
        writer.writeheader()
        writer.writerows(_rows(report.evaluation))
    with replacing(folder / RESULT) as temporary:
        text = json.dumps(report.record(), indent=1, ensure_ascii=False, allow_nan=False)
        temporary.write_text(text + "\n", encoding="utf-8")


def read_report(path: Path) -> Stored:
    """Return a result that `write_report` wrote.

    Args:
        path: Its folder, or the `result.json` in it.

    Raises:
        InputError: There is none, or it is broken.
    """
    folder = path.parent if path.name == RESULT else path
    try:
        record = json.loads((folder / RESULT).read_text(encoding="utf-8"))
        with (folder / IMAGES).open(encoding="utf-8", newline="") as file:
            rows = list(csv.DictReader(file))
        metrics = list(record["results"])
        images = {
            row["name"]: {metric: float(row[metric]) for metric in metrics}
            for row in rows
            if not row[_LAST]
        }
        record["protocol"]["name"], record["protocol"]["version"], record["dataset"]["truth"]
    except OSError as error:
        raise InputError(
            f"{error.filename}: cannot be read: {error.strerror}; wanted a folder that "
            f"`flexdepth evaluate` wrote, with {RESULT} and {IMAGES}"
        ) from error
    except (ValueError, LookupError, TypeError) as error:
        raise InputError(f"{folder}: {RESULT} or {IMAGES} is broken: {error}") from error
    return Stored(folder, record, images)


def check_place(
    folder: Path,
    dataset: str,
    settings: object,
    predictions: Mapping[str, object],
    overwrite: bool,
) -> None:
    """Refuse to put a result in the place of one of another set or of other predictions.

    Raises:
        InputError: There is such a result, or something that is none.
    """
    if overwrite or not (folder / RESULT).exists():
        return
    record = read_report(folder).record
    there = {**_mapping(record, "predictions")}
    there.pop("sizes", None)
    about = {"dataset": _mapping(record, "dataset").get("settings"), "predictions": there}
    same = about == {"dataset": plain(settings), "predictions": plain(predictions)}
    if not same or _mapping(record, "dataset").get("name") != dataset:
        raise InputError(
            f"{folder / RESULT}: is the result of another set or of other predictions; add "
            f"--overwrite or choose another --output-dir"
        )


def check_comparable(first: Stored, second: Stored) -> None:
    """Refuse two results that do not measure the same.

    Raises:
        InputError: They are of different protocols, sets or truths.
    """
    for what, key in (("protocol", "name"), ("protocol", "version"), ("dataset", "truth")):
        one, other = (_mapping(each.record, what).get(key) for each in (first, second))
        if one != other:
            raise InputError(
                f"{first.path} and {second.path} do not measure the same: "
                f"{what} {key} is {one} in one and {other} in the other"
            )


def remarks(found: Evaluation, settings: DataSettings) -> tuple[str, ...]:
    """Return what a reader of the numbers must know before comparing them with published ones."""
    protocol, scored = found.protocol, len(found.scores)
    said = deviations(settings, protocol)
    if protocol.images is not None and scored != protocol.images:
        said.append(f"{protocol.name} is published for {protocol.images} images, here {scored}")
    if "+" in protocol.name:
        said.append(f"{protocol.name} is not the protocol as it stands: say so beside the numbers")
    if len({size.split()[1] for size in found.sizes}) > 1:
        sizes = ", ".join(f"{count} of {size}" for size, count in found.sizes.items())
        said.append(f"predictions do not all mean the same: {sizes}")
    return tuple(said)


def _mapping(record: Mapping[str, object], name: str) -> Mapping[str, object]:
    found = record.get(name)
    return found if isinstance(found, Mapping) else {}


def plain(value: object) -> object:
    """Return a value as JSON has it; a dataclass carries the name of its class.

    Infinity becomes the string "inf", and NaN "nan": JSON has neither.
    """
    if is_dataclass(value):
        return {"_type": type(value).__name__, **plain_fields(value)}
    if isinstance(value, Enum):
        return str(value.value)
    if isinstance(value, float) and not math.isfinite(value):
        return str(value)
    if isinstance(value, Mapping):
        return {str(key): plain(each) for key, each in value.items()}
    if isinstance(value, tuple | list):
        return [plain(each) for each in value]
    return str(value) if isinstance(value, Path) else value


def plain_fields(value: object) -> dict[str, object]:
    """Return the fields of a dataclass as JSON has them."""
    if not is_dataclass(value):
        raise TypeError(f"wanted a dataclass, got {value!r}")
    return {each.name: plain(getattr(value, each.name)) for each in fields(value)}


def _rows(found: Evaluation) -> list[dict[str, object]]:
    scored: list[dict[str, object]] = [
        {
            "name": score.name,
            "number": number,
            "pixels": score.pixels,
            "factor": score.fit.line.factor,
            "offset": score.fit.line.offset,
            **score.values,
        }
        for number, score in zip(found.numbers, found.scores, strict=True)
    ]
    return scored + [{"name": each.name, _LAST: each.reason} for each in found.left_out]
