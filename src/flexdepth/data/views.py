"""What sets hold besides pairs of image and depth: posed images, optical flow, ordinal pairs."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Generic, TypeVar

import numpy as np
from numpy.typing import NDArray

from flexdepth.data.trajectory import Pose
from flexdepth.runtime.depthmap import Intrinsics

Item = TypeVar("Item")


@dataclass(frozen=True, eq=False)
class PosedImage:
    """An image and where it was taken from.

    Attributes:
        name: Unique in its set.
        image: RGB, 0 to 255.
        camera: In pixels of the image.
        world_from_camera: 4 x 4, metres.
    """

    name: str
    image: NDArray[np.uint8]
    camera: Intrinsics
    world_from_camera: Pose


@dataclass(frozen=True, eq=False)
class FlowPair:
    """Two images and where the pixels of the first have gone in the second.

    Attributes:
        name: Unique in its set.
        key: RGB, 0 to 255.
        target: The later image.
        flow: Height x width x 2, right and down in pixels; NaN is unknown.
        occluded: Pixels of `key` that are hidden in `target`; None where nobody says.
    """

    name: str
    key: NDArray[np.uint8]
    target: NDArray[np.uint8]
    flow: NDArray[np.float32]
    occluded: NDArray[np.bool_] | None


@dataclass(frozen=True, eq=False)
class OrdinalPair:
    """An image and which of two of its points is farther away.

    Attributes:
        name: Unique in its set.
        image: RGB, 0 to 255.
        farther: Column and row of the farther point's pixel, the first is 0.
        nearer: Column and row of the nearer one.
    """

    name: str
    image: NDArray[np.uint8]
    farther: tuple[int, int]
    nearer: tuple[int, int]


@dataclass(frozen=True, eq=False)
class OrdinalRegions:
    """An image and two regions of it, all of one farther away than all of the other.

    Attributes:
        name: Unique in its set.
        image: RGB, 0 to 255.
        nearer: At the image's size; may be empty.
        farther: Likewise.
    """

    name: str
    image: NDArray[np.uint8]
    nearer: NDArray[np.bool_]
    farther: NDArray[np.bool_]


@dataclass(frozen=True)
class Listed(Generic[Item]):
    """Things on disk by number, each read when it is asked for.

    Attributes:
        readers: One for each thing.
    """

    readers: tuple[Callable[[], Item], ...]

    def __len__(self) -> int:
        """Return how many there are."""
        return len(self.readers)

    def __getitem__(self, index: int) -> Item:
        """Return one.

        Raises:
            InputError: A file is missing or damaged.
        """
        return self.readers[index]()
