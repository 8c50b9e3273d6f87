import numpy as np
import pytest

from flexdepth.scenes.arrows import arrows, spread_out


def test_an_arrow_goes_from_its_start_to_its_end():
    mesh = arrows(
        np.array([[0.0, 0, 4]]),
        np.array([[1.0, 0, 0]]),
        np.array([[1, 2, 3]], np.uint8),
        np.array([4.0]),
    )
    np.testing.assert_allclose(mesh.positions.min(0)[0], 0, atol=1e-6)
    np.testing.assert_allclose(mesh.positions.max(0)[0], 1, atol=1e-6)
    assert np.ptp(mesh.positions[:, 1]) < 0.05
    assert mesh.triangles.max() == len(mesh.positions) - 1
    assert (mesh.colours == (1, 2, 3)).all()


def test_the_surface_of_an_arrow_has_no_gap_but_its_tail():
    mesh = arrows(np.zeros((1, 3)), np.eye(3)[:1], np.zeros((1, 3), np.uint8), np.ones(1))
    edges = np.sort(
        np.concatenate([mesh.triangles[:, [a, b]] for a, b in ((0, 1), (1, 2), (2, 0))])
    )
    _, counts = np.unique(edges, axis=0, return_counts=True)
    assert sorted(counts)[:5] == [1] * 5  # the ring of the tail
    assert set(counts[counts != 1]) == {2}


def test_arrows_too_short_to_be_seen_are_left_out():
    ways = np.array([[1e-3, 0, 0], [0.1, 0, 0]])
    mesh = arrows(np.zeros((2, 3)), ways, np.zeros((2, 3), np.uint8), np.ones(2))
    assert len(mesh.positions) == 16
    none = arrows(np.zeros((1, 3)), np.zeros((1, 3)), np.zeros((1, 3), np.uint8), np.ones(1))
    assert not len(none.positions)


@pytest.mark.parametrize("most", [10, 100, 5000])
def test_pixels_are_spread_evenly_and_no_more_than_wanted(most):
    mask = np.zeros((60, 80), bool)
    mask[10:50, 20:70] = True
    chosen = spread_out(mask, most)
    assert (chosen <= mask).all()
    assert 0.5 * min(most, 2000) <= chosen.sum() <= 1.5 * most
