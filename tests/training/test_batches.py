from dataclasses import replace

import pytest
import torch
from torch.testing import assert_close

from flexdepth.data.colour import Colour
from flexdepth.data.folder import Folder
from flexdepth.data.recipes import KittiCrop, NyuCrop
from flexdepth.runtime.errors import InputError
from flexdepth.training.batches import Batches, BatchSettings, divided, loader

SETTINGS = BatchSettings(size=2, shapes=((32, 32), (64, 32)), seed=7)


def test_a_batch_depends_on_its_number_alone(pairs):
    first, again = Batches(pairs, SETTINGS, 9)[4], Batches(pairs, SETTINGS, 100)[4]
    assert first.name == again.name
    assert torch.equal(first.key.image, again.key.image)
    assert not torch.equal(first.key.camera.focal, Batches(pairs, SETTINGS, 9)[5].key.camera.focal)


def test_the_batches_of_a_seed_stay_what_they_are(pairs):
    """Recorded with the colours of `data/colour.py`, which draw from the same generator."""
    first, second = Batches(pairs, SETTINGS, 9)[0], Batches(pairs, SETTINGS, 9)[1]
    assert (first.name, second.name) == (("2", "0"), ("4", "1"))
    assert first.key.image.shape[-2:] == (32, 64)
    centres = [[19.692308, 13.714286], [21.333334, 22.666666]]
    assert_close(first.key.camera.centre, torch.tensor(centres))
    assert_close(second.key.camera.focal, torch.tensor([[59.733334, 64.0], [39.822224, 37.333332]]))
    assert first.truth.depth.sum().item() == pytest.approx(23454.477, rel=1e-6)


def test_every_pair_is_seen_once_before_any_is_seen_again(pairs):
    batches = Batches(pairs, SETTINGS, 5)
    names = [name for number in range(5) for name in batches[number].name]
    assert sorted(names[:5]) == ["0", "1", "2", "3", "4"]
    assert sorted(names[5:]) == ["0", "1", "2", "3", "4"]
    assert names[:5] != names[5:]


def test_batches_take_all_shapes(pairs):
    batches = Batches(pairs, SETTINGS, 20)
    shapes = {tuple(batches[number].key.image.shape) for number in range(20)}
    assert shapes == {(2, 3, 32, 32), (2, 3, 32, 64)}


@pytest.mark.parametrize("recipe", [NyuCrop(), KittiCrop()])
def test_batches_take_the_recipes_of_chapter_3(pairs, recipe):
    settings = BatchSettings(size=2, shapes=((32, 48),), crop=recipe, colour=Colour(0.0))
    batch = Batches(pairs, settings, 1)[0]
    assert batch.key.image.shape == (2, 3, 48, 32)
    assert batch.truth.valid.any()


def test_a_resumed_run_sees_what_an_uninterrupted_one_sees(pairs):
    batches = Batches(pairs, SETTINGS, 6)
    straight = [batch.key.image for batch in loader(batches, 0, 0)]
    resumed = [batch.key.image for batch in loader(batches, 4, 0)]
    assert len(resumed) == 2
    assert all(torch.equal(a, b) for a, b in zip(straight[4:], resumed, strict=True))


def test_other_processes_make_the_same_batches(pairs):
    batches = Batches(pairs, SETTINGS, 3)
    own = [batch.key.image for batch in loader(batches, 0, 0)]
    others = [batch.key.image for batch in loader(batches, 0, 1)]
    assert all(torch.equal(a, b) for a, b in zip(own, others, strict=True))


def test_the_parts_of_a_batch_are_the_batch(pairs):
    whole = Batches(pairs, replace(SETTINGS, size=4), 9)
    parts = [replace(whole, part=part, parts=2)[5] for part in (0, 1)]
    divided_batch = list(divided(whole[5], 2))
    for each in (parts, divided_batch):
        assert each[0].name + each[1].name == whole[5].name
        assert [part.draw for part in each] == [5, 5]
        for field in (lambda b: b.key.image, lambda b: b.key.camera.focal, lambda b: b.truth.depth):
            assert torch.equal(torch.cat([field(part) for part in each]), field(whole[5]))


def test_a_file_that_another_process_cannot_read_stops_the_run_in_one_line(tmp_path):
    for folder, content in (("image", b"GIF89a"), ("depth", b"PK")):
        (tmp_path / folder).mkdir()
        (tmp_path / folder / ("a.png" if folder == "image" else "a.npz")).write_bytes(content)
    batches = Batches(Folder(tmp_path).load(), SETTINGS, 3)
    with pytest.raises(InputError, match=r"a\.png: ") as stopped:
        list(loader(batches, 0, 1))
    assert "\n" not in str(stopped.value)


@pytest.mark.parametrize(
    "wrong", [{"size": 0}, {"shapes": ()}, {"shapes": ((32, 0),)}, {"seed": -1}]
)
def test_batches_of_nothing_are_refused(wrong):
    with pytest.raises(InputError, match="a batch needs a size >= 1"):
        BatchSettings(**wrong)
