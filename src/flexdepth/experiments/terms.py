"""What the networks of chapter 3 minimise, by data set."""

from collections.abc import Mapping
from types import MappingProxyType

from flexdepth.losses import Squared, VirtualNormal, WeightedCrossEntropy
from flexdepth.training.objective import Term

NYU_BASE: Mapping[str, Term] = MappingProxyType(
    {
        "cross_entropy": Term(WeightedCrossEntropy(), 1.0),
        "virtual_normal": Term(VirtualNormal(focal=519.0), 6.0),
    }
)
"""The base model's: weighted cross-entropy and virtual normals, 1 : 6."""

NYU: Mapping[str, Term] = MappingProxyType({**NYU_BASE, "squared": Term(Squared(), 25.0)})
"""The dissertation's, eq. 3.4: 1 : 6 : 25, with the mean square in the network's own unit."""

KITTI_BASE: Mapping[str, Term] = MappingProxyType(
    {**NYU_BASE, "virtual_normal": Term(VirtualNormal(focal=357.3), 6.0)}
)
"""`NYU_BASE` at the focal length of KITTI."""

KITTI: Mapping[str, Term] = MappingProxyType({**KITTI_BASE, "squared": Term(Squared(), 25.0)})
"""`NYU` at the focal length of KITTI."""

RENDERS: Mapping[str, Term] = MappingProxyType(
    {**NYU, "virtual_normal": Term(VirtualNormal(focal=None), 6.0)}
)
"""`NYU` with the camera of each image, for rendered images have different ones."""
