import numpy as np
import pytest
from scipy.io import savemat

from flexdepth.data.make3d import Make3d, Make3dLayer
from flexdepth.data.read import Split
from flexdepth.runtime.errors import InputError


@pytest.fixture
def photo(tmp_path, picture):
    """Return a function that writes a photo of 6 x 4 pixels with a grid of 2 x 3 cells."""

    def write(name, images="Train400Img", depths="Train400Depth", layers=4):
        picture(tmp_path / images / f"img-{name}.jpg", 6, 4)
        grid = np.zeros((2, 3, layers))
        grid[..., -1] = [[1, 2, 3], [4, 5, 0]]
        grid[..., -2] = 0.5 * grid[..., -1]
        (tmp_path / depths).mkdir(exist_ok=True)
        savemat(tmp_path / depths / f"depth_sph_corr-{name}.mat", {"Position3DGrid": grid})

    return write


def test_each_cell_of_the_grid_is_a_block_of_the_photo(tmp_path, photo):
    photo("10.21op2-p-015t000")
    (pair,) = Make3d(tmp_path).load()
    assert pair.name == "10.21op2-p-015t000"
    assert pair.truth.intrinsics is None
    assert pair.truth.values[:2].tolist() == [[1, 1, 2, 2, 3, 3]] * 2
    assert pair.truth.values[2:, :4].tolist() == [[4, 4, 5, 5]] * 2
    assert np.isnan(pair.truth.values[2:, 4:]).all()
    (depth,) = Make3d(tmp_path, layer=Make3dLayer.DEPTH).load()
    assert depth.truth.values[3, 3] == 2.5


def test_the_test_photos_lie_in_folders_of_their_own(tmp_path, photo):
    photo("op1-p-1", "Test134", "Gridlaserdata")
    assert len(Make3d(tmp_path, Split.TEST).load()) == 1
    with pytest.raises(InputError, match="Train400Img: no such folder"):
        Make3d(tmp_path).load()


def test_a_photo_without_a_grid_and_a_grid_of_another_shape_are_named(tmp_path, photo):
    photo("a", layers=3)
    with pytest.raises(
        InputError, match=r"corr-a\.mat: .*55 x 305 x 4 is wanted, it is \(2, 3, 3\)"
    ):
        Make3d(tmp_path).load()[0]
    photo("b")
    (tmp_path / "Train400Depth" / "depth_sph_corr-b.mat").unlink()
    with pytest.raises(InputError, match=r"img-b\.jpg: has no partner"):
        Make3d(tmp_path).load()
