import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import torch
from safetensors.torch import save_file
from torch import nn

from flexdepth.data.folder import Pair
from flexdepth.networks.compact import Compact
from flexdepth.runtime.depthmap import DepthMap, FocalSource, Intrinsics, Space
from flexdepth.runtime.errors import InputError
from flexdepth.runtime.images import Photo
from flexdepth.sample import Prediction
from flexdepth.training.processes import ALONE

HEIGHT, WIDTH = 24, 32


class TwoEverywhere(nn.Module):
    """Say the canonical depth 2 of every pixel, and remember what was shown."""

    settings = Compact(canonical_focal=0.8)

    def forward(self, image):
        self.shown = image
        return Prediction(depth=torch.full_like(image[:, 0], 2.0), canonical_focal=0.8)


def test_a_photo_is_seen_at_the_size_that_was_learnt_at_and_its_lens_makes_metres(room):
    network = TwoEverywhere()
    predict = room("judges").looking(network, (160, 128), ALONE)
    pixels = np.full((480, 640, 3), 51, np.uint8)
    said = predict(Photo(pixels, 0.4, ()))
    assert network.shown.shape == (1, 3, 128, 160)
    assert network.shown.unique().tolist() == pytest.approx([0.2])
    assert said.space is Space.METRIC
    # Half of the canonical focal length: half as far.
    np.testing.assert_allclose(said.values, np.ones((480, 640)), rtol=1e-6)
    assert predict(Photo(pixels, None, ())).space is Space.SCALE


class Wall:
    """A picture of a tilted wall, which may have a camera."""

    def __init__(self, known=True):
        camera = Intrinsics.centred(WIDTH, HEIGHT, 30.0, FocalSource.GIVEN) if known else None
        metres = np.tile(np.linspace(1, 3, WIDTH, dtype=np.float32), (HEIGHT, 1))
        image = np.zeros((HEIGHT, WIDTH, 3), np.uint8)
        self.pair = Pair("wall", image, DepthMap(metres, Space.METRIC, camera))

    def read(self):
        return self.pair


def twice(photo):
    """Predict the wall twice as far."""
    known = photo.focal_in_diagonals is not None
    truth = Wall().pair.truth
    return replace(truth, values=2 * truth.values, space=Space.METRIC if known else Space.SCALE)


def test_photos_are_scored_after_a_fit_and_as_metres_where_the_camera_is_known(room):
    judges, fit = room("judges"), room("scores").Fit
    sample_set = room("samples").SampleSet("walls", 10.0, lambda _folder: ())
    errors = judges.on_set(twice, sample_set, [Wall(), Wall()])
    assert errors[fit.DISPARITY] == pytest.approx(0, abs=1e-6)
    assert errors[fit.METRES] == pytest.approx(1.0)
    unknown = judges.on_set(twice, sample_set, [Wall(known=False)])
    assert unknown.keys() == {fit.DISPARITY}


def test_sets_count_the_same_and_those_without_metres_are_not_in_their_mean(room, monkeypatch):
    judges, fit = room("judges"), room("scores").Fit
    sets = [
        room("samples").SampleSet(name, 10.0, lambda _folder, name=name: [name] * 5)
        for name in ("near", "far", "unknown", "not chosen on")
    ]
    said = {
        "near": {fit.DISPARITY: 0.1, fit.METRES: 0.2},
        "far": {fit.DISPARITY: 0.2, fit.METRES: 0.6},
        "unknown": {fit.DISPARITY: 0.6},
    }
    frames = {}

    def on_set(_predict, sample_set, files):
        frames[sample_set.name] = len(files)
        return said[sample_set.name]

    monkeypatch.setattr(judges, "SETS", sets)
    monkeypatch.setattr(judges, "CHOSEN_ON", {"near": 1, "far": 2, "unknown": 5})
    monkeypatch.setattr(judges, "on_set", on_set)
    means = judges.on_photos(twice, Path())
    assert means == pytest.approx({fit.DISPARITY: 0.3, fit.METRES: 0.4})
    assert frames == {"near": 5, "far": 3, "unknown": 1}


def test_the_sets_that_choices_are_made_on_exist_and_no_bar_is_set_by_their_frames(room):
    names = {each.name for each in room("samples").SETS}
    assert set(room("judges").CHOSEN_ON) < names
    assert "NYU" not in room("judges").CHOSEN_ON


def written(room, folder, name):
    """Write the first weights of a variant, and return them."""
    variants = room("variants")
    weights = variants.network_of(variants.VARIANTS[name]).state_dict()
    save_file(weights, folder / f"{name}.safetensors")
    return weights


def test_kept_weights_come_back_whatever_their_spread(room, tmp_path):
    stored = written(room, tmp_path, "again")
    path = tmp_path / "again.safetensors"
    older = {k: v for k, v in stored.items() if not k.startswith("spread.")}
    save_file({**older, "spread.look.weight": torch.zeros(3)}, path)
    network = room("choices").kept("again", tmp_path)
    for name, value in network.state_dict().items():
        assert torch.equal(value, stored[name])


def test_weights_that_are_missing_or_of_another_variant_are_refused(room, tmp_path):
    choices = room("choices")
    with pytest.raises(InputError, match="no such file"):
        choices.kept("compact", tmp_path)
    written(room, tmp_path, "addition")
    (tmp_path / "addition.safetensors").rename(tmp_path / "compact.safetensors")
    with pytest.raises(InputError, match="not of the variant compact"):
        choices.kept("compact", tmp_path)


@pytest.mark.parametrize("given", [("--data",), ("--weights",), ("--weights", "-o")])
def test_who_names_nothing_to_judge_by_is_told_so(room, tmp_path, monkeypatch, capsys, given):
    words = [word for flag in given for word in (flag, str(tmp_path))]
    monkeypatch.setattr("sys.argv", ["choices.py", *words])
    with pytest.raises(SystemExit) as left:
        room("choices").main()
    assert left.value.code == 2
    assert "nothing to judge by" in capsys.readouterr().err


def test_kept_weights_are_judged_without_training(room, tmp_path, monkeypatch, capsys):
    choices = room("choices")
    written(room, tmp_path, "compact")
    fit = room("scores").Fit
    monkeypatch.setattr(
        room("judges"), "on_photos", lambda *_: {fit.DISPARITY: 0.12345, fit.METRES: 0.5}
    )
    command = ["choices.py", "--weights", str(tmp_path), "--samples", "photos", "--only", "compact"]
    monkeypatch.setattr("sys.argv", command)
    choices.main()
    assert json.loads(capsys.readouterr().out) == {
        "variant": "compact",
        "averaged": {"photos, fitted in disparity": 0.1235, "photos, metres, nothing fitted": 0.5},
    }
