"""What travels from a data set through a network to a loss.

One type serves a single sample and a batch: leading dimensions are free.
"""

from dataclasses import dataclass

from jaxtyping import Bool, Float
from torch import Tensor

from flexdepth.geometry.camera import Camera
from flexdepth.geometry.depth import canonical_from_metres


@dataclass(frozen=True, eq=False)
class Frame:
    """An image and the camera that took it.

    Attributes:
        image: RGB in [0, 1].
        camera: In pixels of this image.
    """

    image: Float[Tensor, "*batch 3 height width"]
    camera: Camera

    def focal_in_diagonals(self) -> Float[Tensor, "*batch"]:
        """Return the camera's focal length divided by the image's diagonal."""
        height, width = self.image.shape[-2:]
        return self.camera.focal_in_diagonals(width, height)


@dataclass(frozen=True, eq=False)
class Truth:
    """What was measured or rendered.

    A pixel that is neither valid nor sky is unknown.

    Attributes:
        depth: z in metres; meaningless where not valid.
        valid: Where the depth is known and finite.
        sky: Where there is nothing to measure.
    """

    depth: Float[Tensor, "*batch height width"]
    valid: Bool[Tensor, "*batch height width"]
    sky: Bool[Tensor, "*batch height width"]


@dataclass(frozen=True, eq=False)
class Sample:
    """One training or test image, or a batch of them.

    Attributes:
        name: Where it comes from; in a batch, one name for each.
        key: The frame whose depth is sought.
        truth: Its depth, where it is known.
    """

    name: str | tuple[str, ...]
    key: Frame
    truth: Truth | None


@dataclass(frozen=True, eq=False)
class Prediction:
    """What a network says of a batch of images.

    Attributes:
        depth: For a camera of `canonical_focal`.
        canonical_focal: In image diagonals: metres = depth * (focal length in diagonals) /
            `canonical_focal`.
        sky_logit: Log odds of a pixel being sky.
        attention: Maps of spatial attention in [0, 1], coarsest first, each at its own size.
    """

    depth: Float[Tensor, "*batch height width"]
    canonical_focal: float
    sky_logit: Float[Tensor, "*batch height width"] | None = None
    attention: tuple[Float[Tensor, "*batch 1 _ _"], ...] = ()


def measured(sample: Sample, wanted_by: str) -> Truth:
    """Return the sample's truth.

    Args:
        sample: With or without truth.
        wanted_by: Who needs it, for the message.

    Raises:
        ValueError: If the sample has none.
    """
    if sample.truth is None:
        raise ValueError(f"{wanted_by} needs measured depth, but this sample has no `truth`")
    return sample.truth


def canonical_truth(
    sample: Sample, truth: Truth, canonical_focal: float
) -> Float[Tensor, "*batch height width"]:
    """Return the true depth of the key frame for a camera of `canonical_focal`."""
    return canonical_from_metres(truth.depth, sample.key.focal_in_diagonals(), canonical_focal)
