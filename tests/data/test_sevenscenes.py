import numpy as np
import pytest

from flexdepth.data.read import Split
from flexdepth.data.sevenscenes import SevenScenes
from flexdepth.runtime.errors import InputError

POSE = "1 0 0 0.5\n0 1 0 0\n0 0 1 0\n0 0 0 1\n"


@pytest.fixture
def scene(tmp_path, picture, codes):
    """Return a function that writes frames of a sequence, without one of their files."""

    def write(sequence, numbers, lacking=""):
        folder = tmp_path / f"seq-{sequence:02d}"
        for number in numbers:
            stem = f"frame-{number:06d}"
            if lacking != "color":
                picture(folder / f"{stem}.color.png")
            if lacking != "depth":
                stored = np.full((480, 640), 1500)
                stored[0, :2] = 0, 65535
                codes(folder / f"{stem}.depth.png", stored)
            (folder / f"{stem}.pose.txt").write_text(POSE)
        return tmp_path

    return write


def test_the_lists_choose_the_sequences(scene):
    root = scene(1, (0, 1))
    scene(2, (5,))
    (root / "TrainSplit.txt").write_text("sequence2\r\nsequence1\r\n")
    (root / "TestSplit.txt").write_text("sequence1\n")
    train, test = (SevenScenes(root, split).load() for split in Split)
    assert [files.name for files in train.files] == [
        "seq-02_000005",
        "seq-01_000000",
        "seq-01_000001",
    ]
    assert [files.name for files in test.files] == ["seq-01_000000", "seq-01_000001"]
    poses = SevenScenes(root).poses()
    assert len(poses) == 3
    assert poses[0][0, 3] == 0.5


def test_both_codes_of_the_unknown_are_unknown_and_the_rest_millimetres(scene):
    root = scene(1, (0,))
    (root / "TrainSplit.txt").write_text("sequence1\n")
    truth = SevenScenes(root).load()[0].truth
    assert np.argwhere(~truth.valid).tolist() == [[0, 0], [0, 1]]
    assert truth.values[1, 1] == 1.5
    camera = truth.intrinsics
    assert (camera.focal_x, camera.focal_y, camera.centre_x, camera.centre_y) == (
        585,
        585,
        320.5,
        240.5,
    )


@pytest.mark.parametrize("lacking", ["color", "depth"])
def test_a_frame_without_a_partner_is_named(scene, lacking):
    root = scene(1, (0,))
    scene(1, (1,), lacking)
    (root / "TrainSplit.txt").write_text("sequence1\n")
    with pytest.raises(InputError, match=r"frame-000001\.\w+\.png: has no partner"):
        SevenScenes(root).load()


def test_a_list_of_other_words_or_a_sequence_that_is_not_there_is_named(scene):
    root = scene(1, (0,))
    (root / "TrainSplit.txt").write_text("sequence1\nseq-02\n")
    with pytest.raises(
        InputError, match=r"TrainSplit\.txt, line 2: wanted `sequence1`, got 'seq-02'"
    ):
        SevenScenes(root).load()
    (root / "TrainSplit.txt").write_text("sequence3\n")
    with pytest.raises(InputError, match="seq-03: no such folder"):
        SevenScenes(root).load()


def test_real_depth_agrees_with_its_poses(tmp_path, samples, reprojection_error):
    real = samples / "indoor_7scenes_redkitchen" / "frames"
    if not real.is_dir():
        pytest.skip(f"no {real}")
    (tmp_path / "seq-01").symlink_to(real)
    (tmp_path / "TrainSplit.txt").write_text("sequence1\n")
    scene = SevenScenes(tmp_path)
    pairs, poses = scene.load(), scene.poses()
    assert len(pairs) == len(poses) == 180
    assert reprojection_error(pairs[0], pairs[20], poses[0], poses[20]) < 0.005
