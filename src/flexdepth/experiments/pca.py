"""The training of section 3.5.1: depth as the coefficients of principal components.

The dissertation gives the steps and a result, an AbsRel of 12 % on NYU, and nothing of the
networks, the loss or the training. What is not the step's own is as for the other networks here:
`Silog` and gradients as for `compact`, AdamW.
"""

from dataclasses import replace
from pathlib import Path

from flexdepth.data import NyuLabelled
from flexdepth.data.read import Split
from flexdepth.data.transforms import Crop
from flexdepth.evaluation.alignment import Alignment
from flexdepth.experiments.chapter3 import NYU_ROOT
from flexdepth.experiments.experiment import Experiment
from flexdepth.losses import GradientMatching, Silog
from flexdepth.networks import PCA
from flexdepth.networks.depth_basis import Basis
from flexdepth.training.batches import BatchSettings
from flexdepth.training.loop import LoopSettings
from flexdepth.training.objective import Term

PCA_RENDERS = Experiment(
    network=PCA(basis=Basis(scale="log"), canonical_focal=0.8),
    terms={"silog": Term(Silog(0.5), 1.0), "gradient": Term(GradientMatching(), 0.5)},
    loop=LoopSettings(
        iterations=2_000,
        batches=BatchSettings(shapes=((256, 192),), crop=Crop(smallest=0.8)),
    ),
)
"""On rendered rooms and streets, with the logarithm of depth, for its range is wide.

The coefficients are about whole images, so crops are large and of one shape.
"""

PCA_NYU = replace(
    PCA_RENDERS,
    network=PCA(basis=Basis(nearest=0.3, farthest=10.0)),
    data=NyuLabelled(Path(NYU_ROOT)),
    held_out=NyuLabelled(Path(NYU_ROOT), Split.TEST),
    loop=replace(PCA_RENDERS.loop, iterations=5_000, alignment=Alignment.NONE),
)
"""On NYU's 795 labelled training images, with depth as it is, as published."""
