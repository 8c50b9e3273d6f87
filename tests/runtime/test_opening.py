import os
import sys
from pathlib import Path

import pytest

from flexdepth.runtime.errors import InputError
from flexdepth.runtime.opening import open_input


def test_a_file_is_opened_for_reading_bytes(tmp_path):
    (tmp_path / "a.bin").write_bytes(b"abc")
    with open_input(tmp_path / "a.bin") as file:
        assert file.read() == b"abc"


@pytest.mark.parametrize(
    ("name", "reason"),
    [("nothing.jpg", "does not exist"), ("empty.jpg", "is empty"), ("folder.jpg", "is a folder")],
)
def test_what_cannot_be_read_is_named(tmp_path, name, reason):
    (tmp_path / "empty.jpg").touch()
    (tmp_path / "folder.jpg").mkdir()
    with pytest.raises(InputError, match=reason) as refused:
        open_input(tmp_path / name)
    assert str(tmp_path / name) in str(refused.value)
    assert "\n" not in str(refused.value)


@pytest.mark.skipif(sys.platform == "win32", reason="Windows has no pipes in folders")
def test_a_pipe_is_refused_instead_of_waited_for(tmp_path):
    os.mkfifo(tmp_path / "pipe.png")
    with pytest.raises(InputError, match="not a plain file"):
        open_input(tmp_path / "pipe.png")


def test_a_file_that_may_not_be_read_is_named(tmp_path, monkeypatch):
    path = tmp_path / "locked.jpg"
    path.write_bytes(b"abc")

    def refuse(*_):
        raise PermissionError(13, "Permission denied", str(path))

    monkeypatch.setattr("pathlib.Path.open", refuse)
    with pytest.raises(InputError, match=r"locked\.jpg: cannot be read: Permission denied"):
        open_input(path)


def test_a_name_that_is_too_long_is_refused(tmp_path):
    with pytest.raises(InputError):
        open_input(tmp_path / ("a" * 5000))


@pytest.mark.parametrize("address", ["https://example.org/a.jpg", "http://example.org/b.mp4"])
def test_an_address_is_answered_with_what_to_do(address):
    with pytest.raises(InputError, match="nothing is downloaded here, save it first"):
        open_input(Path(address))
