"""A network of other people in an ONNX file, shown pictures as its card says."""

import hashlib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from flexdepth.runtime.card import Card, Colours, Layout
from flexdepth.runtime.depthmap import Space
from flexdepth.runtime.errors import InputError
from flexdepth.runtime.estimator import About
from flexdepth.runtime.foreign import Sight
from flexdepth.runtime.session import Session
from flexdepth.runtime.sizes import Area, network_size, resized

_NUMBERS = {"tensor(float)": np.float32, "tensor(float16)": np.float16}


@dataclass(frozen=True, eq=False)
class CardedNetwork:
    """An ONNX network and its card.

    Attributes:
        card: What is said of it.
        file: The card's.
        session: The network, opened.
        input: The name of its input.
        output: The name of its output.
        long_side: The longer side of what it sees, in pixels; None keeps the card's area.
    """

    card: Card
    file: Path
    session: Session
    input: str
    output: str
    long_side: int | None = None

    @property
    def about(self) -> About:
        """Who it is; the digest is that of the network and of what the card says of its numbers."""
        card = self.card
        said = f"{self.session.digest} {card.input} {card.normalisation} {card.output}"
        return About(card.name, "", card.licence, hashlib.sha256(said.encode()).hexdigest())

    @property
    def space(self) -> Space:
        """What its numbers are ambiguous up to."""
        return self.card.output.space

    @property
    def settings(self) -> Mapping[str, str]:
        """What its numbers depend on beside itself."""
        return {"long_side": str(self.long_side or "by the card")}

    def look(self, pixels: NDArray[np.uint8]) -> Sight:
        """Return what it sees in a picture, brought to the picture's size by interpolation.

        What is interpolated are the network's own numbers: 1/depth where it gives that.

        Raises:
            InputError: The network fails, or gives anything but a map of numbers.
        """
        height, width = pixels.shape[:2]
        size = self._size(width, height)
        (found,) = self.session.run([self.output], {self.input: self._shown(pixels, size)}, size)
        values = resized(self._map(found), (width, height))
        said = self.card.output
        if said.inverse:
            with np.errstate(divide="ignore"):
                values = np.where(values > 0, np.float32(1) / values, np.float32(np.nan))
        focal = said.focal_in_pixels(*size)
        return Sight(
            np.asarray(values * np.float32(said.unit), np.float32),
            None if focal is None else focal * width / size[0],
        )

    def _size(self, width: int, height: int) -> tuple[int, int]:
        given = self.card.input
        if given.multiple is None:
            return given.area
        return network_size(width, height, Area(given.area, given.multiple), self.long_side)

    def _shown(self, pixels: NDArray[np.uint8], size: tuple[int, int]) -> NDArray[np.generic]:
        said, given = self.card.normalisation, self.card.input
        seen = resized(np.ascontiguousarray(pixels), size).astype(np.float32)
        if given.colours is Colours.BGR:
            seen = seen[..., ::-1]
        mean, std = (np.array(each, np.float32) for each in (said.mean, said.std))
        shown = (seen * np.float32(said.scale) - mean) / std
        if given.layout is Layout.NCHW:
            shown = np.moveaxis(shown, 2, 0)
        (kind,) = (x.type for x in self.session.opened.get_inputs() if x.name == self.input)
        return np.ascontiguousarray(shown[None]).astype(_NUMBERS[kind])

    def _map(self, found: NDArray[np.generic]) -> NDArray[np.float32]:
        """Return height x width of an output that may have axes of length one beside these."""
        shape = tuple(side for side in found.shape if side != 1) or found.shape
        if len(shape) != 2 or not np.issubdtype(found.dtype, np.floating):
            raise InputError(
                f"{self.file}: `output.name`: wanted a map of real numbers, got `{self.output}` of "
                f"the shape {found.shape} and type {found.dtype}"
            )
        return found.reshape(shape).astype(np.float32)


def carded_network(
    card: Card, file: Path, session: Session, long_side: int | None = None
) -> CardedNetwork:
    """Return the network of a card, after a look at whether they fit together.

    Args:
        card: What is said of the network.
        file: The card's, named in errors.
        session: The network, opened.
        long_side: The longer side of what it sees; None keeps the card's area.

    Raises:
        InputError: The card names an input or output that the network has not, leaves out which of
            several is meant, or the input takes no real numbers; `long_side` is asked of a network
            of one size.
    """
    if long_side is not None and card.input.multiple is None:
        raise InputError(
            f"--long-side: {file} says that the network has one size, "
            f"{card.input.area[0]} x {card.input.area[1]}"
        )
    inputs = {each.name: each for each in session.opened.get_inputs()}
    outputs = [each.name for each in session.opened.get_outputs()]
    if len(inputs) > 1:
        raise InputError(
            f"{session.path}: wanted a network with the picture as its only input, got the inputs "
            f"{', '.join(inputs)}"
        )
    given = _named(card.input.name, list(inputs), "input", file)
    if inputs[given].type not in _NUMBERS:
        raise InputError(
            f"{session.path}: input `{given}`: wanted {' or '.join(_NUMBERS)}, got "
            f"{inputs[given].type}"
        )
    _check_shape(card, file, inputs[given].shape)
    found = _named(card.output.name, outputs, "output", file)
    return CardedNetwork(card, file, session, given, found, long_side)


def _check_shape(card: Card, file: Path, shape: Sequence[int | str | None]) -> None:
    """Refuse a card whose picture does not fit the axes of which the network fixes the length."""
    if len(shape) != 4:
        raise InputError(f"{file}: `input.name`: wanted an input of four axes, got {list(shape)}")
    channels, height, width = (
        shape[1:] if card.input.layout is Layout.NCHW else (shape[3], *shape[1:3])
    )
    if isinstance(channels, int) and channels != 3:
        raise InputError(
            f"{file}: `input.layout`: {card.input.layout} makes {channels} colours of the "
            f"network's axes {list(shape)}"
        )
    fixed = [side if isinstance(side, int) else None for side in (width, height)]
    if card.input.multiple is None:
        fits = all(side in (None, own) for side, own in zip(fixed, card.input.area, strict=True))
    else:
        fits = fixed == [None, None]
    if not fits:
        raise InputError(
            f"{file}: `input.size`: wanted the network's own, {fixed} (width, height; None is free)"
        )


def _named(name: str, there: list[str], what: str, file: Path) -> str:
    if name in there:
        return name
    if not name and len(there) == 1:
        return there[0]
    got = repr(name) if name else "nothing"
    raise InputError(f"{file}: `{what}.name`: wanted one of {', '.join(there)}, got {got}")
