from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from flexdepth.data.folder import Folder
from flexdepth.data.kitti import EIGEN_TEST, Kitti
from flexdepth.data.kitti_velodyne import KittiVelodyne, LaserDepth
from flexdepth.data.nyu import NyuDepth, NyuFolders, NyuLabelled
from flexdepth.data.read import Split
from flexdepth.data.sintel import Sintel, SintelPass
from flexdepth.evaluation.alignment import Alignment
from flexdepth.evaluation.catalogue import (
    PROTOCOLS,
    Changes,
    changed,
    deviations,
    for_testing,
    protocol_named,
    protocols_for,
    suited,
)
from flexdepth.evaluation.protocols import Averaging, Range, Scope, WholeMetres, scored_pixels
from flexdepth.evaluation.score import ALL_METRICS
from flexdepth.runtime.errors import InputError

KITTI = ("kitti-eigen-garg-bts", "kitti-eigen-garg-adabins", "kitti-improved", "kitti-vnl")


def columns(*depths):
    """A map of KITTI's size in which each row has these depths, over and over."""
    return np.resize(np.array(depths, np.float32), (375, 1242))


def test_the_same_words_mean_two_regions_on_kitti():
    near = columns(10)
    bts, adabins = (
        scored_pixels(near, PROTOCOLS[f"kitti-eigen-garg-{who}"]) for who in ("bts", "adabins")
    )
    assert bts.sum() == 251_354
    assert adabins.sum() == 232_574
    for found, (top, bottom, left, right) in (
        (bts, (153, 371, 44, 1197)),
        (adabins, (166, 372, 56, 1185)),
    ):
        rows, wide = np.flatnonzero(found.any(1)), np.flatnonzero(found.any(0))
        assert (rows[0], rows[-1] + 1, wide[0], wide[-1] + 1) == (top, bottom, left, right)


def test_nyu_scores_eigens_crop_between_a_millimetre_and_ten_metres():
    truth = np.full((480, 640), 5, np.float32)
    truth[100, 100:104] = 0.001, 10.0, 9.999, np.nan
    found = scored_pixels(truth, PROTOCOLS["nyu-eigen"])
    assert found.sum() == (471 - 45) * (601 - 41) - 3
    assert found[45, 41]
    assert found[470, 600]
    assert not found[44, 41]
    np.testing.assert_array_equal(found[100, 100:104], [False, False, True, False])


@pytest.mark.parametrize(
    ("name", "scored"),
    [
        ("kitti-eigen-garg-bts", [False, True, False, False]),
        ("kitti-improved", [False, True, True, False]),
        ("kitti-monodepth2-benchmark", [True, True, True, True]),
        ("kitti-vnl", [True, True, True, True]),
    ],
)
def test_the_ends_of_the_range_are_those_of_the_source(name, scored):
    truth = columns(10)
    truth[200, 600:604] = 0.0005, 79.9, 80.0, 85.0
    found = scored_pixels(truth, PROTOCOLS[name])[200, 600:604]
    np.testing.assert_array_equal(found, scored)


def test_a_range_holds_its_ends_only_where_it_is_closed():
    depth = np.array([1.0, 1.5, 2.0, np.nan])
    np.testing.assert_array_equal(Range(1.0, 2.0).holds(depth), [False, True, False, False])
    np.testing.assert_array_equal(Range(1.0, 2.0, True).holds(depth), [True, True, True, False])


def test_cityscapes_scores_the_middle_of_its_upper_three_quarters():
    truth = np.full((1024, 2048), 20, np.float32)
    found = scored_pixels(truth, PROTOCOLS["cityscapes-manydepth"])
    rows, wide = np.flatnonzero(found.any(1)), np.flatnonzero(found.any(0))
    # Rows 256: of the upper 768, columns 192:1856.
    assert (rows[0], rows[-1], wide[0], wide[-1]) == (256, 767, 192, 1855)
    assert PROTOCOLS["cityscapes-manydepth"].view.box(1024, 2048) == (0, 768, 0, 2048)


def test_the_released_truth_of_sintel_b_is_whole_metres_by_a_hundred():
    depth = np.array([0.9, 1.0, 70.9, np.nan], np.float32)
    # 65535 / 650 is 100.823.
    np.testing.assert_allclose(
        WholeMetres()(depth), [0, 1 / 100.823, 70 / 100.823, np.nan], rtol=1e-5
    )
    assert PROTOCOLS["sintel-vda"].recoded == WholeMetres()
    # So depth below a metre is out of range, and nothing reaches the 70 m.
    assert not PROTOCOLS["sintel-vda"].scored.holds(WholeMetres()(depth[:1])).any()


@pytest.mark.parametrize("name", PROTOCOLS)
def test_every_protocol_says_where_it_comes_from_and_names_metrics_there_are(name):
    protocol = PROTOCOLS[name]
    assert protocol.name == name
    assert protocol.source
    assert protocol.summary
    assert protocol.version >= 1
    assert set(protocol.metrics) <= set(ALL_METRICS)
    if protocol.clip is not None:
        assert protocol.sky == protocol.clip[1] >= protocol.clip[0]


def test_every_protocol_and_every_metric_is_explained():
    page = Path(__file__).parents[2].joinpath("docs", "protocols.md").read_text(encoding="utf-8")
    assert [name for name in (*PROTOCOLS, *ALL_METRICS) if f"`{name}`" not in page] == []


def test_the_published_counts_of_images_are_known():
    counts = {name: PROTOCOLS[name].images for name in PROTOCOLS}
    assert counts["nyu-eigen"] == 654
    assert counts["kitti-eigen-garg-bts"] == counts["kitti-monodepth2-benchmark"] == 652
    assert counts["kitti-monodepth2-eigen"] == 697
    assert counts["cityscapes-manydepth"] == 1525


def test_the_two_of_monodepth2_differ_in_truth_region_and_range():
    raw, improved = (PROTOCOLS[f"kitti-monodepth2-{s}"] for s in ("eigen", "benchmark"))
    assert raw.alignment is improved.alignment is Alignment.MEDIAN
    assert raw.clip == improved.clip == (1e-3, 80.0)
    assert (raw.sets, improved.sets) == (("KittiVelodyne",), ("Kitti",))
    assert raw.region != improved.region


def test_the_three_sintels_differ_as_their_sources_do():
    a, b, c = (PROTOCOLS[f"sintel-{who}"] for who in ("depthcrafter", "vda", "monst3r"))
    assert (a.frames, b.frames, c.frames) == (50, 100, None)
    assert (len(a.videos), len(b.videos), len(c.videos)) == (0, 0, 14)
    assert a.per is b.per is c.per is Scope.VIDEO
    assert a.alignment is b.alignment is Alignment.LEAST_SQUARES_DISPARITY
    assert c.alignment is Alignment.DESCENT
    assert (a.averaging, c.averaging) == (Averaging.VIDEOS, Averaging.VIDEOS_BY_PIXELS)
    assert for_testing(Sintel(), a).rendering is SintelPass.CLEAN
    assert for_testing(Sintel(), c).rendering is SintelPass.FINAL


def test_a_misspelt_protocol_gets_a_hint():
    with pytest.raises(InputError, match="did you mean nyu-eigen"):
        protocol_named("nyu-eigne")
    with pytest.raises(InputError, match="choose one of nyu-eigen"):
        protocol_named("?")


def test_a_set_has_its_own_protocols_before_the_plain_ones():
    names = [each.name for each in protocols_for(Kitti())]
    assert names[0] == "kitti-eigen-garg-bts"
    assert "nyu-eigen" not in names
    assert protocols_for(Folder())[0].name == "metric"
    assert protocols_for(KittiVelodyne())[0].name == "kitti-monodepth2-eigen"


def test_a_protocol_chooses_split_and_truth():
    eigen, vnl = PROTOCOLS["nyu-eigen"], PROTOCOLS["nyu-vnl"]
    assert suited(NyuLabelled(), eigen) == NyuLabelled(split=Split.TEST, depth=NyuDepth.RAW)
    assert suited(NyuLabelled(), vnl) == NyuLabelled(split=Split.TEST, depth=NyuDepth.FILLED)
    # Folders hold one truth alone: there is nothing to choose.
    assert suited(NyuFolders(), eigen) == NyuFolders(split=Split.TEST)
    assert suited(Kitti(), PROTOCOLS["kitti-vnl"]) == Kitti(frames=EIGEN_TEST)
    raw = suited(KittiVelodyne(), PROTOCOLS["kitti-monodepth2-eigen"])
    assert raw.depth is LaserDepth.MONODEPTH2


def test_a_file_that_the_user_has_named_stays(tmp_path):
    own = Kitti(frames=tmp_path / "own.txt")
    assert suited(own, PROTOCOLS["kitti-vnl"]) == own


def test_a_plain_protocol_still_tests_on_the_test_split():
    assert for_testing(NyuLabelled(), PROTOCOLS["metric"]).split is Split.TEST


def test_settings_that_are_not_the_protocols_are_told(tmp_path):
    eigen, vnl = PROTOCOLS["nyu-eigen"], PROTOCOLS["kitti-vnl"]
    assert deviations(for_testing(NyuLabelled(), eigen), eigen) == []
    filled = replace(for_testing(NyuLabelled(), eigen), depth=NyuDepth.FILLED)
    assert deviations(filled, eigen) == ["--depth is depths, and nyu-eigen is for rawDepths"]
    assert deviations(Kitti(frames=tmp_path / EIGEN_TEST), vnl) == []
    assert len(deviations(Kitti(frames=tmp_path / "own.txt"), vnl)) == 1
    assert deviations(NyuFolders(split=Split.TEST), eigen) == []


def test_every_change_of_a_protocol_shows_in_its_name():
    found = changed(
        PROTOCOLS["nyu-eigen"],
        Changes(Alignment.MEDIAN, Scope.VIDEO, 8.0, Averaging.PIXELS),
    )
    assert found.name == "nyu-eigen+median+video+pixels+8m"
    assert (found.alignment, found.per, found.averaging) == ("median", "video", "pixels")
    assert (found.scored, found.clip, found.sky) == (Range(1e-3, 8.0), (1e-3, 8.0), 8.0)
    assert "alignment median" in found.summary


def test_what_is_no_change_leaves_the_name():
    protocol = PROTOCOLS["nyu-eigen"]
    assert changed(protocol, Changes()) == protocol
    assert changed(protocol, Changes(alignment=Alignment.NONE)) == protocol


def test_a_range_without_depth_is_refused():
    with pytest.raises(InputError, match="wanted metres beyond"):
        changed(PROTOCOLS["metric"], Changes(farthest=0.0))
