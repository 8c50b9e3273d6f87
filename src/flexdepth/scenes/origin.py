"""What a solution is made from: its files and settings, to recognise it by later."""

from importlib.metadata import version
from pathlib import Path

from flexdepth.runtime.origin import Origin, digest
from flexdepth.scenes.correspondence import FlowFile, FlowMethod, RaftFlow
from flexdepth.scenes.pair import PairSettings
from flexdepth.scenes.prior import opened


def origin(settings: PairSettings) -> Origin:
    """Return it, the same for the same frames and settings, wherever they lie.

    Raises:
        InputError: A file is missing or cannot be read.
    """
    camera = settings.camera
    return {
        "flexdepth": version("flexdepth"),
        **{name: digest(path) for name, path in settings.files.named()},
        "camera": digest(camera) if isinstance(camera, Path) else str(camera or "the frames' own"),
        "flow": _flow(settings.flow),
        "prior": "none"
        if settings.model is None
        else f"sha256:{opened(settings.model).about.digest}",
        "baseline": str(settings.baseline),
        "objective": str(settings.objective),
        "long_side": str(settings.long_side),
    }


def _flow(method: FlowMethod) -> str:
    match method:
        case FlowFile(path, noise):
            return f"{digest(path)} with noise {noise:g}"
        case RaftFlow(weights):
            return f"raft {digest(weights)}"
    return str(method)
