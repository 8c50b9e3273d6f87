"""What is held out where only the data to learn from was named."""

from dataclasses import replace

from flexdepth.data import Folder
from flexdepth.experiments.experiment import Experiment


def with_own_held_out(first: Experiment, changed: Experiment) -> Experiment:
    """Return the changed experiment, judged on what belongs to its data.

    Where the data to learn from lies elsewhere than in `first` and nothing was said of what is held
    out, that is the last tenth of a plain folder, which is then not learnt from; of a published
    set, its own split in the same place.
    """
    data, held_out = changed.data, changed.held_out
    if data.root == first.data.root or held_out != first.held_out:
        return changed
    if isinstance(data, Folder) and isinstance(held_out, Folder):
        return replace(
            changed, data=replace(data, part="first"), held_out=replace(data, part="last")
        )
    if type(data) is type(first.data) and first.data.root == held_out.root:
        return replace(changed, held_out=replace(held_out, root=data.root))
    return changed
