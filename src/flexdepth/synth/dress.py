"""What people wear."""

from dataclasses import dataclass

from numpy.random import Generator

from flexdepth.synth.materials import Material, material


@dataclass(frozen=True, eq=False)
class Dress:
    """What somebody wears, and hair.

    Attributes:
        trousers: Of legs and pelvis.
        shirt: Of chest and upper arms.
        sleeve: Share of the arm that the shirt covers.
        leg: Share of the leg that the trousers cover.
        hem: Height at which a skirt or coat ends, a share of the body's height; 0 is none.
        hair: Of the hair; skin where there is none.
        nape: Height down to which the hair falls, a share of the body's height.
        skin: Of face, hands and what is bare.
        shoes: Of the shoes.
        loose: How much wider than the body the clothes are.
    """

    trousers: Material
    shirt: Material
    sleeve: float
    leg: float
    hem: float
    hair: Material
    nape: float
    skin: Material
    shoes: Material
    loose: float

    @classmethod
    def drawn(cls, rng: Generator) -> "Dress":
        """Return random clothes."""
        flesh = material(rng, "skin")
        return cls(
            trousers=material(rng, "fabric"),
            shirt=material(rng, "fabric"),
            sleeve=float(rng.choice([0.4, 1.0, 1.0])),
            leg=float(rng.choice([0.45, 1.0, 1.0, 1.0])),
            hem=float(rng.uniform(0.22, 0.4)) if rng.random() < 0.25 else 0.0,
            hair=flesh if rng.random() < 0.1 else material(rng, "bark"),
            nape=float(rng.choice([0.9, 0.885, 0.8])),
            skin=flesh,
            shoes=material(rng, str(rng.choice(["tyre", "fabric", "wood"]))),
            loose=float(rng.uniform(1.0, 1.2)),
        )
