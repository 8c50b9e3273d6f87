"""The training of chapter 3: the AGA network on NYU and KITTI, and its recipe on rendered images.

The numbers are those of section 3.4.2 of the dissertation. Where it is silent they are those of
the base model's published code (Yin et al., ICCV 2019), and the experiment says so; where its
words leave a choice, the experiment names it. `docs/chapter3.md` has the table of both.
"""

from dataclasses import replace
from pathlib import Path

from flexdepth.data import Folder, Kitti, NyuFolders, NyuLabelled
from flexdepth.data.colour import Colour
from flexdepth.data.kitti import EIGEN_TEST
from flexdepth.data.read import Split
from flexdepth.data.recipes import KittiCrop, NyuCrop
from flexdepth.evaluation.alignment import Alignment
from flexdepth.experiments import terms
from flexdepth.experiments.experiment import Experiment
from flexdepth.geometry.depth import KITTI_BINS, DepthBins
from flexdepth.networks import AGA
from flexdepth.networks.attention import ChannelAttention
from flexdepth.networks.blocks import Pyramid
from flexdepth.networks.encoders import Encoder
from flexdepth.networks.heads import BinnedDepth
from flexdepth.networks.merge import SpatialPlusChannelAttention
from flexdepth.training.batches import BatchSettings
from flexdepth.training.loop import LoopSettings
from flexdepth.training.optimiser import SGDPolynomial

NYU_ROOT, KITTI_ROOT = Path("data/nyu"), Path("data/kitti")
"""Where the data is looked for; `--data.root` and `--held-out.root` name other places."""

_NETWORK = AGA(encoder=Encoder("resnext101_32x4d.gluon_in1k", 16))
"""The main network, S7. The encoder's weights are those that have seen ImageNet alone; timm's
default ones of this name have also seen 100 million other photographs, and are not for commerce."""

_LINE_TO_ZERO = SGDPolynomial(rate=0.003, momentum=0.9, weight_decay=5e-4, power=1.0)

NYU_LARGE = Experiment(
    network=_NETWORK,
    data=NyuFolders(NYU_ROOT),
    held_out=NyuLabelled(NYU_ROOT, Split.TEST),
    terms=terms.NYU,
    loop=LoopSettings(
        iterations=99_300,
        save_every=2_000,
        average_decay=0.0,
        batches=BatchSettings(
            size=16, shapes=((384, 384),), crop=NyuCrop(), colour=Colour(strength=0.0)
        ),
        optimiser=_LINE_TO_ZERO,
        alignment=Alignment.NONE,
    ),
)
"""The frames of NYU's training scenes (Table 3.2).

Which frames, and how many, is not said: 99,300 iterations of 16 are 30 rounds, the code's default,
of about 52,950. All frames under `sync` are taken; `--data.frames` names a list. From the code:
colours as they are, no averaged weights, no limit to the gradient, a validation every 2,000
iterations. The code fills the holes of the measured depth; here they are left out of the losses.
"""

NYU_SMALL = replace(
    NYU_LARGE,
    data=NyuLabelled(NYU_ROOT),
    loop=replace(
        NYU_LARGE.loop,
        iterations=5_000,
        save_every=250,
        batches=replace(NYU_LARGE.loop.batches, size=8),
        optimiser=replace(_LINE_TO_ZERO, power=0.9),
    ),
)
"""The 795 labelled images of NYU's training scenes (Table 3.4).

The dissertation calls it a subset, split by scenes; that it is this one follows from the number
of iterations: 5,000 are 50 rounds of the 100 batches of 8. A validation every 250 iterations gives
20 values to the table's moving average of 15; the dissertation does not say how often.
"""

KITTI = replace(
    NYU_LARGE,
    network=replace(_NETWORK, head=BinnedDepth(KITTI_BINS)),
    data=Kitti(KITTI_ROOT),
    held_out=Kitti(KITTI_ROOT, frames=EIGEN_TEST),
    terms=terms.KITTI,
    loop=replace(
        NYU_LARGE.loop,
        batches=replace(NYU_LARGE.loop.batches, shapes=((512, 384),), crop=KittiCrop()),
    ),
)
"""The frames of Eigen's split of KITTI (Table 3.3).

The 100 bins from 1.2 m to 80 m are the code's; the dissertation counts the parameters of the
network with 150 alone. The base model was trained on depth with its holes filled, here it is the
annotated depth, a fifth of the pixels. The dissertation tests on all 697 images of the split, of
which 652 have annotated depth: these are held out.
"""

_LIGHT = AGA(
    encoder=Encoder(output_stride=16),
    laterals=(64, 32, 32, 32),
    top=64,
    widths=(32, 32, 32, 32, 32),
    pyramid=Pyramid(width=64),
    head=BinnedDepth(DepthBins(150, 0.00375, 1.5, unit=80.0)),
).merged_by(SpatialPlusChannelAttention(ratio=4, channel=ChannelAttention(8)))

CHAPTER3_SMALL = replace(
    Experiment(),
    network=_LIGHT,
    terms=terms.RENDERS,
    loop=replace(
        NYU_LARGE.loop,
        iterations=1_000,
        save_every=250,
        batches=replace(NYU_LARGE.loop.batches, size=8, shapes=((192, 192),)),
        alignment=Alignment.LEAST_SQUARES_DISPARITY,
    ),
)
"""The recipe of `NYU_LARGE` on rendered rooms and streets, small enough for two cores.

Its own: a light encoder, a narrow decoder whose attention has a quarter of its channels inside (a
sixteenth would be two), bins from 0.3 m to 120 m in KITTI's unit, each image's own camera in the
virtual normals, and 1,000 iterations of 8 crops of 192x192. The cameras of the renders differ,
which no picture tells, so depth is fitted before it is scored.
"""

CHAPTER3_SHORT = replace(
    CHAPTER3_SMALL,
    network=replace(_LIGHT, head=BinnedDepth(DepthBins(40, 0.00375, 1.5, unit=80.0))),
    data=Folder(Path("renders/short-train")),
    held_out=Folder(Path("renders/short-heldout")),
    loop=replace(
        CHAPTER3_SMALL.loop,
        iterations=100,
        save_every=5,
        batches=replace(CHAPTER3_SMALL.loop.batches, shapes=((64, 64),)),
        optimiser=replace(_LINE_TO_ZERO, rate=0.01),
    ),
)
"""`CHAPTER3_SMALL` short enough for a table of many runs: NYU's crops at a sixth of their size.

Images of 128x96 and crops of 64x64; 40 bins; 100 iterations at the rate of the base's code, which
is three times the dissertation's. 20 evaluations, of which the last 15 are averaged.
"""
