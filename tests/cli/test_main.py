import os
import subprocess
import sys
from importlib import import_module
from importlib.metadata import version
from types import SimpleNamespace

import pytest

from flexdepth.cli.main import COMMANDS, Command, main
from flexdepth.runtime.errors import InputError

TORCH_SIDE = {"torch", "torchvision", "timm", "jaxtyping", "cattrs", "embreex", "onnx"}
HEAVY = TORCH_SIDE | {"numpy", "cv2", "PIL", "onnxruntime", "av", "trimesh", "tyro", "rich"}


@pytest.fixture
def flexdepth(monkeypatch):
    """Run `flexdepth act ...` where the command `act` is the given function."""

    def run_as(run, *arguments):
        monkeypatch.setitem(sys.modules, "acting", SimpleNamespace(run=run))
        return main(arguments, {"act": Command("acting", "Do as the test says.")})

    return run_as


def raising(error):
    def run(_):
        raise error

    return run


def test_a_command_gets_what_follows_its_name_and_gives_the_exit_code(flexdepth):
    seen = []
    assert flexdepth(lambda arguments: seen.extend(arguments) or 7, "act", "a.jpg", "--flip") == 7
    assert seen == ["a.jpg", "--flip"]


def test_the_help_names_every_command_with_its_summary(capsys):
    assert main(["--help"]) == 0
    page, errors = capsys.readouterr()
    assert errors == ""
    for name, command in COMMANDS.items():
        (line,) = [line for line in page.splitlines() if line.startswith(f"  {name} ")]
        assert line.endswith(command.summary)
    assert max(map(len, page.splitlines())) <= 80


def test_without_a_command_the_help_goes_to_the_errors(capsys):
    assert main([]) == 2
    page, errors = capsys.readouterr()
    assert page == ""
    assert "usage: flexdepth COMMAND" in errors


def test_the_version_is_the_installed_one(capsys):
    assert main(["--version"]) == 0
    assert capsys.readouterr().out == f"flexdepth {version('flexdepth')}\n"


@pytest.mark.parametrize("slip", ["predcit", "PREDICT", "predicts", "--predict"])
def test_a_slip_of_the_pen_is_answered_with_the_nearest_command(slip, capsys):
    assert main([slip]) == 2
    assert capsys.readouterr() == (
        "",
        f"flexdepth: no command `{slip}`; did you mean `flexdepth predict`?\n",
    )


def test_a_photo_in_the_place_of_the_command_is_answered_with_predict(tmp_path, capsys):
    photo = tmp_path / "photo.jpg"
    photo.touch()
    assert main([str(photo)]) == 2
    assert capsys.readouterr().err.endswith(f"flexdepth predict {photo}\n")


def test_a_word_like_no_command_is_answered_with_all_of_them(capsys):
    assert main(["xyzzy"]) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert all(name in line for name in COMMANDS)


def test_a_mistake_of_the_user_is_one_line_and_exit_code_2(flexdepth, capsys):
    assert flexdepth(raising(InputError("a.jpg: empty file")), "act") == 2
    assert capsys.readouterr() == ("", "flexdepth: a.jpg: empty file\n")


def test_ctrl_c_is_one_line_and_exit_code_130(flexdepth, capsys):
    assert flexdepth(raising(KeyboardInterrupt()), "act") == 130
    assert capsys.readouterr() == ("", "flexdepth: interrupted\n")


@pytest.mark.parametrize("bug", [ValueError("a bug"), ModuleNotFoundError("x", name="flexdeth")])
def test_a_bug_is_not_hidden(bug, flexdepth):
    with pytest.raises(type(bug)):
        flexdepth(raising(bug), "act")


def test_a_bug_shows_its_traceback_and_exits_with_1():
    script = (
        "import sys, types\n"
        "from flexdepth.cli.main import Command, main\n"
        "sys.modules['acting'] = types.SimpleNamespace(run=lambda _: 1 / 0)\n"
        "sys.exit(main(['act'], {'act': Command('acting', '')}))\n"
    )
    ended = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True)
    assert ended.returncode == 1
    assert "Traceback" in ended.stderr
    assert "ZeroDivisionError" in ended.stderr


@pytest.mark.parametrize(
    ("module", "extra"),
    [
        ("torch", "torch"),
        ("torch.nn", "torch"),
        ("timm", "torch"),
        ("embreex.rtcore", "torch"),
        ("transformers", "hub"),
    ],
)
def test_a_missing_extra_is_named_with_the_line_that_installs_it(module, extra, flexdepth, capsys):
    assert flexdepth(raising(ModuleNotFoundError("no", name=module)), "act") == 2
    assert capsys.readouterr().err == (
        f"flexdepth: `flexdepth act` needs {module}, which is not installed: "
        f'pip install "flexdepth[{extra}]"\n'
    )


def test_a_reader_that_leaves_early_is_no_error():
    read_end, write_end = os.pipe()
    os.close(read_end)
    with os.fdopen(write_end, "wb") as pipe:
        ended = subprocess.run(
            [sys.executable, "-m", "flexdepth", "--help"],
            stdout=pipe,
            stderr=subprocess.PIPE,
            env={**os.environ, "PYTHONUNBUFFERED": ""},
        )
    assert (ended.returncode, ended.stderr) == (141, b"")


def test_a_file_name_that_the_terminal_cannot_spell_is_written_escaped():
    script = (
        "import sys, types\n"
        "from flexdepth.cli.main import Command, main\n"
        "run = lambda _: sys.stdout.write('\\udce9\\u6df1.jpg') and 0\n"
        "sys.modules['acting'] = types.SimpleNamespace(run=run)\n"
        "sys.exit(main(['act'], {'act': Command('acting', '')}))\n"
    )
    ended = subprocess.run(
        [sys.executable, "-c", script],
        capture_output=True,
        env={**os.environ, "PYTHONIOENCODING": "ascii"},
    )
    assert (ended.returncode, ended.stdout) == (0, rb"\udce9\u6df1.jpg")


def test_the_help_loads_nothing_heavy():
    loaded = modules_loaded_by("from flexdepth.cli.main import main; main(['--help'])")
    assert not loaded & HEAVY


def test_importing_the_package_loads_no_torch():
    assert not modules_loaded_by("import flexdepth") & TORCH_SIDE


@pytest.mark.parametrize("name", COMMANDS)
def test_every_command_has_a_help_page_that_names_it(name, capsys):
    assert callable(import_module(COMMANDS[name].module).run)
    try:
        code = main([name, "--help"])
    except SystemExit as ended:
        code = ended.code
    assert code == 0
    assert f"flexdepth {name}" in capsys.readouterr().out


def modules_loaded_by(script):
    listed = subprocess.run(
        [sys.executable, "-c", f"{script}; import sys; print(*sys.modules, sep='\\n')"],
        capture_output=True,
        text=True,
        check=True,
    )
    return set(listed.stdout.split())
