"""Which photos and videos a user means, and what their outputs are called.

An input is a file, a folder or a glob. A folder gives the photos and videos in it and below it,
and their outputs mirror its sub-folders; left out are hidden files, the output folder, and the
pictures that flexdepth makes (NAME.preview.png, NAME.normals.png, CLIP.preview.mp4). A file that
is named is taken whatever its name. A glob is expanded here, for not every shell does it.
"""

import os
from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from glob import glob, has_magic
from pathlib import Path

from flexdepth.runtime.images import is_picture_name, starts_like_picture

_OWN = (".preview.png", ".normals.png", ".preview.mp4")


@dataclass(frozen=True)
class Input:
    """A photo or a video.

    Attributes:
        path: Where it is.
        name: What its outputs are called, below the output folder and without a suffix.
    """

    path: Path
    name: Path

    @property
    def is_video(self) -> bool:
        """Whether its name is that of a video, unless it holds a picture all the same."""
        return _is_video_name(self.path) and not starts_like_picture(self.path)


@dataclass(frozen=True)
class Refusal:
    """An input that gives nothing to work on, and why, in one line."""

    path: Path
    reason: str


def find_inputs(given: Sequence[str], output: Path) -> tuple[list[Input], list[Refusal]]:
    """Return the photos and videos that are meant, each once, and what was given in vain.

    Two inputs whose outputs would have one name keep their extension in it: `a.jpg` and `a.png`
    become `a.jpg.npz` and `a.png.npz`.

    Args:
        given: Files, folders and globs.
        output: The output folder, in which nothing is looked for.
    """
    found: dict[str, Input] = {}
    refusals = []
    for text in given:
        for each in _meant(text, output):
            if isinstance(each, Refusal):
                refusals.append(each)
            else:
                found.setdefault(os.path.realpath(each.path), each)
    return _told_apart(found.values()), refusals


def _meant(text: str, output: Path) -> Iterator[Input | Refusal]:
    path = Path(text)
    if not text:
        yield Refusal(path, "an input is an empty name; name a photo, a folder or a video")
        return
    try:
        if path.is_dir():
            yield from _listed(path, output)
        elif has_magic(text) and not path.exists():
            yield from _matching(text, output)
        else:
            yield Input(path, Path(path.name))
    except OSError as error:
        yield Refusal(path, f"{text}: cannot be read: {error.strerror}; check the name")


def _matching(pattern: str, output: Path) -> Iterator[Input | Refusal]:
    """Give what matches a glob; folders are listed, but for `**`, which lists them itself."""
    matches = [Path(match) for match in sorted(glob(pattern, recursive=True))]
    if not matches:
        yield Refusal(Path(pattern), f"{pattern}: matches no file; check the pattern")
    for match in matches:
        if not match.is_dir():
            yield Input(match, Path(match.name))
        elif "**" not in pattern:
            yield from _listed(match, output)


def _listed(folder: Path, output: Path) -> Iterator[Input | Refusal]:
    """Give the photos and videos in a folder and below it, in the order of their names."""
    unread: list[OSError] = []
    found = 0
    for place, folders, files in os.walk(folder, onerror=unread.append):
        below = Path(place)
        folders[:] = sorted(
            each for each in folders if each[0] != "." and not _is_same(below / each, output)
        )
        for name in sorted(filter(_is_listed, files)):
            found += 1
            yield Input(below / name, (below / name).relative_to(folder))
    for error in unread:
        yield Refusal(
            Path(error.filename),
            f"{error.filename}: the folder cannot be read: {error.strerror}; check its permissions",
        )
    if not found and not unread:
        yield Refusal(folder, f"{folder}: the folder holds no photo and no video; name another")


def _is_listed(name: str) -> bool:
    own = name.lower().endswith(_OWN) or name.startswith(".")
    return not own and (is_picture_name(Path(name)) or _is_video_name(Path(name)))


def _is_video_name(path: Path) -> bool:
    if is_picture_name(path):
        return False
    # Photos do without FFmpeg, which takes a tenth of a second to load.
    from flexdepth.runtime.video import is_video_name  # noqa: PLC0415

    return is_video_name(path)


def _is_same(folder: Path, output: Path) -> bool:
    return os.path.exists(output) and folder.samefile(output)


def _told_apart(inputs: Iterable[Input]) -> list[Input]:
    """Take the extension off each name, but where it is what tells two names apart."""
    every = list(inputs)
    alike = Counter(_spelt(each.name) for each in every)
    return [
        Input(each.path, each.name.with_suffix("") if alike[_spelt(each.name)] == 1 else each.name)
        for each in every
    ]


def _spelt(name: Path) -> str:
    """Return a name without its extension as a file system that ignores case has it."""
    return str(name.with_suffix("")).casefold()
