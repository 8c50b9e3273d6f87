from types import SimpleNamespace

import cv2
import numpy as np
import pytest
from PIL import Image

from flexdepth.flow.matches import Agreement
from flexdepth.runtime.errors import InputError
from flexdepth.scenes.correspondence import FlowFile, RaftFlow, doubts


def frames(folder):
    return [np.asarray(Image.open(folder / f"{name}.png")) for name in ("key", "target")]


def test_a_flow_file_gives_its_flow_with_the_stated_noise(pair, hills):
    field = FlowFile(pair / "flow.flo", 0.25).between(*frames(pair))
    np.testing.assert_array_equal(field.flow, hills[1])
    assert field.valid.all()
    assert np.unique(field.noise) == np.float32(0.25)


def test_a_png_of_kitti_is_read_to_its_step(pair, hills):
    flow = hills[1]
    coded = np.rint(flow * 64 + 2**15).astype(np.uint16)
    known = np.ones(flow.shape[:2], np.uint16)
    known[:10] = 0
    cv2.imwrite(str(pair / "flow.png"), np.dstack([known, coded[..., 1], coded[..., 0]]))
    field = FlowFile(pair / "flow.png").between(*frames(pair))
    assert not field.valid[:10].any()
    assert np.abs(field.flow - flow)[10:].max() <= 1 / 128 + 1e-4


def test_flow_shrinks_with_the_frames(pair, hills, write_flo):
    flow = hills[1].copy()
    flow[:20] = np.nan
    write_flo(pair / "holes.flo", flow)
    small = [frame[::2, ::2] for frame in frames(pair)]
    field = FlowFile(pair / "holes.flo", 0.2, (0.5, 0.5)).between(*small)
    assert field.flow.shape == (60, 80, 2)
    assert not field.valid[:10].any()
    assert field.valid[10:].all()
    assert np.nanmax(field.noise) == pytest.approx(0.1)
    blocks = flow[20:].reshape(50, 2, 80, 2, 2).mean((1, 3)) / 2
    np.testing.assert_allclose(field.flow[10:], blocks, atol=1e-5)


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (lambda flow: flow[::2], "flow of 160x120 pixels with 2 components is wanted"),
        (lambda flow: flow * np.nan, "NaN or infinite at every pixel"),
        (lambda flow: -3 * flow, "leads from what the key frame shows to what looks different"),
    ],
)
def test_flow_of_other_frames_is_refused_by_name(change, said, pair, hills, write_flo):
    path = write_flo(pair / "bad.flo", change(hills[1]))
    with pytest.raises(InputError, match=rf"bad\.flo: .*{said}"):
        FlowFile(path).between(*frames(pair))


@pytest.mark.parametrize("name", ["flow.txt", "key.png", "none.flo"])
def test_what_is_no_flow_file_is_refused(name, pair):
    with pytest.raises(InputError, match=name):
        FlowFile(pair / name).between(*frames(pair))


def test_raft_without_weights_is_refused(pair):
    with pytest.raises(InputError, match=r"none\.pth: does not exist"):
        RaftFlow(pair / "none.pth").between(*frames(pair))


@pytest.fixture
def raft(monkeypatch, tmp_path):
    """Return what makes a RAFT that says the same two ways whatever it is shown."""
    weights = tmp_path / "raft.pth"
    weights.write_bytes(b"read by nobody")

    def saying(there, back):
        ways = [np.full((120, 160, 2), (way, 0), np.float32) for way in (there, back)]
        network = SimpleNamespace(both_ways=lambda *_: tuple(ways))
        monkeypatch.setattr("flexdepth.networks.flow.Raft", lambda _weights: network)
        return RaftFlow(weights)

    return saying


def test_flow_of_raft_is_valid_where_its_ways_agree(raft, pair):
    key = frames(pair)[0]
    field = raft(-4, 4).between(key, np.roll(key, -4, axis=1))
    assert (field.flow == (-4, 0)).all()
    assert field.valid[:, 4:].all()
    assert not field.valid[:, :4].any()


def test_a_cut_between_the_frames_is_said_of_rafts_flow_too(raft, pair):
    key, target = frames(pair)
    with pytest.raises(InputError, match=r"only 0% of the key frame is found again .* a cut"):
        raft(20, 20).between(key, target)
    # The ways agree, as of what a network has made up, but lead to what looks different.
    with pytest.raises(InputError, match=r"looks different in the two frames: .* a cut"):
        raft(0, 0).between(key, key[::-1])


def test_flow_is_doubted_only_where_enough_matches_contradict_it():
    (said,) = doubts(Agreement(20, 0.49))
    assert said.startswith("only 49% of 20 points that AKAZE matches have gone where the flow says")
    assert doubts(Agreement(20, 0.5)) == ()
    assert doubts(Agreement(19, 0.0)) == ()
    assert doubts(Agreement(0, float("nan"))) == ()
