"""Videos of a job: a folder of numbered outputs, one for each frame, and a preview of the whole.

The preview is made in a second pass, from the depth files: only when all of them are there is it
known which depth is nearest and which is farthest in the clip. No more than one run of frames is
in memory at a time.
"""

import itertools
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, replace
from functools import reduce
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray

from flexdepth.runtime.colour import limits, merged
from flexdepth.runtime.depthmap import DepthMap
from flexdepth.runtime.errors import InputError
from flexdepth.runtime.files import read_depth, read_meaning
from flexdepth.runtime.images import Photo
from flexdepth.runtime.inputs import Input
from flexdepth.runtime.job import Job, Result, Status, failure
from flexdepth.runtime.origin import Origin
from flexdepth.runtime.outputs import PREVIEW, Output, Scene, discard, is_made, unmade, write_all
from flexdepth.runtime.picture import preview
from flexdepth.runtime.video import frame_rate, read_frames, video_origin, writing_video

Frame = tuple[int, NDArray[np.uint8]]
_Problem = InputError | KeyboardInterrupt | None


@dataclass(frozen=True, eq=False)
class _Clip:
    """A video of a job, and where its outputs go."""

    job: Job
    path: Path
    folder: Path
    origin: Origin

    @property
    def preview(self) -> Path:
        return self.folder.with_name(f"{self.folder.name}.preview.mp4")

    @property
    def wants_preview(self) -> bool:
        return PREVIEW in self.job.outputs

    @property
    def of_frames(self) -> tuple[Output, ...]:
        return tuple(output for output in self.job.outputs if output is not PREVIEW)

    def depth_file(self, index: int) -> Path:
        return self.job.outputs[0].path(self.base(index))

    def base(self, index: int) -> Path:
        return self.folder / f"{index:06d}"


def clip_result(job: Job, video: Input, watch: Callable[[int], None]) -> Result:
    """Make the outputs of a video's frames, CLIP/000000.npz and so on, and CLIP.preview.mp4.

    Frames whose files are there already are not predicted again. Those before a break in the
    video are kept, and the preview shows them. A preview is made of the clip, not of each frame.
    Where a shorter clip replaces a longer one, the frames beyond its end go too.

    Args:
        job: What is to be made.
        video: The clip.
        watch: Is told how many frames are done.

    Raises:
        KeyboardInterrupt: The user stopped it before any frame was done.
    """
    try:
        clip = _Clip(job, video.path, job.folder / video.name, job.origin(video.path))
        finished = not clip.wants_preview or (
            not job.overwrite and is_made(clip.preview, clip.origin, video_origin)
        )
    except InputError as error:
        return failure(video.path, error)
    count, made, problem = _frames_made(clip, watch)
    if isinstance(problem, KeyboardInterrupt):
        return _result(clip, count, True, problem)
    try:
        if job.overwrite and problem is None:
            _discard_beyond(clip, count)
        if clip.wants_preview and count and (made or not finished):
            _write_preview(clip, count)
    except (InputError, KeyboardInterrupt) as error:
        problem = problem or error
    return _result(clip, count, bool(made) or not finished, problem)


def _result(clip: _Clip, count: int, new: bool, problem: _Problem) -> Result:
    there = [clip.folder] * (count > 0) + [clip.preview] * clip.wants_preview
    outputs = tuple(path for path in there if path.exists())
    meaning = read_meaning(clip.depth_file(count - 1)) if count else {}
    if isinstance(problem, KeyboardInterrupt):
        return Result(clip.path, Status.IN_PART, outputs, meaning, count)
    if problem is not None:
        return replace(failure(clip.path, problem), outputs=outputs, meaning=meaning, frames=count)
    status = Status.DONE if new else Status.SKIPPED
    return Result(clip.path, status, outputs, meaning, count)


def _frames_made(clip: _Clip, watch: Callable[[int], None]) -> tuple[int, int, _Problem]:
    """Return how many frames have their files, how many had them not, and what went wrong."""
    count = made = 0
    try:
        for new in _making(clip):
            count, made = count + 1, made + new
            watch(count)
    except InputError as error:
        return count, made, error
    except KeyboardInterrupt as stop:
        if not count:
            raise
        return count, made, stop
    return count, made, None


def _making(clip: _Clip) -> Iterator[bool]:
    """Make the files of all frames, in order; say of each whether any was still to be made."""
    job, outputs = clip.job, clip.of_frames
    for run in _runs(enumerate(read_frames(clip.path)), job.batch):
        wanted = [unmade(outputs, clip.base(index), clip.origin, job.overwrite) for index, _ in run]
        todo = [frame for frame, missing in zip(run, wanted, strict=True) if missing]
        maps = iter(job.predictor.predict_all([Photo(pixels, None, ()) for _, pixels in todo]))
        for (index, pixels), missing in zip(run, wanted, strict=True):
            if missing:
                write_all(missing, clip.base(index), Scene(pixels, next(maps)), clip.origin)
            yield bool(missing)


def _runs(frames: Iterable[Frame], length: int) -> Iterator[list[Frame]]:
    """Give the frames in lists of `length`; an error comes after the frames before it."""
    run: list[Frame] = []
    try:
        for frame in frames:
            run.append(frame)
            if len(run) == length:
                yield run
                run = []
    except InputError:
        yield run
        raise
    yield run


def _discard_beyond(clip: _Clip, count: int) -> None:
    """Remove the outputs of a longer clip that lie beyond the end of this one."""
    for output in clip.of_frames:
        for index in itertools.count(count):
            if not _is_ours(output, output.path(clip.base(index))):
                break
            discard(output, clip.base(index))


def _is_ours(output: Output, path: Path) -> bool:
    """Return whether a file of flexdepth's is there, whatever it was made from."""
    try:
        return path.exists() and output.origin(path) is not None
    except InputError:
        return False


def _write_preview(clip: _Clip, count: int) -> None:
    """Write the clip in colours; one scale and one legend hold for all its frames."""

    def maps() -> Iterator[DepthMap]:
        return (read_depth(clip.depth_file(index)) for index in range(count))

    shown = reduce(lambda one, other: merged((one, other)), map(limits, maps()))
    with writing_video(clip.preview, frame_rate(clip.path), clip.origin) as video:
        for depth_map in maps():
            frame = preview(depth_map, shown)
            video.write(_fitted(frame, video.shape or frame.shape))


def _fitted(frame: NDArray[np.uint8], shape: tuple[int, ...]) -> NDArray[np.uint8]:
    """Return the frame at the size of the clip's first one; a video may change its size."""
    if frame.shape == shape:
        return frame
    return np.asarray(cv2.resize(frame, (shape[1], shape[0])), np.uint8)
