import json

import numpy as np
import pytest
from PIL import Image

from flexdepth.cli.main import main
from flexdepth.runtime.depthmap import DepthMap, FocalSource, Intrinsics, Space
from flexdepth.runtime.files import write_depth

SIZE = (64, 48)


def plane(metres):
    return np.full((SIZE[1], SIZE[0]), metres, np.float32)


def depth_map(values, space=Space.METRIC):
    camera = Intrinsics.centred(*SIZE, 64.0, FocalSource.GIVEN)
    return DepthMap(values, space, camera)


@pytest.fixture
def rooms(here):
    """A folder with two images and their depth, 2 m and 4 m."""
    for name, metres in (("a", 2.0), ("b", 4.0)):
        (here / "rooms" / "image").mkdir(parents=True, exist_ok=True)
        Image.new("RGB", SIZE, (51, 51, 51)).save(here / "rooms" / "image" / f"{name}.png")
        write_depth(here / "rooms" / "depth" / f"{name}.npz", depth_map(plane(metres)))
    return "rooms"


@pytest.fixture
def said(here):
    """Return a function that writes predictions: so many times the truth."""

    def write(folder, first, second, space=Space.METRIC):
        for name, metres in (("a", 2.0 * first), ("b", 4.0 * second)):
            write_depth(here / folder / f"{name}.npz", depth_map(plane(metres), space))
        return folder

    return write


@pytest.fixture
def evaluate(capsys):
    """Run `flexdepth evaluate`; return exit code, stdout and stderr."""

    def run(*arguments):
        code = main(["evaluate", *map(str, arguments)])
        return code, *capsys.readouterr()

    return run


def result(folder):
    with open(f"{folder}/result.json", encoding="utf-8") as file:
        return json.load(file)


def test_predictions_are_scored_and_the_numbers_can_be_repeated(evaluate, rooms, said, here):
    code, out, err = evaluate(said("p", 1.5, 1.0), rooms, "-o", "out")
    assert (code, err) == (0, "")
    assert "metric v1" in out
    assert "AbsRel         0.2500" in out
    found = result("out/metric")
    assert found["results"]["abs_rel"]["value"] == pytest.approx(0.25)
    assert found["scored"] == 2
    assert found["command"] == [
        "flexdepth",
        "evaluate",
        "p",
        "folder",
        "--root",
        "rooms",
        "-o",
        "out",
    ]
    assert (here / "out/metric/images.csv").is_file()
    drawn = sorted(path.name for path in (here / "out/metric/worst").iterdir())
    assert drawn == ["01-a.png", "02-b.png"]
    assert evaluate(*found["command"][2:])[0] == 0


def test_a_model_is_asked_once_and_its_predictions_are_kept(evaluate, rooms, make_bundle, here):
    bundle = make_bundle()
    assert evaluate(bundle, rooms, "--worst", 0)[0] == 0
    kept = sorted((here / "evaluation" / "tiny-rooms" / "predictions").rglob("*.npz"))
    assert [path.name for path in kept] == ["a.npz", "b.npz"]
    stamps = [path.stat().st_mtime_ns for path in kept]
    assert evaluate(bundle, rooms, "--protocol", "scale", "--worst", 0)[0] == 0
    assert [path.stat().st_mtime_ns for path in kept] == stamps
    about = result("evaluation/tiny-rooms/scale")["predictions"]
    assert (about["name"], about["version"]) == ("tiny", "1.2")
    # 1.2 of the network, for a focal length of .8 diagonals where .5 is its own: 1.92 m.
    assert result("evaluation/tiny-rooms/metric")["results"]["abs_rel"]["value"] == pytest.approx(
        (0.08 / 2 + 2.08 / 4) / 2, rel=1e-4
    )


def test_a_fit_that_is_too_weak_is_refused_in_one_line(evaluate, rooms, said):
    code, _, err = evaluate(said("p", 1, 1, Space.SCALE), rooms)
    assert code == 2
    assert "choose one of: median, scale" in err
    assert err.count("\n") == 1


def test_a_change_of_the_protocol_shows_in_its_name(evaluate, rooms, said):
    code, out, _ = evaluate(
        said("p", 5, 9, Space.SCALE), rooms, "--alignment", "median", "--farthest", "3"
    )
    assert code == 0
    assert "metric+median+3m v1" in out
    assert "1 images scored, 1 left out" in out
    assert "left out: b: no pixel has truth where the protocol scores" in out
    assert "is not the protocol as it stands" in out


def test_numbers_of_other_programs_are_what_the_user_says(evaluate, rooms, here):
    (here / "p").mkdir()
    for number, metres in enumerate((2, 4)):
        np.save(here / "p" / f"{number:03d}.npy", plane(metres * 1000).astype(np.uint16))
    code, _, err = evaluate("p", rooms)
    assert code == 2
    assert "no prediction for the image a" in err
    stated = ("--space", "metric", "--scale", "0.001")
    code, out, _ = evaluate("p", rooms, *stated, "--match", "order")
    assert code == 0
    assert "AbsRel         0.0000" in out


def test_a_result_of_other_predictions_is_not_replaced_unasked(evaluate, rooms, said):
    said("p", 1, 1)
    said("q", 2, 2)
    assert evaluate("p", rooms, "-o", "out")[0] == 0
    code, _, err = evaluate("q", rooms, "-o", "out")
    assert code == 2
    assert "--overwrite" in err
    assert evaluate("q", rooms, "-o", "out", "--overwrite")[0] == 0
    assert result("out/metric")["results"]["abs_rel"]["value"] == pytest.approx(1)


def test_an_audit_scores_everything_that_applies(evaluate, rooms, said):
    code, out, err = evaluate("audit", said("p", 1.5, 1.5), rooms, "-o", "audit.json")
    assert (code, err) == (0, "")
    assert [line.split()[0] for line in out.splitlines()[1:5]] == [
        "metric",
        "scale",
        "affine-depth",
        "affine-disparity",
    ]
    assert "AbsRel from metric to scale: 0.5000 -> 0.0000 (-0.5000)" in out
    assert "-0.5000  fit: none -> median" in out
    with open("audit.json", encoding="utf-8") as file:
        assert len(json.load(file)["rows"]) == 4


def test_an_audit_marks_the_fits_that_it_had_to_replace(evaluate, rooms, said):
    _, out, _ = evaluate("audit", said("p", 3, 3, Space.SCALE), rooms)
    assert "metric                       median*" in out


def test_two_results_are_compared_image_by_image(evaluate, rooms, said):
    for name, factors in (("p", (1.1, 1.2)), ("q", (1.3, 1.4))):
        assert evaluate(said(name, *factors), rooms, "-o", f"of-{name}")[0] == 0
    code, out, err = evaluate("compare", "of-p/metric", "of-q/metric")
    assert (code, err) == (0, "")
    (line,) = (line for line in out.splitlines() if "AbsRel" in line)
    assert line.split()[:4] == ["AbsRel", "0.1500", "0.3500", "+0.2000"]
    assert "on 0%" in line


def test_results_of_two_protocols_are_not_compared(evaluate, rooms, said):
    said("p", 1, 1)
    for protocol in ("metric", "scale"):
        assert evaluate("p", rooms, "-o", "out", "--protocol", protocol)[0] == 0
    code, _, err = evaluate("compare", "out/metric", "out/scale")
    assert code == 2
    assert "protocol name is metric in one and scale in the other" in err


@pytest.mark.parametrize(
    ("arguments", "complaint"),
    [
        ((), "name a model and a set"),
        (("bundled",), "name a model and a set"),
        (("bundled", "nowhere"), "no data set 'nowhere', and no such folder"),
        (("bundled", "kiti"), "did you mean 'kitti'?"),
        (("nothing", "rooms"), "no model 'nothing': wanted `bundled`"),
        (("p", "rooms", "--protocol", "nyu"), "there is no 'nyu'"),
        (("p", "rooms", "--protocol", "nyu-eigen"), "nyu-eigen is not for the set folder"),
        (("p", "rooms", "--alignment", "guess"), "invalid choice 'guess'"),
        (("p", "rooms", "--worst", "-1"), "--worst: wanted a whole number >= 0"),
        (("bundled", "rooms", "--space", "metric"), "are for a folder of predictions"),
        (("audit", "p"), "name predictions and a set"),
        (("audit", "nowhere", "rooms"), "no such folder of predictions"),
        (("compare", "p"), "flexdepth evaluate compare --help"),
        (("compare", "p", "q"), "cannot be read"),
    ],
)
@pytest.mark.usefixtures("rooms")
def test_a_mistake_is_told_in_one_line(evaluate, said, arguments, complaint):
    said("p", 1, 1)
    code, out, err = evaluate(*arguments)
    assert (code, out) == (2, "")
    assert complaint in err
    assert err.count("\n") == 1


@pytest.mark.parametrize("before", [(), ("audit",), ("bundled",)])
def test_help_lists_sets_and_protocols(before, capsys):
    with pytest.raises(SystemExit) as stop:
        main(["evaluate", *before, "--help"])
    assert stop.value.code == 0
    out = capsys.readouterr().out
    for word in ("nyu-labelled", "kitti-eigen-garg-adabins", "audit", "compare"):
        assert word in out


def test_the_help_of_a_set_shows_its_own_settings(capsys):
    with pytest.raises(SystemExit) as stop:
        main(["evaluate", "bundled", "nyu-labelled", "--help"])
    assert stop.value.code == 0
    out = capsys.readouterr().out
    assert "--root" in out
    assert "rawDepths" in out
