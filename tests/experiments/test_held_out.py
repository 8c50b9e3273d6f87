from dataclasses import replace
from pathlib import Path

import pytest

from flexdepth.data import Folder, Kitti, NyuLabelled
from flexdepth.data.read import Split
from flexdepth.experiments.catalogue import CATALOGUE
from flexdepth.experiments.held_out import with_own_held_out

MINE = Path("mine")


def elsewhere(name):
    first = CATALOGUE[name]
    return with_own_held_out(first, replace(first, data=replace(first.data, root=MINE)))


def test_of_a_folder_of_ones_own_a_tenth_is_held_out():
    found = elsewhere("compact")
    assert (found.data, found.held_out) == (Folder(MINE, "first"), Folder(MINE, "last"))


def test_of_a_published_set_its_own_split_is_held_out():
    assert elsewhere("nyu-small").held_out == NyuLabelled(MINE, Split.TEST)
    found = elsewhere("kitti").held_out
    assert isinstance(found, Kitti)
    assert (found.root, found.frames) == (MINE, CATALOGUE["kitti"].held_out.frames)


@pytest.mark.parametrize("name", CATALOGUE)
def test_what_is_said_is_done(name):
    first = CATALOGUE[name]
    assert with_own_held_out(first, first) == first
    both = replace(first, data=Folder(MINE), held_out=Folder(Path("others")))
    assert with_own_held_out(first, both) == both


def test_data_of_another_kind_leaves_what_is_held_out_alone():
    first = CATALOGUE["kitti"]
    other = replace(first, data=Folder(MINE))
    assert with_own_held_out(first, other) == other
