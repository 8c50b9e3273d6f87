import pytest

from flexdepth.cli import synth
from flexdepth.cli.main import main


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["--rate", "5"], "a single image shows none; give --frames 2"),
        (["--frames", "2", "--parallax", "8", "2"], "from a least to a most"),
        (["-n", "0"], "--count is a whole number >= 1"),
    ],
)
def test_what_cannot_be_rendered_is_refused_in_one_line(arguments, said, tmp_path, capsys):
    assert main(["synth", "-o", str(tmp_path / "world"), *arguments]) == 2
    error = capsys.readouterr().err
    assert said in error
    assert error.count("\n") == 1
    assert not (tmp_path / "world").exists()


@pytest.fixture
def render(monkeypatch, tmp_path, capsys):
    """Return a function that renders nothing, scene by scene; it returns what stderr shows."""

    def images(_world, count, _folder, _processes):
        return (min(first + 4, count) for first in range(0, count, 4))

    monkeypatch.setattr(synth, "write_images", images)
    monkeypatch.setattr(synth, "write_image_sheet", lambda *_: tmp_path / "sheet.png")

    def run(count):
        assert main(["synth", "-o", str(tmp_path), "-n", str(count), "--processes", "1"]) == 0
        return capsys.readouterr().err

    return run


@pytest.mark.parametrize(
    ("count", "told"),
    [
        (200, [20, 40, 60, 80, 100, 120, 140, 160, 180, 200]),
        (30, [4, 8, 12, 16, 20, 24, 28, 30]),
        (3, [3]),
    ],
)
def test_where_there_is_no_terminal_a_line_tells_of_every_tenth(render, count, told):
    lines = render(count).splitlines()
    assert [line.partition(" in ")[0] for line in lines] == [
        f"rendered {done} of {count}" for done in told
    ]
    assert lines[0].endswith(" s")


def test_at_a_terminal_a_bar_shows_how_far_the_rendering_is(render, monkeypatch):
    monkeypatch.setenv("FORCE_COLOR", "1")
    said = render(200)
    assert "200/200" in said
    assert "rendered" not in said


def test_renders_do_not_go_among_the_photographs_that_they_show(tmp_path, capsys):
    shown = ["--photographs", str(tmp_path)]
    assert main(["synth", "-o", str(tmp_path / "renders"), "-n", "4", *shown]) == 2
    assert "renders are no photographs" in capsys.readouterr().err
    assert list(tmp_path.iterdir()) == []
