from collections import Counter

import numpy as np
import pytest

from flexdepth.synth.worlds import INDOORS, OUTDOORS, drawn


@pytest.mark.parametrize(("share", "table"), [(0.0, INDOORS), (1.0, OUTDOORS)])
def test_kinds_are_drawn_as_often_as_the_table_says(share, table):
    rng = np.random.default_rng(0)
    found = Counter(drawn(rng, share) for _ in range(4000))
    total = sum(part for part, _ in table)
    assert set(found) == {make for _, make in table}
    for part, make in table:
        assert found[make] / 4000 == pytest.approx(part / total, abs=0.03)


@pytest.mark.parametrize(
    "make", [make for _, make in (*INDOORS, *OUTDOORS)], ids=lambda make: make.__name__
)
def test_every_kind_can_be_built_twice_the_same(make):
    first, second = (make(np.random.default_rng(5)) for _ in range(2))
    assert first.outdoors == any(make is other for _, other in OUTDOORS)
    assert first.carriers
    assert (first.places == second.places).all()
    assert len(first.parts) == len(second.parts) > 5
    for one, other in zip(first.parts, second.parts, strict=True):
        assert np.isfinite(one.mesh.corners).all()
        assert np.isfinite(one.mesh.uv).all()
        assert (one.mesh.corners == other.mesh.corners).all()
    assert (first.eyes[0] <= first.eyes[1]).all()
