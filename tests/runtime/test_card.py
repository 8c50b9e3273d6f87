import pytest

from flexdepth.runtime.card import Colours, FocalIn, Layout, read_card
from flexdepth.runtime.depthmap import Space
from flexdepth.runtime.errors import InputError

LEAST = "input: {size: [4, 2]}\noutput: {space: affine_disparity}\n"


def card(folder, text):
    path = folder / "net.yaml"
    path.write_text(text)
    return path


def refusal(folder, text):
    with pytest.raises(InputError) as caught:
        read_card(card(folder, text))
    said = str(caught.value)
    assert "\n" not in said
    assert said.startswith(f"{folder / 'net.yaml'}: ")
    return said.removeprefix(f"{folder / 'net.yaml'}: ")


def test_what_a_card_leaves_out_has_a_plain_meaning(tmp_path):
    found = read_card(card(tmp_path, LEAST))
    assert (found.onnx, found.name, found.licence) == (tmp_path / "net.onnx", "net", "unknown")
    assert (found.input.area, found.input.multiple) == ((4, 2), None)
    assert (found.input.layout, found.input.colours) == (Layout.NCHW, Colours.RGB)
    assert found.normalisation.scale == pytest.approx(1 / 255)
    assert (found.normalisation.mean, found.normalisation.std) == ((0, 0, 0), (1, 1, 1))
    said = found.output
    assert (said.space, said.inverse, said.unit) == (Space.AFFINE_DISPARITY, False, 1)
    assert said.focal_in_pixels(4, 3) is None


def test_a_card_says_everything(tmp_path):
    found = read_card(
        card(
            tmp_path,
            """
onnx: weights/other.onnx
name: Other
licence: CC-BY-NC-4.0
input: {name: pixels, area: [384, 288], multiple: 32, layout: nhwc, colours: bgr}
normalisation: {scale: 1, mean: [104, 117.5, 123], std: [2, 2, 2]}
output: {name: z, space: metric, inverse: true, unit: 0.001, canonical_focal: 500}
""",
        )
    )
    assert found.onnx == tmp_path / "weights" / "other.onnx"
    assert (found.name, found.licence) == ("Other", "CC-BY-NC-4.0")
    assert (found.input.area, found.input.multiple) == ((384, 288), 32)
    assert (found.input.layout, found.input.colours) == (Layout.NHWC, Colours.BGR)
    assert found.normalisation.mean == (104, 117.5, 123)
    assert (found.output.inverse, found.output.unit) == (True, 0.001)
    assert found.output.focal_in_pixels(400, 300) == 500


@pytest.mark.parametrize(("unit", "pixels"), [("pixels", 0.5), ("widths", 200), ("diagonals", 250)])
def test_a_canonical_focal_length_counts_in_what_the_card_says(unit, pixels, tmp_path):
    text = f"output: {{space: metric, canonical_focal: 0.5, canonical_focal_in: {unit}}}"
    found = read_card(card(tmp_path, f"input: {{size: [4, 2]}}\n{text}"))
    assert found.output.canonical_focal_in is FocalIn(unit)
    assert found.output.focal_in_pixels(400, 300) == pytest.approx(pixels)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("# nothing", "a card: wanted fields"),
        ("just words", "a card: wanted fields"),
        ("a: [", "wanted a YAML card"),
        ("!!python/object/apply:os.system ['true']", "wanted a YAML card"),
        ("input: {size: [4, 2]}", "`output`: wanted fields, got nothing"),
        (LEAST + "licens: MIT", "`licens`: no such field; wanted some of onnx, name, licence"),
        ("input: 4\noutput: {space: scale}", "`input`: wanted fields"),
        ("input: {size: 4}\noutput: {space: scale}", "`input.size`: wanted [width, height]"),
        ("input: {size: [4, 0]}\noutput: {space: scale}", "`input.size`: wanted [width, height]"),
        ("input: {}\noutput: {space: scale}", "`input.size`: wanted either `size`"),
        (
            "input: {size: [4, 2], area: [4, 2], multiple: 2}\noutput: {space: scale}",
            "`input.size`: wanted either `size`",
        ),
        ("input: {area: [4, 2]}\noutput: {space: scale}", "`input.multiple`: goes with `area`"),
        (
            "input: {size: [4, 2], layout: chw}\noutput: {space: scale}",
            "`input.layout`: wanted one of nchw, nhwc, got 'chw'",
        ),
        ("input: {size: [4, 2]}\noutput: {}", "`output.space`: wanted one of metric, scale"),
        (
            "input: {size: [4, 2]}\noutput: {space: metres}",
            "`output.space`: wanted one of metric, scale, affine_depth, affine_disparity, got",
        ),
        (
            "input: {size: [4, 2]}\noutput: {space: affine_disparity, inverse: true}",
            "`output.inverse`: wanted with the space metric or scale",
        ),
        (
            "input: {size: [4, 2]}\noutput: {space: scale, canonical_focal: 1}",
            "`output.canonical_focal`: wanted with the space metric",
        ),
        ("input: {size: [4, 2]}\noutput: {space: metric, unit: -1}", "`output.unit`: wanted a num"),
        (LEAST + "normalisation: {mean: [1, 2]}", "`normalisation.mean`: wanted three numbers"),
        (
            LEAST + "normalisation: {std: [1, 1, 0]}",
            "`normalisation.std`: wanted three numbers > 0",
        ),
        (LEAST + "normalisation: {scale: 1e-3}", "`normalisation.scale`: wanted a number > 0"),
    ],
)
def test_what_is_wrong_with_a_card_is_said_by_file_and_field(text, said, tmp_path):
    assert refusal(tmp_path, text).startswith(said)


def test_a_card_that_is_not_there_is_named(tmp_path):
    with pytest.raises(InputError, match=r"none\.yaml: does not exist"):
        read_card(tmp_path / "none.yaml")
