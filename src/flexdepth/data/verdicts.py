"""The checks of a data set: each says "fine", "found" or "not judged", with the numbers it goes by.

The thresholds are set so that clean sets (ICL-NUIM, NYU, KITTI, Middlebury, 7-Scenes but for its
registration) give no finding; `tests/data/test_verdicts.py` holds them to it.
"""

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from enum import StrEnum
from types import MappingProxyType

import numpy as np
from numpy.typing import NDArray

from flexdepth.data.examination import Look, correlated
from flexdepth.data.perpendicular import FACTORS
from flexdepth.data.registration import REACH, reduction
from flexdepth.runtime.depthmap import Space

_MARGIN = 3.5
"""So many times too large or too small depth may be before it is a finding."""

_LENS = 2.0
"""And so many times more where the lens is assumed: 35 or 90 degrees are not 60."""

_SLIPS = MappingProxyType(
    {
        1000 / 256: "1/256 m and millimetres",
        5.0: "1/5000 m and millimetres",
        10.0: "centimetres and millimetres",
        100.0: "centimetres and metres",
        256.0: "1/256 m and metres",
        1000.0: "millimetres and metres",
        5000.0: "1/5000 m and metres",
    }
)
"""Factors between units that are taken for one another."""


class Verdict(StrEnum):
    """The outcome of a check."""

    FINE = "fine"
    FOUND = "FOUND"
    UNJUDGED = "not judged"


@dataclass(frozen=True)
class Finding:
    """What one check says.

    Attributes:
        check: Its name.
        verdict: The outcome.
        text: What it goes by, and what may be the matter; one line.
        images: Names of pairs that show it.
    """

    check: str
    verdict: Verdict
    text: str
    images: tuple[str, ...] = ()


def verdicts(looks: Sequence[Look]) -> tuple[Finding, ...]:
    """Return what each check says of the pairs that were looked at; at least one."""
    checks = (
        missing,
        repeated,
        order,
        pairing,
        scale,
        registration,
        focal,
        frame,
        saturation,
        steps,
    )
    return tuple(check(looks) for check in checks)


def missing(looks: Sequence[Look]) -> Finding:
    """Say whether pairs lack depth that the others have."""
    usual = float(np.median([look.known for look in looks]))
    poor = tuple(look.name for look in looks if look.known < usual / 10 or not look.pixels)
    shares = f"half of the pairs have depth in at least {usual:.1%} of their pixels"
    if poor:
        return Finding(
            "missing depth", Verdict.FOUND, f"{len(poor)} pairs have next to none; {shares}", poor
        )
    return Finding("missing depth", Verdict.FINE, shares)


def repeated(looks: Sequence[Look]) -> Finding:
    """Say whether different pairs have one and the same depth."""
    counts = Counter(look.digest for look in looks if look.pixels)
    twice = tuple(look.name for look in looks if counts[look.digest] > 1)
    if twice:
        text = (
            f"{len(twice)} pairs share their depth, value by value, with another: wrongly paired?"
        )
        return Finding("repeated depth", Verdict.FOUND, text, twice)
    return Finding("repeated depth", Verdict.FINE, f"{len(looks)} pairs, each with its own")


def scale(looks: Sequence[Look]) -> Finding:
    """Say whether depth is off by a factor, compared to what the bundled model takes it for."""
    judged = [look for look in looks if look.space is Space.METRIC and np.isfinite(look.ratio)]
    if not judged:
        return Finding("depth scale", Verdict.UNJUDGED, "wants metric depth")
    ratio = float(np.median([look.ratio for look in judged]))
    text = f"depth is {ratio:.3g} times what the model sees (median of {len(judged)})"
    margin = _MARGIN
    if any(look.camera is None for look in judged):
        margin *= _LENS
        text += ", for a lens of 60 degrees, as no camera is known"
    if 1 / margin < ratio < margin:
        return Finding("depth scale", Verdict.FINE, text)
    if order(looks).verdict is Verdict.FOUND:
        return Finding("depth scale", Verdict.UNJUDGED, f"{text}; see near and far first")
    near = sorted(_SLIPS, key=lambda factor: abs(np.log(factor) - abs(np.log(ratio))))[:2]
    way = "large" if ratio > 1 else "small"
    slips = " or ".join(f"{factor:.4g} ({_SLIPS[factor]})" for factor in near)
    return Finding("depth scale", Verdict.FOUND, f"{text}: too {way} by a factor of {slips}?")


def order(looks: Sequence[Look]) -> Finding:
    """Say whether near and far are where the model sees them."""
    found = [look.correlation for look in looks if np.isfinite(look.correlation)]
    if not found:
        return Finding("near and far", Verdict.UNJUDGED, "no picture could be compared")
    middle = float(np.median(found))
    text = f"correlates with the model's by {middle:.2f} (median of {len(found)})"
    if middle < -0.3:
        return Finding(
            "near and far", Verdict.FOUND, f"{text}: disparity stored as depth, or inverted?"
        )
    if middle < 0.15:
        return Finding("near and far", Verdict.FOUND, f"{text}: depth of other pictures?")
    return Finding("near and far", Verdict.FINE, text)


def pairing(looks: Sequence[Look]) -> Finding:
    """Say whether each depth fits its own picture better than it fits the others."""
    sketches = [look.sketch for look in looks if look.sketch is not None]
    if len(sketches) < 6:
        return Finding("pairing", Verdict.UNJUDGED, f"{len(sketches)} pairs to compare")
    fits = np.array([[correlated(truth, seen) for truth, _ in sketches] for _, seen in sketches])
    alike = np.array([[correlated(one, other) for one, _ in sketches] for other, _ in sketches])
    apart = ~np.eye(len(sketches), dtype=bool)
    if not np.nanmedian(np.where(apart, alike, np.nan)) < 0.9:
        return Finding("pairing", Verdict.UNJUDGED, "depth is much the same in all pairs")
    ranks = []
    for number, row in enumerate(fits):
        others = row[apart[number] & np.isfinite(row)]
        if others.size and np.isfinite(row[number]):
            ranks.append(float((others < row[number]).mean()))
    mean = float(np.mean(ranks))
    text = f"depth fits its own picture better than {mean:.0%} of the others ({len(ranks)} pairs)"
    if mean < 0.5 + 1.0 / np.sqrt(12 * len(ranks)):
        return Finding("pairing", Verdict.FOUND, f"{text}: chance gives 50%")
    return Finding("pairing", Verdict.FINE, text)


def registration(looks: Sequence[Look]) -> Finding:
    """Say whether the edges of depth lie on edges of the picture."""
    name = "registration"
    maps = [look.agreement for look in looks if look.agreement is not None]
    if not maps:
        return Finding(name, Verdict.UNJUDGED, "depth has too few edges")
    mean: NDArray[np.float64] = np.mean(maps, axis=0)
    score = (mean - np.median(mean)) / (mean.std() or 1.0)
    row, column = np.unravel_index(score.argmax(), score.shape)
    factor = reduction(looks[0].size[0])
    right, down = (int(place) - REACH for place in (column, row))
    best, here = float(score.max()), float(score[REACH, REACH])
    numbers = f"edges meet by {here:.1f} sigma as they lie, {best:.1f} at best ({len(maps)} pairs)"
    shift = max(abs(right), abs(down))
    if best >= 3.5 and shift * factor <= 3:
        return Finding(name, Verdict.FINE, numbers)
    if best >= 3.5 and best - here > 1 and shift < REACH:
        text = f"{numbers}: depth should move by {right * factor} px right, {down * factor} px down"
        return Finding(name, Verdict.FOUND, text)
    dense = np.median([look.known for look in looks]) > 0.5
    if here < 0.5 and dense and len(maps) >= 8:
        text = f"{numbers}: depth is not registered to the pictures, or not theirs"
        return Finding(name, Verdict.FOUND, text)
    return Finding(name, Verdict.UNJUDGED, numbers)


def focal(looks: Sequence[Look]) -> Finding:
    """Say whether flat things meet at right angles with the stated focal length."""
    name = "focal length"
    curves = [look.angles for look in looks if look.angles is not None]
    if len(curves) < 3:
        return Finding(name, Verdict.UNJUDGED, f"{len(curves)} pairs with enough flat surfaces")
    mean: NDArray[np.float64] = np.mean(curves, axis=0)
    each = [float(FACTORS[curve.argmax()]) for curve in curves]
    factor = float(np.median(each))
    low, high = np.quantile(each, [0.25, 0.75])
    clear = mean.max() > 1.4 * np.median(mean) and mean.max() > 0.06 and high / low < 1.25
    text = f"most right angles at {factor:.2f} times the stated one ({len(curves)} pairs)"
    if not clear:
        return Finding(name, Verdict.UNJUDGED, f"{text}, but not clearly")
    if abs(np.log(factor)) > np.log(1.15):
        return Finding(name, Verdict.FOUND, text)
    return Finding(name, Verdict.FINE, text)


def frame(looks: Sequence[Look]) -> Finding:
    """Say whether cameras can belong to images of their size."""
    name, cameras = "camera and size", [(look, look.camera) for look in looks if look.camera]
    if not cameras:
        return Finding(name, Verdict.UNJUDGED, "no camera is known")
    odd = []
    for look, camera in cameras:
        width, height = look.size
        aside = max(abs(camera.centre_x / width - 0.5), abs(camera.centre_y / height - 0.5))
        diagonals = camera.focal_in_diagonals(width, height)
        square = abs(np.log(camera.focal_x / camera.focal_y)) < np.log(1.1)
        if aside > 0.2 or not 0.2 < diagonals < 8 or not square:
            odd.append((look.name, aside, diagonals, camera.focal_x / camera.focal_y))
    if odd:
        _, aside, diagonals, stretch = odd[0]
        text = (
            f"{len(odd)} cameras do not fit: principal point {aside:.0%} of a side off the middle, "
            f"focal length {diagonals:.2f} diagonals, fx/fy {stretch:.2f}; of another size?"
        )
        return Finding(name, Verdict.FOUND, text, tuple(each[0] for each in odd))
    return Finding(name, Verdict.FINE, f"{len(cameras)} cameras look through their image's middle")


def saturation(looks: Sequence[Look]) -> Finding:
    """Say whether depth ends at one value that many pixels share."""
    filled = [look for look in looks if look.pixels]
    if len(filled) < 2:
        return Finding("saturation", Verdict.UNJUDGED, "wants two pairs with depth")
    limit = max(look.largest for look in filled)
    full = tuple(look.name for look in filled if look.largest == limit and look.at_largest > 0.005)
    if len(full) >= max(2, 0.2 * len(filled)):
        text = f"{len(full)} pairs end at {limit:.6g} with many pixels: cut off, or a code?"
        return Finding("saturation", Verdict.FOUND, text, full)
    return Finding(
        "saturation", Verdict.FINE, f"no value is where many end; the largest is {limit:.6g}"
    )


def steps(looks: Sequence[Look]) -> Finding:
    """Say whether depth is stored in few steps; disparity often is, as it is published."""
    spaces = (Space.METRIC, Space.SCALE)
    large = [look for look in looks if look.pixels > 5000 and look.space in spaces]
    if not large:
        return Finding("steps", Verdict.UNJUDGED, "wants depth, no disparity, in 5000 pixels")
    usual = float(np.median([look.levels for look in large]))
    text = f"half of the pairs hold at least {usual:.0f} different values"
    if usual < 100:
        return Finding("steps", Verdict.FOUND, f"{text}: whole metres, or 8 bits?")
    return Finding("steps", Verdict.FINE, text)
