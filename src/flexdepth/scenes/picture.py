"""What two frames tell, in pictures."""

import cv2
import numpy as np
from numpy.typing import NDArray

from flexdepth.runtime.colour import SKY, UNKNOWN, Colour, coloured, limits, palette
from flexdepth.runtime.depthmap import DepthMap, Space
from flexdepth.scenes.own_motion import own_ways
from flexdepth.scenes.pair import Solution
from flexdepth.scenes.panels import Bar, Key, Panel, Pixels, kinds, magnitude, number, sheet, signed
from flexdepth.scenes.words import camera_translation, summary
from flexdepth.solvers.two_frame import Kind, TwoFrame, Unknown

_STATIC: Colour = (120, 156, 214)
_BORDER: Colour = (0, 0, 0)
_MOVERS: tuple[Colour, ...] = (
    (232, 112, 168),
    (96, 186, 98),
    (240, 160, 60),
    (150, 110, 200),
    (220, 70, 60),
    (70, 180, 190),
    (190, 170, 60),
    (150, 100, 70),
)
"""As in Fig. 5.12, the static part is blue, the first thing that moves pink, the second green."""

_REASONS: tuple[tuple[str, Colour], ...] = (
    ("known", (235, 235, 235)),
    ("no flow", (60, 60, 60)),
    ("hidden in the target", (214, 96, 77)),
    ("too little parallax", (244, 190, 90)),
    ("scale unknown", (150, 110, 200)),
    ("behind the camera", (70, 160, 120)),
    ("sky", SKY),
    ("inferred from around", (150, 190, 235)),
)
"""By the numbers of `Unknown`, and what is inferred."""

_THREE = ("x", "y", "z")

_SHARE, _ALONE = "The single-image depth's share (0 to 1)", "Depth from the key frame alone"

_LEAST_TURN, _LEAST_WAY = 0.1, 0.05
"""Degrees, and shares of the camera's way: smaller differences are not drawn in full colour."""


def region_colours(found: TwoFrame) -> Pixels:
    """Return the colour of each region by its label: regions by 3; static is blue."""
    return np.array(
        [
            _STATIC if region.kind is Kind.STATIC else _MOVERS[(region.label - 1) % len(_MOVERS)]
            for region in found.regions
        ],
        np.uint8,
    )


def borders(labels: NDArray[np.integer]) -> NDArray[np.bool_]:
    """Return the pixels beside which, across or down, another region lies."""
    cross = cv2.getStructuringElement(cv2.MORPH_CROSS, (3, 3))
    numbers = labels.astype(np.float32)
    return np.asarray(cv2.dilate(numbers, cross) != cv2.erode(numbers, cross))


def moving_picture(found: TwoFrame) -> Pixels:
    """Return the mask of what moves by itself: white on black."""
    return np.repeat(np.where(found.moving, 255, 0).astype(np.uint8)[..., None], 3, axis=2)


def border_picture(found: TwoFrame) -> Pixels:
    """Return the parts of the scene in colours, with black between them, as in Fig. 5.12."""
    picture = region_colours(found)[found.labels]
    picture[_thick(borders(found.labels))] = _BORDER
    return picture


def motion_panels(solution: Solution) -> list[Panel]:
    """Return the six maps of Fig. 5.3: the components of rotation n and translation t.

    White is the camera's own motion, so that what moves by itself shows.
    """
    found = solution.found
    still = found.camera_motion.pose
    own = np.degrees(cv2.Rodrigues(still.rotation)[0]).ravel(), camera_translation(found)
    turns = _three("k", "rotation n", np.degrees(found.rotation), own[0])
    ways = _three("t", "translation t", found.translation, own[1])
    least = _LEAST_WAY * (float(np.linalg.norm(own[1])) or 1.0)
    return [
        *(signed(*each, _LEAST_TURN, "°") for each in turns),
        *(signed(*each, least, _unit(found)) for each in ways),
    ]


def _three(
    sign: str, name: str, maps: NDArray[np.float64], own: NDArray[np.float64]
) -> list[tuple[str, NDArray[np.float64], float]]:
    """Return title, map and the camera's own number of each component."""
    return [
        (f"{sign}{letter}: {name}, {letter}", maps[..., axis], float(own[axis]))
        for axis, letter in enumerate(_THREE)
    ]


def motion_picture(solution: Solution) -> Pixels:
    """Return the six maps on one sheet."""
    return sheet(
        ["Motion of each pixel, X' = R(n) X + t; white is the camera's own motion"],
        motion_panels(solution),
        3,
    )


def solution_picture(solution: Solution) -> Pixels:
    """Return everything that is known on one labelled sheet."""
    heading = ["Two frames: depth and motion of every pixel", *summary(solution)]
    return sheet(heading, _panels(solution), 3)


def _reasons(found: TwoFrame) -> NDArray[np.uint8]:
    return np.where(found.inferred, np.uint8(len(Unknown)), found.unknown)


def _panels(solution: Solution) -> list[Panel]:
    found = solution.found
    share = found.prior_share
    return [
        _key(solution),
        Panel("Target frame", solution.views.pictures["target"]),
        _flow(solution),
        _depth("Depth", solution.depth),
        magnitude("Depth: relative standard deviation", found.spread, most=0.5),
        kinds("Why a pixel has no depth", _reasons(found), _REASONS),
        _regions(solution),
        magnitude("How sure the scale of each part is (0 to 1)", solution.confidence, most=1.0),
        Panel(_SHARE, None) if share is None else magnitude(_SHARE, share, most=1.0),
        magnitude("Parallax", np.abs(found.parallax), " px"),
        magnitude("Residual: flow that is not explained", found.residual, " px"),
        Panel(_ALONE, None) if solution.prior is None else _depth(_ALONE, solution.prior),
        Panel("What moves by itself (white)", moving_picture(found)),
        magnitude("By how much, beside what is static", _own_way(solution), _unit(found)),
        magnitude("Noise of the flow, one standard deviation", solution.flow.noise, " px"),
        *motion_panels(solution),
    ]


def _own_way(solution: Solution) -> NDArray[np.float64]:
    """Return how far each pixel's point has moved by itself; 0 where it is static."""
    found = solution.found
    ways = np.where(np.isfinite(found.depth), 0.0, np.nan)
    chosen = found.moving & np.isfinite(found.depth)
    _, own = own_ways(solution, chosen)
    ways[chosen] = np.linalg.norm(own, axis=1)
    return ways


def _unit(found: TwoFrame) -> str:
    return " m" if found.metric else ""


def _key(solution: Solution) -> Panel:
    """Return the key frame with what moves outlined."""
    picture = solution.key.copy()
    edge = _thick(borders(solution.found.labels))
    picture[edge] = (255, 0, 200)
    words = {"border between parts that move differently": (255, 0, 200)} if edge.any() else {}
    return Panel("Key frame", picture, Key(words))


def _flow(solution: Solution) -> Panel:
    """Return the flow in colours: hue is the direction, red to the right; white stands still."""
    field = solution.flow
    known = np.asarray(np.isfinite(field.flow).all(axis=-1))
    flow = np.where(known[..., None], field.flow, 0)
    length = np.linalg.norm(flow, axis=-1)
    full = max(float(np.percentile(length[known], 99)), 1e-6) if known.any() else 1.0
    hue = np.degrees(np.arctan2(flow[..., 1], flow[..., 0])) % 360 / 2
    bands = np.stack([hue, 255 * np.clip(length / full, 0, 1), np.full_like(hue, 255)], -1)
    picture = np.asarray(cv2.cvtColor(bands.astype(np.uint8), cv2.COLOR_HSV2RGB), np.uint8)
    picture[~known] = UNKNOWN
    legend = {f"right (full colour {full:.1f} px)": (255, 0, 0), "down": (128, 255, 0)}
    legend |= {"left": (0, 255, 255), "up": (128, 0, 255)}
    return Panel("Optical flow, key to target", picture, Key(legend))


def _depth(title: str, depth: DepthMap) -> Panel:
    ends = limits(depth)
    unit = " m" if depth.space is Space.METRIC else ""
    if ends.empty:
        return Panel(f"{title}: nowhere known", coloured(depth, ends), Key({"unknown": UNKNOWN}))
    middle = (ends.nearest * ends.farthest) ** 0.5
    words = tuple(f"{number(value)}{unit}" for value in (ends.nearest, middle, ends.farthest))
    named = f"{title}, {'metres' if unit else 'camera steps' if title == 'Depth' else 'relative'}"
    bar = Bar(palette()[::-1], (f"near {words[0]}", words[1], f"far {words[2]}"))
    return Panel(f"{named} (gray unknown, blue sky)", coloured(depth, ends), bar)


def _regions(solution: Solution) -> Panel:
    found = solution.found
    colours = region_colours(found)
    sizes = sorted(found.regions, key=lambda region: -region.pixels)[:6]
    legend: dict[str, Colour] = {}
    for region in sizes:
        r, g, b = (int(value) for value in colours[region.label])
        name = "static" if region.kind is Kind.STATIC else f"{region.label} {region.kind}"
        legend[name] = (r, g, b)
    return Panel("Parts that move differently, and borders", border_picture(found), Key(legend))


def _thick(edge: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Return a border that is seen in a picture of its size."""
    width = max(1, edge.shape[1] // 400)
    if width == 1:
        return edge
    return np.asarray(cv2.dilate(edge.astype(np.uint8), np.ones((width, width), np.uint8)) > 0)
