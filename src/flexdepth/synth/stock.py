"""A few individuals of a kind, seen again and again: what fills a scene without costing time."""

from numpy.random import Generator

from flexdepth.synth.parts import Maker, Parts


def stocked(make: Maker, count: int) -> Maker:
    """Return a maker whose things are copies of at most `count` different ones."""
    made: list[Parts] = []

    def one(rng: Generator) -> Parts:
        number = int(rng.integers(count))
        if number < len(made):
            return made[number]
        made.append(make(rng))
        return made[-1]

    return one
