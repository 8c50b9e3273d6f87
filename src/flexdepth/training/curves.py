"""Curves and pictures for TensorBoard: `tensorboard --logdir runs`.

They are there to be looked at; a run does not need them. Where they cannot be written, it says so
once and goes on.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

from torch.utils.tensorboard import SummaryWriter

from flexdepth.runtime.colour import Pixels


@dataclass(eq=False)
class Curves:
    """The curves of a run.

    Attributes:
        folder: Where TensorBoard finds them; made with the first of them.
        first: The iteration that the run goes on from; what an interrupted run drew after it is
            hidden.
        show: Takes the line that says what went wrong.
    """

    folder: Path
    first: int
    show: Callable[[str], None]
    _broken: bool = False

    def draw(self, iteration: int, values: Mapping[str, float]) -> None:
        """Add a point to each curve."""

        def add(writer: SummaryWriter) -> None:
            for name, value in values.items():
                writer.add_scalar(name, value, iteration)

        self._add(add)

    def paint(self, iteration: int, pictures: Mapping[str, Pixels]) -> None:
        """Add pictures by name."""

        def add(writer: SummaryWriter) -> None:
            for name, pixels in pictures.items():
                writer.add_image(name, pixels, iteration, dataformats="HWC")

        self._add(add)

    def _add(self, add: Callable[[SummaryWriter], None]) -> None:
        if self._broken:
            return
        try:
            add(self._writer)
            self._writer.flush()
        except OSError as error:
            self._broken = True
            self.show(
                f"{self.folder}: no more curves and pictures, for they cannot be written: {error}"
            )

    @cached_property
    def _writer(self) -> SummaryWriter:
        return SummaryWriter(str(self.folder), purge_step=self.first + 1)
