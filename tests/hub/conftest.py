"""Tiny models with random weights, as transformers itself saves them; nothing is downloaded."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

transformers = pytest.importorskip("transformers")
torch = pytest.importorskip("torch")


def encoder():
    return transformers.Dinov2Config(
        image_size=28,
        patch_size=14,
        hidden_size=16,
        num_hidden_layers=4,
        num_attention_heads=2,
        intermediate_size=32,
        out_indices=[1, 2, 3, 4],
        reshape_hidden_states=False,
    )


def depth_anything(**changes):
    config = transformers.DepthAnythingConfig(
        backbone_config=encoder(),
        reassemble_hidden_size=16,
        neck_hidden_sizes=[8] * 4,
        fusion_hidden_size=8,
        head_hidden_size=8,
        **changes,
    )
    shown = transformers.DPTImageProcessor(
        size={"height": 56, "width": 56}, keep_aspect_ratio=True, ensure_multiple_of=14
    )
    return transformers.DepthAnythingForDepthEstimation(config), shown


def dpt(side=64, **changes):
    config = transformers.DPTConfig(
        **{
            "hidden_size": 16,
            "num_hidden_layers": 4,
            "num_attention_heads": 2,
            "intermediate_size": 32,
            "image_size": 64,
            "backbone_out_indices": [0, 1, 2, 3],
            "neck_hidden_sizes": [8] * 4,
            "fusion_hidden_size": 8,
            "is_hybrid": False,
        }
        | changes
    )
    shown = transformers.DPTImageProcessor(size={"height": side, "width": side})
    return transformers.DPTForDepthEstimation(config), shown


def glpn():
    config = transformers.GLPNConfig(
        depths=[1] * 4, hidden_sizes=[8] * 4, num_attention_heads=[1] * 4, decoder_hidden_size=8
    )
    return transformers.GLPNForDepthEstimation(config), transformers.GLPNImageProcessor()


def zoedepth():
    beit = transformers.BeitConfig(
        image_size=64,
        patch_size=16,
        hidden_size=16,
        num_hidden_layers=4,
        num_attention_heads=2,
        intermediate_size=32,
        out_indices=[1, 2, 3, 4],
        reshape_hidden_states=False,
    )
    config = transformers.ZoeDepthConfig(
        backbone_config=beit,
        neck_hidden_sizes=[8] * 4,
        fusion_hidden_size=8,
        bottleneck_features=8,
        num_relative_features=8,
        bin_embedding_dim=8,
        num_attractors=[4, 2, 2, 1],
        bin_configurations=[{"n_bins": 8, "min_depth": 1e-3, "max_depth": 10.0, "name": "nyu"}],
    )
    shown = transformers.ZoeDepthImageProcessor(
        size={"height": 64, "width": 64}, ensure_multiple_of=32
    )
    return transformers.ZoeDepthForDepthEstimation(config), shown


def depth_pro(**changes):
    part = {
        f"{name}_model_config": transformers.Dinov2Config(
            image_size=32,
            patch_size=8,
            hidden_size=16,
            num_hidden_layers=2,
            num_attention_heads=2,
            intermediate_size=32,
        )
        for name in ("image", "patch", "fov")
    }
    config = transformers.DepthProConfig(
        patch_size=32,
        fusion_hidden_size=8,
        intermediate_hook_ids=[1, 0],
        intermediate_feature_dims=[8, 8],
        scaled_images_ratios=[0.5, 1],
        scaled_images_overlap_ratios=[0.0, 0.2],
        scaled_images_feature_dims=[8, 8],
        num_fov_head_layers=1,
        **part,
        **changes,
    )
    shown = transformers.DepthProImageProcessor(size={"height": 64, "width": 64})
    return transformers.DepthProForDepthEstimation(config), shown


MAKERS = {
    "depth_anything": depth_anything,
    "depth_anything_metric": lambda: depth_anything(depth_estimation_type="metric", max_depth=20),
    "dpt": dpt,
    "dpt_dinov2": lambda: dpt(56, backbone_config=encoder(), patch_size=14),
    "glpn": glpn,
    "zoedepth": zoedepth,
    "depth_pro": lambda: depth_pro(use_fov_model=True),
    "depth_pro_without_fov": lambda: depth_pro(use_fov_model=False),
}


@pytest.fixture(scope="session")
def saved(tmp_path_factory) -> Callable[[str], Path]:
    """Return a function that gives the folder of a tiny model, saved once."""
    folder = tmp_path_factory.mktemp("hub")

    def model(name):
        place = folder / name
        if not place.exists():
            torch.manual_seed(1)
            network, shown = MAKERS[name]()
            with torch.no_grad():
                spread = 0.1 if name.startswith("depth_pro") else 0.3
                for weight in network.parameters():
                    weight.add_(spread * torch.randn_like(weight))
                if getattr(network, "fov_model", None) is not None:
                    network.fov_model.head.layers[-1].bias.fill_(60)
                    network.fov_model.head.layers[-1].weight.mul_(0.01)
            network.save_pretrained(place)
            shown.save_pretrained(place)
        return place

    return model


@pytest.fixture(scope="session")
def picture():
    """A picture whose sides are no multiples of anything."""
    return np.random.default_rng(0).integers(0, 256, (50, 71, 3), np.uint8)
