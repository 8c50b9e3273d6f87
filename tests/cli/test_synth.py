import pytest

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
