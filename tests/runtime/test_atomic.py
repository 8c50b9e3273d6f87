import errno
import os

import pytest

from flexdepth.runtime.atomic import check_writable, discard_unfinished, replacing
from flexdepth.runtime.errors import InputError


def write_and_fail(path, failure):
    with replacing(path) as temporary:
        temporary.write_text("half")
        raise failure


def test_the_file_appears_when_the_block_ends_well(tmp_path):
    path = tmp_path / "new" / "room.npz"
    with replacing(path) as temporary:
        temporary.write_text("new")
        assert not path.exists()
    assert path.read_text() == "new"
    assert list(path.parent.iterdir()) == [path]


def test_the_temporary_file_is_hidden_beside_the_file_and_keeps_its_suffix(tmp_path):
    with replacing(tmp_path / "a.room.PNG") as temporary:
        assert temporary.parent == tmp_path
        assert temporary.name.startswith(".")
        assert temporary.suffix == ".PNG"
        temporary.touch()


def test_what_was_written_is_on_the_disk_before_it_has_its_name(tmp_path, monkeypatch):
    path, kept = tmp_path / "room.npz", []
    monkeypatch.setattr(os, "fsync", lambda number: kept.append((os.fstat(number), path.exists())))
    with replacing(path) as temporary:
        temporary.write_text("new")
        written = temporary.stat()
    ((synced, named),) = kept
    assert os.path.samestat(synced, written)
    assert not named


@pytest.mark.parametrize("failure", [KeyboardInterrupt, RuntimeError, SystemExit])
def test_a_failure_leaves_the_old_file_and_nothing_else(tmp_path, failure):
    path = tmp_path / "room.npz"
    path.write_text("old")
    with pytest.raises(failure):
        write_and_fail(path, failure())
    assert path.read_text() == "old"
    assert list(tmp_path.iterdir()) == [path]


def test_a_full_disk_is_one_line_that_names_the_file(tmp_path):
    path = tmp_path / "room.npz"
    full = OSError(errno.ENOSPC, os.strerror(errno.ENOSPC), str(tmp_path / ".flexdepth-x.npz"))
    with pytest.raises(InputError) as refusal:
        write_and_fail(path, full)
    assert str(refusal.value).startswith(f"{path}: cannot be written: No space left")
    assert ".flexdepth-" not in str(refusal.value)
    assert list(tmp_path.iterdir()) == []


def test_a_folder_or_a_file_in_the_way_is_named(tmp_path):
    (tmp_path / "room.npz").mkdir()
    with (
        pytest.raises(InputError, match=r"room\.npz: cannot"),
        replacing(tmp_path / "room.npz") as t,
    ):
        t.touch()
    (tmp_path / "file").touch()
    with (
        pytest.raises(InputError, match=r"room\.npz: cannot"),
        replacing(tmp_path / "file" / "room.npz") as t,
    ):
        t.touch()
    assert sorted(entry.name for entry in tmp_path.iterdir()) == ["file", "room.npz"]


def test_a_folder_that_can_be_made_is_writable_and_one_below_a_file_is_not(tmp_path):
    check_writable(tmp_path)
    check_writable(tmp_path / "new" / "newer")
    (tmp_path / "file").touch()
    for folder in (tmp_path / "file", tmp_path / "file" / "new"):
        with pytest.raises(InputError, match="file is no folder; choose another --output-dir"):
            check_writable(folder)


def test_a_folder_that_may_not_be_written_is_refused(tmp_path, monkeypatch):
    monkeypatch.setattr(os, "access", lambda path, _mode: path != tmp_path)
    with pytest.raises(InputError, match="permission denied"):
        check_writable(tmp_path / "new")


def test_what_a_killed_writer_left_is_removed_and_nothing_else(tmp_path):
    with replacing(tmp_path / "kept.txt") as temporary:
        left = temporary.name
        temporary.write_text("kept")
    for name in (left, ".hidden", "flexdepth-0123.txt"):
        (tmp_path / name).write_text("")
    discard_unfinished(tmp_path)
    assert {path.name for path in tmp_path.iterdir()} == {
        "kept.txt",
        ".hidden",
        "flexdepth-0123.txt",
    }
