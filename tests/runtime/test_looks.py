import numpy as np
import pytest

from flexdepth.runtime.answer import Answer
from flexdepth.runtime.looks import at_three_sizes, geometric_mean, mirrored_too, once

WIDTHS = {2 / 3: 4, 1: 6, 4 / 3: 8}


class Told:
    """A network that answers what it is told to for a width, and remembers what it was shown."""

    def __init__(self, answers):
        self.answers = answers
        self.seen = []

    def run(self, images):
        self.seen.append(images)
        return self.answers[images.shape[-1]]


def flat(width, depth, spread=None, focal=None):
    maps = np.ones((1, 4, width), np.float32)
    return Answer(
        maps * np.float32(depth),
        maps * np.float32(0.5),
        None if spread is None else maps * np.float32(spread),
        None if focal is None else np.array([focal], np.float32),
    )


def shown(times):
    row = np.arange(WIDTHS[times], dtype=np.float32)
    return np.broadcast_to(row, (1, 3, 4, len(row)))


def test_three_sizes_have_the_geometric_mean_of_their_depths_at_the_middle_size():
    model = Told({4: flat(4, 1, 0.1, 0.5), 6: flat(6, 2, 0.2, 0.6), 8: flat(8, 32, 0.6, 1.0)})
    found = at_three_sizes(model, shown)
    np.testing.assert_allclose(found.depth, np.full((1, 4, 6), 4), rtol=1e-6)
    np.testing.assert_allclose(found.spread, np.full((1, 4, 6), 0.3), rtol=1e-6)
    np.testing.assert_allclose(found.focal, [0.7], rtol=1e-6)
    np.testing.assert_allclose(found.sky, np.full((1, 4, 6), 0.5), rtol=1e-6)
    assert {x.dtype for x in (found.depth, found.sky, found.spread)} == {np.dtype(np.float32)}


def test_the_smaller_and_the_larger_are_seen_in_a_mirror():
    model = Told({width: flat(width, 1) for width in (4, 6, 8)})
    at_three_sizes(model, shown)
    first_columns = {each.shape[-1]: each[0, 0, 0, 0] for each in model.seen}
    assert first_columns == {4: 3, 6: 0, 8: 7}


def test_what_is_seen_in_a_mirror_is_turned_back():
    ramp = np.broadcast_to(np.array([1, 4, 16], np.float32), (1, 2, 3))
    model = Told({3: Answer(ramp, ramp / 16)})
    found = mirrored_too(model, lambda _times: np.zeros((1, 3, 2, 3), np.float32))
    np.testing.assert_allclose(found.depth[0, 0], [4, 4, 4], rtol=1e-6)
    np.testing.assert_allclose(found.sky[0, 0], np.array([8.5, 4, 8.5]) / 16, rtol=1e-6)


def test_one_look_is_the_networks_own_answer():
    answer = flat(6, 3, 0.1, 0.7)
    assert once(Told({6: answer}), shown) is answer


@pytest.mark.parametrize("unsaid", ["spread", "focal"])
def test_what_one_look_does_not_say_the_mean_does_not_say(unsaid):
    whole = {"spread": 0.2, "focal": 0.6}
    part = {name: value for name, value in whole.items() if name != unsaid}
    found = geometric_mean([flat(6, 2, **whole), flat(6, 2, **part)])
    assert getattr(found, unsaid) is None


def test_resized_depth_is_interpolated_in_its_logarithm():
    answer = Answer(np.array([[[1, 9]]], np.float32), np.array([[[0, 1]]], np.float32))
    found = answer.resized((4, 1))
    # Pixel centres at half integers: the four lie at 0, 1/4, 3/4 and 1 between the two.
    np.testing.assert_allclose(found.depth[0, 0], [1, 9**0.25, 9**0.75, 9], rtol=1e-6)
    np.testing.assert_allclose(found.sky[0, 0], [0, 0.25, 0.75, 1], rtol=1e-6)
