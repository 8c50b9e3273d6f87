"""Time and memory of one run, of a process or within this one."""

import os
import subprocess
import sys
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass

from flexdepth.runtime.errors import InputError

REST = 0.02
"""Seconds between runs in one process, in which onnxruntime's threads stop spinning."""


@dataclass(frozen=True)
class Run:
    """What one run took: seconds, seconds of CPU, bytes of memory at its peak.

    None where it cannot be measured. The system never tells a peak below that of the process
    that started it, so this one must stay small.
    """

    wall: float
    cpu: float | None
    peak: int | None


def child(command: Sequence[str]) -> Run:
    """Run a command to its end.

    Raises:
        InputError: It failed.
    """
    started = time.perf_counter()
    with subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE) as process:
        said = process.stderr.read() if process.stderr else b""
        cpu = peak = None
        if sys.platform == "win32":
            process.wait()
        else:
            _, status, usage = os.wait4(process.pid, 0)
            process.returncode = os.waitstatus_to_exitcode(status)
            cpu = usage.ru_utime + usage.ru_stime
            peak = usage.ru_maxrss * (1 if sys.platform == "darwin" else 1024)
        wall = time.perf_counter() - started
    if process.returncode:
        last = said.decode(errors="replace").strip().rpartition("\n")[2]
        raise InputError(f"{' '.join(command)}: exit code {process.returncode}: {last}")
    return Run(wall, cpu, peak)


def inside(work: Callable[[], object]) -> Run:
    """Run something in this process."""
    time.sleep(REST)
    cpu, wall = time.process_time(), time.perf_counter()
    work()
    return Run(time.perf_counter() - wall, time.process_time() - cpu, None)


def in_turn(
    first: Callable[[], object], second: Callable[[], object], pairs: int
) -> tuple[list[Run], list[Run]]:
    """Run two things A B A B, after one uncounted pair."""
    runs = [(inside(first), inside(second)) for _ in range(pairs + 1)][1:]
    return [a for a, _ in runs], [b for _, b in runs]
