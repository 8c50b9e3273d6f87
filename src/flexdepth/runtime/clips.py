"""Videos of a job: a folder of numbered outputs, one for each frame, and a preview of the whole.

The preview is made in a second pass, from the depth files: only when all of them are there is it
known which depth is nearest and which is farthest in the clip. No more than one run of frames is
in memory at a time.
"""

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
from flexdepth.runtime.outputs import PREVIEW, Scene, is_made, unmade, write_all
from flexdepth.runtime.picture import preview
from flexdepth.runtime.video import frame_rate, read_frames, video_origin, writing_video

Frame = tuple[int, NDArray[np.uint8]]


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

    def depth_file(self, index: int) -> Path:
        return self.job.outputs[0].path(self.base(index))

    def base(self, index: int) -> Path:
        return self.folder / f"{index:06d}"


def clip_result(job: Job, video: Input, watch: Callable[[int], None]) -> Result:
    """Make the outputs of a video's frames, CLIP/000000.npz and so on, and CLIP.preview.mp4.

    Frames whose files are there already are not predicted again. Those before a break in the
    video are kept, and the preview shows them. A preview is made of the clip, not of each frame.

    Args:
        job: What is to be made.
        video: The clip.
        watch: Is told how many frames are done.
    """
    try:
        clip = _Clip(job, video.path, job.folder / video.name, job.origin(video.path))
        finished = not clip.wants_preview or (
            not job.overwrite and is_made(clip.preview, clip.origin, video_origin)
        )
    except InputError as error:
        return failure(video.path, error)
    count, made, problem = _frames_made(clip, watch)
    try:
        if clip.wants_preview and count and (made or not finished):
            _write_preview(clip, count)
    except InputError as error:
        problem = problem or error
    return _result(clip, count, bool(made) or not finished, problem)


def _result(clip: _Clip, count: int, new: bool, problem: InputError | None) -> Result:
    there = [clip.folder] * (count > 0) + [clip.preview] * clip.wants_preview
    outputs = tuple(path for path in there if path.exists())
    meaning = read_meaning(clip.depth_file(count - 1)) if count else {}
    if problem is not None:
        return replace(failure(clip.path, problem), outputs=outputs, meaning=meaning, frames=count)
    status = Status.DONE if new else Status.SKIPPED
    return Result(clip.path, status, outputs, meaning, count)


def _frames_made(clip: _Clip, watch: Callable[[int], None]) -> tuple[int, int, InputError | None]:
    """Return how many frames have their files, how many had them not, and what went wrong."""
    count = made = 0
    try:
        for new in _making(clip):
            count, made = count + 1, made + new
            watch(count)
    except InputError as error:
        return count, made, error
    return count, made, None


def _making(clip: _Clip) -> Iterator[bool]:
    """Make the files of all frames, in order; say of each whether any was still to be made."""
    job = clip.job
    outputs = [output for output in job.outputs if output is not PREVIEW]
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
