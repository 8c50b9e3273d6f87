import json
from dataclasses import replace

import numpy as np
import pytest
import trimesh
from PIL import Image

from flexdepth.flow.matches import Agreement
from flexdepth.runtime.depthmap import Space
from flexdepth.runtime.errors import InputError
from flexdepth.runtime.files import read_depth
from flexdepth.scenes.files import all_made, products, write_solution
from flexdepth.scenes.space import cloud
from flexdepth.solvers.two_frame import Unknown

ORIGIN = {"key": "sha256:1", "objective": "dense"}
WANTED = products(["glb", "ply"])
NAMES = {
    "depth.npz",
    "motion.npz",
    "solution.npz",
    "moving.png",
    "borders.png",
    "motion.png",
    "solution.png",
    "cloud.glb",
    "cloud.ply",
    "solution.json",
}


@pytest.fixture
def folder(solution, tmp_path):
    write_solution(solution, WANTED, tmp_path, ORIGIN)
    return tmp_path


def test_every_file_is_there_and_says_what_it_was_made_from(folder):
    assert {path.name for path in folder.iterdir()} == NAMES
    for product in WANTED:
        assert product.origin(folder / product.name) == ORIGIN
    assert all_made(WANTED, folder, ORIGIN, overwrite=False)
    assert not all_made(WANTED, folder, ORIGIN, overwrite=True)


@pytest.mark.parametrize("name", sorted(NAMES))
def test_a_file_of_other_settings_is_not_replaced_unasked(name, folder):
    other = {**ORIGIN, "objective": "regions"}
    for path in folder.iterdir():
        if path.name != name:
            path.unlink()
    with pytest.raises(InputError, match=f"{name}: is there already"):
        all_made(WANTED, folder, other, overwrite=False)
    assert not all_made(WANTED, folder, other, overwrite=True)


@pytest.mark.parametrize("name", sorted(NAMES))
def test_somebody_elses_file_is_not_replaced_unasked(name, tmp_path):
    (tmp_path / name).write_text("{}")
    with pytest.raises(InputError, match=f"{name}: is there already"):
        all_made(WANTED, tmp_path, ORIGIN, overwrite=False)


def test_depth_is_the_projects_own(folder, found):
    depth = read_depth(folder / "depth.npz")
    assert depth.space is Space.SCALE
    np.testing.assert_array_equal(depth.values, found.depth.astype(np.float32))


def test_metres_are_said_only_where_they_are_known(solution, tmp_path):
    metric = replace(solution, found=replace(solution.found, metric=True))
    write_solution(metric, WANTED, tmp_path, ORIGIN)
    assert read_depth(tmp_path / "depth.npz").space is Space.METRIC
    assert json.loads((tmp_path / "solution.json").read_text())["unit"] == "m"


def test_maps_hold_what_was_found(folder, found):
    with np.load(folder / "motion.npz") as motion:
        np.testing.assert_array_equal(motion["translation"], found.translation.astype(np.float32))
        assert motion["rotation"].shape == (36, 48, 3)
    with np.load(folder / "solution.npz") as maps:
        np.testing.assert_array_equal(maps["label"], found.labels)
        np.testing.assert_array_equal(maps["valid"], found.unknown == 0)
        assert maps["confidence"][15, 10] == np.float32(0.75)
        assert maps["confidence"][0, 0] == 1
        names = set(maps) - {"origin"}
    said = json.loads((folder / "solution.json").read_text())
    assert names == set(said["arrays"]["solution.npz"]) - {"prior_share"}


def test_the_record_says_how_things_move(folder):
    said = json.loads((folder / "solution.json").read_text())
    assert said["camera"]["convention"] == "opencv"
    assert said["camera"]["centre_x"] == 23.5
    assert said["camera_motion"]["position"] == [1, 0, 0]
    assert said["regions"][1]["scale_from"] == "contact"
    assert said["share_by_reason"]["sky"] == pytest.approx(8 / 48, abs=1e-6)
    assert said["unit"] == "the camera's way"


def test_the_record_says_how_far_the_flow_is_borne_out(folder, solution, tmp_path):
    said = json.loads((folder / "solution.json").read_text())
    assert said["akaze"] == {"matches": 40, "agree_with_flow": 0.9}
    nothing = replace(solution, borne_out=Agreement(0, float("nan")))
    write_solution(nothing, WANTED, tmp_path / "other", ORIGIN)
    said = json.loads((tmp_path / "other" / "solution.json").read_text())
    assert said["akaze"] == {"matches": 0, "agree_with_flow": None}


def test_the_record_says_what_the_prior_has_a_part_in(folder, solution, found, tmp_path):
    said = json.loads((folder / "solution.json").read_text())
    assert (said["prior"], said["prior_tells"]) == (None, None)
    prior = replace(solution.depth, model="seer 1.0")
    shares = np.where(found.unknown == Unknown.SKY, 1.0, 0.0)
    asked = replace(solution, prior=prior, found=replace(found, prior_share=shares))
    write_solution(asked, WANTED, tmp_path / "other", ORIGIN)
    said = json.loads((tmp_path / "other" / "solution.json").read_text())
    assert (said["prior"], said["prior_tells"]) == ("seer 1.0", "sky")


def test_the_mask_is_a_picture_that_scripts_can_read(folder, found):
    mask = np.asarray(Image.open(folder / "moving.png").convert("L"))
    np.testing.assert_array_equal(mask > 127, found.moving)


def test_the_cloud_has_points_and_arrows(folder, solution):
    shown = cloud(solution)
    known = solution.depth.valid.sum()
    assert len(shown.cloud.positions) == pytest.approx(known, rel=0.1)
    scene = trimesh.load(folder / "cloud.glb")
    kinds = {type(each).__name__ for each in scene.geometry.values()}
    assert kinds == {"PointCloud", "Trimesh"}
    ply = trimesh.load(folder / "cloud.ply", process=False)
    assert len(ply.vertices) == len(shown.cloud.positions) + len(shown.drawn.positions)
    assert len(ply.faces) == len(shown.drawn.triangles)


def test_arrows_show_own_motion_true_to_scale(solution):
    # The square lies at 3 and moves by -.5 along y; the camera's way is the other arrow.
    drawn = cloud(solution).drawn.positions
    per = 16
    tips, tails = drawn[per - 1 :: per], drawn[::per]
    ways = tips - drawn.reshape(-1, per, 3)[:, :5].mean(1)
    assert len(tails) > 10
    np.testing.assert_allclose(ways[:-1], np.tile([0, -0.5, 0], (len(ways) - 1, 1)), atol=1e-5)
    np.testing.assert_allclose(ways[-1], [1, 0, 0], atol=1e-5)


def test_without_any_depth_there_is_no_cloud(solution, found, tmp_path):
    nothing = replace(found, depth=np.full_like(found.depth, np.nan))
    made = write_solution(replace(solution, found=nothing), WANTED, tmp_path, ORIGIN)
    assert {path.name for path in made} == NAMES - {"cloud.glb", "cloud.ply"}
