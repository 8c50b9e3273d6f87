"""How far a job is, and how long it will take, for a person who waits at a terminal."""

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

from flexdepth.runtime.errors import InputError
from flexdepth.runtime.inputs import Input
from flexdepth.runtime.job import Result

if TYPE_CHECKING:
    from rich.progress import Progress

Watch = Callable[[Path, int], None]


def with_progress(
    inputs: Sequence[Input], work: Callable[[Watch], Iterator[Result]]
) -> Iterator[Result]:
    """Give the results of `work` while a bar on stderr says how many pictures are left.

    A photo counts as one picture, a video as its frames. There is no bar where nobody would see
    it, that is where stderr is no terminal, nor for a single photo.

    Args:
        inputs: What is worked on.
        work: Gives one result for each input, in order; it tells the function it is given how
            many frames of which video are done.
    """
    if len(inputs) < 2 and not any(each.is_video for each in inputs):
        yield from work(lambda _path, _frames: None)
        return
    with _bar("{task.description}", transient=True) as bar:
        steps = [1 if bar.disable else _pictures(each) for each in inputs]
        task = bar.add_task(inputs[0].path.name, total=sum(steps))
        before = 0

        def watch(path: Path, frames: int) -> None:
            bar.update(task, completed=before + frames, description=path.name)

        # The results first: after the last of them, Ctrl-C may still have to be passed on.
        for result, step in zip(work(watch), steps, strict=False):
            before += step
            bar.update(task, completed=before, description=result.path.name)
            yield result


@contextmanager
def counted(word: str, total: int) -> Iterator[Callable[[int], None]]:
    """Give what is told how many of a set's images are done, while a bar on stderr shows it.

    Args:
        word: What is being done.
        total: How many images there are.
    """
    with _bar(word, transient=False) as bar:
        task = bar.add_task(word, total=total)
        yield lambda done: bar.update(task, completed=done)


def _bar(words: str, transient: bool) -> "Progress":
    """Return a bar on stderr, with count and time left; none where nobody would see it."""
    # A single photo has no bar, and does without rich, which takes 0.05 s to load.
    from rich.console import Console  # noqa: PLC0415
    from rich.progress import (  # noqa: PLC0415
        BarColumn,
        MofNCompleteColumn,
        Progress,
        TextColumn,
        TimeRemainingColumn,
    )

    console = Console(stderr=True)
    columns = (
        TextColumn(words, markup=False),
        BarColumn(),
        MofNCompleteColumn(),
        TimeRemainingColumn(),
    )
    seen = console.is_terminal
    return Progress(*columns, console=console, transient=transient, disable=not seen)


def _pictures(each: Input) -> int:
    """Return about how many pictures an input holds."""
    if not each.is_video:
        return 1
    # Photos do without FFmpeg, which takes a tenth of a second to load.
    from flexdepth.runtime.video import frame_count  # noqa: PLC0415

    try:
        return frame_count(each.path) or 1
    except InputError:
        return 1
