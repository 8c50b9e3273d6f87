"""A student of a teacher, and a network with a basis: runs that first make what they need."""

from dataclasses import replace

import pytest
import torch
from PIL import Image

from flexdepth.data.folder import Folder
from flexdepth.data.transforms import as_sample
from flexdepth.experiments.catalogue import CATALOGUE
from flexdepth.experiments.experiment import CODEC, Experiment, Labels, Trained, Untrained
from flexdepth.experiments.run import BEST, LABELS, LATEST, run_experiment, trained_network
from flexdepth.networks import PCA
from flexdepth.networks.compact import Compact
from flexdepth.networks.depth_basis import Basis
from flexdepth.networks.encoders import Encoder
from flexdepth.runtime.errors import InputError
from flexdepth.synth.generate import SynthSettings, write_images
from flexdepth.training.batches import BatchSettings
from flexdepth.training.checkpoint import load
from flexdepth.training.loop import LoopSettings
from flexdepth.training.semi_supervised import Agreement


@pytest.fixture(scope="module")
def rendered(tmp_path_factory):
    folder = tmp_path_factory.mktemp("renders")
    list(write_images(SynthSettings(seed=5, width=64, height=64), 4, folder, 1))
    return folder


@pytest.fixture(scope="module")
def experiment(rendered):
    batches = BatchSettings(size=4, shapes=((64, 64),))
    return Experiment(
        network=Compact(encoder=Encoder("test_resnet"), widths=(32, 32, 32, 32)),
        data=Folder(rendered),
        held_out=Folder(rendered),
        loop=LoopSettings(iterations=1, save_every=1, batches=batches),
        start=Untrained(),
    )


@pytest.fixture(scope="module")
def teacher(experiment, tmp_path_factory):
    folder = tmp_path_factory.mktemp("teacher")
    run_experiment(experiment, folder, 0, lambda _line: None)
    return folder / BEST


def heard(experiment, folder):
    lines = []
    run_experiment(experiment, folder, 0, lines.append)
    return lines


def test_a_student_learns_from_the_labels_of_its_teacher(experiment, teacher, rendered, tmp_path):
    """Four photos more; its first step, from the same weights, is another than without them."""
    agreement = Agreement(ratio=3.0, area=64 * 64)
    labels = Labels(rendered / "image", Trained(teacher), agreement)
    student = replace(experiment, labels=labels)
    lines = heard(student, tmp_path / "student")
    assert lines[0].startswith("labelling 4 photos of")
    assert "with 8 images, 4 held out" in lines[2]
    alone, taught = (load(path / LATEST) for path in (teacher.parent, tmp_path / "student"))
    names = [name for name in alone.tensors if name.startswith("network.head")]
    assert any(not torch.equal(alone.tensors[n], taught.tensors[n]) for n in names)
    pairs = Folder(tmp_path / "student" / LABELS).load()
    assert len(pairs) == 4
    # A second start trains nothing and labels nothing.
    again = heard(student, tmp_path / "student")
    assert [line.partition(" with ")[0] for line in again] == ["resuming at iteration 1 of 1"]


def test_labels_by_another_teacher_are_refused(experiment, teacher, rendered, tmp_path):
    labels = Labels(rendered / "image", Trained(teacher), Agreement(ratio=3.0, area=64 * 64))
    (tmp_path / LABELS).mkdir()
    (tmp_path / LABELS / "labels.json").write_text("{}")
    with pytest.raises(InputError, match="labels of other photos or by another teacher"):
        run_experiment(replace(experiment, labels=labels), tmp_path, 0, print)


def test_an_experiment_with_labels_survives_a_file(experiment):
    labelled = replace(experiment, labels=Labels("photos", Trained("best.safetensors")))
    values = CODEC.plain(labelled)
    assert values["labels"]["teacher"]["_type"] == "Trained"
    assert CODEC.restored(Experiment, values, "file").labels.agreement == Agreement()
    del values["labels"]
    assert CODEC.restored(Experiment, values, "file").labels is None


def test_a_network_of_components_takes_the_basis_of_its_training_data(
    experiment, rendered, tmp_path
):
    basis = Basis(6, 8, 3, scale="log")
    network = PCA(
        encoder=Encoder("test_resnet"),
        basis=basis,
        width=8,
        grid=(2, 2),
        hidden=8,
        canonical_focal=0.8,
    )
    terms = CATALOGUE["pca"].terms
    found = replace(experiment, network=network, terms=terms)
    lines = heard(found, tmp_path)
    assert lines[0].startswith("of the depth of 4 images, 3 components explain 100.0%")
    trained = trained_network(tmp_path / BEST)
    pairs = Folder(rendered).load()
    fitted = network.fit(as_sample(pairs[number]) for number in range(4))
    assert torch.equal(trained.mean, fitted.mean)
    assert heard(found, tmp_path)[0].startswith("resuming at iteration 1 of 1")


def test_data_without_depth_makes_no_basis(experiment, tmp_path):
    network = PCA(encoder=Encoder("test_resnet"), basis=Basis(6, 8, 3), grid=(2, 2))
    (tmp_path / "data" / "image").mkdir(parents=True)
    Image.new("RGB", (64, 64)).save(tmp_path / "data" / "image" / "a.png")
    with pytest.raises(InputError):
        run_experiment(
            replace(experiment, network=network, data=Folder(tmp_path / "data")),
            tmp_path / "run",
            0,
            print,
        )
