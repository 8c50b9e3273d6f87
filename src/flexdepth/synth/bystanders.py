"""People and animals caught in mid-step, for pictures in which nothing moves."""

import numpy as np
from numpy.random import Generator

from flexdepth.synth.animals import CAT, COW, DOG, HORSE, Beast, Bird
from flexdepth.synth.courses import Course
from flexdepth.synth.furniture import Parts
from flexdepth.synth.materials import Part
from flexdepth.synth.movers import Body
from flexdepth.synth.people import Person


def bystander(rng: Generator) -> Parts:
    """Somebody who walks or stands, turned towards z."""
    course = _course(float(rng.choice([0.0, rng.uniform(0.5, 1.7)])))
    return _caught(rng, Person.drawn(rng, course, 0.0), course)


def animal(rng: Generator) -> Parts:
    """A cat, a dog, a horse or a cow, turned towards z."""
    course = _course(float(rng.uniform(0.4, 1.4)))
    build = (CAT, DOG, DOG, HORSE, COW)[int(rng.integers(5))]
    return _caught(rng, Beast.drawn(rng, build, course), course)


def pet(rng: Generator) -> Parts:
    """A cat or a dog, turned towards z."""
    course = _course(float(rng.uniform(0.4, 1.4)))
    return _caught(rng, Beast.drawn(rng, (CAT, DOG)[int(rng.integers(2))], course), course)


def bird(rng: Generator) -> Parts:
    """A bird in the air."""
    course = _course(1.0)
    return _caught(rng, Bird.drawn(rng, course), course)


def _course(speed: float) -> Course:
    return Course(np.zeros(3), 0.0, speed, 0.0)


def _caught(rng: Generator, body: Body, course: Course) -> Parts:
    time = float(rng.uniform(0, 3))
    back = -course.place(time)
    return [
        Part(mesh.placed(back), look)
        for mesh, look in zip(body.meshes(time), body.looks, strict=True)
    ]
