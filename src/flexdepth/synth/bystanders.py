"""People and animals caught in mid-step or seated, for pictures in which nothing moves."""

from dataclasses import replace

import numpy as np
from numpy.random import Generator

from flexdepth.synth.animals import CAT, COW, DOG, HORSE, Beast, Bird
from flexdepth.synth.courses import Course
from flexdepth.synth.materials import Part
from flexdepth.synth.movers import Body
from flexdepth.synth.parts import Parts, chosen
from flexdepth.synth.people import Person, Pose
from flexdepth.synth.seating import chair, office_chair, slatted

_SEAT = 0.06
"""Height of the hips above what one sits on, a share of the body's height."""


def bystander(rng: Generator) -> Parts:
    """Somebody who walks or stands, turned towards z."""
    course = _course(float(rng.choice([0.0, rng.uniform(0.5, 1.7)])))
    return _caught(rng, Person.drawn(rng, course, 0.0), course)


def seated(rng: Generator, seat: float) -> Parts:
    """Somebody who sits on a seat of that height above the origin, the feet at -z."""
    course = Course(np.zeros(3), np.pi, 0.0, 0.0)
    body = Person.drawn(rng, course, 0.0)
    # The feet of the small would not reach the ground.
    height = max(body.height, 1.5)
    pose = Pose(seat / height + _SEAT, 0.24, float(rng.uniform(0.9, 1.5)))
    dress = replace(body.dress, hem=0.0)
    return _caught(rng, replace(body, height=height, pose=pose, dress=dress), course)


def sitter(rng: Generator) -> Parts:
    """Somebody who sits on a chair."""
    seat = chosen(rng, (chair, chair, slatted, office_chair))
    front = seat[0].mesh.corners[seat[0].mesh.corners[..., 2] < 0]
    return seat + seated(rng, float(front[:, 1].max()))


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
