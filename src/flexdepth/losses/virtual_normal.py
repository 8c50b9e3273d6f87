"""The virtual normal loss: triangles far across the scene, each turned as it is in the truth."""

from dataclasses import dataclass, field, replace
from hashlib import sha256
from math import cos, radians

import torch
from jaxtyping import Bool, Float, Int
from torch import Tensor

from flexdepth.geometry.camera import Camera
from flexdepth.sample import Prediction, Sample, true_depth

Vector = tuple[Tensor, Tensor, Tensor]
"""x, y and z of many vectors."""

_ZERO_NORM = 0.01
"""The length that a normal of length zero is divided by: it stays zero, with a finite gradient."""

_ZERO_EDGES = 1e-8
"""Added to the product of two edges' lengths before a cosine is told."""


@dataclass(frozen=True)
class Triangles:
    """Which triangles are drawn, and which of them count. Lengths are in units of depth.

    Attributes:
        share: Triangles drawn per pixel of one image.
        smallest_cosine: No corner of a true triangle is wider than this says.
        largest_cosine: No corner of a true triangle is narrower than this says.
        gap: A true triangle is refused that has an edge shorter than this along x, one along y
            and one along z.
        edge: A true triangle is refused that has an edge of this length or shorter.
        dropped: The share of triangles, those with the smallest errors, that is left out.

    References:
        The defaults are what the base model's published code does, whatever its paper says.
    """

    share: float = 0.15
    smallest_cosine: float = -0.867
    largest_cosine: float = 0.867
    gap: float = 0.005
    edge: float = 0.0
    dropped: float = 0.25


PAPER_NYU = Triangles(
    smallest_cosine=cos(radians(120)), largest_cosine=cos(radians(30)), gap=0.0, edge=0.06
)
"""The paper's own: corners of 30 to 120 degrees, edges longer than 0.6 m, in units of 10 m."""

PAPER_KITTI = replace(PAPER_NYU, edge=0.0075)
"""The same in units of 80 m."""


def drawn(height: int, width: int, share: float, generator: torch.Generator) -> Int[Tensor, "3 n"]:
    """Return the corners of `⌊share · height · width⌋` triangles as places in a flattened image.

    Every corner is any pixel, valid or not, with equal chance.
    """
    count = int(share * height * width)
    return torch.randint(height * width, (3, count), generator=generator, device=generator.device)


def virtual_normal(
    depth: Float[Tensor, "b h w"],
    truth: Float[Tensor, "b h w"],
    valid: Bool[Tensor, "b h w"],
    camera: Camera,
    corners: Int[Tensor, "3 n"],
    triangles: Triangles,
) -> Float[Tensor, ""]:
    """Return the mean over triangles of `|n₁ − n₁*| + |n₂ − n₂*| + |n₃ − n₃*|`.

    n is the unit normal of a triangle between three pixels at their predicted depth, n* at their
    true depth. The same corners are taken in every image. A triangle counts if its corners are
    valid and its true shape is accepted; the mean is over those of the whole batch less the
    dropped ones. The loss is blind to the scale of `depth`, and zero where nothing counts.

    The accepted triangles, as a rule less than half, are taken out of the rest. A GPU is waited
    for once, to learn their number; what is refused costs no more and cannot spoil a gradient.

    Args:
        depth: Positive wherever valid.
        truth: Positive wherever valid, in the unit of `triangles`.
        valid: The pixels that count.
        camera: Of each image, or one for all.
        corners: From `drawn`.
        triangles: Which of them count.

    References:
        Yin et al., ICCV 2019, section 3.2.
    """
    corners = corners.to(depth.device)
    width = depth.shape[-1]
    pixels = torch.stack([corners % width, corners // width]).to(depth.dtype) + 0.5
    true_edges, known = _everywhere(truth, valid, camera, corners, pixels)
    kept = (known & _accepted(*true_edges, triangles)).flatten().nonzero().squeeze(1)
    true_normal = _unit(_cross(*(_picked(edge, kept) for edge in true_edges)))
    normal = _unit(_cross(*_kept_edges(depth, camera, corners, pixels, kept)))
    differences = [(a - b).abs() for a, b in zip(normal, true_normal, strict=True)]
    return _mean_without_smallest(torch.stack(differences).sum(0), triangles.dropped)


def _everywhere(
    truth: Tensor, valid: Tensor, camera: Camera, corners: Tensor, pixels: Tensor
) -> tuple[tuple[Vector, Vector], Tensor]:
    """Return two edges of every triangle in every image, and whether its corners are valid."""
    places = corners.flatten().expand(len(truth), -1)
    z, known = (x.flatten(1).gather(1, places).view(-1, *corners.shape) for x in (truth, valid))
    rays = (pixels - camera.centre[..., None, None]) / camera.focal[..., None, None]
    return _edges(rays, z), known[:, 0] & known[:, 1] & known[:, 2]


def _kept_edges(
    depth: Tensor, camera: Camera, corners: Tensor, pixels: Tensor, kept: Tensor
) -> tuple[Vector, Vector]:
    """Return two edges of the triangles whose number, counted through the images, is in `kept`."""
    images, height, width = depth.shape
    image = kept // corners.shape[1]
    triangle = kept - image * corners.shape[1]
    places = corners.index_select(1, triangle) + height * width * image
    # Along dimension 1, for along 0 `gather` sorts the places first.
    z = depth.reshape(1, -1).gather(1, places.view(1, -1)).view(places.shape)
    seen = pixels.view(6, -1).index_select(1, triangle).view(2, 3, -1)
    centre, focal = (
        x.expand(images, 2).mT.index_select(1, image)[:, None]
        for x in (camera.centre, camera.focal)
    )
    return _edges((seen - centre) / focal, z)


def _picked(vector: Vector, kept: Tensor) -> Vector:
    x, y, z = (part.flatten().index_select(0, kept) for part in vector)
    return x, y, z


def _edges(
    rays: Float[Tensor, "*batch 2 3 m"], z: Float[Tensor, "*images 3 m"]
) -> tuple[Vector, Vector]:
    """Return the edges from the first corner to the second and from the second to the third."""
    across, down = (rays * z.unsqueeze(-3)).unbind(-3)
    points = [part.unbind(-2) for part in (across, down, z)]
    (x, u), (y, v), (z, w) = ((b - a, c - b) for a, b, c in points)
    return (x, y, z), (u, v, w)


def _accepted(first: Vector, second: Vector, triangles: Triangles) -> Tensor:
    """Return which triangles are neither too pointed nor too near to a point."""
    third = (first[0] + second[0], first[1] + second[1], first[2] + second[2])
    a, b, c = (_dot(edge, edge) for edge in (first, second, third))
    ab = _dot(first, second)
    result = _least(a, b, c) > triangles.edge**2
    for product, squares in ((-ab, (a, b)), (a + ab, (a, c)), (b + ab, (b, c))):
        lengths = torch.mul(*squares).sqrt_().add_(_ZERO_EDGES)
        result &= torch.sub(product, lengths, alpha=triangles.largest_cosine) <= 0
        result &= torch.sub(product, lengths, alpha=triangles.smallest_cosine) >= 0
    shortest = [
        _least(x.abs(), y.abs(), z.abs()) for x, y, z in zip(first, second, third, strict=True)
    ]
    return result & (torch.maximum(torch.maximum(*shortest[:2]), shortest[2]) >= triangles.gap)


def _least(a: Tensor, b: Tensor, c: Tensor) -> Tensor:
    return torch.minimum(torch.minimum(a, b), c)


def _dot(a: Vector, b: Vector) -> Tensor:
    return torch.addcmul(torch.addcmul(a[0] * b[0], a[1], b[1]), a[2], b[2])


def _cross(a: Vector, b: Vector) -> Vector:
    return (
        torch.addcmul(a[1] * b[2], a[2], b[1], value=-1),
        torch.addcmul(a[2] * b[0], a[0], b[2], value=-1),
        torch.addcmul(a[0] * b[1], a[1], b[0], value=-1),
    )


def _unit(vector: Vector) -> Vector:
    """Return the vector divided by its length, and zero for zero."""
    square = _dot(vector, vector)
    length = square.where(square > 0, _ZERO_NORM**2).sqrt()
    return vector[0] / length, vector[1] / length, vector[2] / length


def _mean_without_smallest(error: Tensor, dropped: float) -> Tensor:
    """Return the mean of the errors but the smallest `⌊dropped · count⌋`; zero if there are none.

    It is t + Σ max(eᵢ − t, 0) / (count left) with t the smallest that is left: sorting takes
    longer than all the geometry.
    """
    if not error.numel():
        return error.sum()
    rank = int(dropped * error.numel())
    least = error.kthvalue(rank + 1).values
    return least + (error - least).relu().sum() / (error.numel() - rank)


@dataclass(frozen=True)
class VirtualNormal:
    """Virtual normal loss against measured depth; each image is given the mean of the batch.

    The triangles follow from `seed`, the names in the batch and their `draw`: a resumed run, and
    a run on another device, takes the same.

    Attributes:
        focal: In pixels of the network's image, with the principal point in its middle, as the
            base model has it: 519 for NYU, 357.3 for KITTI, whatever the image was cropped from.
            None takes each image's own camera.
        triangles: Which triangles count.
        seed: Of the corners.
    """

    focal: float | None = 519.0
    triangles: Triangles = field(default_factory=Triangles)
    seed: int = 0

    def __call__(self, prediction: Prediction, sample: Sample) -> Float[Tensor, " b"]:
        """Return the loss of the batch, for each image."""
        truth, valid = true_depth(prediction, sample, "VirtualNormal")
        depth = prediction.depth
        images, height, width = depth.shape
        camera = sample.key.camera
        if self.focal is not None:
            camera = central_camera(self.focal, depth)
        key = repr((self.seed, sample.name, sample.draw)).encode()
        generator = torch.Generator().manual_seed(int.from_bytes(sha256(key).digest()[:8]))
        corners = drawn(height, width, self.triangles.share, generator)
        loss = virtual_normal(depth, truth, valid, camera, corners, self.triangles)
        return loss.expand(images)


def central_camera(focal: float, depth: Float[Tensor, "b h w"]) -> Camera:
    """Return a camera for all images, aimed at the centre of pixel (⌊width/2⌋, ⌊height/2⌋)."""
    height, width = depth.shape[-2:]
    centre = depth.new_tensor([width // 2 + 0.5, height // 2 + 0.5])
    return Camera(torch.full_like(centre, focal), centre)
