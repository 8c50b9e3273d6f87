"""Screens, laptops and keyboards."""

import numpy as np
from numpy.random import Generator

from flexdepth.synth.materials import Material, Part, material, shown
from flexdepth.synth.parts import Parts
from flexdepth.synth.shapes import box, cushion, joined, quad


def screen(rng: Generator, width: float) -> Parts:
    """A monitor or a laptop, lit or dark."""
    height = rng.uniform(0.55, 0.7) * width
    shell = material(rng, "plastic")
    face = quad((width / 2 - 0.01, 0.09, -0.001), (0.02 - width, 0, 0), (0, height - 0.02, 0))
    if rng.random() < 0.6:
        lit = shown("display", (width - 0.02, height - 0.02), float(rng.uniform(0.2, 1.5)))
    else:
        lit = material(rng, "glass")
    body = joined(
        [
            box((0, height / 2 + 0.08, 0.012), (width, height, 0.02)),
            box((0, 0.04, 0.03), (0.04, 0.08, 0.03)),
            cushion((0, 0.006, 0), (0.45 * width, 0.012, 0.18), 0.3),
        ]
    )
    return [Part(body, shell), Part(face, lit)]


def laptop(rng: Generator) -> Parts:
    """An open laptop."""
    width, deep = rng.uniform((0.28, 0.2), (0.38, 0.26))
    lean = rng.uniform(0.1, 0.5)
    shell = material(rng, str(rng.choice(["metal", "plastic"])))
    up = np.array([0, deep * np.cos(lean), deep * np.sin(lean)])
    face = quad((width / 2 - 0.01, 0.018, deep / 2 - 0.003), (0.02 - width, 0, 0), 0.94 * up)
    lid = quad((width / 2, 0.012, deep / 2), (-width, 0, 0), up)
    keys = quad((0.45 * width, 0.0165, -0.1 * deep), (-0.9 * width, 0, 0), (0, 0, 0.5 * deep))
    lit = shown("display", (width, deep), float(rng.uniform(0.3, 1.5)))
    return [
        Part(box((0, 0.008, 0), (width, 0.016, deep)), shell),
        Part(lid, shell),
        Part(face, lit if rng.random() < 0.7 else material(rng, "glass")),
        Part(
            keys,
            Material(
                "keys", np.array([[0.02] * 3, [0.06] * 3, [0.3] * 3]), (0.9 * width, 0.5 * deep)
            ),
        ),
    ]


def keyboard(rng: Generator) -> Parts:
    """A keyboard, at times with a mouse."""
    width, deep = rng.uniform((0.3, 0.12), (0.45, 0.18))
    tone = rng.uniform(0.01, 0.6)
    look = Material(
        "keys", np.array([[tone] * 3, [tone * 0.6] * 3, [0.3] * 3]), (width, deep), 0, 0.03, 0.2
    )
    wedge = box((0, 0.012, 0), (width, 0.024, deep))
    parts = [Part(wedge, material(rng, "plastic"))]
    top = quad((width / 2, 0.0245, -deep / 2), (-width, 0, 0), (0, 0, deep))
    parts.append(Part(top, look))
    if rng.random() < 0.6:
        mouse = cushion((-width / 2 - 0.08, 0.016, 0), (0.06, 0.034, 0.1), 0.8)
        parts.append(Part(mouse, material(rng, "plastic")))
    return parts


def monitor(rng: Generator) -> Parts:
    """A screen of ordinary size."""
    return screen(rng, float(rng.uniform(0.3, 0.6)))
