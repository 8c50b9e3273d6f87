import numpy as np
import pytest

from flexdepth.evaluation.predictions import ModelPredictions, Stated, prediction_folder
from flexdepth.evaluation.region import WHOLE, KittiCrop
from flexdepth.runtime.depthmap import Space
from flexdepth.runtime.errors import InputError
from flexdepth.runtime.files import write_depth
from flexdepth.runtime.model import load_model
from flexdepth.runtime.predictor import Predictor


@pytest.fixture
def folder(tmp_path, metric):
    """Predictions of the images `a` and `b_2` by name, beside files that are none."""
    place = tmp_path / "found"
    write_depth(place / "a.npz", metric([[1, 2]]))
    write_depth(place / "b" / "2.exr", metric([[3, 4]], Space.SCALE))
    (place / "a.preview.png").write_bytes(b"")
    (place / "notes.txt").write_text("")
    return place


def test_files_belong_to_images_by_name_in_any_folder_and_format(folder, pair):
    found = prediction_folder(folder)
    first = found.of(pair("a", [[1, 1]]), 0, WHOLE)
    np.testing.assert_array_equal(first.values, [[1, 2]])
    second = found.of(pair("b_2", [[1, 1]]), 1, WHOLE)
    assert second.space is Space.SCALE
    np.testing.assert_array_equal(second.values, [[3, 4]])


def test_an_image_without_a_prediction_is_named(folder, pair):
    with pytest.raises(InputError, match="no prediction for the image c; looked for c"):
        prediction_folder(folder).of(pair("c", [[1, 1]]), 0, WHOLE)


def test_files_belong_to_images_by_order_where_that_is_said(folder, pair):
    found = prediction_folder(folder, None, 2)
    np.testing.assert_array_equal(found.of(pair("x", [[1, 1]]), 1, WHOLE).values, [[3, 4]])
    assert found.about["matched"] == "by order"
    with pytest.raises(InputError, match="holds 2 depth files, the set 3 images"):
        prediction_folder(folder, None, 3)


def test_numbers_that_do_not_say_what_they_mean_are_what_the_user_says(tmp_path, pair):
    np.save(tmp_path / "a.npy", np.array([[1000, 0, 2500]], np.uint16))
    with pytest.raises(InputError, match="does not say what its numbers mean"):
        prediction_folder(tmp_path).of(pair("a", [[1, 1, 1]]), 0, WHOLE)
    stated = prediction_folder(tmp_path, Stated(Space.METRIC, 0.001))
    found = stated.of(pair("a", [[1, 1, 1]]), 0, WHOLE)
    np.testing.assert_allclose(found.values, [[1, np.nan, 2.5]])
    assert stated.about["stated"] == {"space": "metric", "scale": 0.001}


def test_two_files_of_one_image_are_refused(folder, metric):
    write_depth(folder / "a.pfm", metric([[1, 2]]))
    with pytest.raises(InputError, match=r"a.npz is a prediction of a too; keep one"):
        prediction_folder(folder)


def test_a_folder_that_is_missing_or_holds_no_depth_is_refused(tmp_path):
    with pytest.raises(InputError, match="no such folder"):
        prediction_folder(tmp_path / "nowhere")
    with pytest.raises(InputError, match="holds no depth file"):
        prediction_folder(tmp_path)


@pytest.fixture
def model(tmp_path, make_bundle):
    return ModelPredictions(Predictor(load_model(make_bundle())), tmp_path / "predictions")


def test_a_model_predicts_metres_by_the_camera_of_the_set(model, pair):
    room = pair("room", np.ones((32, 32)))
    found = model.of(room, 0, WHOLE)
    assert found.space is Space.METRIC
    # The network says 1 + 128/255 for half the diagonal of a 4:3 image of the same area.
    # The set's focal length is the side of the square: √12 / 5 of it.
    np.testing.assert_allclose(found.values, (1 + 128 / 255) * 2 * 12**0.5 / 5, rtol=1e-5)


def test_what_has_been_predicted_is_not_predicted_again(model, pair):
    room = pair("room", np.ones((32, 32)))
    model.of(room, 0, WHOLE)
    (path,) = model.cache.rglob("*.npz")
    before = path.stat().st_mtime_ns
    model.of(room, 0, WHOLE)
    assert path.stat().st_mtime_ns == before


def test_a_prediction_of_other_pixels_is_not_taken_for_this_one(model, pair):
    room = pair("room", np.ones((32, 32)))
    model.of(room, 0, WHOLE)
    room.image[0, 0] = 7
    with pytest.raises(InputError, match="was not made from this input"):
        model.of(room, 0, WHOLE)
    again = ModelPredictions(model.predictor, model.cache, overwrite=True)
    assert again.of(room, 0, WHOLE).values[0, 0] < 2


def test_the_parts_of_an_image_that_networks_see_are_kept_apart(model, pair):
    road = pair("road", np.ones((375, 1242)))
    assert model.of(road, 0, KittiCrop()).values.shape == (352, 1216)
    assert model.of(road, 0, WHOLE).values.shape == (375, 1242)
    assert len(list(model.cache.rglob("road.npz"))) == 2


def test_the_focal_length_is_kept_when_a_part_is_cut_out(model, pair):
    road = pair("road", np.ones((375, 1242)))
    found = [model.of(road, 0, view).values[0, 0] for view in (WHOLE, KittiCrop())]
    assert found[0] == pytest.approx(found[1] * (352 * 1216 / (375 * 1242)) ** 0.5, rel=1e-5)


def test_predictions_that_lie_a_folder_deeper_are_pointed_at(model, pair):
    room = pair("room", np.ones((32, 32)))
    model.of(room, 0, WHOLE)
    above = prediction_folder(model.cache)
    with pytest.raises(InputError, match=r"predictions/whole/room\.npz: name the folder .*whole\)"):
        above.of(room, 0, WHOLE)
