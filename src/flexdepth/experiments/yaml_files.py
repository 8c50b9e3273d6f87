"""Experiments in .yaml files: what differs from a named one, or every field."""

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import yaml

from flexdepth.experiments.experiment import CODEC, Experiment
from flexdepth.experiments.held_out import with_own_held_out
from flexdepth.runtime.errors import InputError, reason

LIKE = "like"
"""The field that names the experiment whose fields a file changes."""

_KIND = "_type"


def read_experiment(path: Path, named: Mapping[str, Experiment]) -> Experiment:
    """Return the experiment in a file.

    What the file does not say is as in the experiment that it says it is `like`, whose terms it
    adds to, changes, or leaves out by null. Without `like` the rest is as in `Experiment`, but the
    terms are the file's. Where a file gives a field another `_type`, what it does not say of that
    field is the default of the type.

    Args:
        path: The file.
        named: What it may be like.

    Raises:
        InputError: The file cannot be read, or a field is unknown or of another type.
    """
    values = _mapping(path)
    like = values.pop(LIKE, None)
    names = sorted(named)
    if like is not None and like not in names:
        raise InputError(f"{path}: {LIKE}: no experiment {like!r}; choose one of {names}")
    first = Experiment() if like is None else named[like]
    plain = CODEC.plain(first)
    if like is None and "terms" in values:
        plain["terms"] = {}
    changed = _changed(plain, values)
    terms = changed["terms"]
    if isinstance(terms, dict):
        changed["terms"] = {name: term for name, term in terms.items() if term is not None}
    experiment = CODEC.restored(Experiment, changed, str(path))
    return experiment if "held_out" in values else with_own_held_out(first, experiment)


def experiment_text(experiment: Experiment) -> str:
    """Return every field of an experiment as YAML that `read_experiment` takes."""
    plain = json.loads(json.dumps(CODEC.plain(experiment)))  # YAML knows no named constants
    text: str = yaml.safe_dump(plain, sort_keys=False, allow_unicode=True)
    return text


def _mapping(path: Path) -> dict[str, Any]:
    try:
        values = yaml.safe_load(path.read_text(encoding="utf-8"))
    except (OSError, UnicodeDecodeError) as error:
        raise InputError(f"{path}: cannot be read as an experiment: {reason(error)}") from error
    except yaml.YAMLError as error:
        raise InputError(f"{path}: is not YAML: {reason(error)}") from error
    if not isinstance(values, dict):
        raise InputError(f"{path}: wanted the fields of an experiment, got {values!r}")
    return values


def _changed(first: Any, values: Any) -> Any:  # noqa: ANN401 - plain values of any kind
    """Return plain values with those of a file in their places."""
    if not isinstance(first, dict) or not isinstance(values, dict):
        return values
    if values.get(_KIND, first.get(_KIND)) != first.get(_KIND):
        return values
    return first | {key: _changed(first.get(key), value) for key, value in values.items()}
