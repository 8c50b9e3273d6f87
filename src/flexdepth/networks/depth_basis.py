"""A basis of depth maps: the principal components of those of a data set.

The dissertation's section 3.5.1 takes the eigenvectors of the depth images of a set as they are.
Here every map is first brought to a small size, and the covariance of its pixels is kept up to
date, map by map. So one pass over a set of any length is enough, in memory that depends on the
small size alone (75 MB at 64 x 48), the result is exact and does not depend on the order; an
incremental singular value decomposition at full size is neither. What the small size loses are
edges, which no few components can hold, and which are what the network's filter at the size of
the image is for.
"""

import json
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from itertools import islice
from pathlib import Path
from types import MappingProxyType
from typing import Literal

import torch
from jaxtyping import Bool, Float
from safetensors import SafetensorError, safe_open
from safetensors.torch import save_file
from torch import Tensor
from torch.nn.functional import adaptive_avg_pool2d, avg_pool2d

from flexdepth.runtime.atomic import replacing
from flexdepth.runtime.errors import InputError

_FORMAT = "1"
_AT_A_TIME = 64
"""Maps for which the covariance is brought up to date together."""


@dataclass(frozen=True)
class Scale:
    """In what depth is added up: a function, and its inverse."""

    of_depth: Callable[[Tensor], Tensor]
    depth_of: Callable[[Tensor], Tensor]


def _as_it_is(depth: Tensor) -> Tensor:
    return depth


SCALES: Mapping[str, Scale] = MappingProxyType(
    {"depth": Scale(_as_it_is, _as_it_is), "log": Scale(torch.log, torch.exp)}
)


@dataclass(frozen=True)
class Basis:
    """How a basis of depth maps is made.

    Attributes:
        rows: Of the small maps.
        columns: Of the small maps.
        components: How many of the most important components are kept.
        scale: Depth as it is, as published, or its logarithm.
        nearest: Depth is brought between this
        farthest: and this. Both are in the unit of the maps.

    Raises:
        InputError: The small maps have no pixel, or fewer than there are components, or 0 <
            `nearest` < `farthest` does not hold.
    """

    rows: int = 48
    columns: int = 64
    components: int = 64
    scale: Literal["depth", "log"] = "depth"
    nearest: float = 0.1
    farthest: float = 80.0

    def __post_init__(self) -> None:
        enough = 1 <= self.components <= self.rows * self.columns and min(self.rows, self.columns)
        if not (enough and 0 < self.nearest < self.farthest):
            raise InputError(
                f"a basis of depth maps needs 1 <= components <= rows * columns and "
                f"0 < nearest < farthest, got {self}"
            )

    def ends(self) -> tuple[float, float]:
        """Return the nearest and the farthest depth in the scale of the basis."""
        both = torch.tensor([self.nearest, self.farthest], device="cpu")
        nearest, farthest = SCALES[self.scale].of_depth(both).tolist()
        return nearest, farthest

    def small(
        self, depth: Float[Tensor, "height width"], known: Bool[Tensor, "height width"]
    ) -> Float[Tensor, "rows columns"]:
        """Return a map at the size and in the scale of the basis, without holes.

        A small pixel is the mean of the known ones in it; one without any takes the mean of the
        smallest block around it, of 2 x 2, 4 x 4 or more small pixels, that has some.

        Args:
            depth: Anything where not known.
            known: At least one pixel is.
        """
        inside = depth.clamp(self.nearest, self.farthest).double()
        values = SCALES[self.scale].of_depth(inside).where(known, 0.0)[None]
        size = (self.rows, self.columns)
        weight = adaptive_avg_pool2d(known[None].double(), size)
        total = adaptive_avg_pool2d(values, size)
        return _filled(total, weight)[0]

    def fit(self, maps: Iterable[tuple[Tensor, Tensor]]) -> "DepthBasis":
        """Return the principal components of depth maps; memory does not grow with their number.

        Args:
            maps: Depth, of any size, and where it is known. Maps without a known pixel are left
                out.

        Raises:
            InputError: There are fewer than two maps to learn from.
        """
        moments = Moments.of_nothing(self.rows * self.columns)
        usable = (self.small(depth, known).flatten() for depth, known in maps if known.any())
        while some := list(islice(usable, _AT_A_TIME)):
            moments = moments.updated(torch.stack(some))
        if moments.count < 2:
            raise InputError(
                f"a basis of depth maps needs at least 2 maps with known depth, got "
                f"{moments.count}: name other data"
            )
        variances, vectors = torch.linalg.eigh(moments.products / moments.count)
        shape = (-1, self.rows, self.columns)
        kept = vectors.mT.flip(0)[: self.components]
        return DepthBasis(
            moments.mean.reshape(shape)[0].float(),
            kept.reshape(shape).float(),
            variances.flip(0).clamp(min=0).float(),
            moments.count,
        )


def _filled(
    total: Float[Tensor, "1 rows columns"], weight: Float[Tensor, "1 rows columns"]
) -> Float[Tensor, "1 rows columns"]:
    """Return total / weight, and where the weight is zero that of the block around it."""
    known = weight > 0
    own = total / weight.where(known, 1.0)
    if known.all():
        return own
    rows, columns = total.shape[-2:]
    coarse = _filled(*(avg_pool2d(x, 2, ceil_mode=True) for x in (total, weight)))
    grown = coarse.repeat_interleave(2, 1).repeat_interleave(2, 2)
    return own.where(known, grown[:, :rows, :columns])


@dataclass(frozen=True, eq=False)
class Moments:
    """Mean and covariance of numbers that come in parts.

    Attributes:
        count: How many rows have been seen.
        mean: Of each number.
        products: Sums over the rows of the products of two numbers' distances from their means.
    """

    count: int
    mean: Float[Tensor, " numbers"]
    products: Float[Tensor, "numbers numbers"]

    @classmethod
    def of_nothing(cls, numbers: int) -> "Moments":
        """Return what is known before the first row."""
        zeros = torch.zeros(numbers, dtype=torch.float64)
        return cls(0, zeros, torch.zeros(numbers, numbers, dtype=torch.float64))

    def updated(self, rows: Float[Tensor, "count numbers"]) -> "Moments":
        """Return the moments of these rows and all before; `products` is changed in place.

        References:
            Chan, Golub and LeVeque, Stanford STAN-CS-79-773, 1979, eqs 2.1.
        """
        here, together = len(rows), self.count + len(rows)
        mean = rows.mean(0)
        apart, step = rows - mean, mean - self.mean
        self.products.addmm_(apart.mT, apart)
        self.products.addr_(step, step, alpha=self.count * here / together)
        return Moments(together, self.mean + step * (here / together), self.products)


@dataclass(frozen=True, eq=False)
class DepthBasis:
    """Principal components of depth maps.

    Attributes:
        mean: Of the maps, in their scale.
        components: Orthonormal maps, the most important first.
        variances: Of the maps along every component there is, also those that are not kept.
        count: How many maps they are of.
    """

    mean: Float[Tensor, "rows columns"]
    components: Float[Tensor, "components rows columns"]
    variances: Float[Tensor, " all"]
    count: int

    def explained(self) -> Float[Tensor, " components"]:
        """Return which share of the variance the first 1, 2, 3, ... kept components explain."""
        kept = self.variances.double().cumsum(0)[: len(self.components)]
        return (kept / self.variances.double().sum()).float()

    def coefficients(
        self, small: Float[Tensor, "*batch rows columns"]
    ) -> Float[Tensor, "*batch components"]:
        """Return how much of each component is in maps of the size and scale of the basis."""
        return torch.einsum("...rc,krc->...k", small - self.mean, self.components)

    def maps(
        self, coefficients: Float[Tensor, "*batch components"]
    ) -> Float[Tensor, "*batch rows columns"]:
        """Return the mean and so much of each component."""
        return self.mean + torch.einsum("...k,krc->...rc", coefficients, self.components)

    def save(self, path: Path, settings: Basis) -> None:
        """Write the basis, and what it was made with, to a safetensors file.

        Raises:
            InputError: The file cannot be written.
        """
        words = {"basis": _FORMAT, "settings": json.dumps(vars(settings)), "maps": str(self.count)}
        parts = {"mean": self.mean, "components": self.components, "variances": self.variances}
        with replacing(path) as temporary:
            save_file({name: x.contiguous() for name, x in parts.items()}, temporary, words)

    @classmethod
    def load(cls, path: Path, settings: Basis) -> "DepthBasis":
        """Return the basis in a file.

        Raises:
            InputError: The file is missing or no basis, or was made with other settings.
        """
        if not path.is_file():
            raise InputError(f"{path}: no such basis of depth maps")
        try:
            with safe_open(path, framework="pt") as file:
                words = file.metadata() or {}
                parts = {name: file.get_tensor(name) for name in file.keys()}  # noqa: SIM118
        except (SafetensorError, OSError) as error:
            raise InputError(f"{path}: not a readable safetensors file ({error})") from error
        if words.get("basis") != _FORMAT or "settings" not in words:
            raise InputError(f"{path}: wanted a basis of depth maps, got something else")
        if json.loads(words["settings"]) != vars(settings):
            raise InputError(
                f"{path}: made with {words['settings']}, wanted {json.dumps(vars(settings))}; "
                f"change the settings, or make the basis again"
            )
        lacking = {"mean", "components", "variances"} - parts.keys()
        if lacking:
            raise InputError(f"{path}: lacks {sorted(lacking)}; make the basis again")
        return cls(**parts, count=int(words.get("maps", 0)))
