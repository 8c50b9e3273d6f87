import hashlib

import numpy as np
import pytest

from flexdepth.runtime.depthmap import Space
from flexdepth.runtime.errors import InputError
from flexdepth.runtime.files import read_depth
from flexdepth.runtime.images import read_photo
from flexdepth.synth.generate import SynthSettings, rendered, write_images
from flexdepth.synth.rooms import cellar, cookery, home, office, shop
from flexdepth.synth.streets import street

SMALL = SynthSettings(seed=3, width=64, height=48)


def digests(folder):
    files = sorted(path for path in folder.rglob("*") if path.is_file())
    return {p.relative_to(folder): hashlib.sha256(p.read_bytes()).hexdigest() for p in files}


@pytest.fixture(scope="module")
def written(tmp_path_factory):
    folder = tmp_path_factory.mktemp("synth")
    assert list(write_images(SMALL, 6, folder, 1)) == [4, 6]
    return folder


def test_two_runs_give_the_same_bytes_whatever_the_number_of_processes(written, tmp_path):
    list(write_images(SMALL, 6, tmp_path, 2))
    assert digests(tmp_path) == digests(written)
    assert len(digests(written)) == 13


def test_an_interrupted_run_goes_on(written, tmp_path):
    list(write_images(SMALL, 3, tmp_path, 1))
    kept = tmp_path / "image" / "000001.jpg"
    before = kept.stat().st_mtime_ns
    list(write_images(SMALL, 6, tmp_path, 1))
    assert kept.stat().st_mtime_ns == before
    assert digests(tmp_path) == digests(written)


def test_images_of_two_worlds_do_not_mix(tmp_path):
    list(write_images(SMALL, 1, tmp_path, 1))
    with pytest.raises(InputError, match=r"world\.json: the images here are of another world"):
        list(write_images(SynthSettings(4, 64, 48), 1, tmp_path, 1))


def test_a_file_in_the_place_of_the_folder_is_refused(tmp_path):
    (tmp_path / "file").touch()
    with pytest.raises(InputError, match=r"world\.json: cannot be written"):
        list(write_images(SMALL, 1, tmp_path / "file", 1))


def test_the_depth_file_says_metres_and_camera(written):
    depth_map = read_depth(written / "depth" / "000002.npz")
    photo = read_photo(written / "image" / "000002.jpg")
    assert depth_map.space is Space.METRIC
    assert photo.pixels.shape == (48, 64, 3)
    assert depth_map.values.shape == (48, 64)
    assert (depth_map.intrinsics.centre_x, depth_map.intrinsics.centre_y) == (32, 24)
    assert depth_map.values[depth_map.valid].min() > 0


def test_other_numbers_and_seeds_are_other_images():
    first = rendered(SMALL, 0)[1]
    assert not np.array_equal(first, rendered(SMALL, 1)[1])
    assert not np.array_equal(first, rendered(SynthSettings(4, 64, 48), 0)[1])


def test_streets_have_sky_and_rooms_do_not():
    outside, _ = rendered(SynthSettings(0, 64, 48, outdoor_share=1.0), 0)
    inside, _ = rendered(SynthSettings(0, 64, 48, outdoor_share=0.0), 0)
    assert np.isinf(outside.depth).any()
    assert np.isfinite(inside.depth).all()
    assert inside.depth.max() < 20


@pytest.mark.parametrize("make", [home, office, cookery, shop, cellar, street])
def test_many_scenes_can_be_built_and_are_finite(make):
    for number in range(6):
        scene = make(np.random.default_rng([7, number]))
        assert all(np.isfinite(part.mesh.corners).all() for part in scene.parts)
        assert (scene.eyes[0] <= scene.eyes[1]).all()


def test_a_world_that_cannot_be_rendered_is_refused():
    with pytest.raises(InputError, match="width and height >= 32"):
        SynthSettings(width=8)
