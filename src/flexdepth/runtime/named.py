"""Models by the names that users give them, opened and ready to look at pictures.

| name | what |
|---|---|
| `compact`, `bundled` | the model that comes with flexdepth |
| `FILE.onnx` | a bundle; or any network, where FILE.yaml beside it says what it takes and gives |
| `FILE.yaml` | the network of this card (`card.py`) |
| `hub:NAME`, `hub:./FOLDER` | a model in the format of transformers |

The rooms behind a prefix need more than the light install. They lie above this one, and are named
here, not imported: one is loaded once a model of it is asked for.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from importlib import import_module
from pathlib import Path
from types import MappingProxyType
from typing import Any

from flexdepth.runtime.bundle import METADATA_KEY
from flexdepth.runtime.card import Card, read_card
from flexdepth.runtime.carded import carded_network
from flexdepth.runtime.errors import InputError
from flexdepth.runtime.estimator import Estimator
from flexdepth.runtime.foreign import ForeignPredictor, Network
from flexdepth.runtime.lens import Lens
from flexdepth.runtime.looks import Look
from flexdepth.runtime.model import Model, load_model, model_in
from flexdepth.runtime.predictor import Predictor
from flexdepth.runtime.session import Provider, Session, open_session

BUNDLED = ("compact", "bundled")
"""The names of the model that comes with flexdepth."""

_LARGEST_SIDE = 4096
"""What the network sees takes memory by its area: far beyond this, more than any machine has."""

_CARDS = (".yaml", ".yml")


@dataclass(frozen=True)
class _Room:
    """Where models behind a prefix are opened, by `network(name, provider)`, and what it takes."""

    module: str
    extra: str


_ROOMS: Mapping[str, _Room] = MappingProxyType({"hub": _Room("flexdepth.hub.network", "hub")})


@dataclass(frozen=True)
class Wishes:
    """How a model is to look at pictures; flexdepth's own can do all of it, others less.

    Attributes:
        lens: What the user says of the camera.
        long_side: The longer side of what the network sees, in pixels.
        look: How it looks at a picture; None is its own way.
        details: How many times as large it sees a picture once more; None is its own way.
        tiles: How many tiles of the longer side it looks at as well.
        provider: What it runs on.
        threads: How many CPU threads onnxruntime uses.
    """

    lens: Lens | None = None
    long_side: int | None = None
    look: Look | None = None
    details: int | None = None
    tiles: int = 1
    provider: Provider = Provider.CPU
    threads: int | None = None


def named_estimator(name: str | Path, wishes: Wishes = Wishes()) -> Estimator:
    """Return a model by its name.

    Raises:
        InputError: There is no such model, it is broken, or it cannot do what is wished.
    """
    prefix, colon, rest = str(name).partition(":")
    if colon and prefix in _ROOMS:
        _refuse_own_ways(str(name), wishes)
        if wishes.long_side is not None or wishes.threads is not None:
            raise InputError(
                f"--long-side and --threads are not for {name}: its own settings say what it sees, "
                f"and OMP_NUM_THREADS sets its threads"
            )
        return ForeignPredictor(_in_room(prefix, rest, wishes.provider), wishes.lens)
    if name in BUNDLED:
        return _own(load_model(None, wishes.provider, wishes.threads), wishes)
    path = Path(name)
    if path.suffix not in (".onnx", *_CARDS) and not path.is_file():
        raise InputError(_no_model(path))
    return _of_card(path, wishes) if path.suffix in _CARDS else _of_onnx(path, wishes)


def _no_model(path: Path) -> str:
    if (path / "config.json").is_file():
        return f"{path}: a folder; for the model of transformers in it, say hub:{path}"
    return (
        f"no model {str(path)!r}: wanted `bundled`, an .onnx network, its .yaml card, or hub:NAME "
        f"(docs/models.md)"
    )


def _own(model: Model, wishes: Wishes) -> Predictor:
    _check_long_side(wishes, model.description.multiple)
    asked = {"look": wishes.look, "details": wishes.details}
    given: dict[str, Any] = {name: value for name, value in asked.items() if value is not None}
    return Predictor(model, wishes.lens, wishes.long_side, tiles=wishes.tiles, **given)


def _of_onnx(path: Path, wishes: Wishes) -> Estimator:
    """Return the model of an ONNX file: what it says of itself counts before what a card says."""
    session = open_session(path, wishes.provider, wishes.threads)
    cards = [path.with_suffix(suffix) for suffix in _CARDS]
    card = next((each for each in cards if each.is_file()), None)
    if METADATA_KEY in session.metadata or card is None:
        return _own(model_in(session), wishes)
    return _carded(replace(read_card(card), onnx=path), card, session, wishes)


def _of_card(path: Path, wishes: Wishes) -> Estimator:
    card = read_card(path)
    return _carded(card, path, open_session(card.onnx, wishes.provider, wishes.threads), wishes)


def _carded(card: Card, file: Path, session: Session, wishes: Wishes) -> Estimator:
    _refuse_own_ways(str(file), wishes)
    if card.input.multiple is not None:
        _check_long_side(wishes, card.input.multiple)
    return ForeignPredictor(carded_network(card, file, session, wishes.long_side), wishes.lens)


def _in_room(prefix: str, name: str, provider: Provider) -> Network:
    room = _ROOMS[prefix]
    try:
        opened: Network = import_module(room.module).network(name, provider)
    except ModuleNotFoundError as missing:
        raise InputError(
            f"{prefix}:{name} needs {missing.name}, which is not installed: "
            f'pip install "flexdepth[{room.extra}]"'
        ) from missing
    return opened


def _refuse_own_ways(name: str, wishes: Wishes) -> None:
    if (wishes.look, wishes.details, wishes.tiles) != (None, None, 1):
        raise InputError(
            f"--looks, --look, --details and --tiles are for flexdepth's own models, {name} is "
            f"none; leave them out"
        )


def _check_long_side(wishes: Wishes, least: int) -> None:
    if wishes.long_side is not None and not least <= wishes.long_side <= _LARGEST_SIDE:
        raise InputError(
            f"--long-side: wanted {least} to {_LARGEST_SIDE} pixels, got {wishes.long_side}; "
            "--tiles shows flexdepth's own models more detail in less memory"
        )
