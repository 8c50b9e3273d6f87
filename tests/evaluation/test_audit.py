import json
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import pytest

from flexdepth.data.kitti import Kitti
from flexdepth.data.nyu import NyuDepth, NyuLabelled
from flexdepth.data.read import Split
from flexdepth.evaluation.alignment import Alignment
from flexdepth.evaluation.audit import LINKS, METRICS, audit
from flexdepth.evaluation.catalogue import PROTOCOLS
from flexdepth.evaluation.protocols import ScoringProtocol
from flexdepth.evaluation.report import plain_fields
from flexdepth.runtime.depthmap import Space
from flexdepth.runtime.errors import InputError


@dataclass(frozen=True)
class Anything:
    """The settings of a set that has no protocol of its own."""

    root: Path = Path()


def silent(_done):
    pass


@pytest.fixture(scope="module")
def road(pair, shelf):
    """One image of KITTI, whose depth grows upwards."""
    rows = np.linspace(60, 5, 375)
    return shelf(pair("road_1", np.repeat(rows[:, None], 1242, 1)))


@pytest.fixture(scope="module")
def said(road, metric, shelf):
    """A prediction that is 10 % too far below Garg's crop and the truth elsewhere, times 3."""

    def make(space):
        values = road[0].truth.values.copy()
        values[371:] *= 1.1
        return shelf(metric(values * (3 if space is Space.SCALE else 1), space))

    return make


@pytest.fixture(scope="module")
def found(road, said):
    """The audit of metric depth."""
    return audit(Kitti(), lambda _settings: road, said(Space.METRIC), silent)


def test_the_same_predictions_are_scored_by_every_protocol_of_the_set(found):
    names = [row.protocol.name for row in found.rows]
    assert names[:2] == ["kitti-eigen-garg-bts", "kitti-eigen-garg-adabins"]
    assert {"kitti-monodepth2-benchmark", "kitti-vnl", "metric", "affine-disparity"} <= set(names)
    assert not found.refused
    # Only Garg's crop of the whole image ends above the rows that are wrong.
    errors = {row.protocol.name: row.results["abs_rel"].value for row in found.rows}
    assert errors["kitti-eigen-garg-bts"] == pytest.approx(0, abs=1e-6)
    assert errors["kitti-eigen-garg-adabins"] == pytest.approx(0.1 * 1 / 206, rel=1e-4)
    assert errors["metric"] == pytest.approx(0.1 * 4 / 375, rel=1e-4)


def test_the_links_of_a_chain_add_up_to_the_difference(found):
    first = found.rows[0].results["abs_rel"].value
    assert found.rows[0].chain == ()
    for row in found.rows[1:]:
        apart = row.results["abs_rel"].value - first
        assert sum(link.change for link in row.chain) == pytest.approx(apart, abs=1e-12)


def test_a_link_names_what_makes_the_difference(found):
    (improved,) = (row for row in found.rows if row.protocol.name == "kitti-improved")
    links = {link.name: link for link in improved.chain}
    assert links["region"].change == pytest.approx(0.1 * 4 / 375, rel=1e-4)
    assert links["region"].after == "whole image"
    assert links["range"].change == 0
    assert links["clipping"].after == "not clipped, the unknown refused"


def test_a_fit_that_is_too_weak_is_replaced_and_said(pair, metric, shelf):
    room, prediction = pair("room", [[1, 2]]), metric([[3, 6]], Space.SCALE)
    found = audit(Anything(), lambda _settings: shelf(room), shelf(prediction), silent)
    fits = {row.protocol.name: (row.protocol.alignment, row.replaced) for row in found.rows}
    assert fits["metric"] == (Alignment.MEDIAN, Alignment.NONE)
    assert fits["scale"] == (Alignment.MEDIAN, None)
    assert found.rows[0].results["abs_rel"].value == pytest.approx(0, abs=1e-7)


def test_a_protocol_that_cannot_be_applied_is_told_with_its_reason(road, said, shelf):
    holes = said(Space.METRIC)[0].values.copy()
    holes[:30] = np.nan
    found = audit(
        Kitti(), lambda _s: road, shelf(replace(said(Space.METRIC)[0], values=holes)), silent
    )
    # Garg's crop lies below the holes; where the whole image counts they are refused.
    assert "kitti-eigen-garg-bts" in [row.protocol.name for row in found.rows]
    assert "has no depth > 0 at 37260 of" in found.refused["metric"]


def test_each_protocol_is_given_the_truth_that_it_is_for(pair, metric, shelf):
    asked = []

    def load(settings):
        asked.append((settings.split, settings.depth))
        return shelf(pair("room_1", np.full((480, 640), 2.0)))

    said = shelf(metric(np.full((480, 640), 2.0)))
    found = audit(NyuLabelled(), load, said, silent)
    assert (Split.TEST, NyuDepth.FILLED) in asked
    assert (Split.TEST, NyuDepth.RAW) in asked
    assert {split for split, _ in asked} == {Split.TEST}
    (vnl,) = (row for row in found.rows if row.protocol.name == "nyu-vnl")
    assert vnl.chain[0].name == "truth"
    assert vnl.chain[0].after == "split test, depth depths"


def test_everything_goes_into_json(road, said):
    found = audit(Anything(), lambda _settings: road, said(Space.METRIC), silent)
    assert [row.protocol.name for row in found.rows] == [
        "metric",
        "scale",
        "affine-depth",
        "affine-disparity",
    ]
    record = json.loads(json.dumps(plain_fields(found), allow_nan=False))
    assert record["rows"][0]["results"]["silog_half"]["value"] >= 0


def test_an_empty_set_is_refused(said, shelf):
    with pytest.raises(InputError, match="the set is empty"):
        audit(Anything(), lambda _settings: shelf(), said(Space.METRIC), silent)


def test_every_choice_of_a_protocol_is_in_some_link():
    """A new field of a protocol that no link changes would be a difference without a name."""
    words = {"name", "version", "summary", "source", "sets", "images", "metrics"}
    named = {name for names in LINKS.values() for name in names}
    assert named | words == set(ScoringProtocol.__dataclass_fields__)
    assert set(PROTOCOLS["metric"].metrics) <= set(METRICS)
