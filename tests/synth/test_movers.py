import numpy as np
import pytest

from flexdepth.synth.courses import Course
from flexdepth.synth.movers import KINDS, Ground, kinds
from flexdepth.synth.people import Person
from flexdepth.synth.solids import rolling

TIMES = (0.0, 0.13, 0.4, 2.7)
LEVEL = 0.12


def body(kind, seed=0, turning=0.2):
    rng = np.random.default_rng([seed, 5])
    speed = float(np.mean(kind.speed))
    return kind.make(rng, Course(np.array([3.0, LEVEL, -2.0]), 0.6, speed, turning))


def points(thing, time):
    return np.concatenate([mesh.corners.reshape(-1, 3) for mesh in thing.meshes(time)])


def residual(before, after):
    """Return the metres that remain after the best rotation and translation (Kabsch)."""
    a, b = before - before.mean(0), after - after.mean(0)
    u, _, v = np.linalg.svd(a.T @ b)
    flip = np.diag([1, 1, np.linalg.det(u @ v)])
    return np.abs(a @ (u @ flip @ v) - b).max()


@pytest.mark.parametrize("kind", KINDS, ids=lambda kind: kind.name)
def test_every_mover_keeps_its_triangles_and_its_materials(kind):
    thing = body(kind)
    counts = [[len(mesh.corners) for mesh in thing.meshes(time)] for time in TIMES]
    assert counts == [counts[0]] * len(TIMES)
    assert len(thing.looks) == len(counts[0])
    assert all(np.isfinite(points(thing, time)).all() for time in TIMES)


@pytest.mark.parametrize("kind", KINDS, ids=lambda kind: kind.name)
def test_rigid_movers_stay_rigid_and_flexible_ones_bend(kind):
    thing = body(kind)
    bent = max(residual(points(thing, 0.0), points(thing, time)) for time in TIMES[1:])
    assert bent > 0.01 if kind.flexible else bent < 1e-9


@pytest.mark.parametrize("kind", KINDS, ids=lambda kind: kind.name)
@pytest.mark.parametrize("seed", range(3))
def test_what_stands_touches_the_ground_and_what_does_not_is_in_the_air(kind, seed):
    thing = body(kind, seed)
    if kind.name == "flag":
        cloth = thing.meshes(0.0)[0].corners[..., 1].min()
        assert cloth > LEVEL + 0.3
        return
    lowest = points(thing, 0.0)[:, 1].min() - LEVEL
    assert -0.04 < lowest < 0.02 if kind.stands else lowest > 0.08


@pytest.mark.parametrize("kind", KINDS, ids=lambda kind: kind.name)
def test_what_has_a_speed_goes_that_far(kind):
    thing = body(kind, turning=0.0)
    gone = points(thing, 2.0).mean(0) - points(thing, 0.0).mean(0)
    speed = float(np.mean(kind.speed))
    assert np.hypot(gone[0], gone[2]) == pytest.approx(2 * speed, abs=0.25)


@pytest.mark.parametrize("name", ["car", "rolling ball", "pushed thing"])
def test_rigid_things_on_the_ground_stay_on_it(name):
    (kind,) = (each for each in KINDS if each.name == name)
    for seed in range(6):
        thing = body(kind, seed)
        heights = [points(thing, time)[:, 1].min() for time in TIMES]
        assert heights == pytest.approx([heights[0]] * len(TIMES), abs=0.005)


def test_plants_sway_the_more_the_higher_and_keep_their_roots():
    (kind,) = (each for each in KINDS if each.name == "tree or bush")
    for seed in range(3):
        thing = body(kind, seed)
        here, there = points(thing, 0.0), points(thing, 0.3)
        shift, height = np.linalg.norm(there - here, axis=1), here[:, 1] - LEVEL
        quarter = height.max() / 4
        assert shift[height <= 0].max(initial=0) < 1e-12
        assert shift[height > 3 * quarter].mean() > 2 * shift[height < quarter].mean()


def test_the_sole_of_a_walker_does_not_slide():
    walker = Person.drawn(np.random.default_rng(1), Course(np.zeros(3), 0.4, 1.3, 0.25), 0.0)
    start, end = (share * walker.gait.duty * walker.gait.period for share in (0.15, 0.5))
    shoes = [walker.meshes(time)[-1].corners for time in np.linspace(start, end, 4)]
    left = len(shoes[0]) // 2
    for shoe in shoes[1:]:
        assert shoe[:left] == pytest.approx(shoes[0][:left], abs=1e-12)
        assert np.abs(shoe[left:] - shoes[0][left:]).max() > 0.03


def test_a_walker_has_one_foot_on_the_ground_at_any_time():
    walker = Person.drawn(np.random.default_rng(1), Course(np.zeros(3), 0.4, 1.3, 0.0), 0.0)
    for time in np.linspace(0, 2, 17):
        assert points(walker, time)[:, 1].min() == pytest.approx(0, abs=0.005)
        assert points(walker, time)[:, 1].max() == pytest.approx(walker.height, abs=0.1)


def test_a_ball_rolls_its_circumference_in_one_turn():
    ball = rolling(np.random.default_rng(0), Course(np.zeros(3), 0.3, 1.1, 0.2))
    turn = 2 * np.pi * ball.height / 1.1
    here, there = ball.meshes(0.0)[0].corners, ball.meshes(turn)[0].corners
    gone = ball.course.place(turn)
    assert np.linalg.norm(gone) == pytest.approx(2 * np.pi * ball.height)
    assert there - gone == pytest.approx(here, abs=1e-9)
    lowest = here.reshape(-1, 3)[here[..., 1].argmin()]
    soon = ball.meshes(1e-4)[0].corners.reshape(-1, 3)[here[..., 1].argmin()]
    assert np.linalg.norm(soon - lowest) < 0.2 * 1.1e-4


def test_kinds_are_chosen_by_what_is_asked_for():
    indoors = kinds(False, True, (Ground.FLOOR,))
    assert {kind.name for kind, _ in indoors} == {"rolling ball", "pushed thing"}
    assert all(ground is Ground.FLOOR for _, ground in indoors)
    for flexible in (False, True):
        for stands in (False, True):
            assert kinds(flexible, stands, (Ground.OPEN,))
