import json
import pickle
import struct
import zipfile
from dataclasses import replace
from pathlib import Path
from tempfile import TemporaryDirectory

import cv2
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from flexdepth.runtime.depthmap import DepthMap, FocalSource, Intrinsics, Space
from flexdepth.runtime.errors import InputError
from flexdepth.runtime.files import (
    SUFFIXES,
    read_depth,
    read_meaning,
    read_origin,
    read_stated,
    write_depth,
)

EXACT = [".npz", ".npy", ".exr", ".pfm"]
SIDECAR = [".npy", ".pfm"]
EVERY = list(SUFFIXES.values())

maps = arrays(
    np.float32,
    st.tuples(st.integers(1, 7), st.integers(1, 7)),
    elements=st.floats(width=32, allow_nan=True, allow_infinity=True),
)
ordinary = arrays(
    np.float32,
    st.tuples(st.integers(1, 7), st.integers(1, 7)),
    elements=st.one_of(
        st.floats(0.0009765625, 300, width=32), st.sampled_from([0.0, np.nan, np.inf, 65.5, 65.534])
    ),
)
spaces = st.sampled_from(list(Space))
pixels = st.floats(0.01, 1e5)
cameras = st.none() | st.builds(
    Intrinsics, pixels, pixels, pixels, pixels, st.sampled_from(list(FocalSource))
)
origins = st.dictionaries(st.text(), st.text(), max_size=3)


def a_room(space=Space.METRIC):
    values = np.linspace(0.5, 9.5, 30, dtype=np.float32).reshape(5, 6)
    values[0, 0] = np.nan
    values[0, 1] = -np.inf if space is Space.AFFINE_DISPARITY else np.inf
    camera = Intrinsics(4.0, 4.0, 3.0, 2.5, FocalSource.ASSUMED)
    return DepthMap(values, space, camera, "compact 0.1.0")


def read_back(depth_map, suffix, origin=None):
    with TemporaryDirectory() as folder:
        path = Path(folder) / f"room{suffix}"
        write_depth(path, depth_map, origin)
        return read_depth(path), read_origin(path)


def bits(values):
    return np.where(np.isnan(values), np.uint32(0x7FC00000), values.view(np.uint32))


@pytest.mark.parametrize("suffix", EXACT)
@settings(max_examples=60)
@given(values=maps, space=spaces)
def test_the_float_formats_give_every_value_back_to_the_bit(suffix, values, space):
    found, _ = read_back(DepthMap(values, space), suffix)
    np.testing.assert_array_equal(bits(found.values), bits(values))
    assert found.values.dtype == np.float32


@given(values=maps | ordinary, space=spaces)
def test_a_16_bit_png_gives_values_back_to_half_a_step(values, space):
    with TemporaryDirectory() as folder:
        path = Path(folder) / "room.png"
        write_depth(path, DepthMap(values, space), None)
        found, step = read_depth(path), read_meaning(path)["scale"]
    finite = np.isfinite(values)
    np.testing.assert_array_equal(found.valid, finite)
    np.testing.assert_array_equal(found.sky, np.isinf(values))
    wanted, got = values[finite].astype(np.float64), found.values[finite].astype(np.float64)
    at_least_a_step = (wanted >= step) | (space in (Space.AFFINE_DEPTH, Space.AFFINE_DISPARITY))
    # The value that is read is a float32 once more.
    rounding = np.spacing(np.maximum(np.abs(values), np.abs(found.values))[finite])
    bound = np.where(at_least_a_step, step / 2, step) * (1 + 1e-9) + rounding.astype(np.float64)
    assert np.all(np.abs(got - wanted) <= bound)


@pytest.mark.parametrize("suffix", EVERY)
@settings(max_examples=30)
@given(space=spaces, camera=cameras, model=st.text(), origin=origins)
def test_the_meaning_survives_every_format(suffix, space, camera, model, origin):
    written = DepthMap(np.ones((3, 4), np.float32), space, camera, model)
    found, found_origin = read_back(written, suffix, origin)
    assert (found.space, found.model, found_origin) == (space, model, origin)
    assert (found.intrinsics is None) == (camera is None)
    if camera is not None:
        assert found.intrinsics.source is camera.source
        # The centre is moved by half a pixel and back: of 1e5, 1e-10 is some last places.
        for name in ("focal_x", "focal_y", "centre_x", "centre_y"):
            assert abs(getattr(found.intrinsics, name) - getattr(camera, name)) < 1e-10


@pytest.mark.parametrize("suffix", EVERY)
def test_files_say_what_they_hold(tmp_path, suffix):
    path = tmp_path / f"room{suffix}"
    write_depth(path, a_room(), {"input": "room.jpg"})
    said = read_meaning(path)
    assert said["space"] == "metric"
    assert said["unit"] == "m"
    assert said["quantity"] == "depth"
    assert (said["width"], said["height"]) == (6, 5)
    assert said["origin"] == {"input": "room.jpg"}
    # OpenCV's centre lies half a pixel before the project's; 6 pixels at focal 4 see
    # 2 atan(3/4) = 73.74 degrees.
    assert said["intrinsics"]["convention"] == "opencv"
    assert (said["intrinsics"]["centre_x"], said["intrinsics"]["centre_y"]) == (2.5, 2.0)
    assert said["intrinsics"]["field_of_view"] == pytest.approx(73.7397953)


def test_only_a_focal_length_that_nobody_knows_is_told_as_a_field_of_view(tmp_path):
    for source in FocalSource:
        camera = Intrinsics(4.0, 4.0, 3.0, 2.5, source)
        write_depth(tmp_path / "a.npz", DepthMap(a_room().values, Space.METRIC, camera), None)
        told = "field_of_view" in read_meaning(tmp_path / "a.npz")["intrinsics"]
        assert told == (source in (FocalSource.PREDICTED, FocalSource.ASSUMED))


def an_unsure_room():
    spread = np.linspace(0.01, 0.59, 30, dtype=np.float32).reshape(5, 6)
    spread[0, :2] = np.nan
    return replace(a_room(), spread=spread, scale_spread=0.25)


@pytest.mark.parametrize("suffix", [".npz", ".exr"])
def test_a_spread_comes_back_to_the_bit(suffix):
    written = an_unsure_room()
    found, _ = read_back(written, suffix)
    np.testing.assert_array_equal(found.spread, written.spread)
    np.testing.assert_array_equal(found.values, written.values)
    assert found.scale_spread == 0.25


@pytest.mark.parametrize("suffix", EVERY)
def test_every_file_says_how_far_off_it_may_be(tmp_path, suffix):
    # Of 30 evenly spaced spreads, without the first two, the median is the mean of the ends.
    write_depth(tmp_path / f"a{suffix}", an_unsure_room(), None)
    said = read_meaning(tmp_path / f"a{suffix}")["spread"]
    assert said["median"] == pytest.approx((0.05 + 0.59) / 2, abs=1e-6)
    assert said["of_scale"] == 0.25


@pytest.mark.parametrize("suffix", EVERY)
def test_a_map_without_a_spread_has_none_in_its_file(suffix):
    found, _ = read_back(a_room(), suffix)
    assert found.spread is None
    assert found.scale_spread is None


def test_a_spread_of_another_size_is_refused(tmp_path):
    room = a_room()
    with pytest.raises(InputError, match=r"of the map's shape \(5, 6\), got \(5, 5\)"):
        replace(room, spread=np.ones((5, 5), np.float32))
    write_depth(tmp_path / "a.npz", an_unsure_room(), None)
    with np.load(tmp_path / "a.npz") as stored:
        arrays = dict(stored) | {"spread": np.ones((4, 4), np.float32)}
    np.savez(tmp_path / "a.npz", **arrays)
    with pytest.raises(InputError, match=r"a\.npz: holds a spread of the shape \(4, 4\)"):
        read_depth(tmp_path / "a.npz")


def test_numpy_reads_depth_and_disparity_by_name_without_pickles(tmp_path):
    for space, name in ((Space.SCALE, "depth"), (Space.AFFINE_DISPARITY, "disparity")):
        write_depth(tmp_path / "a.npz", a_room(space), None)
        with np.load(tmp_path / "a.npz", allow_pickle=False) as archive:
            assert sorted(archive) == sorted([name, "meaning"])
            np.testing.assert_array_equal(archive[name], a_room(space).values)
            assert json.loads(str(archive["meaning"]))["space"] == space


def test_other_readers_see_the_same_picture(tmp_path):
    room = a_room()
    for suffix in (".pfm", ".png", ".npy"):
        write_depth(tmp_path / f"room{suffix}", room, None)
    np.testing.assert_array_equal(np.load(tmp_path / "room.npy"), room.values)
    np.testing.assert_array_equal(
        cv2.imread(str(tmp_path / "room.pfm"), cv2.IMREAD_UNCHANGED), room.values
    )
    millimetres = cv2.imread(str(tmp_path / "room.png"), cv2.IMREAD_UNCHANGED)
    assert millimetres.dtype == np.uint16
    assert millimetres[0, :3].tolist() == [0, 65535, 1121]
    assert millimetres[-1, -1] == 9500


@pytest.mark.parametrize("suffix", SIDECAR)
def test_an_array_without_its_meaning_is_refused_with_what_to_do(tmp_path, suffix):
    path = tmp_path / f"room{suffix}"
    write_depth(path, a_room(), None)
    (tmp_path / "room.json").unlink()
    with pytest.raises(InputError, match=rf"room\{suffix}: does not say.*flexdepth convert"):
        read_depth(path)


@pytest.mark.parametrize("suffix", EVERY)
def test_a_foreign_file_is_read_as_stated_and_a_speaking_file_is_not(tmp_path, suffix):
    path = tmp_path / f"room{suffix}"
    write_depth(path, a_room(), None)
    with pytest.raises(InputError, match="says itself"):
        read_stated(path, Space.METRIC, 0.5)


def test_stated_millimetres_become_metres_and_zero_is_unknown(tmp_path):
    codes = np.array([[0, 1, 65535], [500, 2000, 7]], np.uint16)
    metres = np.array([[np.nan, 0.001, 65.535], [0.5, 2, 0.007]], np.float32)
    cv2.imwrite(str(tmp_path / "a.png"), codes)
    np.save(tmp_path / "a.npy", codes)
    np.savez_compressed(tmp_path / "a.npz", codes.astype(np.float64))
    for suffix in (".png", ".npy", ".npz"):
        found = read_stated(tmp_path / f"a{suffix}", Space.METRIC, 0.001)
        np.testing.assert_array_equal(found.values, metres)
        with pytest.raises(InputError, match="does not say"):
            read_depth(tmp_path / f"a{suffix}")


def test_columns_first_and_big_endian_arrays_are_read_as_they_are_seen(tmp_path):
    np.save(tmp_path / "a.npy", np.array([[1, 2, 3], [4, 5, 6]], ">f8", order="F"))
    found = read_stated(tmp_path / "a.npy", Space.METRIC, 1.0)
    assert found.values.tolist() == [[1, 2, 3], [4, 5, 6]]


@pytest.mark.parametrize(
    "content", [np.ones((2, 2), complex), np.empty((0, 9)), np.ones((2, 2, 1))]
)
def test_arrays_that_are_no_map_of_numbers_are_refused(tmp_path, content):
    np.save(tmp_path / "a.npy", content)
    with pytest.raises(InputError, match=r"a\.npy: cannot be read as a npy file"):
        read_stated(tmp_path / "a.npy", Space.METRIC, 1.0)


def test_bytes_after_the_array_are_refused(tmp_path):
    np.save(tmp_path / "a.npy", np.ones((2, 2)))
    with (tmp_path / "a.npy").open("ab") as file:
        file.write(b"x")
    with pytest.raises(InputError, match="32 bytes of numbers are declared, 33 are there"):
        read_stated(tmp_path / "a.npy", Space.METRIC, 1.0)


def test_zero_stays_a_value_where_an_offset_is_unknown(tmp_path):
    np.save(tmp_path / "a.npy", np.array([[0.0, 2.0]]))
    found = read_stated(tmp_path / "a.npy", Space.AFFINE_DISPARITY, 0.5)
    assert found.values.tolist() == [[0.0, 1.0]]


def test_an_eight_bit_or_colour_picture_is_no_depth(tmp_path):
    for shape in ((3, 4), (3, 4, 3)):
        cv2.imwrite(str(tmp_path / "a.png"), np.ones(shape, np.uint8))
        with pytest.raises(InputError, match="16 bits"):
            read_stated(tmp_path / "a.png", Space.METRIC, 1.0)


@pytest.mark.parametrize(("kind", "scale"), [("<f4", "-1.0"), (">f4", "1"), ("<f4", "-0.0039")])
def test_of_the_scale_in_a_pfm_only_the_sign_counts(tmp_path, kind, scale):
    bottom_up = np.array([[3, 4], [1, 2]], kind)
    (tmp_path / "a.pfm").write_bytes(f"Pf\n2 2\n{scale}\n".encode() + bottom_up.tobytes())
    found = read_stated(tmp_path / "a.pfm", Space.SCALE, 1.0)
    assert found.values.tolist() == [[1, 2], [3, 4]]


def test_npy_and_pfm_of_one_name_share_a_json_and_keep_their_own_meaning(tmp_path):
    write_depth(tmp_path / "a.npy", a_room(), {"model": "one"})
    write_depth(tmp_path / "a.pfm", a_room(Space.SCALE), {"model": "two"})
    assert read_origin(tmp_path / "a.npy") == {"model": "one"}
    assert read_depth(tmp_path / "a.npy").space is Space.METRIC
    assert read_origin(tmp_path / "a.pfm") == {"model": "two"}
    assert read_depth(tmp_path / "a.pfm").space is Space.SCALE


def test_the_meaning_of_an_array_that_is_gone_is_dropped(tmp_path):
    write_depth(tmp_path / "a.npy", a_room(), None)
    (tmp_path / "a.npy").unlink()
    write_depth(tmp_path / "a.pfm", a_room(), None)
    assert list(json.loads((tmp_path / "a.json").read_text())) == ["pfm"]


@pytest.mark.parametrize("content", ['{"labels": [1, 2]}', "[]", "not json"])
def test_a_json_of_somebody_else_is_not_overwritten(tmp_path, content):
    (tmp_path / "a.json").write_text(content)
    with pytest.raises(InputError, match=r"a\.json: (is not|cannot be read as) the meaning"):
        write_depth(tmp_path / "a.npy", a_room(), None)
    assert (tmp_path / "a.json").read_text() == content
    assert not (tmp_path / "a.npy").exists()


def test_a_meaning_of_another_size_is_refused(tmp_path):
    write_depth(tmp_path / "a.npy", a_room(), None)
    np.save(tmp_path / "a.npy", np.ones((2, 2), np.float32))
    with pytest.raises(InputError, match="2 x 2 numbers, but its meaning speaks of 6 x 5"):
        read_depth(tmp_path / "a.npy")


@pytest.mark.parametrize("suffix", EVERY)
def test_a_missing_file_is_named_once(tmp_path, suffix):
    path = tmp_path / f"nothing{suffix}"
    with pytest.raises(InputError) as refusal:
        read_depth(path)
    assert str(refusal.value).count("nothing") == 1


def test_an_unknown_suffix_lists_the_known_ones(tmp_path):
    for read in (read_depth, read_meaning):
        with pytest.raises(InputError, match=r"a\.tiff: .*\.npz, \.npy, \.png, \.exr, \.pfm"):
            read(tmp_path / "a.tiff")


class Bomb:
    def __reduce__(self):
        return (Path.touch, (Path(self.mark),))

    def __init__(self, mark):
        self.mark = str(mark)


@pytest.mark.parametrize("suffix", [".npy", ".npz"])
def test_pickles_are_never_run(tmp_path, suffix):
    path, mark = tmp_path / f"a{suffix}", tmp_path / "ran"
    content = np.array([[Bomb(mark)]], dtype=object)
    if suffix == ".npy":
        np.save(path, content)
    else:
        np.savez(path, depth=content, meaning=content)
    for read in (read_depth, lambda path: read_stated(path, Space.METRIC, 1.0)):
        with pytest.raises(InputError):
            read(path)
    path.write_bytes(pickle.dumps(Bomb(mark)))
    with pytest.raises(InputError):
        read_stated(path, Space.METRIC, 1.0)
    assert not mark.exists()


def npy_header(shape):
    text = f"{{'descr': '<f4', 'fortran_order': False, 'shape': {shape}}}".ljust(117) + "\n"
    return b"\x93NUMPY\x01\x00" + struct.pack("<H", len(text)) + text.encode()


@pytest.mark.parametrize("shape", [(1 << 40, 1 << 40), (1 << 14, 1 << 14), (-5, 3), (0, 9), (3,)])
def test_declared_sizes_are_not_believed(tmp_path, shape):
    (tmp_path / "a.npy").write_bytes(npy_header(shape) + bytes(64))
    with zipfile.ZipFile(tmp_path / "a.npz", "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("depth.npy", npy_header(shape) + bytes(1 << 20))
    size = f"{shape[-1]} {shape[0]}"
    (tmp_path / "a.pfm").write_bytes(f"Pf\n{size}\n-1\n".encode() + bytes(64))
    for suffix in (".npy", ".npz", ".pfm"):
        with pytest.raises(InputError, match=rf"a\{suffix}: cannot be read as"):
            read_stated(tmp_path / f"a{suffix}", Space.METRIC, 1.0)


@pytest.mark.parametrize(
    "change",
    [
        {"version": 2},
        {"space": "miles"},
        {"scale": 0},
        {"scale": "nan"},
        {"scale": 1e300},
        {"offset": "inf"},
        {"width": None},
        {"intrinsics": {"convention": "opencv", "focal_x": 1}},
        {"intrinsics": {"convention": "opengl"}},
        {"origin": 3},
        {"origin": "ab"},
    ],
)
def test_a_wrong_meaning_names_its_file(tmp_path, change):
    write_depth(tmp_path / "a.npy", a_room(), None)
    records = json.loads((tmp_path / "a.json").read_text())
    (tmp_path / "a.json").write_text(json.dumps({"npy": records["npy"] | change}))
    with pytest.raises(InputError, match=r"a\.json: its meaning"):
        read_depth(tmp_path / "a.npy")


def refusal_of(read, path):
    try:
        read(path)
    except InputError as refusal:
        return str(refusal)
    return None


@pytest.mark.parametrize("suffix", EVERY)
@settings(max_examples=60)
@given(choices=st.data())
def test_broken_files_are_refused_in_one_line_or_read(suffix, choices):
    with TemporaryDirectory() as folder:
        path = Path(folder) / f"room{suffix}"
        write_depth(path, a_room(), {"input": "room.jpg"})
        broken = (
            path
            if suffix not in SIDECAR or choices.draw(st.booleans())
            else path.with_suffix(".json")
        )
        content = bytearray(broken.read_bytes())
        places = st.integers(0, len(content) - 1)
        for place, byte in choices.draw(
            st.lists(st.tuples(places, st.integers(0, 255)), max_size=4)
        ):
            content[place] = byte
        broken.write_bytes(content[: choices.draw(st.none() | places)])
        for read in (read_depth, read_meaning):
            said = refusal_of(read, path)
            assert said is None or (folder in said and "\n" not in said)


@pytest.mark.parametrize("suffix", EVERY)
def test_every_truncation_is_refused(tmp_path, suffix):
    path = tmp_path / f"room{suffix}"
    write_depth(path, a_room(), None)
    content = path.read_bytes()
    # The last chunk of a PNG, IEND, holds nothing.
    needed = len(content) - 12 if suffix == ".png" else len(content)
    for length in range(0, needed, 7):
        path.write_bytes(content[:length])
        with pytest.raises(InputError, match=rf"room\{suffix}"):
            read_depth(path)


@pytest.mark.parametrize("suffix", EVERY)
def test_writing_replaces_and_leaves_nothing_behind(tmp_path, suffix):
    path = tmp_path / "new" / f"room{suffix}"
    write_depth(path, DepthMap(np.ones((2, 2), np.float32), Space.SCALE), None)
    write_depth(path, a_room(), None)
    assert read_depth(path).space is Space.METRIC
    expected = {path.name} | ({"room.json"} if suffix in SIDECAR else set())
    assert {entry.name for entry in path.parent.iterdir()} == expected


@pytest.mark.parametrize("suffix", EVERY)
def test_rows_that_are_not_contiguous_are_written_as_they_are_seen(tmp_path, suffix):
    values = np.asfortranarray(a_room().values)[:, ::2]
    write_depth(tmp_path / f"a{suffix}", DepthMap(values, Space.METRIC), None)
    # Half a millimetre, the step of the 16-bit PNG.
    np.testing.assert_allclose(read_depth(tmp_path / f"a{suffix}").values, values, atol=5.1e-4)


def test_a_path_may_be_text(tmp_path):
    path = tmp_path / "a.npz"
    write_depth(str(path), DepthMap(np.ones((2, 3), np.float32), Space.SCALE))
    assert read_depth(str(path)).values.shape == (2, 3)
