import numpy as np
import pytest

from flexdepth.flow.along_lines import AlongLines
from flexdepth.runtime.depthmap import FocalSource, Intrinsics

CAMERA = Intrinsics.centred(160, 120, 140.0, FocalSource.GIVEN)
NOTHING = np.full((120, 160, 2), np.nan, np.float32)
RIGHT = np.eye(3), np.array([-1.0, 0.0, 0.0])
"""The camera goes to the right: what stands still goes left."""


@pytest.fixture
def frames(cut):
    """A sheet before a camera that goes to the right; it moves by 6 pixels, a nearer one by 14."""
    key, target = cut(), cut(right=6)
    key[40:80, 70:110] = cut(seed=5)[:40, :40]
    target[40:80, 56:96] = cut(seed=5)[:40, :40]
    return key, target


def test_what_stands_still_is_found_on_its_lines(frames):
    found = AlongLines(*frames, CAMERA)(*RIGHT, NOTHING)
    assert np.abs(found.flow[50:70, 80:100, 0] + 14).max() < 0.3
    assert np.abs(found.flow[90:115, 20:140, 0] + 6).max() < 0.3
    assert np.abs(found.flow[..., 1]).max() < 1e-5
    assert found.valid[90:115, 20:140].all()
    assert (np.isfinite(found.noise) == found.valid).all()


def test_what_the_nearer_sheet_hides_is_not_valid(frames):
    found = AlongLines(*frames, CAMERA)(*RIGHT, NOTHING)
    assert not found.valid[45:75, 63:67].any()  # It is seen at 57 to 61, behind the sheet.


def test_a_turn_is_no_parallax(frames):
    """A camera that has also turned sees the same in other places."""
    angle = 0.05
    turned = np.array(
        [[np.cos(angle), 0, np.sin(angle)], [0, 1, 0], [-np.sin(angle), 0, np.cos(angle)]]
    )
    found = AlongLines(*frames, CAMERA)(turned, -turned[:, 0], NOTHING)
    # Turned by .05, what is far goes right by 7 pixels or more: no depth explains 6 to the left.
    assert (found.flow[90:115, 40:120, 0] > -6.5).all()
    straight = AlongLines(frames[0], frames[0], CAMERA)(*RIGHT, NOTHING)
    assert np.abs(straight.flow[10:-10, 10:-10]).max() < 0.3


def test_other_flow_is_believed_where_it_looks_more_alike(frames, cut):
    key, target = frames
    key[5:30, 20:60] = cut(seed=7)[:25, :40]
    target[9:34, 25:65] = cut(seed=7)[:25, :40]  # It goes right and down by itself.
    true, wrong = NOTHING.copy(), NOTHING.copy()
    true[5:30, 20:60] = (5, 4)
    wrong[90:115, 20:140] = (5, 4)
    search = AlongLines(key, target, CAMERA)
    assert not search(*RIGHT, true).valid[10:25, 28:52].any()
    assert search(*RIGHT, wrong).valid[95:110, 30:130].all()


def test_of_places_on_the_line_that_look_alike_the_one_that_is_known_stays(cut):
    """Stripes that come again every 12 pixels have moved by 6, or by 18."""
    stripes = np.tile(cut()[:, :12], (1, 15))
    search = AlongLines(stripes[:, :160], stripes[:, 6:166], CAMERA)
    here, beside = (np.full_like(NOTHING, (-18, down)) for down in (0, 2))
    assert np.abs(search(*RIGHT, NOTHING).flow[45:75, 65:95, 0] + 6).max() < 0.3
    assert search(*RIGHT, NOTHING).valid[45:75, 65:95].all()
    assert not search(*RIGHT, here).valid[45:75, 65:95].any()
    assert search(*RIGHT, beside).valid[45:75, 65:95].all()
