import pytest

from flexdepth.networks import AGA, EDRB, PCA, Compact
from flexdepth.networks.aga import BASE
from flexdepth.networks.encoders import Encoder
from flexdepth.networks.merge import VARIANTS
from flexdepth.networks.parts import parts
from flexdepth.runtime.errors import InputError


@pytest.fixture(scope="module")
def base():
    return {part.name: part for part in parts(BASE, 384, 384)}


def test_the_whole_comes_first_and_costs_what_was_published(base):
    whole = next(iter(base.values()))
    assert whole.name == ""
    assert whole.parameters == 90_436_054
    assert whole.multiplications / 1e9 == pytest.approx(178, abs=0.5)


def test_half_of_the_cost_is_the_last_stage_and_the_head(base):
    assert base["last"].multiplications / 1e9 == pytest.approx(45.9, abs=0.05)
    assert base["head"].multiplications / 1e9 == pytest.approx(51.0, abs=0.05)


def test_a_convolution_is_counted_once_for_each_weight_and_place(base):
    # 64 filters of 7 x 7 x 3 at 192 x 192 places.
    assert base["encoder.conv1"].multiplications == 64 * 7 * 7 * 3 * 192 * 192
    assert base["encoder.conv1"].parameters == 64 * 7 * 7 * 3


@pytest.mark.parametrize("network", [BASE, Compact(), EDRB()], ids=["base", "compact", "edrb"])
def test_parts_add_up_to_the_whole(network):
    whole, *rest = parts(network, 128, 96)
    for what in ("parameters", "multiplications"):
        ends = [p for p in rest if not any(q.name.startswith(f"{p.name}.") for q in rest)]
        assert sum(getattr(p, what) for p in ends) == getattr(whole, what)


def test_most_of_the_work_of_edrb_is_done_on_its_largest_maps():
    found = {part.name: part for part in parts(EDRB(), 512, 384)}
    first, second, last = (found[f"rows.encoder.{n}"].multiplications for n in (0, 1, 4))
    # Nine 3 x 3 convolutions and a last one of 256 channels at a half of the size, after a
    # first one with the stride; a 1 x 1 convolution of three channels at the whole.
    assert first == 10 * 9 * 256**2 * (192 * 256) + 3 * 256 * (384 * 512)
    assert second > 10 * last


def test_components_cost_each_of_their_pixels_once():
    network = PCA()
    whole, *rest = parts(network, 128, 96)
    # What is left is the sum of 64 components of 48 x 64 pixels.
    ends = [p for p in rest if not any(q.name.startswith(f"{p.name}.") for q in rest)]
    assert whole.multiplications - sum(p.multiplications for p in ends) == 64 * 48 * 64
    assert whole.parameters == sum(p.parameters for p in ends)


def test_looking_everywhere_costs_every_pixel_times_every_pixel():
    here, everywhere = (parts(AGA().merged_by(VARIANTS[v]), 64, 64) for v in ("S7", "NS7"))
    # At 4 x 4, 4 x 4, 8 x 8 and 16 x 16 places; the embedding's width and the features'.
    pairs = (16**2 * (32 + 512), 16**2 * (16 + 256), 64**2 * (16 + 256), 256**2 * (16 + 256))
    assert everywhere[0].multiplications - here[0].multiplications == sum(pairs)


def test_an_encoder_that_takes_no_such_image_is_named():
    mixer = AGA(encoder=Encoder("maxvit_pico_rw_256", 32))
    with pytest.raises(InputError, match="maxvit_pico_rw_256 takes no image of 384 x 380 pixels"):
        parts(mixer, 384, 380)
