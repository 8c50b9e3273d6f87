"""What two frames show, as the solver of two frames wants it."""

from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from flexdepth.runtime.depthmap import Intrinsics
from flexdepth.runtime.errors import InputError

Array = NDArray[np.float64]
Flow = NDArray[np.float32]


class Found(Protocol):
    """What a search has found: flow, as in `Seen`, and its noise, NaN where it is none."""

    @property
    def flow(self) -> Flow:
        """Pixels."""
        ...

    @property
    def noise(self) -> NDArray[np.float32]:
        """Its standard deviation, pixels; NaN where what is found does not count."""
        ...


class Search(Protocol):
    """What looks for the still world where one motion of the camera would show it."""

    def __call__(self, rotation: Array, translation: Array, flow: Flow) -> Found:
        """Return the flow of what stands still, as far as the pictures go.

        Args:
            rotation: 3 x 3, of `target_from_key`.
            translation: Its 3 numbers, not 0; their length has no effect.
            flow: What else is believed, pixels; NaN is nothing. Where that looks more alike,
                what is found does not count.
        """
        ...


@dataclass(frozen=True, eq=False)
class Prior:
    """Depth of the key frame from that one picture.

    Attributes:
        depth: Height x width; +inf is sky, NaN unknown.
        spread: Height x width, the relative standard deviation of `depth` beyond one common
            factor; such as .15.
        metric: Whether it is in metres.
    """

    depth: NDArray[np.floating]
    spread: NDArray[np.floating]
    metric: bool = False


@dataclass(frozen=True, eq=False)
class ThirdFrame:
    """Flow from the key frame to a third one, such as the one before it.

    Attributes:
        flow: Height x width x 2, pixels; NaN is unknown.
        noise: Height x width, as in `Seen`.
    """

    flow: Flow
    noise: NDArray[np.float32]


@dataclass(frozen=True, eq=False)
class Stereo:
    """Flow from the key frame to the right picture of a rectified stereo camera.

    Attributes:
        flow: Height x width x 2, pixels; NaN is unknown. Things go left: x is negative.
        noise: Height x width, as in `Seen`.
        baseline: Metres between the two.
    """

    flow: Flow
    noise: NDArray[np.float32]
    baseline: float


@dataclass(frozen=True, eq=False)
class Seen:
    """What is known of two frames.

    Attributes:
        flow: From key to target, height x width x 2, pixels; NaN is unknown.
        noise: Standard deviation of each component, pixels; NaN where the flow is not to be
            trusted, as where the target hides what the key frame shows.
        camera: Of both frames.
        image: The key frame, height x width x 3 in RGB: where its edges are, regions may end.
        prior: Depth from the key frame alone.
        third: A third frame.
        stereo: The right picture of the key frame.
        target: The target frame, of the same kind as `image`, if flow was estimated from the two:
            then nothing moves by itself but what standing still explains worse in the pictures.
        search: Looks again for what stands still once the camera's motion is known, if flow was
            estimated.
    """

    flow: Flow
    noise: NDArray[np.float32]
    camera: Intrinsics
    image: NDArray[np.uint8] | None = None
    prior: Prior | None = None
    third: ThirdFrame | None = None
    stereo: Stereo | None = None
    target: NDArray[np.uint8] | None = None
    search: Search | None = None

    def __post_init__(self) -> None:
        """Refuse maps of different size and noise that is none."""
        shape = self.noise.shape
        maps = {"flow": self.flow, "image": self.image, "target": self.target}
        if self.prior is not None:
            maps |= {"prior.depth": self.prior.depth, "prior.spread": self.prior.spread}
        if self.third is not None:
            maps |= {"third.flow": self.third.flow, "third.noise": self.third.noise}
        if self.stereo is not None:
            maps |= {"stereo.flow": self.stereo.flow, "stereo.noise": self.stereo.noise}
            if not 0 < self.stereo.baseline < np.inf:
                raise InputError(
                    f"the stereo baseline is wanted in metres, above 0, got {self.stereo.baseline}"
                )
        for name, values in maps.items():
            if values is not None and values.shape[:2] != shape:
                size = "x".join(map(str, values.shape[:2]))
                raise InputError(
                    f"{name} of {shape[0]}x{shape[1]} pixels (height first) is wanted, as the "
                    f"noise is, got {size}; resize both frames alike before"
                )
        if (self.noise <= 0).any():
            raise InputError(
                "noise of flow must be above 0 pixels; NaN where it is not to be trusted"
            )

    @property
    def known(self) -> NDArray[np.bool_]:
        """Where there is any flow, trusted or not."""
        return np.asarray(np.isfinite(self.flow).all(axis=-1))

    @property
    def trusted(self) -> NDArray[np.bool_]:
        """Where the flow is known and to be trusted."""
        return self.known & np.isfinite(self.noise)
