from collections import Counter

import numpy as np
import pytest

from flexdepth.runtime.errors import InputError
from flexdepth.synth.motion import Footing, Motion


def test_two_thirds_of_the_movers_show_their_feet_and_half_of_the_rest_stand_too():
    motion = Motion(2, rigid=(1, 1), flexible=(1, 1), feet=2 / 3)
    casts = [motion.cast(np.random.default_rng(0), number) for number in range(100, 124)]
    assert all([bends for bends, _ in cast] == [False, True] for cast in casts)
    for k in (0, 1):
        counted = Counter(cast[k][1] for cast in casts)
        assert counted == {Footing.SEEN: 16, Footing.HIDDEN: 4, Footing.NONE: 4}


def test_all_show_their_feet_or_none_does():
    for feet, footings in ((0.0, {Footing.HIDDEN, Footing.NONE}), (1.0, {Footing.SEEN})):
        motion = Motion(2, rigid=(2, 2), flexible=(1, 1), feet=feet)
        casts = [motion.cast(np.random.default_rng(0), number) for number in range(5)]
        assert {each for cast in casts for _, each in cast} == footings


def test_something_moves_wherever_something_may():
    motion = Motion(2, rigid=(0, 1), flexible=(0, 0))
    assert all(len(motion.cast(np.random.default_rng(n), n)) == 1 for n in range(9))
    assert Motion(2, rigid=(0, 0), flexible=(0, 0)).cast(np.random.default_rng(0), 0) == []


def test_frames_follow_one_another_at_the_rate():
    assert Motion(3, rate=12.5).time(2) == pytest.approx(0.16)


@pytest.mark.parametrize(
    "wrong",
    [
        {"frames": 0},
        {"rate": 0.0},
        {"focal": 0.0},
        {"parallax": (8.0, 2.0)},
        {"moving": (0.5, 1.5)},
        {"rigid": (-1, 2)},
        {"feet": 1.2},
    ],
)
def test_a_motion_that_cannot_be_filmed_is_refused(wrong):
    with pytest.raises(InputError, match=r"sequence|moving|focal"):
        Motion(**wrong)
