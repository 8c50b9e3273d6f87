import pytest

from flexdepth.data.diw import Diw, DiwSplit
from flexdepth.runtime.errors import InputError


@pytest.fixture
def photos(tmp_path, picture):
    for name in ("a1", "b2"):
        picture(tmp_path / "DIW_test" / f"{name}.thumb", 8, 6)
    path = tmp_path / "DIW_test.csv"
    path.write_text("./DIW_test/a1.thumb\n1,2,6,8,>,8,6\n./DIW_test/b2.thumb\n1,2,6,8,<,8,6\n")
    return path


def test_rows_come_before_columns_from_one_and_the_sign_says_which_is_farther(photos):
    pairs = Diw(photos.parent).load()
    assert [pairs[n].name for n in range(2)] == ["a1", "b2"]
    assert (pairs[0].farther, pairs[0].nearer) == ((1, 0), (7, 5))
    assert (pairs[1].farther, pairs[1].nearer) == ((7, 5), (1, 0))
    assert pairs[0].image.shape == (6, 8, 3)


@pytest.mark.parametrize(
    ("old", "new", "complaint"),
    [
        ("1,2,6,8,<", "1,2,6,8,=", r"DIW_test\.csv, line 4: wanted yA,xA"),
        ("1,2,6,8,<", "1,2,6,eight,<", r"DIW_test\.csv, line 4: wanted points and a size"),
        ("b2.thumb", "c3.thumb", r"DIW_test\.csv, line 4: looked for .*c3\.thumb"),
        ("./DIW_test/b2.thumb\n", "", r"DIW_test\.csv: wanted two lines a photo.*got 3"),
    ],
)
def test_a_line_that_is_no_pair_is_named(photos, old, new, complaint):
    photos.write_text(photos.read_text().replace(old, new))
    with pytest.raises(InputError, match=complaint):
        Diw(photos.parent).load()


@pytest.mark.parametrize("points", ["1,2,7,8,<,8,6", "1,2,6,8,<,6,8"])
def test_points_outside_and_photos_of_another_size_are_named(photos, points):
    photos.write_text(f"./DIW_test/a1.thumb\n{points}\n")
    with pytest.raises(InputError, match=r"a1\.thumb: has 8x6 pixels, but its list says"):
        Diw(photos.parent).load()[0]


def test_a_missing_list_is_named(photos):
    with pytest.raises(InputError, match=r"DIW_train\.csv: no such file"):
        Diw(photos.parent, DiwSplit.TRAIN).load()
