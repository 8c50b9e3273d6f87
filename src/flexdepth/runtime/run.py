"""A job from its first input to its last."""

import os
from collections.abc import Callable, Iterator, Sequence
from functools import partial
from itertools import groupby
from pathlib import Path

from flexdepth.runtime.errors import InputError
from flexdepth.runtime.inputs import Input
from flexdepth.runtime.job import Job, Result, Status, failure
from flexdepth.runtime.photos import photo_results


def results(
    job: Job, inputs: Sequence[Input], watch: Callable[[Path, int], None]
) -> Iterator[Result]:
    """Work on the inputs in their order and say of each what became of it.

    A full disk ends the work: the next input would fail as well. Stopping between two results
    leaves nothing half-written. A video that is stopped with Ctrl-C gives the result of its frames
    so far before the KeyboardInterrupt.

    Args:
        job: What is to be made.
        inputs: Photos and videos.
        watch: Is told which video is being worked on, and how many of its frames are done.
    """
    for result in _all_results(job, inputs, watch):
        yield result
        if result.disk_is_full:
            return


def _all_results(
    job: Job, inputs: Sequence[Input], watch: Callable[[Path, int], None]
) -> Iterator[Result]:
    for is_video, group in groupby(inputs, lambda each: each.is_video):
        alike = list(group)
        if is_video:
            yield from _clip_results(job, alike, watch)
        else:
            for start in range(0, len(alike), job.batch):
                yield from photo_results(job, alike[start : start + job.batch])


def _clip_results(
    job: Job, clips: Sequence[Input], watch: Callable[[Path, int], None]
) -> Iterator[Result]:
    # Photos do without FFmpeg, which takes a tenth of a second to load.
    from flexdepth.runtime.clips import clip_result  # noqa: PLC0415

    for clip in clips:
        result = clip_result(job, clip, partial(watch, clip.path))
        yield result
        if result.status is Status.IN_PART:
            raise KeyboardInterrupt


def without_clashes(job: Job, inputs: Sequence[Input]) -> tuple[list[Input], list[Result]]:
    """Return the inputs that have places of their own for their outputs, and the others' failure.

    An output may take neither the place of any input nor that of another input's output, names
    that differ in case alone being the same on many a disk.

    Args:
        job: What is to be made.
        inputs: Photos and videos.
    """
    owners = {_spelt(each.path): each for each in inputs}
    kept, failures = [], []
    for each in inputs:
        places = {_spelt(path): path for path in _places(job, each)}
        taken = next((place for place in places if place in owners), None)
        if taken is None:
            kept.append(each)
            owners |= dict.fromkeys(places, each)
        else:
            reason = (
                f"{each.path}: its output {places[taken]} would take the place of "
                f"{owners[taken].path} or of an output of it; give it another --output-dir"
            )
            failures.append(failure(each.path, InputError(reason)))
    return kept, failures


def _places(job: Job, each: Input) -> Iterator[Path]:
    base = job.folder / each.name
    if each.is_video:
        yield from (base, base.with_name(f"{base.name}.preview.mp4"))
        return
    for output in job.outputs:
        yield output.path(base)
        if output.beside:
            yield base.with_name(base.name + output.beside)


def _spelt(path: Path) -> str:
    return os.path.realpath(path).casefold()
