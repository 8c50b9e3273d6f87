"""Chapter 5's objective over a depth, rotation and translation of each pixel, by Adam.

What the dissertation did with networks is done here with free maps, as in its Fig. 5.3.
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor

from flexdepth.geometry.camera import Camera
from flexdepth.geometry.field import norm
from flexdepth.geometry.pose import rotated, rotation_log
from flexdepth.geometry.sampling import pixel_centres
from flexdepth.geometry.warp import induced_flow
from flexdepth.runtime.errors import InputError
from flexdepth.solvers.answer import Evidence, Kind, Region, TwoFrame, Unknown
from flexdepth.solvers.correspondences import from_flow
from flexdepth.solvers.dissertation import (
    OBJECTIVES,
    TABLE_5_1,
    Fields,
    Form,
    Scale,
    Terms,
    View,
    Weights,
    total,
)
from flexdepth.solvers.ego_motion import camera_motion
from flexdepth.solvers.pose import Pose
from flexdepth.solvers.seen import Seen

Array = NDArray[np.float64]

_PARALLAX = 0.1, 100.0
"""Pixels of parallax between which the corrected form's depth is held."""

_OWN = 1.0
"""Pixels by which a pixel's motion differs from the median one where it is said to move."""


@dataclass(frozen=True)
class FirstOrder:
    """How chapter 5's objective is minimised.

    Attributes:
        form: How it is read.
        weights: Of its terms. The corrected form leaves out `depth_scale`: it has a scale already.
        iterations: Steps of Adam.
        rate: Of the first; it falls to 0 by a line, as in section 5.5.2.
        quantile: ρ of (5.33).
        depths: The least and the largest depth, metres, that the form as written is held to.
        start: The camera's motion `target_from_key` that all pixels begin with; None begins at no
            rotation and small random translations.
        seed: Of what is random.
    """

    form: Form = Form.AS_WRITTEN
    weights: Weights = TABLE_5_1
    iterations: int = 400
    rate: float = 0.01
    quantile: float = 0.9
    depths: tuple[float, float] = (0.5, 80.0)
    start: Pose | None = None
    seed: int = 0

    def __post_init__(self) -> None:
        """Refuse what means nothing."""
        nearest, farthest = self.depths
        if not (0 < nearest < farthest and 0 < self.quantile <= 1 and self.iterations >= 0):
            raise InputError(
                "the dissertation's objective wants 0 < nearest < farthest depth, a quantile in "
                f"(0, 1] and 0 or more iterations, got {self}"
            )

    def scale(self, focal: float) -> Scale:
        """Return what holds the scale, for a focal length in pixels.

        As written, |t| is 0.01 on average and depth in metres. Corrected, |t| is 1, and depth where
        parallax has between a tenth of a pixel and a hundred pixels.
        """
        if self.form is Form.AS_WRITTEN:
            return Scale(0.01, *self.depths, self.quantile)
        least, most = _PARALLAX
        return Scale(1.0, focal / most, focal / least, self.quantile)


@dataclass(frozen=True, eq=False)
class Clues:
    """What feeds the sparse terms and those of flow.

    Attributes:
        key: Matched points of the key frame, m x 2, pixels; the first pixel's centre is 0.5.
        target: The same points in the target.
        frames: Key and target in gray, height x width, 0 to 255: with them flow is an unknown too,
            which begins as it is given. Without them (None) it stays so.
    """

    key: Array
    target: Array
    frames: tuple[NDArray[np.uint8], NDArray[np.uint8]] | None = None


def first_order(
    seen: Seen, settings: FirstOrder = FirstOrder(), clues: Clues | None = None
) -> TwoFrame:
    """Return the depth and motion at which chapter 5's objective is left.

    The objective knows no doubt: depth is said wherever flow is trusted, its spread is unknown, and
    there is one region. Translation and depth are scaled so that the median translation is 1.

    Flow is sought as well where the clues have frames, as in Fig. 5.4. Else it is given, as in
    Fig. 5.3: nothing but geometry would tell it between the matches, and geometry is sought itself.
    Then its two terms are constant.

    Raises:
        InputError: Fewer than 16 pixels have flow that is to be trusted.
    """
    view = viewed(seen, clues)
    *_, (fields, _) = descent(view, settings)
    return _answer(seen, view, _in_house(fields, settings.form))


def descent(view: View, settings: FirstOrder) -> Iterator[tuple[Fields, Terms]]:
    """Yield the fields and terms before each step and after the last, without gradient."""
    objective = OBJECTIVES[settings.form]
    scale = settings.scale(float(view.camera.focal.prod().sqrt()))
    weights = settings.weights
    if settings.form is Form.CORRECTED:
        weights = replace(weights, depth_scale=0.0)
    unknowns = _start(view, settings, scale)
    free = unknowns[:3] if view.frames is None else unknowns
    optimiser = torch.optim.Adam([each.requires_grad_() for each in free], lr=settings.rate)
    decay = torch.optim.lr_scheduler.LinearLR(
        optimiser, 1.0, 0.0, total_iters=max(settings.iterations, 1)
    )
    for step in range(settings.iterations + 1):
        log_depth, n, t, flow = unknowns
        fields = Fields(log_depth.exp(), n, t, flow)
        terms = objective(fields, view, scale)
        yield (
            Fields(*(x.detach().clone() for x in (fields.depth, n, t, flow))),
            {name: value.detach() for name, value in terms.items()},
        )
        if step < settings.iterations:
            loss = total(terms, weights)
            for each, gradient in zip(free, torch.autograd.grad(loss, free), strict=True):
                each.grad = gradient
            optimiser.step()
            decay.step()


def viewed(seen: Seen, clues: Clues | None) -> View:
    """Return what is seen in single precision, in which the dissertation's networks compute."""
    camera = seen.camera
    nothing = np.zeros((0, 2))
    key, target = (nothing, nothing) if clues is None else (clues.key, clues.target)
    frames = None
    if clues is not None and clues.frames is not None:
        one, other = (_single(frame)[None] / 255 for frame in clues.frames)
        frames = one, other
    return View(
        Camera.of(camera),
        _single(np.where(seen.known[..., None], seen.flow, 0.0)),
        torch.from_numpy(seen.trusted.copy()),
        _single(key),
        _single(target),
        frames,
    )


def _single(values: NDArray[np.generic]) -> Tensor:
    return torch.from_numpy(np.ascontiguousarray(values, np.float32))


def _start(view: View, settings: FirstOrder, scale: Scale) -> list[Tensor]:
    """Return log depth, n, t and flow to begin with: depth is the middle of its range, by ratio."""
    generator = torch.Generator().manual_seed(settings.seed)
    height, width = view.trusted.shape
    middle = 0.5 * np.log(scale.nearest * scale.farthest)
    noise = torch.randn(7, height, width, generator=generator)
    log_depth = middle + 0.01 * noise[0]
    n, t = 1e-3 * noise[1:4], scale.length * noise[4:] / 3**0.5
    if settings.start is not None:
        rotation = torch.from_numpy(settings.start.rotation)
        turn = rotation_log(rotation)
        way = torch.from_numpy(settings.start.translation)
        if settings.form is Form.AS_WRITTEN:
            way = -rotated(-turn, way)
        length = way.norm().clamp(min=1e-12)
        n = turn.float()[:, None, None].expand(3, height, width).clone()
        t = (scale.length * way / length).float()[:, None, None].expand(3, height, width).clone()
    return [log_depth, n, t, view.flow.clone()]


def _in_house(fields: Fields, form: Form) -> Fields:
    """Return the fields with motion X_target = R X_key + t: as written, t is -R of its own."""
    if form is Form.CORRECTED:
        return fields
    n, t = fields.n.movedim(0, -1), fields.t.movedim(0, -1)
    return replace(fields, t=-rotated(n, t).movedim(-1, 0))


def _answer(seen: Seen, view: View, fields: Fields) -> TwoFrame:
    n, t = fields.n.movedim(0, -1), fields.t.movedim(0, -1)
    unit = norm(t.flatten(0, 1).median(0).values).clamp(min=1e-12)
    depth, t = fields.depth / unit, t / unit
    flow, _ = induced_flow(depth, n, t, view.camera)
    turning, _ = induced_flow(depth, n, 0 * t, view.camera)
    shape = seen.noise.shape
    motion = camera_motion(from_flow(seen.flow, seen.trusted, seen.noise, seen.camera))
    one = Region(0, Kind.STATIC, Evidence.CAMERA, 0.0, float("inf"), int(np.prod(shape)))

    def known(values: Tensor) -> Array:
        return np.where(seen.known, values.double().numpy(), np.nan)

    return TwoFrame(
        depth=np.where(seen.trusted, depth.double().numpy(), np.nan),
        rotation=n.double().numpy(),
        translation=t.double().numpy(),
        labels=np.zeros(shape, np.int32),
        regions=(one,),
        moving=(_own_motion(view, depth, n, t) > _OWN).numpy(),
        parallax=known(norm(flow - turning)),
        residual=known(norm(flow - view.flow)),
        flow=np.where(seen.known[..., None], seen.flow, np.nan).astype(np.float64),
        noise=np.where(seen.trusted, seen.noise, np.nan).astype(np.float64),
        spread=np.full(shape, np.inf),
        unknown=np.select(
            [~seen.known, ~seen.trusted], [Unknown.NO_FLOW, Unknown.OCCLUDED], Unknown.KNOWN
        ).astype(np.uint8),
        inferred=np.zeros(shape, bool),
        camera_motion=motion,
        prior_share=None,
        metric=False,
    )


def _own_motion(view: View, depth: Tensor, n: Tensor, t: Tensor) -> Tensor:
    """Return by how many pixels each point moves otherwise than the median motion would move it."""
    centres = pixel_centres(depth)
    rays = view.camera.unproject(centres.flatten(0, 1)).reshape(*depth.shape, 3)
    usual_n, usual_t = (x.flatten(0, 1).median(0).values.expand_as(x) for x in (n, t))
    own = rotated(n, rays) - rotated(usual_n, rays) + (t - usual_t) / depth[..., None]
    return norm(own) * view.camera.focal.prod().sqrt()
