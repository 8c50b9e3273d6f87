"""What `flexdepth predict` says at its end, in words or in JSON."""

import json
from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass
from importlib.metadata import version

from flexdepth.runtime.depthmap import FocalSource, Space
from flexdepth.runtime.errors import one_line
from flexdepth.runtime.job import Job, Result, Status

_MOST_NAMED = 20
"""Of more inputs than these, the outputs are not listed one by one."""

_DONE, _FAILED, _INTERRUPTED = 0, 2, 130


@dataclass(frozen=True, eq=False)
class Summary:
    """What became of all inputs.

    Attributes:
        results: One for each input that was tried.
        total: How many inputs there were.
        stopped: The user stopped the work.
        seconds: How long it took.
    """

    results: tuple[Result, ...]
    total: int
    stopped: bool
    seconds: float

    @property
    def exit_code(self) -> int:
        """0 if all went well, 2 if an input failed, 130 if the user stopped the work."""
        if self.stopped:
            return _INTERRUPTED
        return _FAILED if self._failed or self._left else _DONE

    @property
    def _failed(self) -> list[Result]:
        return [each for each in self.results if each.status is Status.FAILED]

    @property
    def _left(self) -> int:
        return self.total - len(self.results)

    def _counts(self) -> dict[str, int]:
        counts = Counter(each.status for each in self.results)
        return {str(status): counts[status] for status in Status} | {"not tried": self._left}

    def made(self) -> str:
        """Return the outputs that were made, one a line, if they can be taken in at a glance."""
        done = [each for each in self.results if each.status is Status.DONE]
        if len(done) > _MOST_NAMED:
            return ""
        return "".join(f"{path}\n" for each in done for path in each.outputs)

    def words(self) -> str:
        """Return warnings, failures and counts, one a line."""
        lines = [warning for each in self.results for warning in each.warnings]
        lines += [f"failed: {each.error}" for each in self._failed]
        relative = sum(map(_wants_a_lens, self.results))
        if relative:
            lines.append(
                f"relative depth for {relative} of {self.total}: the focal length is not known; "
                f"--fov or --focal gives metres"
            )
        counts = [f"{count} {name}" for name, count in self._counts().items() if count]
        start = "stopped: " if self.stopped else ""
        lines.append(f"{start}{', '.join(counts) or 'nothing done'} in {self.seconds:.1f} s")
        return "".join(f"flexdepth: {one_line(line)}\n" for line in lines)

    def json(self, job: Job) -> str:
        """Return everything as one JSON document."""
        about = job.predictor.about
        document = {
            "flexdepth": version("flexdepth"),
            "model": {
                "name": about.name,
                "version": about.version,
                "licence": about.licence,
                "sha256": about.digest,
            },
            "results": [_record(each) for each in self.results],
            "counts": {name.replace(" ", "_"): n for name, n in self._counts().items()},
            "stopped": self.stopped,
            "seconds": round(self.seconds, 3),
        }
        return json.dumps(document, indent=1)


def _wants_a_lens(result: Result) -> bool:
    camera = result.meaning.get("intrinsics")
    assumed = isinstance(camera, Mapping) and camera["source"] == FocalSource.ASSUMED
    return assumed and result.meaning.get("space") == Space.SCALE


def _record(result: Result) -> dict[str, object]:
    named = ("space", "unit", "width", "height", "intrinsics")
    return {
        "input": str(result.path),
        "status": str(result.status),
        "outputs": [str(path) for path in result.outputs],
        **{name: result.meaning.get(name) for name in named},
        "frames": result.frames,
        "warnings": list(result.warnings),
        "error": result.error or None,
    }
