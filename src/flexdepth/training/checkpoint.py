"""A run on disk: one safetensors file with weights, averages, the optimiser's state and settings.

Nothing in it is executed when it is read, and it appears whole or not at all.
"""

import json
import subprocess
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from importlib.metadata import version
from pathlib import Path
from typing import Any

import torch
from safetensors import SafetensorError, safe_open
from safetensors.torch import save_file
from torch import Tensor, nn
from torch.optim import Optimizer

from flexdepth.runtime.atomic import replacing
from flexdepth.runtime.errors import InputError

FORMAT = "1"


@dataclass(frozen=True, eq=False)
class Checkpoint:
    """What a run needs to go on.

    Attributes:
        iteration: How many are done.
        settings: Of the experiment, as plain values.
        tensors: By name: `network.*`, `average.*`, `optimiser.<number>.<name>`.
        source: The code that it comes from, as `source` has it; empty in old files.
        errors: Held out, of every validation so far, in order; empty in old files.
    """

    iteration: int
    settings: Mapping[str, Any]
    tensors: Mapping[str, Tensor]
    source: str = ""
    errors: Sequence[float] = ()

    def part(self, prefix: str) -> dict[str, Tensor]:
        """Return the tensors under `prefix.`, without it."""
        start = f"{prefix}."
        return {k.removeprefix(start): v for k, v in self.tensors.items() if k.startswith(start)}


def save(path: Path, checkpoint: Checkpoint) -> None:
    """Write a checkpoint, replacing the one that was there."""
    words = {
        "format": FORMAT,
        "iteration": str(checkpoint.iteration),
        "settings": json.dumps(checkpoint.settings),
        "source": checkpoint.source,
        "errors": json.dumps(list(checkpoint.errors)),
    }
    tensors = {name: tensor.contiguous() for name, tensor in checkpoint.tensors.items()}
    with replacing(path) as temporary:
        temporary.touch()
        mode = temporary.stat().st_mode
        save_file(tensors, temporary, metadata=words)
        temporary.chmod(mode)  # safetensors lets its writer alone read it


def load(path: Path) -> Checkpoint:
    """Return the checkpoint in a file.

    Raises:
        InputError: The file is missing, is no checkpoint of flexdepth, or is of another format.
    """
    words, tensors = _read(path, with_tensors=True)
    iteration, settings, errors = _parsed(path, words)
    return Checkpoint(iteration, settings, tensors, words.get("source", ""), errors)


def progress(path: Path) -> tuple[int, Mapping[str, Any]]:
    """Return the iteration and the settings of a checkpoint; its tensors are not read.

    Raises:
        InputError: As in `load`.
    """
    words, _ = _read(path, with_tensors=False)
    iteration, settings, _ = _parsed(path, words)
    return iteration, settings


def _read(path: Path, *, with_tensors: bool) -> tuple[Mapping[str, str], dict[str, Tensor]]:
    if not path.is_file():
        raise InputError(f"{path}: no such checkpoint")
    try:
        with safe_open(path, framework="pt") as file:
            words: Mapping[str, str] = file.metadata() or {}
            names = file.keys() if with_tensors else ()
            tensors = {name: file.get_tensor(name) for name in names}
    except (SafetensorError, OSError) as error:
        raise InputError(f"{path}: not a readable safetensors file ({error})") from error
    if words.get("format") != FORMAT or "settings" not in words:
        raise InputError(
            f"{path}: wanted a flexdepth checkpoint of format {FORMAT}, "
            f"got format {words.get('format', 'of something else')}"
        )
    return words, tensors


def _parsed(
    path: Path, words: Mapping[str, str]
) -> tuple[int, Mapping[str, Any], tuple[float, ...]]:
    """Return the iteration, the settings and the errors that a file's words tell."""
    try:
        iteration, settings = int(words["iteration"]), json.loads(words["settings"])
        errors = tuple(float(error) for error in json.loads(words.get("errors", "[]")))
    except (KeyError, TypeError, ValueError) as error:
        raise InputError(
            f"{path}: what it says of itself is damaged ({error}); take another checkpoint"
        ) from error
    if not isinstance(settings, dict):
        raise InputError(f"{path}: wanted settings by name, got {words['settings']:.40}")
    return iteration, settings, errors


def source() -> str:
    """Return what code this is: the version and, in a checkout, git's name of the commit.

    `-dirty` after the commit says that files had been changed since.
    """
    released = f"flexdepth {version('flexdepth')}"
    root = Path(__file__).parents[3]
    if not (root / ".git").exists():
        return released
    command = ["git", "-C", str(root), "describe", "--always", "--dirty", "--abbrev=40"]
    try:
        found = subprocess.run(  # noqa: S603
            [*command, "--exclude=*"], capture_output=True, text=True, check=True
        )
    except (OSError, subprocess.CalledProcessError):
        return released
    return f"{released}, commit {found.stdout.strip()}"


def restore(module: nn.Module, weights: Mapping[str, Tensor], where: str) -> None:
    """Give a module exactly these weights.

    Raises:
        InputError: A weight is missing, left over or of another shape; the first ones are named.
    """
    own = module.state_dict()
    missing, unknown = sorted(own.keys() - weights.keys()), sorted(weights.keys() - own.keys())
    common = own.keys() & weights.keys()
    odd = sorted(name for name in common if own[name].shape != weights[name].shape)
    if missing or unknown or odd:
        raise InputError(
            f"{where}: holds the weights of another network; missing {_some(missing)}, "
            f"unknown {_some(unknown)}, of another shape {_some(odd)}"
        )
    module.load_state_dict(dict(weights))


def _some(names: Sequence[str]) -> str:
    return f"{list(names[:3])}" + (f" and {len(names) - 3} more" if len(names) > 3 else "")


def optimiser_tensors(optimiser: Optimizer) -> dict[str, Tensor]:
    """Return the optimiser's state as tensors by name."""
    return {
        f"{number}.{name}": value
        for number, state in optimiser.state_dict()["state"].items()
        for name, value in state.items()
    }


def restore_optimiser(optimiser: Optimizer, tensors: Mapping[str, Tensor]) -> None:
    """Give the optimiser the state that `optimiser_tensors` returned.

    What has the shape of its weight gets the weight's layout in memory, as the optimiser made it:
    another layout is computed with in another order, and the last bits differ.
    """
    weights = [weight for group in optimiser.param_groups for weight in group["params"]]
    state: dict[int, dict[str, Tensor]] = {}
    for key, value in tensors.items():
        number, name = key.split(".")
        weight = weights[int(number)].detach()
        laid = torch.empty_like(weight).copy_(value) if value.shape == weight.shape else value
        state.setdefault(int(number), {})[name] = laid
    optimiser.load_state_dict({**optimiser.state_dict(), "state": state})
