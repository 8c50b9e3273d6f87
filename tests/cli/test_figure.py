import pytest
import torch
from PIL import Image
from torch import nn

from flexdepth.cli import figure
from flexdepth.cli.main import main
from flexdepth.runtime.images import read_photo
from flexdepth.sample import Prediction
from flexdepth.synth.generate import SynthSettings, write_images


class OneMerge(nn.Module):
    def forward(self, image):
        _, _, rows, columns = image.shape
        attention = torch.linspace(0, 1, 12).reshape(1, 1, 3, 4)
        return Prediction(torch.full((1, rows, columns), 2.0), 0.8, None, (attention,))


@pytest.fixture
def network(monkeypatch):
    asked = []

    def network_with(start):
        asked.append(start)
        return OneMerge()

    monkeypatch.setattr(figure, "network_with", network_with)
    return asked


@pytest.mark.usefixtures("network")
@pytest.mark.parametrize("kind", ["attention", "edges"])
def test_each_photo_gets_a_figure_of_its_name(kind, here, capsys):
    for name in ("a.png", "b.jpg"):
        Image.new("RGB", (64, 48)).save(here / name)
    assert main(["figure", kind, "a.png", "b.jpg", "-o", "out"]) == 0
    assert {path.name for path in (here / "out").iterdir()} == {f"a.{kind}.png", f"b.{kind}.png"}
    assert capsys.readouterr().out.splitlines() == [f"out/a.{kind}.png", f"out/b.{kind}.png"]
    assert read_photo(here / "out" / f"a.{kind}.png").pixels.shape[1] > 384


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["attention"], "name at least one photo"),
        (["attention", "none.jpg"], "none.jpg"),
        (["attention", "a.png", "--weights", "imagenet"], "a trained network was wanted"),
        (["attention", "a.png", "--weights", "a.pt"], "--weights: wanted bundled,"),
        (["pca", "nowhere"], "no such folder; a data folder holds"),
        (["photos"], "photos"),
    ],
)
@pytest.mark.usefixtures("here")
def test_a_mistake_is_told_in_one_line(arguments, said, capsys):
    assert main(["figure", *arguments]) == 2
    line = capsys.readouterr().err
    assert said in line
    assert line.count("\n") == 1


def test_emphasis_is_drawn_in_the_format_of_its_name(here):
    assert main(["figure", "emphasis", "-o", "emphasis.svg"]) == 0
    assert "<svg" in (here / "emphasis.svg").read_text(encoding="utf-8")


def test_components_are_counted_for_a_folder(here, capsys):
    list(write_images(SynthSettings(seed=5, width=64, height=48), 3, here / "renders", 1))
    arguments = ["--rows", "3", "--columns", "4", "--components", "2"]
    assert main(["figure", "pca", "renders", *arguments, "-o", "pca.png"]) == 0
    assert "of the depth of 3 images, components: " in capsys.readouterr().out
    assert (here / "pca.png").exists()
