"""Photos of a job: read, predicted together, written one by one."""

from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from pathlib import Path

from flexdepth.runtime.depthmap import DepthMap
from flexdepth.runtime.errors import InputError
from flexdepth.runtime.files import read_meaning
from flexdepth.runtime.images import Photo, read_photo
from flexdepth.runtime.inputs import Input
from flexdepth.runtime.job import Job, Result, Status, failure
from flexdepth.runtime.origin import Origin
from flexdepth.runtime.outputs import Output, Scene, is_made, unmade, write_all


@dataclass(frozen=True, eq=False)
class _Opened:
    """A photo that has outputs to be made."""

    path: Path
    base: Path
    photo: Photo
    origin: Origin
    wanted: tuple[Output, ...]


def photo_results(job: Job, photos: Sequence[Input]) -> Iterator[Result]:
    """Make the outputs of some photos; one that fails leaves the others alone.

    Args:
        job: What is to be made.
        photos: So many as may be in memory together.
    """
    steps = [_opened(job, each) for each in photos]
    ready = [step for step in steps if isinstance(step, _Opened)]
    maps = iter(_predicted(job, ready))
    for step in steps:
        yield step if isinstance(step, Result) else _written(job, step, next(maps))


def _opened(job: Job, photo: Input) -> _Opened | Result:
    base = job.folder / photo.name
    try:
        origin = job.origin(photo.path)
        wanted = unmade(job.outputs, base, origin, job.overwrite)
        if not wanted:
            return Result(photo.path, Status.SKIPPED, _paths(job, base), _meaning(job, base))
        decoded = read_photo(photo.path, job.max_pixels)
    except InputError as error:
        return failure(photo.path, error)
    return _Opened(photo.path, base, decoded, origin, wanted)


def _predicted(job: Job, ready: Sequence[_Opened]) -> Sequence[DepthMap | InputError]:
    try:
        return job.predictor.predict_all([each.photo for each in ready])
    except InputError as error:
        return [error] * len(ready)


def _written(job: Job, ready: _Opened, found: DepthMap | InputError) -> Result:
    if isinstance(found, InputError):
        return failure(ready.path, found)
    try:
        write_all(ready.wanted, ready.base, Scene(ready.photo.pixels, found), ready.origin)
    except InputError as error:
        return _broken_off(job, ready, error)
    return Result(
        ready.path,
        Status.DONE,
        _paths(job, ready.base),
        _meaning(job, ready.base),
        warnings=ready.photo.warnings,
    )


def _broken_off(job: Job, ready: _Opened, error: InputError) -> Result:
    """Return the result of a photo of which an output cannot be made, with those that are there."""
    made = tuple(output.path(ready.base) for output in job.outputs if _is_there(output, ready))
    first = job.outputs[0].path(ready.base)
    meaning = read_meaning(first) if first in made else {}
    return replace(failure(ready.path, error), outputs=made, meaning=meaning)


def _is_there(output: Output, ready: _Opened) -> bool:
    with suppress(InputError):
        origin = {**ready.origin, **output.mark}
        return is_made(output.path(ready.base), origin, output.origin)
    return False


def _paths(job: Job, base: Path) -> tuple[Path, ...]:
    return tuple(output.path(base) for output in job.outputs)


def _meaning(job: Job, base: Path) -> dict[str, object]:
    return read_meaning(job.outputs[0].path(base))
