from pathlib import Path

import pytest

FORMATS = ("npz", "npy", "png16", "exr", "pfm")


def test_every_kind_of_output_is_made_under_its_name(predict, photo, files):
    photo("a.png")
    formats = [word for name in FORMATS for word in ("--format", name)]
    code, out, _ = predict("a.png", *formats, "--preview", "--normals", "--points", "ply")
    assert code == 0
    made = ["a.npz", "a.npy", "a.png", "a.exr", "a.pfm", "a.preview.png", "a.normals.png", "a.ply"]
    assert files() == sorted([*made, "a.json"])
    assert sorted(out.splitlines()) == sorted(str(Path("depth") / name) for name in made)
    assert predict("a.png", "--points", "glb", "-o", "glb")[0] == 0
    assert files("glb") == ["a.glb", "a.npz"]


def test_what_is_there_already_is_skipped_and_what_is_missing_is_added(predict, photo, stamps):
    photo("a.png")
    photo("b.png", 100)
    wanted = ["a.png", "b.png", "--format", "npz", "--format", "npy", "--preview", "--normals"]
    predict(*wanted, "--points", "ply")
    predict(*wanted, "--points", "glb")
    before = stamps()
    for points in ("ply", "glb"):
        code, out, err = predict(*wanted, "--points", points)
        assert (code, out) == (0, "")
        assert "2 skipped" in err
    assert stamps() == before
    Path("depth/a.preview.png").unlink()
    code, _, err = predict(*wanted)
    assert code == 0
    assert "1 done, 1 skipped" in err
    after = stamps()
    assert {path.name for path in after if after[path] != before[path]} == {"a.preview.png"}


@pytest.mark.parametrize(
    "change",
    [
        ("--fov", "80"),
        ("--long-side", "64"),
        ("--focal", "40"),
        ("--looks", "2"),
        ("--tiles", "2"),
        "input",
        "model",
    ],
)
def test_a_file_made_from_something_else_is_in_the_way(predict, make_bundle, change, photo):
    photo("a.png")
    photo("b.png")
    assert predict("a.png")[0] == 0
    before = Path("depth/a.npz").read_bytes()
    if change == "input":
        photo("a.png", 52)
    if change == "model":
        make_bundle(version="1.3")
    options = change if isinstance(change, tuple) else ()
    code, _, err = predict("a.png", "b.png", *options)
    assert code == 2
    assert f"failed: {Path('depth/a.npz')}: is there already and was not made from" in err
    assert "1 done, 1 failed" in err
    assert Path("depth/a.npz").read_bytes() == before
    assert predict("a.png", *options, "--overwrite")[0] == 0
    assert Path("depth/a.npz").read_bytes() != before


@pytest.mark.parametrize(
    ("name", "option"),
    [
        ("a.npz", ()),
        ("a.preview.png", ("--preview",)),
        ("a.normals.png", ("--normals",)),
        ("a.ply", ("--points", "ply")),
        ("a.glb", ("--points", "glb")),
        ("a.png", ("--format", "png16")),
        ("a.exr", ("--format", "exr")),
    ],
)
@pytest.mark.parametrize("content", [b"mine", b"", None])
def test_a_file_of_the_user_is_not_replaced_unasked(predict, name, option, content, photo):
    photo("a.jpg")
    mine = Path("depth") / name
    mine.parent.mkdir()
    if content is None and name.endswith(".png"):
        photo(mine)
    else:
        mine.write_bytes(content or b"ply\nend_header\n" + bytes(40))
    before = mine.read_bytes()
    code, _, err = predict("a.jpg", *option)
    assert code == 2
    assert f"{mine}: is there already" in err
    assert mine.read_bytes() == before
    assert predict("a.jpg", *option, "--overwrite")[0] == 0
    assert mine.read_bytes() != before


def test_an_output_never_replaces_an_input(predict, photo):
    photo("a.png", 51)
    before = Path("a.png").read_bytes()
    code, _, err = predict("a.png", "-o", ".", "--format", "png16", "--overwrite")
    assert code == 2
    assert "would take the place of a.png" in err
    assert Path("a.png").read_bytes() == before


def test_two_inputs_with_one_name_are_told_apart_or_the_second_is_refused(predict, photo, files):
    photo("a.jpg")
    photo("a.png")
    photo("trip/A.png")
    code, _, err = predict("a.jpg", "a.png", "trip/A.png")
    assert code == 2
    assert files() == ["a.jpg.npz", "a.png.npz"]
    assert "would take the place of a.png or of an output of it" in err


def test_a_folder_is_mirrored(predict, photo, files):
    photo("trip/a.png")
    photo("trip/day/a.png")
    assert predict("trip")[0] == 0
    assert files() == ["a.npz", "day/a.npz"]


@pytest.mark.parametrize("name", ["ply", "glb"])
def test_a_mesh_is_not_taken_for_points(predict, photo, name):
    photo("a.png")
    assert predict("a.png", "--points", name)[0] == 0
    points = Path(f"depth/a.{name}").stat().st_size
    assert "is there already" in predict("a.png", "--points", name, "--mesh")[2]
    assert predict("a.png", "--points", name, "--mesh", "--overwrite")[0] == 0
    assert Path(f"depth/a.{name}").stat().st_size > points
    assert "1 skipped" in predict("a.png", "--points", name, "--mesh")[2]
