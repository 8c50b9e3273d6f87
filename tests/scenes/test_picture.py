from dataclasses import replace

import numpy as np

from flexdepth.runtime.depthmap import DepthMap, Space
from flexdepth.scenes.picture import (
    border_picture,
    borders,
    motion_panels,
    motion_picture,
    moving_picture,
    solution_picture,
)


def test_borders_lie_on_both_sides_of_where_two_parts_meet():
    labels = np.zeros((6, 8), int)
    labels[2:4, 3:6] = 7
    edge = borders(labels)
    assert edge[2:4, 3:6].all()  # two rows and three columns: each is at the rim
    assert edge[1, 3:6].all()
    assert edge[2, 2]
    assert not edge[0].any()
    assert not edge[1, 2]  # only across and down, not diagonally
    assert not borders(np.zeros((6, 8), int)).any()


def test_the_mask_is_white_where_things_move(found):
    mask = moving_picture(found)
    assert ((mask == 255).all(-1) == found.moving).all()
    assert set(np.unique(mask)) == {0, 255}


def test_parts_have_their_colours_and_black_between_them(found):
    picture = border_picture(found)
    black = (picture == 0).all(-1)
    np.testing.assert_array_equal(black, borders(found.labels))
    assert len({tuple(c) for c in picture[~black]}) == 2


def test_the_six_maps_are_white_where_the_camera_alone_moves(solution):
    panels = motion_panels(solution)
    assert [panel.title[:2] for panel in panels] == ["kx", "ky", "kz", "tx", "ty", "tz"]
    still = ~solution.found.moving
    for panel in panels:
        assert panel.picture[still].min() > 240
    vertical = panels[4]  # the square goes up: t_y is half a step below the camera's
    assert (vertical.picture[~still] == (33, 102, 172)).all()
    assert vertical.legend.marks == ("-0.50", "0.00", "0.50")


def test_everything_is_shown_on_one_sheet(solution):
    whole = solution_picture(solution)
    depth = DepthMap(np.full((36, 48), 2, np.float32), Space.METRIC, solution.camera)
    share = np.full((36, 48), 0.5)
    more = replace(solution, prior=depth, found=replace(solution.found, prior_share=share))
    fuller = solution_picture(more)
    assert fuller.shape == whole.shape
    assert (fuller != whole).any()
    assert motion_picture(solution).shape[1] == whole.shape[1]


def test_a_solution_without_any_depth_is_shown(solution, found):
    nothing = replace(found, depth=np.full_like(found.depth, np.nan))
    assert solution_picture(replace(solution, found=nothing)).size
