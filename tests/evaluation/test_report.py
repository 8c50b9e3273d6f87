import json
from dataclasses import replace
from pathlib import Path

import pytest

from flexdepth.data.folder import Folder
from flexdepth.evaluation.catalogue import PROTOCOLS
from flexdepth.evaluation.evaluate import evaluate
from flexdepth.evaluation.report import (
    Report,
    check_comparable,
    check_place,
    plain,
    read_report,
    remarks,
    write_report,
)
from flexdepth.runtime.errors import InputError

ABOUT = {"folder": "p"}
DATA = Folder(Path("rooms"))


@pytest.fixture
def report(pair, metric, shelf):
    pairs = shelf(pair("a", [[1, 2]]), pair("käfer, b", [[2, 4]]), pair("dark", [[0, 0]]))
    said = shelf(metric([[2, 2]]), metric([[2, 4]]), metric([[1, 1]]))
    found = evaluate(pairs, said, PROTOCOLS["metric"], lambda _done: None)
    return Report(found, "folder", DATA, ABOUT, ("mind",), ("flexdepth", "evaluate"), 1.25)


def test_a_result_comes_back_as_it_was(report, tmp_path):
    write_report(tmp_path, report)
    for place in (tmp_path, tmp_path / "result.json"):
        found = read_report(place)
        assert found.images == {each.name: each.values for each in report.evaluation.scores}
        assert found.record["results"]["abs_rel"]["value"] == pytest.approx(0.25)
        assert found.record["protocol"]["name"] == "metric"


def test_a_result_says_all_it_takes_to_repeat_it(report):
    record = report.record()
    assert record["dataset"]["settings"] == {
        "_type": "Folder",
        "root": "rooms",
        "part": "all",
    }
    assert record["dataset"]["truth"].startswith("sha256:")
    assert record["predictions"] == {"folder": "p", "sizes": {"2x1 metric": 3}}
    assert record["protocol"]["scored"]["farthest"] == 80.0
    assert record["protocol"]["version"] == 1
    assert record["left_out"] == [
        {"name": "dark", "reason": "no pixel has truth where the protocol scores"}
    ]
    assert record["command"] == ["flexdepth", "evaluate"]
    assert record["intervals"] == {"confidence": 0.95, "resamples": 2000, "seed": 0}
    assert record["remarks"] == ["mind"]
    assert {"flexdepth", "libraries", "scored", "seconds"} <= record.keys()


def test_every_image_has_a_row_also_the_one_without_a_score(report, tmp_path):
    write_report(tmp_path, report)
    header, *rows = (tmp_path / "images.csv").read_text().splitlines()
    assert header.startswith("name,number,pixels,factor,offset,abs_rel")
    assert [row.split(",")[0] for row in rows] == ["a", '"käfer', "dark"]
    assert rows[2].endswith("no pixel has truth where the protocol scores")


@pytest.mark.parametrize("name", PROTOCOLS)
def test_every_protocol_is_valid_json(name):
    json.dumps(plain(PROTOCOLS[name]), allow_nan=False)


def test_a_result_of_something_else_is_not_replaced(report, tmp_path):
    write_report(tmp_path, report)
    check_place(tmp_path, "folder", DATA, ABOUT, overwrite=False)
    check_place(tmp_path / "new", "folder", DATA, ABOUT, overwrite=False)
    for name, data, about in (
        ("kitti", DATA, ABOUT),
        ("folder", Folder(Path("streets")), ABOUT),
        ("folder", DATA, {"folder": "q"}),
    ):
        with pytest.raises(InputError, match="add --overwrite or choose another"):
            check_place(tmp_path, name, data, about, overwrite=False)
        check_place(tmp_path, name, data, about, overwrite=True)


def test_results_that_do_not_measure_the_same_are_not_compared(report, tmp_path):
    write_report(tmp_path / "a", report)
    first = read_report(tmp_path / "a")
    check_comparable(first, first)
    other = replace(report, evaluation=replace(report.evaluation, truth="0"))
    write_report(tmp_path / "b", other)
    with pytest.raises(InputError, match=r"dataset truth is sha256:\w+ in one and sha256:0 in"):
        check_comparable(first, read_report(tmp_path / "b"))
    scale = replace(report.evaluation, protocol=PROTOCOLS["scale"])
    write_report(tmp_path / "c", replace(report, evaluation=scale))
    with pytest.raises(InputError, match="protocol name is metric in one and scale in the other"):
        check_comparable(first, read_report(tmp_path / "c"))


def test_a_broken_or_missing_result_is_named(report, tmp_path):
    with pytest.raises(InputError, match=r"result.json: cannot be read"):
        read_report(tmp_path)
    write_report(tmp_path, report)
    (tmp_path / "images.csv").write_text("name\na\n")
    with pytest.raises(InputError, match=r"images.csv is broken"):
        read_report(tmp_path)
    (tmp_path / "result.json").write_text("{}")
    with pytest.raises(InputError, match="is broken"):
        read_report(tmp_path)


def test_what_a_reader_must_know_is_remarked(report):
    found = report.evaluation
    assert remarks(found, DATA) == ()
    counted = replace(found, protocol=replace(found.protocol, images=654, name="x+median"))
    said = remarks(counted, DATA)
    assert said[0] == "x+median is published for 654 images, here 2"
    assert "is not the protocol as it stands" in said[1]
    mixed = replace(found, sizes={"2x1 metric": 1, "2x1 scale": 2})
    assert "1 of 2x1 metric, 2 of 2x1 scale" in remarks(mixed, DATA)[0]
