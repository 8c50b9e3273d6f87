"""What a region's border tells of what is beside it."""

import numpy as np

from flexdepth.solvers.borders import border, surroundings

HEIGHT, WIDTH = 40, 60


def around():
    """Return a floor that comes nearer downwards, all of it seen."""
    inverse = np.broadcast_to(0.1 + 0.01 * np.arange(HEIGHT)[:, None], (HEIGHT, WIDTH)).copy()
    everywhere = np.ones((HEIGHT, WIDTH), bool)
    return surroundings(inverse, everywhere, np.zeros((HEIGHT, WIDTH, 2)), everywhere)


def test_below_another_moving_thing_is_not_beside_the_region():
    inside, others = np.zeros((2, HEIGHT, WIDTH), bool)
    inside[10:20, 20:40] = True
    others[20:23, 20:34] = True
    seen = border(inside, np.ones((HEIGHT, WIDTH)), around(), others)
    assert sorted(seen.column[seen.down]) == list(range(34, 40))


def test_the_lowest_pixels_are_known_even_where_the_picture_ends():
    inside = np.zeros((HEIGHT, WIDTH), bool)
    inside[10:HEIGHT, 20:40] = True
    inside[30:, 30:] = False
    seen = border(inside, np.ones((HEIGHT, WIDTH)), around())
    # Ten pixels at the picture's edge, and ten of which the floor is seen below.
    assert sorted(seen.lower) == [29] * 10 + [HEIGHT - 1] * 10
    assert sorted(seen.column[seen.down]) == list(range(30, 40))
