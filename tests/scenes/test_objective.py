import numpy as np
import pytest

from flexdepth.runtime.depthmap import FocalSource, Intrinsics
from flexdepth.scenes import objective
from flexdepth.scenes.objective import Objective, solved
from flexdepth.solvers import first_order
from flexdepth.solvers.dissertation import Form
from flexdepth.solvers.two_frame import Seen

CAMERA = Intrinsics(70.0, 70.0, 40.0, 32.0, FocalSource.GIVEN)


@pytest.fixture
def seen():
    return Seen(np.zeros((64, 80, 2), np.float32), np.full((64, 80), 0.1, np.float32), CAMERA)


@pytest.fixture
def frames():
    rng = np.random.default_rng(0)
    return [rng.integers(0, 255, (64, 80, 3)).astype(np.uint8) for _ in range(2)]


@pytest.mark.parametrize(
    ("chosen", "form"),
    [(Objective.DISSERTATION, Form.AS_WRITTEN), (Objective.CORRECTED, Form.CORRECTED)],
)
def test_chapter_5_is_given_matches_and_frames_in_gray(chosen, form, seen, frames, monkeypatch):
    asked = []
    monkeypatch.setattr(first_order, "first_order", lambda *given: asked.append(given))
    solved(chosen, seen, *frames)
    ((of, settings, clues),) = asked
    assert of is seen
    assert settings.form is form
    assert len(clues.key) == len(clues.target)
    assert [frame.shape for frame in clues.frames] == [(64, 80)] * 2


@pytest.mark.parametrize(("chosen", "dense"), [(Objective.DENSE, True), (Objective.REGIONS, False)])
def test_regions_alone_leave_the_refinement_out(chosen, dense, seen, frames, monkeypatch):
    asked = []
    monkeypatch.setattr(objective, "two_frame", lambda *given: asked.append(given))
    solved(chosen, seen, *frames)
    ((of, settings),) = asked
    assert of is seen
    assert (settings.dense is not None) is dense
