import json

import pytest
import torch

from flexdepth.runtime.errors import InputError
from flexdepth.training import record as recorded
from flexdepth.training.curves import Curves
from flexdepth.training.record import Record, span, taken_up, validations


@pytest.fixture
def said():
    return []


@pytest.fixture
def record(tmp_path, said, monkeypatch):
    """A record of six iterations, a line for every two, each of which takes ten seconds."""
    clock = iter(map(float, range(0, 1000, 10)))
    monkeypatch.setattr(recorded, "monotonic", lambda: next(clock))
    curves = Curves(tmp_path / "tensorboard", 0, said.append)
    return Record(tmp_path / "log.jsonl", 6, said.append, curves, 2, _told=next(clock))


def noted(record, *numbers):
    for number in numbers:
        record.iteration(number, 0.5, {"total": torch.tensor(float(number))})


def test_a_line_has_the_means_since_the_last_and_the_time_left(record, said):
    noted(record, 1, 2, 3, 4)
    assert said == [
        "2/6  total 1.5000  10.00 s/it, 40 s left",
        "4/6  total 3.5000  10.00 s/it, 20 s left",
    ]
    lines = [json.loads(line) for line in record.path.read_text().splitlines()]
    assert lines == [
        {"iteration": 2, "seconds": 10.0, "rate": 0.5, "total": 1.5},
        {"iteration": 4, "seconds": 10.0, "rate": 0.5, "total": 3.5},
    ]


def test_the_last_iteration_has_a_line_whatever_its_number(record, said):
    record.every = 4
    noted(record, *range(1, 7))
    assert [line.split()[0] for line in said] == ["4/6", "6/6"]
    assert said[1].startswith("6/6  total 5.5000")


def test_where_iterations_are_slow_a_line_comes_within_a_minute_or_two(record, said):
    """At ten seconds each, six of them: a line for every fifty would take over eight minutes."""
    record.every = record.iterations = 50
    noted(record, *range(1, 13))
    assert [line.split()[0] for line in said] == ["6/50", "12/50"]
    assert said[0].endswith("10.00 s/it, 7 min left")


def test_the_score_of_a_validation_is_logged_and_said(record, said):
    record.scores(4, {"abs_rel": 0.25, "rmse": 1.5})
    assert said == ["4/6  held-out AbsRel 0.2500"]
    logged = '{"iteration": 4, "held_out_abs_rel": 0.25, "held_out_rmse": 1.5}\n'
    assert record.path.read_text() == logged


def test_a_log_gives_its_validations_back_in_order(record):
    noted(record, 1, 2)
    record.scores(2, {"abs_rel": 0.25, "rmse": 1.5})
    noted(record, 3, 4)
    record.scores(4, {"abs_rel": 0.125, "rmse": 1.0})
    first, second = validations(record.path)
    assert first == {"abs_rel": 0.25, "rmse": 1.5}
    assert second == {"abs_rel": 0.125, "rmse": 1.0}


@pytest.mark.parametrize(
    ("seconds", "said"),
    [(0.0, "0 s"), (89.0, "89 s"), (91.0, "2 min"), (5369.0, "89 min"), (1.11e4, "3 h 05 min")],
)
def test_times_are_said_as_people_do(seconds, said):
    assert span(seconds) == said


def test_a_log_is_cut_back_to_where_its_run_goes_on(tmp_path):
    log = tmp_path / "log.jsonl"
    kept = '{"iteration": 2, "total": 1.0}\n{"iteration": 2, "held_out_abs_rel": 0.5}\n'
    log.write_text(kept + '{"iteration": 4, "held_out_abs_rel": 0.25}\n')
    assert taken_up(log, 2) == [0.5]
    assert log.read_text() == kept
    assert taken_up(log, 0) == []
    assert log.read_text() == ""


@pytest.mark.parametrize(
    "torn", ["{", '{"iteration": 2, "held_out_abs_', '{"iteration": 2, "a', "\0"]
)
def test_a_line_that_was_cut_short_is_dropped(tmp_path, torn):
    log, whole = tmp_path / "log.jsonl", '{"iteration": 1, "held_out_abs_rel": 0.5}\n'
    log.write_text(whole + torn)
    assert taken_up(log, 2) == [0.5]
    assert log.read_text() == whole


def test_a_line_that_lacks_but_its_end_is_kept_and_ended(tmp_path):
    log = tmp_path / "log.jsonl"
    log.write_text('{"iteration": 1, "held_out_abs_rel": 0.5}')
    assert taken_up(log, 1) == [0.5]
    assert log.read_text().endswith("}\n")


def test_where_there_is_no_log_there_are_no_scores(tmp_path):
    assert taken_up(tmp_path / "log.jsonl", 5) == []
    assert list(tmp_path.iterdir()) == []


def test_a_log_that_cannot_be_written_stops_the_run_in_one_line(record):
    record.path.mkdir()
    with pytest.raises(InputError, match=r"log\.jsonl: cannot be written: Is a directory"):
        record.scores(1, {"abs_rel": 0.5})
