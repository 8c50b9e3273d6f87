"""What travels from a data set through a network to a loss.

One type serves a single sample and a batch: leading dimensions are free.
"""

from dataclasses import dataclass

from jaxtyping import Bool, Float
from torch import Tensor

from flexdepth.geometry.camera import Camera
from flexdepth.geometry.depth import DepthBins, canonical_from_metres, metres_from_canonical


@dataclass(frozen=True, eq=False)
class Frame:
    """An image and the camera that took it.

    Attributes:
        image: RGB in [0, 1].
        camera: In pixels of this image.
    """

    image: Float[Tensor, "*batch 3 height width"]
    camera: Camera

    def focal_by_area(self) -> Float[Tensor, "*batch"]:
        """Return the focal length divided by the diagonal of a 4:3 image of the same area."""
        height, width = self.image.shape[-2:]
        return self.camera.focal_by_area(width, height)

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
        draw: Which of the random changes of the same image this is, such as the number of the
            batch it is in. What is random in a loss follows from it.
    """

    name: str | tuple[str, ...]
    key: Frame
    truth: Truth | None
    draw: int | tuple[int, ...] = 0


@dataclass(frozen=True, eq=False)
class Prediction:
    """What a network says of a batch of images.

    Depth is in units: a unit is that of `bins`, and a metre without bins.

    Attributes:
        depth: For a camera of `canonical_focal`, or for the camera that took the image.
        canonical_focal: In diagonals of a 4:3 image of the same area: metres = depth * unit *
            (focal length in these diagonals) / `canonical_focal`. None for a network whose units
            do not depend on the camera: metres = depth * unit.
        sky_logit: Log odds of a pixel being sky.
        attention: Maps of spatial attention in [0, 1], coarsest first, each at its own size.
        logits: Of the probability of each of `bins`; `depth` is decoded from them.
        bins: What a network that classifies depth tells apart.
        beyond: Log odds that the depth lies beyond each of `bins`; `depth` is decoded from them.
        centres: Of the bins of depth that the network chose for each image, nearest first.
        spread: Relative standard deviation of depth, the one factor of the whole map left out.
        focal: Of the camera that took the image, in image diagonals.
    """

    depth: Float[Tensor, "*batch height width"]
    canonical_focal: float | None
    sky_logit: Float[Tensor, "*batch height width"] | None = None
    attention: tuple[Float[Tensor, "*batch 1 _ _"], ...] = ()
    logits: Float[Tensor, "*batch bins height width"] | None = None
    bins: DepthBins | None = None
    beyond: Float[Tensor, "*batch bins height width"] | None = None
    centres: Float[Tensor, "*batch _"] | None = None
    spread: Float[Tensor, "*batch height width"] | None = None
    focal: Float[Tensor, "*batch"] | None = None


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


def true_depth(
    prediction: Prediction, sample: Sample, wanted_by: str
) -> tuple[Float[Tensor, "*batch height width"], Bool[Tensor, "*batch height width"]]:
    """Return what the prediction's depth should be, and where that is known.

    It is in the prediction's units and for its camera, positive and finite everywhere; one where
    it is not known. Zero, negative, infinite and undefined depth is not known, whatever `valid`
    says. Depth beyond the prediction's bins is brought into their range, for the network cannot
    say it.

    Args:
        prediction: Says the units.
        sample: Holds the truth.
        wanted_by: Who needs it, for the message.

    Raises:
        ValueError: If the sample has no truth.
    """
    truth, bins = measured(sample, wanted_by), prediction.bins
    depth = truth.depth
    if prediction.canonical_focal is not None:
        focal = sample.key.focal_by_area()
        depth = canonical_from_metres(depth, focal, prediction.canonical_focal)
    if bins is not None:
        depth = depth / bins.unit
    valid = truth.valid & (depth > 0) & depth.isfinite()
    if bins is not None:
        depth = bins.clipped(depth)
    return depth.where(valid, 1.0), valid


def in_metres(
    depth: Float[Tensor, "*batch height width"], prediction: Prediction, sample: Sample
) -> Float[Tensor, "*batch height width"]:
    """Return in metres, for the camera that took the image, depth that is as `prediction` has it.

    Args:
        depth: In the prediction's units and for its camera: its own depth, or `true_depth`.
        prediction: Says the units.
        sample: Says the camera.
    """
    if prediction.bins is not None:
        depth = depth * prediction.bins.unit
    if prediction.canonical_focal is None:
        return depth
    focal = sample.key.focal_by_area()
    return metres_from_canonical(depth, focal, prediction.canonical_focal)
