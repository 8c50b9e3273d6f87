"""What the numbers of each family of models mean, told from its settings.

| family | numbers |
|---|---|
| DPT, MiDaS 3 | disparity up to a factor and an offset; depth in metres with a DINOv2 encoder |
| Depth Anything 1 and 2 | disparity up to a factor and an offset; depth in metres if `metric` |
| Depth Pro | 1/depth for a focal length of one image width; sees the field of view as well |
| GLPN, ZoeDepth | depth in metres |

References:
    Ranftl, Bochkovskiy and Koltun, ICCV 2021 (DPT); Ranftl et al., PAMI 2022 (MiDaS); Oquab et
    al., TMLR 2024 (DINOv2, with DPT heads for NYU and KITTI); Yang et al., CVPR and NeurIPS 2024
    (Depth Anything 1 and 2); Bochkovskii et al., ICLR 2025 (Depth Pro); Kim et al., 2022 (GLPN);
    Bhat et al., 2023 (ZoeDepth).
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any

from flexdepth.runtime.depthmap import Space
from flexdepth.runtime.errors import InputError

UNKNOWN = "unknown"
"""The licence of a model that nothing is known of."""


@dataclass(frozen=True)
class Family:
    """What all models of one kind have in common.

    Attributes:
        space: What the numbers mean, by the model's settings.
        licence: Of the published weights, by the settings; `unknown` where it differs.
        by_width: Metres are those of a camera whose focal length is one image width.
        padded: Pictures are shown with a border, which has to be taken off again.
    """

    space: Callable[[Any], Space]
    licence: Callable[[Any], str] = lambda _config: UNKNOWN
    by_width: bool = False
    padded: bool = False


def _of_dpt(config: Any) -> Space:  # noqa: ANN401
    encoder = config.backbone_config
    is_dinov2 = encoder is not None and encoder.model_type == "dinov2"
    return Space.METRIC if is_dinov2 else Space.AFFINE_DISPARITY


def _of_depth_anything(config: Any) -> Space:  # noqa: ANN401
    is_metric = config.depth_estimation_type == "metric"
    return Space.METRIC if is_metric else Space.AFFINE_DISPARITY


def _licence_of_depth_anything(config: Any) -> str:  # noqa: ANN401
    """Return the licence: version 2, which takes features from all depths, is free only if small.

    Version 1 takes them from the last four layers.
    """
    encoder = config.backbone_config
    last = encoder.num_hidden_layers
    is_first = list(encoder.out_indices) == list(range(last - 3, last + 1))
    is_small = encoder.hidden_size < 768
    return "apache-2.0" if is_first or is_small else "cc-by-nc-4.0"


FAMILIES: Mapping[str, Family] = MappingProxyType(
    {
        "depth_anything": Family(_of_depth_anything, _licence_of_depth_anything),
        "depth_pro": Family(lambda _config: Space.METRIC, lambda _config: "apple-amlr", True),
        "dpt": Family(_of_dpt),
        "glpn": Family(lambda _config: Space.METRIC),
        "zoedepth": Family(lambda _config: Space.METRIC, padded=True),
    }
)
"""The families by the name that transformers gives them (`model_type`)."""


def family_of(config: Any, name: str) -> Family:  # noqa: ANN401
    """Return the family of a model by its settings.

    Raises:
        InputError: It is none whose numbers are known here.
    """
    kind = config.model_type
    if kind not in FAMILIES:
        raise InputError(
            f"{name}: a model of the kind {kind!r}, whose numbers flexdepth does not know; wanted "
            f"one of {', '.join(FAMILIES)}"
        )
    return FAMILIES[kind]
