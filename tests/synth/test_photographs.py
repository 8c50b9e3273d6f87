import json

import cv2
import numpy as np
import pytest

from flexdepth.runtime.errors import InputError
from flexdepth.synth.generate import SynthSettings, write_images
from flexdepth.synth.landscapes import under
from flexdepth.synth.library import NAMES, PRINTS, WHOLE, Library
from flexdepth.synth.patterns import PATTERNS, SIZE
from flexdepth.synth.photographs import cuts, digest, photograph_files, photographs, skies
from flexdepth.synth.prints import PICTURES
from flexdepth.synth.render import render
from flexdepth.synth.rooms import office
from flexdepth.synth.skies import weather
from flexdepth.synth.skylight import Dome
from flexdepth.synth.stage import Stage
from flexdepth.synth.viewpoints import viewpoint

SKY = np.array([110, 160, 230], np.uint8)


def landscape(horizon=60, sky=SKY):
    """A smooth sky that ends at row `horizon` of 120, and what stands below it."""
    picture = np.random.default_rng(0).integers(0, 256, (120, 160, 3)).astype(np.uint8)
    picture[:horizon] = sky
    return picture


def save(path, picture):
    path.parent.mkdir(exist_ok=True, parents=True)
    cv2.imwrite(str(path), picture[..., ::-1])


@pytest.fixture
def folder(tmp_path):
    save(tmp_path / "photos" / "b.png", landscape())
    save(tmp_path / "photos" / "deeper" / "a.png", np.full((40, 30, 3), (200, 30, 90), np.uint8))
    (tmp_path / "photos" / "notes.txt").write_text("no picture")
    return tmp_path / "photos"


def linear(colour):
    return (np.asarray(colour) / 255) ** 2.2


def test_photographs_are_found_in_folders_of_folders_by_name(folder):
    assert [path.name for path in photograph_files(folder)] == ["b.png", "a.png"]


def test_a_folder_without_photographs_is_refused(tmp_path):
    with pytest.raises(InputError, match="no such folder of photos"):
        photograph_files(tmp_path / "none")
    with pytest.raises(InputError, match="holds no photo"):
        photograph_files(tmp_path)


def test_a_photograph_that_is_shrunk_has_tones_between_those_of_8_bits(tmp_path):
    """Halved from 960 columns of 10 and 11 in turn, it is 10.5 all over."""
    fine = np.full((20, 960, 3), 10, np.uint8)
    fine[:, ::2] = 11
    save(tmp_path / "fine.png", fine)
    (small,) = photographs(np.random.default_rng(0), photograph_files(tmp_path))
    assert small.shape == (10, 480, 3)
    assert small == pytest.approx(linear(10.5), rel=1e-3)


def test_a_digest_knows_what_is_shown_and_not_where(folder, tmp_path):
    before = digest(photograph_files(folder))
    moved = folder.rename(tmp_path / "elsewhere")
    assert digest(photograph_files(moved)) == before
    save(moved / "b.png", landscape(50))
    assert digest(photograph_files(moved)) != before


def test_photographs_are_small_and_in_linear_light(tmp_path):
    save(tmp_path / "wide.png", np.full((300, 960, 3), (0, 128, 255), np.uint8))
    (photo,) = photographs(np.random.default_rng(0), photograph_files(tmp_path))
    assert photo.shape == (150, 480, 3)
    assert photo[70, 200] == pytest.approx([0, 0.2195, 1], abs=1e-3)


def test_no_more_photographs_are_read_than_a_world_shows(tmp_path):
    for number in range(70):
        save(tmp_path / f"{number}.png", np.full((8, 8, 3), number, np.uint8))
    found = photographs(np.random.default_rng(0), photograph_files(tmp_path))
    assert len({float(photo[0, 0, 0]) for photo in found}) == len(found) == 64


def test_cuts_show_each_photograph_alike_and_at_least_half_of_each_side():
    ramp = np.broadcast_to(np.linspace(0, 1, 200, dtype=np.float32)[None, :, None], (90, 200, 3))
    flat = np.full((50, 50, 3), 2, np.float32)
    found = cuts(np.random.default_rng(0), [ramp, flat], 10)
    assert all(cut.shape == (SIZE, SIZE, 3) for cut in found)
    assert sum(bool((cut == 2).all()) for cut in found) == 5
    assert all(cut[0, -1, 0] - cut[0, 0, 0] > 0.48 for cut in found[::2])


@pytest.mark.parametrize("horizon", [40, 60, 90])
def test_a_sky_ends_a_little_above_the_horizon(horizon):
    (sky,) = skies([linear(landscape(horizon)).astype(np.float32)])
    assert horizon - 8 <= len(sky) < horizon
    assert sky == pytest.approx(np.broadcast_to(linear(SKY), sky.shape), abs=1e-6)


def test_soft_clouds_are_sky():
    rows, columns = np.mgrid[:120, :160]
    cloud = np.exp(-((rows - 25) ** 2 + (columns - 70) ** 2) / 300)[..., None]
    picture = landscape().astype(float)
    picture[:60] += (cloud * (255 - picture))[:60]
    assert len(skies([linear(picture).astype(np.float32)])) == 1


@pytest.mark.parametrize(
    ("horizon", "colour"),
    [(20, SKY), (60, (60, 160, 50)), (60, (5, 8, 20)), (60, (250, 20, 150))],
    ids=["low", "leaf", "night", "paint"],
)
def test_what_is_no_sky_is_left(horizon, colour):
    assert skies([linear(landscape(horizon, colour)).astype(np.float32)]) == []


def test_every_second_picture_is_a_photograph_and_nothing_else_changes():
    red = np.zeros((60, 80, 3), np.float32)
    red[..., 0] = 1
    bare = Library.made(np.random.default_rng(0), 4).levels[0]
    hung = Library.made(np.random.default_rng(0), 4, [red]).levels[0]
    changed = {
        (NAMES[k // 4], k % 4) for k in range(len(bare)) if not np.array_equal(bare[k], hung[k])
    }
    shown = [name for name in PICTURES if name not in ("carpet", "petals", "tunnel")]
    assert changed == {(name, odd) for name in shown for odd in (1, 3)}
    assert len(shown) < len(PRINTS)
    first = 4 * (len(PATTERNS) + list(PRINTS).index("portrait")) + 1
    assert (hung[first] == (WHOLE, 0, 0)).all()


def domes(photo, count=40):
    rng = np.random.default_rng(2)
    scene = under(rng, [], weather(rng))
    return [Dome.drawn(rng, scene, [photo]) for _ in range(count)]


def test_about_half_of_the_skies_are_photographs():
    photo = np.full((50, 100, 3), 0.3, np.float32)
    shown = [dome.photographed is not None for dome in domes(photo, 200)]
    assert 80 < sum(shown) < 120


def test_a_photographed_sky_has_no_seam_and_is_as_bright_as_the_sky():
    ramp = np.linspace(0.2, 1, 100, dtype=np.float32)[None, :, None]
    photo = np.broadcast_to(ramp, (50, 100, 3))
    turn = np.linspace(-np.pi, np.pi, 721)
    level = np.stack([np.sin(turn), np.full(721, 0.05), np.cos(turn)], -1).astype(np.float32)
    dome = next(dome for dome in domes(photo) if dome.photographed is not None)
    light = dome.light(level)
    assert np.abs(np.diff(light, axis=0)).max() < 0.02 * light.max()
    assert light.max() > 3 * light.min()
    expected = (dome.scene.horizon + dome.scene.zenith).mean() / 2
    assert 0.75 * expected < light.mean() < 1.25 * expected


def test_the_horizon_of_a_photograph_lies_at_the_horizon():
    photo = np.full((50, 100, 3), 0.2, np.float32)
    photo[-1] = (5, 0, 0)
    dome = next(dome for dome in domes(photo) if dome.photographed is not None)
    down, at, above = dome.light(np.array([[0, -1, 1], [0, 0, 1], [0, 0.3, 1]], np.float32))
    assert at[0] > 0
    assert at[1] == at[2] == 0
    assert down == pytest.approx(at)
    assert above[0] == above[1] == above[2] > 0


def test_worlds_with_and_without_photographs_do_not_mix(folder, tmp_path):
    small = SynthSettings(seed=3, width=64, height=48)
    hung = SynthSettings(seed=3, width=64, height=48, photographs=folder)
    list(write_images(hung, 1, tmp_path / "world", 1))
    said = json.loads((tmp_path / "world" / "world.json").read_text())
    assert said["photographs"] == digest(photograph_files(folder))
    with pytest.raises(InputError, match="of another world"):
        list(write_images(small, 1, tmp_path / "world", 1))


def test_photographs_change_what_is_seen_and_not_how_deep_it_is():
    def taken(photos):
        rng = np.random.default_rng(4)
        stage = Stage.built(rng, office(rng), Library.made(np.random.default_rng(0), 2, photos))
        return render(rng, stage, viewpoint(rng, stage.scene, 4 / 3), 160, 120)

    bare, hung = taken([]), taken([np.full((50, 50, 3), (1, 0, 1), np.float32)])
    np.testing.assert_array_equal(bare.depth, hung.depth)
    assert not np.array_equal(bare.light, hung.light)
