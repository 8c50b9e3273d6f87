"""Giving a network the weights, and the basis, that its training starts with."""

from collections.abc import Mapping

from torch import Tensor, nn

from flexdepth.data.transforms import as_sample
from flexdepth.experiments.experiment import Bundled, ImageNet, Start, Trained, Untrained
from flexdepth.export import bundled_weights
from flexdepth.networks import Built
from flexdepth.networks.edrb import EDRBNetwork
from flexdepth.networks.pca import PCANetwork
from flexdepth.networks.pretrained import load_imagenet
from flexdepth.runtime.errors import InputError
from flexdepth.training.batches import Pairs
from flexdepth.training.checkpoint import load, restore


def give_weights(network: Built, start: Start) -> None:
    """Give a network its first weights.

    Raises:
        InputError: The file to start from is missing, broken or of another network.
    """
    match start:
        case Untrained():
            pass
        case ImageNet(file):
            if isinstance(network, EDRBNetwork):
                raise InputError(
                    "the EDRB network has no encoder that ImageNet has weights for: start it "
                    "untrained"
                )
            load_imagenet(network.encoder, file)
        case Trained(checkpoint):
            restore(network, load(checkpoint).part("average"), str(checkpoint))
        case Bundled(bundle):
            where = "the bundled model" if bundle is None else str(bundle)
            restore(network, _as_stored(network, bundled_weights(bundle)), where)


def give_basis(network: Built, pairs: Pairs) -> str | None:
    """Give a PCA network that has no basis that of the training data.

    Args:
        network: Any; the others are left alone.
        pairs: Their depth is looked at, all of it, once.

    Returns:
        What a person should hear of it; None where there was nothing to do.

    Raises:
        InputError: There are fewer than two maps with known depth.
    """
    if not isinstance(network, PCANetwork) or bool(network.mean.isfinite().all()):
        return None
    basis = network.settings.fit(as_sample(pairs[number]) for number in range(len(pairs)))
    network.adopt(basis)
    share = float(basis.explained()[-1])
    return (
        f"of the depth of {basis.count} images, {len(basis.components)} components explain "
        f"{share:.1%}"
    )


def _as_stored(network: nn.Module, weights: Mapping[str, Tensor]) -> dict[str, Tensor]:
    """Return a bundle's weights as a checkpoint would hold them.

    A bundle also holds the constants that a network does not store, and lacks the number of
    batches that a normalisation has seen, which only counts.
    """
    own = network.state_dict()
    constants = dict(network.named_buffers()).keys() - own.keys()
    counters = {name: value for name, value in own.items() if name.endswith("num_batches_tracked")}
    return counters | {name: value for name, value in weights.items() if name not in constants}
