import pytest

from flexdepth.cli.show import run
from flexdepth.experiments.catalogue import experiment_named
from flexdepth.runtime.errors import InputError


def rows(text: str) -> dict[str, list[str]]:
    return {" ".join(line.split()[:-2]): line.split()[-2:] for line in text.splitlines()[1:]}


def test_the_table_has_the_totals_of_base_and_main_variant(capsys):
    assert run(["aga"]) == 0
    table = rows(capsys.readouterr().out)
    assert table["total S1 (base)"] == ["90,436,054", "178.230"]
    assert table["total S7 (AGA)"][0] == "90,464,726"
    assert table["encoder"][0] == "42,128,704"
    assert table["stages.3.merge"][0] == "28,672"


def test_encoder_variant_bins_and_size_are_options(capsys):
    options = {"--encoder": "resnext50_32x4d", "--variant": "S5", "--bins": "100"}
    asked = [word for option in options.items() for word in option]
    assert run(["aga", *asked, "--size", "192", "192"]) == 0
    out = capsys.readouterr().out
    assert "GMAC at 192 x 192" in out
    table = rows(out)
    assert table["total S1 (base)"][0] == "71,172,004"
    assert table["total S5"][0] == f"{71_172_004 + 57_344:,}"


def test_the_bundled_model_s_network_can_be_shown(capsys):
    assert run(["compact"]) == 0
    assert "total compact" in capsys.readouterr().out


@pytest.mark.parametrize(("name", "parameters"), [("edrb", "133,638,806"), ("pca", "4,643,457")])
def test_the_other_networks_of_chapter_3_can_be_shown(name, parameters, capsys):
    assert run([name]) == 0
    assert rows(capsys.readouterr().out)[f"total {name}"][0] == parameters


def test_an_experiment_is_shown_as_a_file_that_is_the_same_experiment(capsys, tmp_path):
    assert run(["experiment", "nyu-small"]) == 0
    file = tmp_path / "same.yaml"
    file.write_text(capsys.readouterr().out)
    assert experiment_named(str(file)) == experiment_named("nyu-small")


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        ([], "name what to show, one of ['aga', "),
        (["agga"], "'agga' cannot be shown; did you mean 'aga'?"),
        (["nothing"], "'nothing' cannot be shown; choose one of ['aga', "),
        (["experiment", "kity"], "no experiment 'kity'; did you mean 'kitti'?"),
    ],
)
def test_a_wrong_name_is_answered_with_the_right_ones(arguments, said):
    with pytest.raises(InputError) as refused:
        run(arguments)
    assert said in str(refused.value)


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["--encoder", "resnet51"], "no encoder 'resnet51'"),
        (["--encoder", "resnet51"], "did you mean 'resnet5"),
        (["--encoder", "nosuchnet"], "no encoder 'nosuchnet'"),
        (["--encoder", "densenet121"], "or the stride 32"),
        (["--size", "0", "9"], "--size is a width and a height in pixels, got 0 9"),
        (["--bins", "0"], "depth bins need count >= 1"),
    ],
)
def test_what_cannot_be_shown_is_said_in_one_line(arguments, said):
    with pytest.raises(InputError) as refused:
        run(["aga", *arguments])
    assert said in str(refused.value)
    assert "\n" not in str(refused.value)
