"""What the tables train is what the dissertation's captions say."""

import pytest
import torch

from flexdepth.evaluation.metrics import METRICS
from flexdepth.experiments.ablations import changed
from flexdepth.experiments.catalogue import CATALOGUE
from flexdepth.experiments.published_tables import TABLES
from flexdepth.networks import EDRB


@pytest.mark.parametrize("number", TABLES)
def test_every_row_of_a_table_has_a_number_for_every_column(number):
    table = TABLES[number]
    assert set(table.metrics) <= METRICS.keys()
    assert {len(row.published) for row in table.rows} == {len(table.metrics)}
    assert len({row.name for row in table.rows}) == len(table.rows)


@pytest.mark.parametrize("number", TABLES)
def test_the_rows_of_a_table_are_different_experiments(number):
    table = TABLES[number]
    base = CATALOGUE[table.experiment]
    varied = [changed(base, row.changes) for row in table.rows]
    assert all(one != other for i, one in enumerate(varied) for other in varied[:i])


def test_l2_is_in_the_rows_that_the_captions_name():
    with_l2 = {
        (table.number, row.name)
        for table in TABLES.values()
        for row in table.rows
        if "squared" in changed(CATALOGUE[table.experiment], row.changes).terms
    }
    assert with_l2 == {
        *(("3.1", name) for name in ("EDRB", "AGA")),
        *((number, "AGA") for number in ("3.2", "3.3")),
        *(("3.4", name) for name in ("S4", "S7")),
        *(("3.5", name) for name in ("S7", "DS7", "NS7")),
    }


def test_rows_with_and_without_l2_have_the_same_network():
    base = CATALOGUE["nyu-small"]
    rows = {row.name: changed(base, row.changes).network for row in TABLES["3.4"].rows}
    assert rows["S2"] == rows["S4"]
    assert rows["S6"] == rows["S7"] == base.network
    assert len({str(network) for network in rows.values()}) == 5


def test_the_edrb_row_is_of_133_million_parameters_with_the_bins_of_the_base():
    """133,638,806 with 150 bins; each of the 50 bins less takes away 9 * 256 + 1."""
    edrb = next(row for row in TABLES["3.1"].rows if row.name == "EDRB")
    network = changed(CATALOGUE["kitti"], edrb.changes).network
    assert isinstance(network, EDRB)
    with torch.device("meta"):
        built = network.build()
    assert sum(p.numel() for p in built.parameters()) == 133_638_806 - 50 * (9 * 256 + 1)
