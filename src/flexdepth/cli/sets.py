"""What commands that take a data set share: its name, its settings as flags, the list of all."""

from collections.abc import Sequence
from difflib import get_close_matches
from pathlib import Path
from typing import TypeVar

import tyro

from flexdepth.cli.arguments import told_in_one_line
from flexdepth.data.catalogue import DATASETS
from flexdepth.runtime.errors import InputError

Settings = TypeVar("Settings")

_WIDTH = 76


def named_set(name: str) -> tuple[str, list[str]]:
    """Return a set's name and the arguments that a plain folder stands for.

    Raises:
        InputError: There is no such set and no such folder.
    """
    if name in DATASETS:
        return name, []
    if Path(name).is_dir():
        return "folder", ["--root", name]
    near = get_close_matches(name.lower(), DATASETS, n=1)
    hint = f"did you mean {near[0]!r}?" if near else f"choose one of {', '.join(DATASETS)}"
    raise InputError(f"no data set {name!r}, and no such folder; {hint}")


def parsed(
    kind: type[Settings], default: Settings, arguments: Sequence[str], command: str
) -> Settings:
    """Return a command's settings, with those of a set among them.

    Args:
        kind: The class of the settings, made for the set.
        default: Values of what is not given.
        arguments: What follows the command.
        command: As it is typed.

    Raises:
        InputError: An argument is unknown, missing or has a value that does not fit.
    """
    with told_in_one_line(command):
        return tyro.cli(
            kind,
            args=arguments,
            prog=command,
            default=default,
            config=(tyro.conf.AvoidSubcommands, tyro.conf.EnumChoicesFromValues),
        )


def listed_sets() -> str:
    """Return the names of all sets, in lines."""
    lines, line = [], " "
    for name in DATASETS:
        if len(line) + len(name) > _WIDTH:
            lines.append(line)
            line = " "
        line += f" {name}"
    return "\n".join([*lines, line])
