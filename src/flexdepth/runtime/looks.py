"""How a network looks at pictures: once, in a mirror too, or at three sizes.

What a network is wrong about in one look it is less wrong about, or wrong about in another way, in
a mirror and at another size; the mean is nearer to the truth than either, in metres above all
(decision 016).
"""

from collections.abc import Callable, Sequence

import numpy as np

from flexdepth.runtime.answer import Answer, Reals
from flexdepth.runtime.model import Model

Shown = Callable[[float], Reals]
"""The same pictures at this many times the width and height that the network learnt from.

(batch, 3, height, width), RGB in [0, 1].
"""

Look = Callable[[Model, Shown], Answer]
"""A network and pictures to an answer at the size of `shown(1)`."""

_SMALLER, _LARGER = 2 / 3, 4 / 3
"""The other two of three sizes."""


def once(model: Model, shown: Shown) -> Answer:
    """Return what the network answers for the pictures."""
    return model.run(shown(1))


def in_mirror(model: Model, images: Reals) -> Answer:
    """Return the answer for the mirrored images, mirrored back."""
    return model.run(np.ascontiguousarray(images[..., ::-1])).mirrored()


def both_ways(model: Model, shown: Shown) -> tuple[Answer, Answer]:
    """Return the answers of two looks, the second in a mirror."""
    images = shown(1)
    return model.run(images), in_mirror(model, images)


def mirrored_too(model: Model, shown: Shown) -> Answer:
    """Return the answer of two looks, one in a mirror."""
    return geometric_mean(both_ways(model, shown))


def at_three_sizes(model: Model, shown: Shown) -> Answer:
    """Return the answer of three looks, the smaller and the larger in a mirror."""
    own = once(model, shown)
    others = [in_mirror(model, shown(times)).resized(own.size) for times in (_SMALLER, _LARGER)]
    return geometric_mean([own, *others])


def geometric_mean(answers: Sequence[Answer]) -> Answer:
    """Return the geometric mean of the depths of several looks, of everything else the mean."""
    depth = np.exp(np.mean([np.log(answer.depth) for answer in answers], axis=0))
    return Answer.joined(answers, depth)
