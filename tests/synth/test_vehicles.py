from dataclasses import replace

import numpy as np
import pytest

from flexdepth.synth import open_places, placing, solids, streets
from flexdepth.synth.bystanders import seated, sitter
from flexdepth.synth.correspondence import Camera
from flexdepth.synth.courses import Course
from flexdepth.synth.head_lights import head_lights
from flexdepth.synth.motion import Footing
from flexdepth.synth.parts import bounds, placed
from flexdepth.synth.placing import Surroundings
from flexdepth.synth.skies import weather
from flexdepth.synth.stage import Stage
from flexdepth.synth.vehicles import bus, car, lorry
from flexdepth.synth.viewpoints import viewpoint


def glowing(parts, red):
    """Return what shines in the red of tail lamps, or in any other colour."""
    colours = [(part, part.material.colours[0]) for part in parts if part.material.glow]
    return [part for part, (r, g, b) in colours if (r > 30 * g and g == b) == red]


@pytest.mark.parametrize("make", [car, bus, lorry])
@pytest.mark.parametrize("seed", range(3))
def test_lit_vehicles_shine_white_ahead_and_red_behind(make, seed):
    lit, dark = (make(np.random.default_rng(seed), on) for on in (True, False))
    heads, tails = glowing(lit, red=False), glowing(lit, red=True)
    middle = np.mean(bounds(lit), 0)[2]
    assert bounds(tails)[0][2] > middle
    assert min(bounds([head])[1][2] for head in heads) < middle
    assert max(head.material.glow for head in heads) > 5
    # The sign of a bus shines at any hour.
    assert not glowing(dark, red=True)
    assert len(glowing(dark, red=False)) == (make is bus)


@pytest.mark.parametrize("dark", [True, False])
@pytest.mark.parametrize("place", [streets, open_places])
def test_cars_have_their_lamps_on_in_the_dark_only(monkeypatch, place, dark):
    monkeypatch.setattr(place, "weather", lambda rng: replace(weather(rng), dark=dark))
    make = streets.street if place is streets else open_places.car_park
    scenes = [make(np.random.default_rng(seed)) for seed in range(3)]
    tails = [len(glowing(scene.parts, red=True)) for scene in scenes]
    assert (max(tails) > 0) == dark
    assert [len(scene.spots) for scene in scenes] == tails
    assert all(scene.dark == dark for scene in scenes)


@pytest.mark.parametrize("make", [car, bus, lorry])
def test_head_lamps_throw_their_light_ahead_of_the_car_and_down_on_the_road(make):
    at, yaw = (3.0, 0.0, -5.0), 0.7
    driven = make(np.random.default_rng(1), True)
    (spot,) = head_lights(driven, at, yaw)
    # Turning by yaw takes z towards x, and a car drives towards -z.
    way = np.array([-np.sin(yaw), 0, -np.cos(yaw)])
    nose = max(float((part.mesh.corners @ way).max()) for part in placed(driven, at, yaw))
    assert 0 < spot.place @ way - nose < 0.1
    # Nothing of a car is beside its middle plane.
    assert np.cross(way, spot.place - at)[1] == pytest.approx(0, abs=1e-6)
    assert 0.5 < spot.place[1] < 1.0
    assert np.linalg.norm(spot.ahead) == pytest.approx(1)
    met = spot.place - spot.place[1] / spot.ahead[1] * spot.ahead
    assert 5 < (met - spot.place) @ way < 12


def test_lamps_that_are_off_throw_no_light():
    assert head_lights(bus(np.random.default_rng(0), False), (0, 0, 0), 0.0) == ()


@pytest.mark.parametrize("dark", [True, False])
def test_cars_among_the_movers_have_their_lamps_on_in_the_dark_only(library, dark):
    rng = np.random.default_rng(0)
    stage = Stage.built(rng, replace(streets.street(rng), dark=dark), library)
    around, times = Surroundings.of(stage), np.array([0.0])
    movers = []
    for _ in range(10):
        camera = Camera(viewpoint(rng, stage.scene, 4 / 3), 300.0, 320, 240)
        put = placing.placed(rng, around, camera, (False, Footing.SEEN, 0.05), times)
        movers += [put.mover] if put and put.mover.kind.name == "car" else []
    assert movers
    for mover in movers:
        assert (max(look.glow for look in mover.body.looks) > 5) == dark


def test_a_car_with_its_lamps_off_has_the_shape_and_the_paint_of_the_same_with_them_on():
    course = Course(np.zeros(3), 0.3, 5.0, 0.0)
    on = solids.car(np.random.default_rng(2), course)
    off = solids.unlit(on)
    for before, after in zip(on.parts, off.parts, strict=True):
        assert after.mesh is before.mesh
        if before.material.glow:
            assert after.material.glow == 0
            assert after.material.colours.max() <= 0.55
        else:
            assert after.material is before.material


def test_windows_show_seats_where_they_are_clear():
    many = [car(np.random.default_rng(seed), False) for seed in range(20)]
    clear = [any(part.material.clear for part in one) for one in many]
    assert 0.5 < np.mean(clear) < 1
    counts = {flag: {len(one) for one, c in zip(many, clear, strict=True) if c == flag}
              for flag in (True, False)}  # fmt: skip
    assert min(counts[True]) > max(counts[False])


@pytest.mark.parametrize("seed", range(8))
def test_who_is_seated_has_the_hips_on_the_seat_and_the_feet_on_the_ground(seed):
    somebody = seated(np.random.default_rng(seed), 0.45)
    trousers, *_, shoes = somebody
    low, high = bounds([shoes])
    assert low[1] == pytest.approx(0, abs=0.005)
    assert high[2] < -0.15
    behind = trousers.mesh.corners[trousers.mesh.corners[..., 2] > -0.1]
    assert behind[:, 1].min() == pytest.approx(0.45, abs=0.06)
    assert bounds(somebody)[1][1] < 1.55


@pytest.mark.parametrize("seed", range(8))
def test_who_sits_on_a_chair_is_above_it(seed):
    assert bounds(sitter(np.random.default_rng(seed)))[1][1] > 1.0
