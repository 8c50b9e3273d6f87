import json
import subprocess
import sys
from importlib import import_module
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from flexdepth.runtime.errors import InputError

BENCHMARKS = Path(__file__).parents[2] / "benchmarks"
POSIX_ONLY = pytest.mark.skipif(sys.platform == "win32", reason="Windows does not tell")


@pytest.fixture
def speed(monkeypatch):
    monkeypatch.syspath_prepend(BENCHMARKS)
    return import_module("speed")


@pytest.fixture
def runs(monkeypatch):
    monkeypatch.syspath_prepend(BENCHMARKS)
    return import_module("runs")


def python(code):
    return [sys.executable, "-c", code]


def measured(speed, wall, cpu=None, peak=None):
    return speed.Run(wall, cpu, peak)


def test_a_process_is_timed_from_start_to_end(runs):
    assert runs.child(python("import time; time.sleep(0.3)")).wall >= 0.3


@POSIX_ONLY
def test_sleep_takes_no_processor(runs):
    assert 0 < runs.child(python("import time; time.sleep(0.5)")).cpu < 0.5


@POSIX_ONLY
def test_the_peak_of_a_process_is_its_own_in_bytes():
    # From a process of its own: the peak of this one, full of tests, would count.
    asks = f"""
import sys
sys.path.insert(0, {str(BENCHMARKS)!r})
from runs import child
for held in (250_000_000, 0):
    print(child([sys.executable, "-c", f"x = b'x' * {{held}}"]).peak)
"""
    said = subprocess.run(python(asks), capture_output=True, text=True, check=True).stdout
    full, empty = map(int, said.split())
    assert 250_000_000 < full < 350_000_000
    assert empty < 100_000_000


def test_a_command_that_fails_is_no_measurement(runs):
    with pytest.raises(InputError, match="exit code 1: ValueError: no such lens"):
        runs.child(python("raise ValueError('no such lens')"))


def test_two_networks_take_turns(runs, monkeypatch):
    monkeypatch.setattr(runs, "REST", 0)
    seen = []
    first, second = runs.in_turn(lambda: seen.append("a"), lambda: seen.append("b"), 3)
    assert "".join(seen) == "ab" * 4, "one pair is not counted"
    assert (len(first), len(second)) == (3, 3)


def test_a_time_is_the_median_of_its_runs(speed):
    runs = [measured(speed, wall, cpu) for wall, cpu in ((5, 1), (1, 3), (2, 2))]
    figure = speed.seconds("x", runs, 3)
    assert (figure.value, figure.cpu, figure.runs, figure.verdict) == (2, 2, (5, 1, 2), "pass")


def test_memory_is_the_largest_peak(speed):
    runs = [measured(speed, 1, peak=peak) for peak in (500_000_000, 1_500_000_000, 100)]
    figure = speed.memory("x", runs, 1.0)
    assert (figure.value, figure.verdict) == (1.5, "MISS")


def test_where_memory_is_not_told_nothing_is_claimed(speed):
    figure = speed.memory("x", [measured(speed, 1)], 1.0)
    assert (figure.value, figure.verdict) == (None, "")
    assert "not measured" in speed.table([figure])


def test_networks_are_compared_pair_by_pair(speed):
    ours = [measured(speed, wall, cpu) for wall, cpu in ((1, 4), (10, 4), (3, 4))]
    theirs = [measured(speed, wall, cpu) for wall, cpu in ((2, 2), (5, 2), (4, 0))]
    # Pair by pair .5, 2, .75; the clock of the third was too coarse for CPU time.
    figure = speed.ratio("x", ours, theirs, 1.0)
    assert (figure.value, figure.cpu, figure.verdict) == (0.75, 2, "pass")


@pytest.mark.parametrize(
    ("value", "verdict"), [(0.2, "pass"), (0.3, "pass"), (0.31, "MISS"), (None, "")]
)
def test_a_bar_is_the_most_that_is_allowed(speed, value, verdict):
    assert speed.Figure("x", "s", value, bar=0.3).verdict == verdict


def test_the_photos_have_the_sizes_of_the_bars(speed):
    assert speed.SMALL == (640, 480)
    assert speed.LARGE[0] * speed.LARGE[1] == 12_000_000


def test_a_large_photo_weighs_what_a_camera_makes_of_it(speed, tmp_path):
    path, size = tmp_path / "photo.jpg", (2000, 1500)
    speed.make_photo(path, size)
    with Image.open(path) as photo:
        assert (photo.size, photo.mode, photo.format) == (size, "RGB", "JPEG")
        assert 60 < np.asarray(photo.reduce(20)).mean() < 200, "the grain must not darken it"
    # Cameras write 2 to 4 bits a pixel.
    assert 2 < 8 * path.stat().st_size / (size[0] * size[1]) < 4


FIGURES = {"import flexdepth": (0.1, 0.3), "a 12-megapixel photo": (4.0, 3.0)}


def run(speed, monkeypatch, *arguments):
    monkeypatch.setattr("sys.argv", ["speed.py", *arguments])
    made = [speed.Figure(name, "s", value, bar=bar) for name, (value, bar) in FIGURES.items()]
    monkeypatch.setattr(speed, "commands", lambda _folder, _options: iter(made))
    monkeypatch.setattr(speed, "networks", lambda _folder, _options: iter(()))
    return speed.main()


def test_json_says_every_figure_its_bar_and_the_machine(speed, monkeypatch, capsys):
    assert run(speed, monkeypatch, "--json", "--threads", "2") == 0
    said = json.loads(capsys.readouterr().out)
    assert {each["name"]: (each["value"], each["bar"]) for each in said["figures"]} == FIGURES
    assert [each["verdict"] for each in said["figures"]] == ["pass", "MISS"]
    assert said["machine"]["threads"] == 2


def test_only_strict_makes_a_missed_bar_an_error(speed, monkeypatch, capsys):
    assert run(speed, monkeypatch) == 0
    lines = capsys.readouterr().out.splitlines()
    assert [line.split()[-1] for line in lines[2:4]] == ["pass", "MISS"]
    assert run(speed, monkeypatch, "--strict") == 1


@pytest.mark.parametrize("load", [0.1, 3.0])
def test_a_busy_machine_is_named(speed, monkeypatch, capsys, load):
    monkeypatch.setattr(speed, "machine", lambda _threads: {"load": load})
    run(speed, monkeypatch)
    assert ("busy" in capsys.readouterr().out) is (load == 3.0)


@pytest.mark.parametrize("arguments", [("--runs", "0"), ("--threads", "-1"), ("--pairs", "x")])
def test_counts_are_at_least_one(speed, monkeypatch, arguments, capsys):
    with pytest.raises(SystemExit, match="2"):
        run(speed, monkeypatch, *arguments)
    assert arguments[0] in capsys.readouterr().err


def test_without_torch_the_network_is_timed_alone(speed, monkeypatch, tmp_path, make_bundle):
    bundle = make_bundle()
    monkeypatch.setattr(speed, "MIDAS", tmp_path / "absent.py")
    arguments = ["speed.py", "--pairs", "2", "--model", str(bundle)]
    monkeypatch.setattr("sys.argv", arguments)
    alone, ratio = speed.networks(tmp_path, speed.arguments())
    assert (alone.name, len(alone.runs)) == ("network, 128x96", 2)
    assert (ratio.value, ratio.verdict) == (None, "")
    assert "absent.py" in ratio.note
