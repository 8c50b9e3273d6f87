"""What surfaces of each kind look like: the tables that materials are drawn from."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Kind:
    """How surfaces of one kind differ.

    Attributes:
        patterns: Textures to choose from; twice what is seen often.
        spread: How far the three colours differ.
        span: Least and most size, metres.
        saturation: Of the strongest colours.
        bright: Least and most brightness.
        gloss: Least and most share of light that is mirrored.
        rough: Least and most roughness of the glossy ones.
        shiny: Share of surfaces that have a gloss at all.
        clear: Share of the light from behind that passes, times the colour.
    """

    patterns: tuple[str, ...]
    spread: float
    span: tuple[float, float]
    saturation: float = 0.6
    bright: tuple[float, float] = (0.04, 0.8)
    gloss: tuple[float, float] = (0.02, 0.06)
    rough: tuple[float, float] = (0.003, 0.05)
    shiny: float = 0.3
    clear: float = 0.0


_PICTURES = (
    "landscape", "interior", "facade", "still_life", "portrait", "petals", "painting", "tunnel",
    "photograph", "photograph",
)  # fmt: skip

KINDS: dict[str, Kind] = {
    "wall": Kind(
        ("plain",) * 6 + ("mottled", "mottled", "stripes", "bricks", "tiles", "wood", "weave"),
        0.15,
        (0.6, 2.5),
        0.35,
        (0.2, 0.9),
        shiny=0.1,
    ),
    "ceiling": Kind(
        ("plain", "plain", "mottled", "tiles"), 0.1, (0.8, 2.4), 0.12, (0.4, 0.9), shiny=0
    ),
    "floor": Kind(
        (
            "wood",
            "wood",
            "wood",
            "tiles",
            "tiles",
            "mottled",
            "speckled",
            "checks",
            "plain",
            "weave",
            "weave",
        ),
        0.4,
        (0.6, 2.5),
        0.4,
        (0.04, 0.6),
        (0.02, 0.08),
        (0.002, 0.03),
        0.6,
    ),
    "wood": Kind(("wood", "wood", "wood", "plain"), 0.35, (0.3, 1.2), 0.5, (0.03, 0.7), shiny=0.5),
    "fabric": Kind(
        (
            "plain",
            "plain",
            "mottled",
            "speckled",
            "stripes",
            "checks",
            "spots",
            "weave",
            "weave",
            "petals",
            "carpet",
        ),
        0.5,
        (0.1, 0.8),
        0.7,
        shiny=0.03,
    ),
    "leather": Kind(
        ("mottled", "plain"), 0.3, (0.2, 0.6), 0.5, (0.01, 0.3), rough=(0.1, 0.3), shiny=1
    ),
    "cabinet": Kind(
        ("panels", "panels", "plain", "wood", "doors", "doors"), 0.4, (0.8, 1.8), 0.5, shiny=0.5
    ),
    "thing": Kind(
        (
            "plain",
            "plain",
            "plain",
            "mottled",
            "stripes",
            "collage",
            "spots",
            "print_lines",
            "wood",
            "label",
            "label",
        ),
        0.7,
        (0.1, 0.6),
        0.9,
        (0.03, 0.85),
        shiny=0.5,
    ),
    "plastic": Kind(("plain",), 0.2, (0.3, 0.6), 1.0, (0.02, 0.85), (0.03, 0.06), (0.02, 0.15), 1),
    "packet": Kind(("label", "label", "label", "page", "collage", "photograph"), 0.8, (0.1, 0.3)),
    "paper": Kind(
        ("page", "page", "plain", "photograph", "print_lines"), 0.2, (0.2, 0.3), shiny=0.1
    ),
    "poster": Kind((*_PICTURES, "page", "label", "collage"), 1.2, (0.4, 1.6), shiny=0.2),
    "picture": Kind(_PICTURES, 1.0, (0.3, 1.0), gloss=(0.03, 0.05), rough=(0.0, 0.03), shiny=0.5),
    "rug": Kind(
        ("carpet", "carpet", "weave", "stripes", "checks", "tunnel", "petals", "spots", "mottled"),
        0.6,
        (0.4, 2.0),
        0.7,
        (0.02, 0.6),
        shiny=0,
    ),
    "metal": Kind(
        ("plain", "plain", "mottled"),
        0.2,
        (0.3, 1.0),
        0.2,
        (0.03, 0.5),
        (0.2, 0.7),
        (0.01, 0.08),
        0.8,
    ),
    "ceramic": Kind(
        ("plain", "plain", "plain", "stripes", "label", "spots"),
        0.3,
        (0.1, 0.3),
        0.7,
        (0.3, 0.9),
        (0.04, 0.06),
        (0.0, 0.05),
        1,
    ),
    "counter": Kind(
        ("plain", "speckled", "speckled", "mottled", "wood"),
        0.3,
        (0.3, 1.2),
        0.3,
        (0.01, 0.7),
        (0.03, 0.1),
        (0.002, 0.04),
        0.9,
    ),
    "splash": Kind(
        ("tiles", "tiles", "plain", "mottled", "bricks"),
        0.25,
        (0.3, 1.0),
        0.4,
        (0.15, 0.9),
        shiny=0.7,
    ),
    "mirror": Kind(("plain",), 0.05, (1.0, 1.0), 0.1, (0.01, 0.03), (0.8, 0.95), (0.0, 0.0), 1),
    "flask": Kind(
        ("plain",), 0.03, (0.3, 0.6), 0.8, (0.4, 0.97), (0.04, 0.06), (0.0, 0.004), 1, 0.96
    ),
    "facade": Kind(
        ("windows", "windows", "bricks", "mottled", "plain", "tiles"), 0.6, (2.0, 7.0), shiny=0
    ),
    "brickwork": Kind(("bricks", "mottled", "plain", "tiles"), 0.3, (0.8, 2.5), 0.4, shiny=0),
    "bare": Kind(
        ("mottled", "mottled", "bricks", "bricks", "speckled", "wood"),
        0.5,
        (0.8, 2.5),
        0.3,
        (0.05, 0.7),
        shiny=0.1,
    ),
}
"""What things that are made by people are made of."""


@dataclass(frozen=True)
class Nature:
    """What has its own colour.

    Textures, mean albedo, sizes in metres, gloss, roughness, waves, share of light that passes.
    """

    patterns: tuple[str, ...]
    base: tuple[float, float, float]
    span: tuple[float, float]
    gloss: float = 0.0
    rough: float = 0.0
    ripple: float = 0.0
    clear: float = 0.0


NATURE: dict[str, Nature] = {
    "asphalt": Nature(("speckled", "mottled"), (0.13, 0.13, 0.14), (1.0, 4.0)),
    "pavement": Nature(("tiles", "bricks", "speckled", "pebbles"), (0.3, 0.28, 0.26), (0.8, 3.0)),
    "grass": Nature(("turf", "turf", "speckled", "foliage"), (0.12, 0.2, 0.05), (0.5, 4.0)),
    "leaf": Nature(("foliage", "foliage", "speckled", "mottled"), (0.08, 0.16, 0.04), (0.3, 1.5)),
    "bark": Nature(("mottled", "wood"), (0.14, 0.1, 0.07), (0.3, 1.0)),
    "skin": Nature(("plain",), (0.5, 0.33, 0.25), (0.3, 0.6)),
    "roof": Nature(("tiles", "bricks", "stripes"), (0.25, 0.12, 0.09), (1.0, 3.0)),
    "glass": Nature(("mottled", "plain"), (0.03, 0.035, 0.04), (1.0, 3.0), 0.1, 0.002),
    "pane": Nature(("plain",), (0.93, 0.96, 0.94), (1.0, 3.0), 0.05, 0.0, clear=0.97),
    "smoked": Nature(("plain",), (0.5, 0.54, 0.52), (1.0, 3.0), 0.06, 0.0, clear=0.97),
    "drink": Nature(("plain",), (0.3, 0.1, 0.04), (0.1, 0.2), 0.04, 0.003),
    "paint": Nature(("plain", "speckled"), (0.75, 0.75, 0.72), (0.5, 2.0)),
    "tyre": Nature(("plain",), (0.02, 0.02, 0.02), (0.3, 0.5)),
    "card": Nature(("plain", "mottled", "label"), (0.42, 0.28, 0.16), (0.3, 0.8)),
    "coffee": Nature(("plain",), (0.03, 0.012, 0.006), (0.1, 0.2), 0.04, 0.005),
    "food": Nature(("speckled", "mottled", "spots"), (0.4, 0.22, 0.1), (0.04, 0.2)),
    "water": Nature(("plain",), (0.03, 0.05, 0.05), (0.3, 0.6), 0.05, 0.02),
    "soil": Nature(("pebbles", "mottled", "speckled", "spots"), (0.16, 0.11, 0.075), (0.6, 4.0)),
    "sand": Nature(("mottled", "speckled", "plain"), (0.45, 0.36, 0.24), (0.6, 4.0)),
    "gravel": Nature(("pebbles", "pebbles", "speckled"), (0.3, 0.28, 0.25), (0.3, 1.5)),
    "snow": Nature(("plain", "mottled"), (0.82, 0.84, 0.88), (1.0, 5.0)),
    "rock": Nature(("pebbles", "mottled", "mottled", "speckled"), (0.25, 0.23, 0.21), (0.8, 6.0)),
    "straw": Nature(("turf", "turf", "wood", "speckled"), (0.42, 0.3, 0.11), (0.3, 2.0)),
    "wood far": Nature(("foliage", "foliage", "speckled"), (0.05, 0.09, 0.035), (8.0, 40.0)),
    "autumn": Nature(("foliage", "foliage", "speckled"), (0.3, 0.14, 0.03), (0.3, 1.5)),
    "blossom": Nature(("foliage", "speckled"), (0.6, 0.4, 0.45), (0.3, 1.0)),
    "lake": Nature(("mottled", "plain"), (0.02, 0.045, 0.05), (3.0, 12.0), 0.03, 0.0, 0.03),
}
"""What things of nature and of the street are made of."""
