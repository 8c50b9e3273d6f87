import io

import numpy as np
import pytest
from PIL import Image
from tensorboard.backend.event_processing.event_accumulator import EventAccumulator
from torch.utils.tensorboard import SummaryWriter

from flexdepth.training.curves import Curves


@pytest.fixture
def said():
    return []


def found(folder):
    events = EventAccumulator(str(folder))
    events.Reload()
    return events


def test_curves_are_found_by_tensorboard(tmp_path, said):
    curves = Curves(tmp_path, 0, said.append)
    curves.draw(50, {"rate": 0.5, "term/silog": 2.0})
    curves.draw(100, {"rate": 0.25})
    events = found(tmp_path)
    assert [(e.step, e.value) for e in events.Scalars("rate")] == [(50, 0.5), (100, 0.25)]
    assert [(e.step, e.value) for e in events.Scalars("term/silog")] == [(50, 2.0)]
    assert said == []


def test_pictures_are_found_by_tensorboard(tmp_path, said):
    pixels = np.random.default_rng(0).integers(0, 255, (6, 8, 3), np.uint8)
    Curves(tmp_path, 0, said.append).paint(50, {"a": pixels})
    (event,) = found(tmp_path).Images("a")
    assert event.step == 50
    with Image.open(io.BytesIO(event.encoded_image_string)) as picture:
        assert (np.asarray(picture) == pixels).all()


def test_what_an_interrupted_run_drew_beyond_its_checkpoint_is_hidden(tmp_path, said):
    first = Curves(tmp_path, 0, said.append)
    for step in (50, 100, 150):
        first.draw(step, {"rate": 1.0})
    Curves(tmp_path, 100, said.append).draw(150, {"rate": 2.0})
    values = [(event.step, event.value) for event in found(tmp_path).Scalars("rate")]
    assert values == [(50, 1.0), (100, 1.0), (150, 2.0)]


def test_a_run_that_draws_nothing_leaves_nothing(tmp_path, said):
    Curves(tmp_path / "tensorboard", 0, said.append)
    assert not (tmp_path / "tensorboard").exists()


def test_where_curves_cannot_be_written_a_run_says_so_once_and_goes_on(tmp_path, said):
    (tmp_path / "tensorboard").write_text("in the way")
    curves = Curves(tmp_path / "tensorboard", 0, said.append)
    for step in (50, 100):
        curves.draw(step, {"rate": 1.0})
        curves.paint(step, {"a": np.zeros((2, 2, 3), np.uint8)})
    assert len(said) == 1
    assert "no more curves and pictures" in said[0]


def test_a_disk_that_fills_up_does_not_stop_a_run(tmp_path, said, monkeypatch):
    curves = Curves(tmp_path, 0, said.append)
    curves.draw(50, {"rate": 1.0})

    def full(_writer):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(SummaryWriter, "flush", full)
    for step in (100, 150):
        curves.draw(step, {"rate": 1.0})
    assert len(said) == 1
    assert said[0].endswith("No space left on device")
