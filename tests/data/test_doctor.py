import numpy as np
import pytest

from flexdepth.data.doctor import as_pair, checkup, contact_sheet, spread_out
from flexdepth.data.folder import Pair
from flexdepth.data.verdicts import Verdict
from flexdepth.runtime.depthmap import DepthMap, Space
from flexdepth.runtime.errors import InputError


class Broken:
    """Rooms of which some cannot be read."""

    def __init__(self, rooms, bad):
        self.rooms, self.bad = rooms, bad

    def __len__(self):
        return len(self.rooms)

    def __getitem__(self, index):
        if index in self.bad:
            raise InputError(f"{index}.png: cannot be read")
        return self.rooms[index]


def test_a_sample_is_spread_evenly_from_the_first_to_the_last():
    assert spread_out(3, 8) == [0, 1, 2]
    assert spread_out(101, 3) == [0, 50, 100]
    assert spread_out(7, 1) == [0]


def test_only_so_many_pairs_are_looked_at_and_the_watcher_hears_of_each(rooms, model):
    heard = []
    result = checkup(rooms, model, 3, heard.append)
    assert (result.total, result.looked_at, heard) == (10, 3, [1, 2, 3])


def test_a_file_that_cannot_be_read_is_named_and_the_rest_is_looked_at(rooms, model):
    result = checkup(Broken(rooms, {2}), model, 24)
    (files,) = (finding for finding in result.found if finding.check == "files")
    assert files.text == "1 pairs cannot be read; 2.png: cannot be read"
    assert result.looked_at == 9


def test_a_set_of_which_nothing_can_be_read_is_refused(rooms, model):
    with pytest.raises(InputError, match=r"no pair can be read: 0\.png: cannot be read"):
        checkup(Broken(rooms, set(range(10))), model, 24)
    with pytest.raises(InputError, match="no pair can be read: the set is empty"):
        checkup((), model, 24)


def test_a_set_without_depth_maps_is_refused():
    with pytest.raises(InputError, match="this set holds str and no images with depth maps"):
        as_pair("flow")


def test_pairs_that_show_something_come_first_on_the_sheet(rooms, model):
    empty = DepthMap(np.full_like(rooms[9].truth.values, np.nan), Space.METRIC)
    last = Pair(rooms[9].name, rooms[9].image, empty)
    result = checkup((*rooms[:9], last), model, 24)
    assert 9 in result.shown
    assert len(result.shown) == 8
    clean = checkup(rooms, model, 24)
    assert all(finding.verdict is not Verdict.FOUND for finding in clean.findings)
    assert (clean.shown[0], clean.shown[-1]) == (0, 9)


def test_the_sheet_has_a_row_for_each_pair_with_edges_in_red(rooms):
    one, two = contact_sheet(rooms, [0]), contact_sheet(rooms, [0, 1])
    assert one.dtype == np.uint8
    assert two.shape[0] == 2 * one.shape[0]
    assert two.shape[1:] == one.shape[1:]
    red = (one == (255, 40, 40)).all(axis=2)
    assert 200 < red.sum() < 20_000


def test_sparse_depth_is_laid_on_the_picture_in_colours(rooms):
    pair = rooms[0]
    values = np.full_like(pair.truth.values, np.nan)
    values[::8, ::8] = pair.truth.values[::8, ::8]
    sheet = contact_sheet([Pair("a", pair.image, DepthMap(values, Space.METRIC))], [0])
    assert not (sheet == (255, 40, 40)).all(axis=2).any()
    picture, laid = sheet[40:300, :480], sheet[40:300, 485:965]
    in_colour = (np.ptp(laid.astype(int), axis=2) > 60).mean()
    assert in_colour > 0.01
    assert picture.shape == laid.shape
