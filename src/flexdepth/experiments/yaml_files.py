"""Experiments in .yaml files: a change of a named one, or every field."""

from pathlib import Path

import yaml

from flexdepth.experiments.experiment import CODEC, Experiment
from flexdepth.runtime.atomic import replacing
from flexdepth.runtime.errors import InputError


def read_experiment(path: Path) -> Experiment:
    """Return the experiment in a file; what it does not name is as in `Experiment`.

    Raises:
        InputError: The file cannot be read, or a field is unknown or of another type.
    """
    try:
        text = path.read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        raise InputError(f"{path}: cannot be read as an experiment: {error}") from error
    try:
        values = yaml.safe_load(text)
    except yaml.YAMLError as error:
        raise InputError(f"{path}: is not YAML: {error}") from error
    if not isinstance(values, dict):
        raise InputError(f"{path}: wanted the fields of an experiment, got {values!r}")
    return CODEC.restored(Experiment, values, str(path))


def write_experiment(path: Path, experiment: Experiment) -> None:
    """Write every field of an experiment."""
    with replacing(path) as temporary:
        text = yaml.safe_dump(CODEC.plain(experiment), sort_keys=False, allow_unicode=True)
        temporary.write_text(text, encoding="utf-8")
