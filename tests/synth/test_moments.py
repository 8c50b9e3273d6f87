import numpy as np
import pytest

from flexdepth.synth.correspondence import Camera
from flexdepth.synth.shapes import blob, box, quad
from flexdepth.synth.viewpoints import Viewpoint, looking

VIEW = Viewpoint(np.array([0.1, 1.5, 0.2]), looking(0.2, -0.3, 0.1), 0.7)
CAMERA = Camera(VIEW, 70.0, 80, 60)
GROUND = quad((-500, 0, -500), (1000, 0, 0), (0, 0, 1000))


def seen(moment):
    return moment.sight(VIEW, CAMERA.rays(CAMERA.pixels()))


def test_the_depth_of_a_plane_is_exact_in_double_precision(play):
    sight = seen(play([GROUND]).at(0.0))
    down = sight.rays @ VIEW.world_from_camera[1]
    hit = np.isfinite(sight.depth)
    assert hit.mean() > 0.5
    assert sight.depth[hit] == pytest.approx(-1.5 / down[hit], rel=1e-13)
    assert (down[hit] < 0).all()


def test_a_seen_point_is_the_mean_of_its_corners_by_their_weights(play):
    thing = blob(np.random.default_rng(0), (2, 2, 2), 0.1).placed((0, 1, 4))
    moment = play([GROUND], [(thing, (0, 0, 0))]).at(0.0)
    sight = seen(moment)
    hit = sight.triangle >= 0
    corners = moment.corners(sight.triangle[hit])
    mean = (sight.weights[hit, :, None] * corners).sum(1)
    ray = VIEW.eye + sight.depth[hit, None] * (sight.rays[hit] @ VIEW.world_from_camera.T)
    assert mean == pytest.approx(ray, abs=1e-9)
    assert (sight.triangle >= len(GROUND.corners)).mean() > 0.02


def test_what_moves_is_seen_as_if_it_were_part_of_the_scene(play):
    thing = box((0, 0.5, 3), (0.8, 1, 0.8))
    apart = seen(play([GROUND], [(thing, (0, 0, 0))]).at(0.0))
    whole = seen(play([GROUND, thing]).at(0.0))
    assert (apart.triangle == whole.triangle).all()
    assert apart.depth == pytest.approx(whole.depth, rel=1e-12)


@pytest.mark.parametrize("query", ["DISTANCE", "OCCLUDED"])
def test_shadow_rays_meet_both_what_is_still_and_what_moves(play, query):
    thing = box((0, 0.5, 3), (0.8, 1, 0.8))
    apart = play([GROUND], [(thing, (0, 0, 0))]).at(0.0).stage.tracer
    whole = play([GROUND, thing]).at(0.0).stage.tracer
    rng = np.random.default_rng(0)
    start = rng.uniform((-2, 0.1, 1), (2, 2, 5), (500, 3)).astype(np.float32)
    way = rng.normal(size=(500, 3)).astype(np.float32)
    one, other = (tracer.run(start, way, query=query) for tracer in (apart, whole))
    if query == "OCCLUDED":
        one, other = one < 0, other < 0
        assert 0.1 < one.mean() < 0.9
    assert one == pytest.approx(other)


def test_what_moves_is_elsewhere_at_another_time(play):
    thing = box((0, 0.5, 3), (0.8, 1, 0.8))
    filmed = play([GROUND], [(thing, (0.5, 0, 0))])
    assert filmed.at(2.0).moving - filmed.at(0.0).moving == pytest.approx(
        np.broadcast_to((1.0, 0, 0), thing.corners.shape)
    )
    assert (seen(filmed.at(2.0)).triangle != seen(filmed.at(0.0)).triangle).any()
