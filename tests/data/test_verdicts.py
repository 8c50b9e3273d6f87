import re
from dataclasses import replace

import numpy as np
import pytest

from flexdepth.data.doctor import checkup
from flexdepth.data.folder import Pair
from flexdepth.data.icl_nuim import IclNuimAugmented
from flexdepth.data.kitti_velodyne import KittiObject
from flexdepth.data.verdicts import Verdict
from flexdepth.runtime.depthmap import DepthMap, Space
from flexdepth.runtime.lens import FocalLength
from flexdepth.runtime.model import load_model
from flexdepth.runtime.predictor import Predictor


def remade(pair, values=None, camera=None):
    truth = pair.truth
    values = truth.values if values is None else np.asarray(values, np.float32)
    return Pair(pair.name, pair.image, DepthMap(values, truth.space, camera or truth.intrinsics))


def scaled(factor):
    return lambda pair: remade(pair, pair.truth.values * factor)


def moved(right, down):
    def change(pair):
        values = np.full_like(pair.truth.values, np.nan)
        values[down:, right:] = pair.truth.values[: len(values) - down, : values.shape[1] - right]
        return remade(pair, values)

    return change


def longer(factor):
    def change(pair):
        camera = pair.truth.intrinsics
        focal = {"focal_x": camera.focal_x * factor, "focal_y": camera.focal_y * factor}
        return remade(pair, camera=replace(camera, **focal))

    return change


def of_another_size(pair):
    return remade(pair, camera=pair.truth.intrinsics.scaled(2, 2))


def cut_off(metres):
    return lambda pair: remade(pair, np.minimum(pair.truth.values, np.float32(metres)))


def inverted(pair):
    return remade(pair, 3 / pair.truth.values)


def in_quarters(pair):
    return remade(pair, np.round(pair.truth.values * 4) / 4)


def found(pairs, model):
    return {finding.check: finding for finding in checkup(pairs, model, 24).found}


def test_clean_rooms_give_no_finding(rooms, model):
    result = checkup(rooms, model, 24)
    assert [finding.verdict for finding in result.findings] == [Verdict.FINE] * 11


@pytest.mark.parametrize(
    ("change", "check", "text"),
    [
        (scaled(10), "depth scale", r"7\.69 times what the model sees .*too large .* 10 \(centi"),
        (scaled(0.001), "depth scale", r"too small by a factor of 1000 \(millimetres and metres\)"),
        (moved(8, 0), "registration", "depth should move by -8 px right, 0 px down"),
        (moved(0, 8), "registration", "depth should move by 0 px right, -8 px down"),
        (longer(1.4), "focal length", r"most right angles at 0\.7\d times the stated one"),
        (longer(0.7), "focal length", r"most right angles at 1\.4\d times the stated one"),
        (of_another_size, "camera and size", "10 cameras do not fit: principal point 50% of a"),
        (cut_off(2.5), "saturation", r"pairs end at 2\.5 with many pixels"),
        (inverted, "near and far", "disparity stored as depth, or inverted"),
        (in_quarters, "steps", "whole metres, or 8 bits"),
    ],
)
def test_what_was_tampered_with_is_found(rooms, model, change, check, text):
    findings = found([change(pair) for pair in rooms], model)
    assert check in findings
    assert re.search(text, findings[check].text)


def of_no_camera(pair, factor):
    return Pair(pair.name, pair.image, DepthMap(pair.truth.values * factor, Space.METRIC))


def test_millimetres_read_as_metres_are_found_without_a_camera_too(rooms, model):
    findings = found([of_no_camera(pair, np.float32(1000)) for pair in rooms], model)
    assert re.search(r"no camera is known: too large .*1000 \(milli", findings["depth scale"].text)
    # What a lens of another angle than the assumed one may do as well is none.
    assert "depth scale" not in found([of_no_camera(p, np.float32(4)) for p in rooms], model)


def test_scale_alone_is_found_where_scale_alone_is_wrong(rooms, model):
    assert set(found([scaled(10)(pair) for pair in rooms], model)) == {"depth scale"}
    assert set(found([moved(8, 0)(pair) for pair in rooms], model)) == {"registration"}
    assert set(found([longer(1.4)(pair) for pair in rooms], model)) == {"focal length"}


def test_pairs_without_depth_and_with_the_depth_of_others_are_named(rooms, model):
    empty = remade(rooms[3], np.full_like(rooms[3].truth.values, np.nan))
    copy = remade(rooms[5], rooms[4].truth.values)
    findings = found([*rooms[:3], empty, rooms[4], copy, *rooms[6:]], model)
    assert findings["missing depth"].images == ("room_3",)
    assert findings["repeated depth"].images == ("room_4", "room_5")


def test_depth_of_other_pictures_is_found(rooms, model):
    others = (*rooms[5:], *rooms[:5])
    mixed = [remade(pair, other.truth.values) for pair, other in zip(rooms, others, strict=True)]
    assert "pairing" in found(mixed, model)


def test_what_cannot_be_judged_is_not(rooms, model):
    truth = DepthMap(rooms[0].truth.values, Space.SCALE)
    result = checkup([Pair("one", rooms[0].image, truth)], model, 24)
    unjudged = {f.check for f in result.findings if f.verdict is Verdict.UNJUDGED}
    assert {
        "depth scale",
        "focal length",
        "camera and size",
        "saturation",
        "pairing",
    } <= unjudged
    assert not result.found


@pytest.fixture(scope="module")
def bundled():
    model = load_model()

    def predict(pair):
        return Predictor(model, FocalLength(pair.truth.intrinsics.focal_x)).predict(pair.image)

    return predict


@pytest.fixture(scope="module")
def living_room(samples, bundled):
    """Six pairs of the set, and what the bundled model sees in them."""
    real = samples / "indoor_iclnuim_livingroom1"
    if not real.is_dir():
        pytest.skip(f"no {real}")
    every = IclNuimAugmented(real).load()
    pairs = [every[number] for number in range(0, 120, 20)]
    seen = {pair.name: bundled(pair) for pair in pairs}
    return pairs, lambda pair: seen[pair.name]


def test_a_clean_rendered_sequence_gives_no_finding(living_room):
    assert not checkup(*living_room, 24).found


@pytest.mark.parametrize(
    ("change", "check"),
    [
        (scaled(10), "depth scale"),
        (moved(8, 0), "registration"),
        (longer(1.3), "focal length"),
        (cut_off(2.0), "saturation"),
    ],
)
def test_what_was_tampered_with_in_a_sequence_is_found(living_room, change, check):
    pairs, model = living_room
    assert check in found([change(pair) for pair in pairs], model)


def test_clean_laser_scans_give_no_finding_and_scaled_ones_do(samples, bundled):
    real = samples / "driving_kitti_object"
    if not real.is_dir():
        pytest.skip(f"no {real}")
    pairs = list(KittiObject(real).load())
    assert not checkup(pairs, bundled, 24).found
    assert "depth scale" in found([scaled(10)(pair) for pair in pairs], bundled)
