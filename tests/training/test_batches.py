import pytest
import torch

from flexdepth.data.recipes import KittiCrop, NyuCrop
from flexdepth.data.transforms import Colour
from flexdepth.training.batches import Batches, BatchSettings, loader, whole

SETTINGS = BatchSettings(size=2, shapes=((32, 32), (64, 32)), seed=7)


def test_a_batch_depends_on_its_number_alone(pairs):
    first, again = Batches(pairs, SETTINGS, 9)[4], Batches(pairs, SETTINGS, 100)[4]
    assert first.name == again.name
    assert torch.equal(first.key.image, again.key.image)
    assert not torch.equal(first.key.camera.focal, Batches(pairs, SETTINGS, 9)[5].key.camera.focal)


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


def test_whole_pairs_are_neither_cropped_nor_recoloured(pairs):
    batch = whole(pairs, [1, 3])
    assert batch.name == ("1", "3")
    assert torch.equal(
        (batch.key.image[1] * 255).round().byte(),
        torch.from_numpy(pairs[3].image.transpose(2, 0, 1).copy()),
    )
