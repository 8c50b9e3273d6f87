"""One network of several that were trained from one another."""

from collections.abc import Sequence
from math import isfinite
from pathlib import Path

from flexdepth.experiments.catalogue import CATALOGUE
from flexdepth.experiments.run import trained_network
from flexdepth.runtime.errors import InputError
from flexdepth.training.averaging import estimate_statistics, mean_of
from flexdepth.training.batches import Batches, Pairs, loader
from flexdepth.training.checkpoint import Checkpoint, load, restore, save, source


def averaged(
    checkpoints: Sequence[Path], shares: Sequence[float], pairs: Pairs, batches: int, output: Path
) -> None:
    """Write a checkpoint of the mean of the averaged weights of several.

    Args:
        checkpoints: Of one network.
        shares: Of each, positive.
        pairs: What the statistics of the normalisations are estimated on, as `compact-spread` sees
            them.
        batches: How many batches of them.
        output: The file to write.

    Raises:
        InputError: A file is no checkpoint or of another network, or a number is out of range.
    """
    if len(shares) != len(checkpoints) or not all(isfinite(x) and x > 0 for x in shares):
        raise InputError(
            f"--shares: wanted {len(checkpoints)} numbers > 0, one for each checkpoint, got "
            f"{' '.join(f'{x:g}' for x in shares)}"
        )
    if batches < 1:
        raise InputError(f"--batches: wanted a whole number >= 1, got {batches}")
    network = trained_network(checkpoints[0])
    found = [load(path) for path in checkpoints]
    weights = [each.part("average") for each in found]
    for path, own in zip(checkpoints, weights, strict=True):
        restore(network, own, str(path))
    restore(network, mean_of(weights, shares), str(output))
    seen = Batches(pairs, CATALOGUE["compact-spread"].loop.batches, batches)
    estimate_statistics(network, (batch.key.image for batch in loader(seen, 0, 0)))
    named = {f"average.{name}": value for name, value in network.state_dict().items()}
    save(output, Checkpoint(0, found[0].settings, named, source()))
