from dataclasses import replace

import numpy as np
import pytest
from PIL import Image

from flexdepth.runtime.depthmap import FocalSource
from flexdepth.runtime.errors import InputError
from flexdepth.runtime.lens import FocalLength
from flexdepth.runtime.video import writing_video
from flexdepth.scenes.views import ViewFiles, read_views


@pytest.fixture
def files(tmp_path):
    for level, name in enumerate("ab"):
        Image.new("RGB", (100, 80), (40 * level,) * 3).save(tmp_path / f"{name}.png")
    return ViewFiles(tmp_path / "a.png", tmp_path / "b.png")


def test_frames_that_are_small_enough_stay_as_they_are(files):
    views = read_views(files, FocalLength(90.0), 100)
    assert views.size == (100, 80)
    assert views.reduced == (1.0, 1.0)
    assert (views.camera.focal_x, views.camera.centre_x) == (90.0, 50.0)
    assert views.warnings == ()


def test_larger_frames_are_reduced_together_with_their_camera(files):
    views = read_views(files, FocalLength(90.0), 64)
    assert views.size == (64, 51)
    assert views.camera.focal_x == pytest.approx(90 * 0.64)
    assert views.camera.centre_y == pytest.approx(25.5)
    assert "solved at 64x51" in views.warnings[0]


def test_the_focal_length_is_assumed_only_where_nobody_says_it(files, tmp_path):
    assert read_views(files, None, 100).camera.source is FocalSource.ASSUMED
    exif = Image.Exif()
    exif[0x8769] = {0xA405: 43}
    Image.new("RGB", (100, 80)).save(tmp_path / "b.jpg", exif=exif)
    found = read_views(replace(files, target=tmp_path / "b.jpg"), None, 100).camera
    assert found.source is FocalSource.EXIF
    assert found.focal_x == pytest.approx(43 / 43.27 * np.hypot(100, 80))


def test_the_same_picture_twice_is_said(files):
    views = read_views(replace(files, third=files.key), None, 100)
    assert len(views.warnings) == 1
    assert "is the same picture as the key frame" in views.warnings[0]


def test_frames_of_two_sizes_are_refused_by_name(files, tmp_path):
    Image.new("RGB", (100, 90)).save(tmp_path / "c.png")
    with pytest.raises(InputError, match=r"c\.png: is 100x90, .*a\.png is 100x80"):
        read_views(replace(files, third=tmp_path / "c.png"), None, 100)


def test_a_video_is_refused_with_the_way_to_its_frames(files, tmp_path):
    with writing_video(tmp_path / "c.mp4", 10) as writer:
        writer.write(np.zeros((80, 100, 3), np.uint8))
    with pytest.raises(InputError, match=r"is a video; two frames .*ffmpeg -i c\.mp4"):
        read_views(replace(files, target=tmp_path / "c.mp4"), None, 100)


@pytest.mark.parametrize(("name", "said"), [("none.png", "does not exist"), ("", "is a folder")])
def test_what_is_no_picture_is_refused(name, said, files, tmp_path):
    with pytest.raises(InputError, match=said):
        read_views(replace(files, target=tmp_path / name), None, 100)


def test_a_size_too_small_to_see_anything_is_refused(files):
    with pytest.raises(InputError, match="--long-side: wanted at least 64 pixels, got 20"):
        read_views(files, None, 20)
