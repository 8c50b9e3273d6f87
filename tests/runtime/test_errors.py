import pytest

from flexdepth.runtime.errors import one_line, reason


@pytest.mark.parametrize(
    ("error", "said"),
    [
        (ValueError("two\n  lines\tof it "), "two lines of it"),
        (KeyError(), "KeyError"),
        (UserWarning(" \n"), "UserWarning"),
        (OSError("x" * 1000), "x" * 200),
    ],
)
def test_what_a_library_says_is_one_line_of_a_length_to_read(error, said):
    assert reason(error) == said


def test_line_ends_and_control_characters_of_names_are_escaped():
    assert one_line("a\nb\x1b[31m ü") == r"a\nb\x1b[31m ü"
