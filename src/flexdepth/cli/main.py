"""`flexdepth COMMAND`: choose a command, load only that, and say plainly what went wrong.

A command is a module with `run(arguments) -> int` (its exit code) and one line in `COMMANDS`. It is
imported once it is chosen: `flexdepth --help` loads no numpy, and `flexdepth predict` no torch.

Exit codes: 0 done; 1 a bug, with its traceback; 2 a mistake that the user can mend, in one line;
130 stopped with Ctrl-C; 141 nobody reads the output any more, as in `flexdepth ... | head`.
"""

import io
import os
import re
import sys
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from difflib import get_close_matches
from importlib import import_module
from importlib.metadata import requires, version
from pathlib import Path
from types import MappingProxyType

from flexdepth.runtime.errors import InputError, one_line


@dataclass(frozen=True)
class Command:
    """Where a command lives, and what it does in one line."""

    module: str
    summary: str


COMMANDS: Mapping[str, Command] = MappingProxyType(
    {
        "predict": Command("flexdepth.cli.predict", "Write the depth of photos and videos."),
        "solve": Command("flexdepth.cli.solve", "Find depth and motion in two frames of a scene."),
        "inspect": Command("flexdepth.cli.inspect", "Say what the numbers in a depth file mean."),
        "convert": Command(
            "flexdepth.cli.convert", "Change a depth file's format, not its meaning."
        ),
        "synth": Command("flexdepth.cli.synth", "Render scenes with exact depth to train on."),
        "train": Command("flexdepth.cli.train", "Train a network, or go on with a run."),
        "table": Command(
            "flexdepth.cli.table", "Train the rows of a table of chapter 3, and write it."
        ),
        "figure": Command("flexdepth.cli.figure", "Draw figures of chapter 3, of any photos."),
        "average": Command("flexdepth.cli.average", "Make one network of several checkpoints."),
        "export": Command("flexdepth.cli.export", "Make a trained network a model bundle."),
        "evaluate": Command(
            "flexdepth.cli.evaluate", "Score a model or predictions by a named protocol."
        ),
        "data": Command("flexdepth.cli.data", "Check a data set, or make it a plain folder."),
        "show": Command(
            "flexdepth.cli.show", "List the parts of a network, or the fields of an experiment."
        ),
    }
)

_DONE, _MISTAKE, _INTERRUPTED, _UNREAD = 0, 2, 130, 141

_PAGE = """\
flexdepth {version}: depth from ordinary colour pictures.

usage: flexdepth COMMAND ...

commands:
{commands}

options:
  -h, --help     show this page
  -V, --version  show the version

flexdepth COMMAND --help lists what a command takes. To begin with:
  flexdepth predict photo.jpg --preview
"""


def main(arguments: Sequence[str] | None = None, commands: Mapping[str, Command] = COMMANDS) -> int:
    """Run one command and return the exit code.

    Args:
        arguments: What follows `flexdepth`; None takes it from the shell.
        commands: The commands by name.
    """
    _write_any_file_name()
    try:
        try:
            return _dispatch(sys.argv[1:] if arguments is None else arguments, commands)
        finally:
            sys.stdout.flush()
    except InputError as mistake:
        return _complain(str(mistake), _MISTAKE)
    except KeyboardInterrupt:
        return _complain("interrupted", _INTERRUPTED)
    except BrokenPipeError:
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return _UNREAD


def _dispatch(arguments: Sequence[str], commands: Mapping[str, Command]) -> int:
    match arguments:
        case []:
            sys.stderr.write(_page(commands))
            return _MISTAKE
        case ["-h" | "--help", *_]:
            sys.stdout.write(_page(commands))
            return _DONE
        case ["-V" | "--version", *_]:
            sys.stdout.write(f"flexdepth {version('flexdepth')}\n")
            return _DONE
        case [name, *rest] if name in commands:
            return _run(name, commands[name].module, rest)
        case [name, *_]:
            raise InputError(_unknown(name, commands))
    raise TypeError(f"the arguments are a sequence of strings, got {arguments!r}")


def _run(name: str, module: str, arguments: Sequence[str]) -> int:
    try:
        run = import_module(module).run
        return int(run(arguments))
    except ModuleNotFoundError as missing:
        extra = _extra_with(missing.name or "")
        if extra is None:
            raise
        raise InputError(
            f"`flexdepth {name}` needs {missing.name}, which is not installed: "
            f'pip install "flexdepth[{extra}]"'
        ) from missing


def _extra_with(module: str) -> str | None:
    """Return the smallest extra of flexdepth that installs `module`; None where there is none.

    An extra may hold all of another one, as `hub` does of `torch`. `dev` is for developers.
    """
    wanted = module.partition(".")[0].lower()
    extras: dict[str, set[str]] = {}
    for requirement in requires("flexdepth") or []:
        found = re.match(r"([\w.-]+).*;.*extra == ['\"](\w+)['\"]", requirement)
        if found and found[2] != "dev":
            extras.setdefault(found[2], set()).add(found[1].lower().replace("-", "_"))
    holding = [name for name, held in extras.items() if wanted in held]
    return min(holding, key=lambda name: len(extras[name]), default=None)


def _unknown(name: str, commands: Mapping[str, Command]) -> str:
    near = get_close_matches(name.lower(), commands, n=1)
    if near:
        return f"no command `{name}`; did you mean `flexdepth {near[0]}`?"
    if Path(name).exists():
        return f"no command `{name}`; for its depth: flexdepth predict {name}"
    return f"no command `{name}`; choose one of {', '.join(commands)} (flexdepth --help)"


def _page(commands: Mapping[str, Command]) -> str:
    width = max(map(len, commands))
    lines = [f"  {name:<{width}}  {command.summary}" for name, command in commands.items()]
    return _PAGE.format(version=version("flexdepth"), commands="\n".join(lines))


def _complain(message: str, code: int) -> int:
    sys.stderr.write(f"flexdepth: {one_line(message)}\n")
    return code


def _write_any_file_name() -> None:
    """Let a file name that the terminal's encoding lacks be written, with its odd letters escaped.

    Python does so for errors only; a listing would end in a UnicodeEncodeError.
    """
    if isinstance(sys.stdout, io.TextIOWrapper):
        sys.stdout.reconfigure(errors="backslashreplace")
