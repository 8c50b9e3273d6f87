import os
from pathlib import Path

import pytest

from flexdepth.runtime.inputs import find_inputs


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """A folder with files in it, which is the current folder."""
    monkeypatch.chdir(tmp_path)

    def make(*names):
        for name in names:
            path = tmp_path / name
            path.parent.mkdir(parents=True, exist_ok=True)
            path.touch()
        return tmp_path

    return make


def names(given, output="depth"):
    inputs, refusals = find_inputs(given, Path(output))
    assert not refusals
    return {each.path.as_posix(): each.name.as_posix() for each in inputs}


def reasons(*given):
    inputs, refusals = find_inputs(given, Path("depth"))
    assert not inputs
    return [each.reason for each in refusals]


def test_a_file_is_named_after_itself(folder):
    folder("trip/a.jpg")
    assert names(["trip/a.jpg"]) == {"trip/a.jpg": "a"}


def test_a_folder_gives_its_pictures_and_videos_and_its_sub_folders_are_mirrored(folder):
    folder("trip/b.JPG", "trip/a.png", "trip/day/c.mp4", "trip/day/c.txt", "trip/notes.md")
    assert names(["trip"]) == {
        "trip/a.png": "a",
        "trip/b.JPG": "b",
        "trip/day/c.mp4": "day/c",
    }


def test_what_flexdepth_makes_and_what_is_hidden_is_no_input(folder):
    folder(
        *("a.jpg", "a.preview.png", "a.normals.png", "clip.preview.mp4", "._a.jpg", ".b/a.jpg"),
        *("depth/a.png", "old/depth/x.png"),
    )
    assert names(["."]) == {"a.jpg": "a", "old/depth/x.png": "old/depth/x"}


def test_a_file_that_is_named_is_taken_whatever_its_name(folder):
    folder("a.preview.png", ".b.jpg", "photo")
    assert names(["a.preview.png", ".b.jpg", "photo"]) == {
        "a.preview.png": "a.preview",
        ".b.jpg": ".b",
        "photo": "photo",
    }


def test_inputs_of_one_stem_keep_their_extension(folder):
    folder("a.jpg", "a.png", "b.jpg", "day/a.jpg", "C.jpg", "c.mp4")
    assert names(["."]) == {
        "C.jpg": "C.jpg",
        "a.jpg": "a.jpg",
        "a.png": "a.png",
        "b.jpg": "b",
        "c.mp4": "c.mp4",
        "day/a.jpg": "day/a",
    }


def test_a_file_that_is_named_twice_is_one_input(folder):
    root = folder("trip/a.jpg")
    assert names(["trip/a.jpg", "trip", str(root / "trip" / "a.jpg")]) == {"trip/a.jpg": "a"}


def test_globs_are_expanded_here(folder):
    folder("trip/b1.jpg", "trip/b2.jpg", "trip/c.jpg", "trip/day/b3.jpg")
    assert list(names(["trip/b*.jpg"])) == ["trip/b1.jpg", "trip/b2.jpg"]
    assert names(["tr*"])["trip/day/b3.jpg"] == "day/b3"
    assert list(names(["trip/**/b*"])) == ["trip/b1.jpg", "trip/b2.jpg", "trip/day/b3.jpg"]
    assert names(["trip/**"])["trip/day/b3.jpg"] == "b3"


def test_a_file_whose_name_looks_like_a_glob_is_that_file(folder):
    folder("a[1].jpg", "a1.jpg")
    assert list(names(["a[1].jpg"])) == ["a[1].jpg"]


def test_what_is_given_in_vain_is_said(folder):
    folder("empty/notes.md")
    assert reasons("empty") == ["empty: the folder holds no photo and no video; name another"]
    assert reasons("x*.jpg") == ["x*.jpg: matches no file; check the pattern"]
    assert "cannot be read" in reasons("x" * 5000 + ".jpg")[0]


def test_a_missing_file_is_left_to_its_reader(folder):
    folder()
    assert names(["missing.jpg"]) == {"missing.jpg": "missing"}


def test_a_folder_that_may_not_be_read_hides_none_of_the_others(folder, monkeypatch):
    folder("trip/a.jpg", "trip/locked/b.jpg")
    scandir = os.scandir

    def guarded(place):
        if Path(place).name == "locked":
            raise PermissionError(13, "Permission denied", place)
        return scandir(place)

    monkeypatch.setattr(os, "scandir", guarded)
    inputs, refusals = find_inputs(["trip"], Path("depth"))
    assert [each.name for each in inputs] == [Path("a")]
    assert "locked: the folder cannot be read: Permission denied" in refusals[0].reason


def test_an_empty_name_is_refused(folder):
    folder("a.jpg")
    assert reasons("") == ["an input is an empty name; name a photo, a folder or a video"]


def test_a_photo_under_the_name_of_a_video_is_a_photo(folder):
    (folder() / "a.mp4").write_bytes(b"\xff\xd8\xff\xe0 and so on")
    (folder() / "b.mp4").write_bytes(b"\0\0\0\x20ftypisom")
    found, _ = find_inputs(["a.mp4", "b.mp4", "missing.mp4"], Path("depth"))
    assert [each.is_video for each in found] == [False, True, True]
