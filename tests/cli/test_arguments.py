import io
from dataclasses import dataclass
from typing import Literal

import pytest
import tyro

from flexdepth.cli.arguments import told_in_one_line
from flexdepth.runtime.errors import InputError


@dataclass(frozen=True)
class Walk:
    """Walk."""

    steps: int
    pace: Literal["slow", "fast"] = "slow"


def walk(*arguments):
    with told_in_one_line("walk"):
        return tyro.cli(Walk, args=arguments, prog="walk")


@pytest.mark.parametrize(
    ("arguments", "complaint"),
    [
        ((), "Missing from walk: --steps INT"),
        (("--steps", "many"), "Error parsing --steps: invalid literal"),
        (("--steps", "3", "--pace", "huge"), "invalid choice 'huge' for argument '--pace'"),
        (("--steps", "3", "--pcae", "slow"), "--pcae, slow; did you mean --pace {slow,fast}?"),
        (("--steps", "3", "on"), "Unrecognized options: on"),
    ],
)
@pytest.mark.parametrize("columns", ["40", "80", "200"])
@pytest.mark.parametrize("encoding", ["utf-8", "ascii"])
def test_a_mistake_is_one_line_in_any_terminal(
    arguments, complaint, columns, encoding, monkeypatch, capsys
):
    monkeypatch.setenv("COLUMNS", columns)
    monkeypatch.setattr("sys.stdout", io.TextIOWrapper(io.BytesIO(), encoding))
    with pytest.raises(InputError) as mistake:
        walk(*arguments)
    said = str(mistake.value)
    assert complaint in said
    assert said.endswith("(walk --help)")
    assert "\n" not in said
    assert not set("│─") & set(said)
    assert "----" not in said
    assert capsys.readouterr().err == ""


def test_arguments_without_mistakes_pass():
    assert walk("--steps", "3") == Walk(3)


def test_help_is_written_as_it_is(capsys):
    with pytest.raises(SystemExit) as stop:
        walk("--help")
    assert stop.value.code == 0
    assert "usage: walk" in capsys.readouterr().out
