import torch
from hypothesis import given
from hypothesis import strategies as st
from torch.testing import assert_close

from flexdepth.geometry.depth import canonical_from_metres, metres_from_canonical


def test_through_twice_the_focal_length_a_thing_looks_half_as_far():
    metres = torch.full((2, 1, 1), 6.0)
    focal = torch.tensor([0.8, 1.6])
    assert_close(canonical_from_metres(metres, focal, 0.8).flatten(), torch.tensor([6.0, 3.0]))


@given(st.floats(0.1, 100), st.floats(0.2, 3), st.floats(0.2, 3))
def test_metres_come_back_from_canonical_depth(depth, focal, canonical):
    metres = torch.full((3, 1, 2, 2), depth, dtype=torch.float64)
    focals = torch.full((3, 1), focal, dtype=torch.float64)
    there = canonical_from_metres(metres, focals, canonical)
    assert_close(metres_from_canonical(there, focals, canonical), metres)
