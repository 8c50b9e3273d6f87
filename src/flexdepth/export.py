"""From a trained network to a model bundle: one ONNX file that says what its numbers mean.

The bundle's format is read by `flexdepth.runtime.bundle`. Weights are stored in half precision
and computed with in single precision: half the file, the same speed. Before a bundle appears, its
depth is compared with the network's over a grid of sizes, before and after the rounding.

Every weight keeps its name, and normalisations stay by themselves (the runtime folds them into
the convolutions when it loads the model): training can start from a bundle.
"""

import json
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np
import onnx
import torch
from jaxtyping import Float
from onnx import TensorProto, helper, numpy_helper
from onnxscript import optimizer
from torch import Tensor, nn
from torch.nn.functional import interpolate

from flexdepth.networks.compact import CompactNetwork
from flexdepth.runtime.atomic import replacing
from flexdepth.runtime.bundle import FORMAT, METADATA_KEY, Description
from flexdepth.runtime.errors import InputError
from flexdepth.runtime.model import Provider, load_model

GRAPH_TOLERANCE = 1e-3
"""The largest relative difference of depth at 99 % of pixels before the weights are rounded."""

ROUNDED_TOLERANCE = 0.02
"""The same after it."""

_NETWORK, _HALF = "network.", ".half"
"""What the names of a network's weights begin with in a graph; what those of rounded ones end with.
"""

SIZES = ((384, 288), (608, 192), (96, 128), (32, 32))
"""Width and height at which bundle and network are compared."""


@dataclass(frozen=True)
class Parity:
    """How far a bundle is from its network.

    Attributes:
        median: Of the relative difference of depth over all pixels and sizes.
        high: Its 99th percentile.
    """

    median: float
    high: float


class _Outputs(nn.Module):
    """The network with its outputs as the bundle names them."""

    def __init__(self, network: CompactNetwork) -> None:
        super().__init__()
        self.network = network

    def forward(self, image: Float[Tensor, "batch 3 height width"]) -> tuple[Tensor, ...]:
        prediction = self.network(image)
        sky = prediction.sky_logit.sigmoid()
        return prediction.depth, sky, prediction.spread, prediction.focal


def export(network: CompactNetwork, description: Description, path: Path) -> Parity:
    """Write the network as a bundle, and return how far the two are apart.

    Args:
        network: Is put into evaluation mode.
        description: What the bundle says of itself.
        path: The bundle's file; its folder is made where it is missing.

    Raises:
        InputError: The bundle's depth is not the network's; nothing is written.
    """
    network.eval()
    model = _graph(network)
    fields = {"format": FORMAT, **asdict(description)}
    helper.set_model_props(model, {METADATA_KEY: json.dumps(fields)})
    with replacing(path) as temporary:
        onnx.save(model, temporary)
        _refuse_beyond(GRAPH_TOLERANCE, compared(network, temporary), path)
        rounded = _with_half_weights(model)
        onnx.checker.check_model(rounded)
        onnx.save(rounded, temporary)
        parity = compared(network, temporary)
        _refuse_beyond(ROUNDED_TOLERANCE, parity, path)
    return parity


def _refuse_beyond(tolerance: float, parity: Parity, path: Path) -> None:
    if parity.high > tolerance:
        raise InputError(
            f"{path}: the bundle's depth differs from the network's by {parity.high:.2%} at 1 % "
            f"of pixels, at most {tolerance:.1%} is allowed; nothing was written"
        )


def compared(network: CompactNetwork, bundle: Path) -> Parity:
    """Return how far the bundle is from the network on random blotches of several sizes."""
    model = load_model(bundle, Provider.CPU, 1)
    differences = []
    for number, (width, height) in enumerate(SIZES):
        rng = np.random.default_rng(number)
        coarse = torch.from_numpy(rng.random((2, 3, height // 8, width // 8), np.float32))
        image = interpolate(coarse, scale_factor=8.0, mode="bicubic").clamp(0, 1)
        with torch.no_grad():
            wanted = network(image).depth.numpy()
        depth = model.run(image.numpy()).depth
        differences.append((np.abs(depth - wanted) / wanted).ravel())
    together = np.concatenate(differences)
    return Parity(float(np.median(together)), float(np.quantile(together, 0.99)))


def _graph(network: CompactNetwork) -> onnx.ModelProto:
    """Return the ONNX graph with free batch, height and width."""
    example = torch.zeros(2, 3, 96, 128)
    free = {0: "batch", 2: torch.export.Dim("rows") * 32, 3: torch.export.Dim("columns") * 32}
    program = torch.onnx.export(
        _Outputs(network).eval(),
        (example,),
        input_names=["image"],
        output_names=["depth", "sky", "spread", "focal"],
        dynamic_shapes=({**free, 0: torch.export.Dim("batch")},),
        dynamo=True,
        verbose=False,
        optimize=False,
    )
    if program is None:
        raise RuntimeError("torch.onnx.export gave no program")
    optimizer.inline(program.model)
    optimizer.fold_constants(program.model)
    optimizer.remove_unused_nodes(program.model)
    return _without_traces(program.model_proto)


def _without_traces(model: onnx.ModelProto) -> onnx.ModelProto:
    """Return the model without what the exporter notes of the code and the folders it ran in."""
    graph = model.graph
    for part in (*graph.node, *graph.value_info, *graph.input, *graph.output, *graph.initializer):
        del part.metadata_props[:]
        part.doc_string = ""
    del graph.metadata_props[:]
    return model


def _with_half_weights(model: onnx.ModelProto) -> onnx.ModelProto:
    """Return the model with the weights of convolutions stored as float16 behind a cast.

    The runtime folds the casts away when it loads the model.
    """
    kept, casts = [], []
    for weight in model.graph.initializer:
        if weight.data_type != TensorProto.FLOAT or len(weight.dims) < 2:
            kept.append(weight)
            continue
        name = weight.name + _HALF
        kept.append(numpy_helper.from_array(numpy_helper.to_array(weight).astype(np.float16), name))
        casts.append(helper.make_node("Cast", [name], [weight.name], to=TensorProto.FLOAT))
    nodes = [*casts, *model.graph.node]
    del model.graph.initializer[:], model.graph.node[:]
    model.graph.initializer.extend(kept)
    model.graph.node.extend(nodes)
    return model


def bundled_weights(path: Path | None) -> dict[str, Tensor]:
    """Return the weights in a bundle by their names in the network that it was made from.

    Args:
        path: An .onnx file; None takes the model that comes with flexdepth.

    Raises:
        InputError: The file is no model bundle.
    """
    bundle = load_model(path, Provider.CPU, 1).path
    weights = {}
    for stored in onnx.load(bundle).graph.initializer:
        if stored.name.startswith(_NETWORK):
            name = stored.name.removeprefix(_NETWORK).removesuffix(_HALF)
            weights[name] = torch.from_numpy(numpy_helper.to_array(stored).astype(np.float32))
    return weights
