"""Pieces of a frame within which flow hardly changes."""

import numpy as np

from flexdepth.solvers.pieces import pieces

HEIGHT, WIDTH, NOISE = 60, 80, 0.1


def test_pieces_end_where_noisy_flow_jumps():
    """A comb: teeth 3 pixels wide, and a hand before another thing, each with its own flow."""
    thing = np.zeros((HEIGHT, WIDTH), int)
    thing[8:30, 20:60] = 1
    thing[20:50, 30:70] = 2
    for left in range(22, 60, 9):
        thing[2:8, left : left + 3] = 1
    flow = np.array([(0.0, 0.0), (2.0, 0.5), (0.8, -0.8)])[thing]
    flow += np.random.default_rng(0).normal(0, NOISE, flow.shape)
    cut = pieces(flow, np.zeros((HEIGHT, WIDTH)), NOISE)
    counts = np.zeros((cut.max() + 1, 3), int)
    np.add.at(counts, (cut, thing), 1)
    strangers = counts.sum(axis=1) - counts.max(axis=1)
    assert strangers.sum() < 0.005 * cut.size
    assert len(counts) < 40
