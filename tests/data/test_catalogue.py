import pickle
import re
from dataclasses import fields, is_dataclass
from importlib import import_module
from pathlib import Path
from pkgutil import iter_modules

import pytest

import flexdepth.data
from flexdepth.data.catalogue import DATASETS
from flexdepth.runtime.errors import InputError


def settings_in_the_room():
    for module in iter_modules(flexdepth.data.__path__, "flexdepth.data."):
        for each in vars(import_module(module.name)).values():
            own = isinstance(each, type) and each.__module__ == module.name
            if own and is_dataclass(each) and callable(getattr(each, "load", None)):
                yield each


def test_every_set_has_a_name():
    assert set(settings_in_the_room()) == set(DATASETS.values())
    assert len(set(DATASETS.values())) == len(DATASETS)


def test_the_page_on_data_sets_has_a_row_for_each():
    page = (Path(__file__).parents[2] / "docs" / "datasets.md").read_text()
    rows = re.findall(r"^\| `([a-z0-9-]+)` \|", page, re.MULTILINE)
    assert sorted(rows) == sorted(DATASETS)


@pytest.mark.parametrize("name", DATASETS)
def test_a_set_that_is_not_there_is_told_with_the_place_that_was_looked_at(name, tmp_path):
    with pytest.raises(InputError, match=str(tmp_path / "nowhere")):
        DATASETS[name](root=tmp_path / "nowhere").load()


@pytest.mark.parametrize("name", DATASETS)
def test_settings_are_frozen_have_defaults_and_travel_between_processes(name):
    settings = DATASETS[name]()
    assert pickle.loads(pickle.dumps(settings)) == settings
    assert fields(settings)[0].name == "root"
    assert type(settings).__dataclass_params__.frozen
