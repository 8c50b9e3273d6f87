"""What `flexdepth predict` has been asked to do, and what became of each input."""

import errno
from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import StrEnum
from pathlib import Path

from flexdepth.runtime.errors import InputError
from flexdepth.runtime.estimator import Estimator
from flexdepth.runtime.origin import Origin, digest
from flexdepth.runtime.outputs import Output


class Status(StrEnum):
    """What became of an input."""

    DONE = "done"
    SKIPPED = "skipped"
    """All its outputs were there, made from the same input, model and settings."""
    FAILED = "failed"
    IN_PART = "in part"
    """A video that the user stopped; the frames so far have their files."""


@dataclass(frozen=True, eq=False)
class Job:
    """What is to be made of every input.

    Attributes:
        predictor: The model and the camera.
        folder: Where the outputs go.
        outputs: What is made of each picture; the first is a depth file.
        overwrite: Replace what lies in the place of an output.
        max_pixels: Larger photos are refused.
        batch: How many pictures of one size share a run of the network.
    """

    predictor: Estimator
    folder: Path
    outputs: tuple[Output, ...]
    overwrite: bool = False
    max_pixels: int = 200_000_000
    batch: int = 1

    def origin(self, path: Path) -> Origin:
        """Return what outputs of the input `path` are made from.

        Raises:
            InputError: The input cannot be read.
        """
        return {
            "input": digest(path),
            "model": f"sha256:{self.predictor.about.digest}",
            **self.predictor.settings,
        }


@dataclass(frozen=True, eq=False)
class Result:
    """What became of one input.

    Attributes:
        path: The input.
        status: Done, skipped, failed or done in part.
        outputs: The files that are there for it now, made just now or before.
        meaning: What its depth file says of itself, the last one's of a video; empty where there
            is none.
        frames: How many frames of a video have their files; None for a photo.
        warnings: What a user should know of how the input was read.
        error: Why it failed, in one line.
        disk_is_full: It failed for want of space, and so would the next.
    """

    path: Path
    status: Status
    outputs: tuple[Path, ...] = ()
    meaning: Mapping[str, object] = field(default_factory=dict)
    frames: int | None = None
    warnings: tuple[str, ...] = ()
    error: str = ""
    disk_is_full: bool = False


def failure(path: Path, error: InputError) -> Result:
    """Return the result of an input that failed."""
    cause = error.__cause__
    full = isinstance(cause, OSError) and cause.errno == errno.ENOSPC
    return Result(path, Status.FAILED, error=str(error), disk_is_full=full)
