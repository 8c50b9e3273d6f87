"""What a picture or a point cloud was made from, written inside the file itself.

Depth files say it in their own record (`formats/meaning.py`). PNG has a text chunk `flexdepth`,
PLY a comment in its header, GLB an entry in `asset.extras`; each holds the same JSON object.
"""

import hashlib
import json
import struct
from collections.abc import Callable, Mapping
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from PIL import Image
from PIL.PngImagePlugin import PngImageFile, PngInfo

from flexdepth.runtime.atomic import replacing
from flexdepth.runtime.opening import open_input

Origin = Mapping[str, str]
"""Such as the digests of the input and the model, and the settings."""

KEY = "flexdepth"
"""What the chunk, the comment or the entry is called."""

_MOST = 1 << 20
"""No header is longer, in bytes: what claims to be is not read."""


def digest(path: Path) -> str:
    """Return what tells a file from every other: `sha256:` and 64 hexadecimal digits.

    Raises:
        InputError: The file cannot be read.
    """
    found = hashlib.sha256()
    with open_input(path) as file:
        while part := file.read(1 << 20):
            found.update(part)
    return f"sha256:{found.hexdigest()}"


def write_picture(path: Path, pixels: NDArray[np.uint8], origin: Origin) -> None:
    """Write an RGB picture as PNG, with its origin; it appears whole or not at all.

    Raises:
        InputError: The file cannot be written.
    """
    text = PngInfo()
    text.add_itxt(KEY, json.dumps(dict(origin)))
    with replacing(path) as temporary:
        Image.fromarray(pixels).save(temporary, format="PNG", compress_level=4, pnginfo=text)


def ply_comment(origin: Origin) -> bytes:
    """Return the header line of a PLY that holds the origin."""
    return f"comment {KEY} {json.dumps(dict(origin))}\n".encode("ascii")


def picture_origin(path: Path) -> Origin | None:
    """Return the origin of a PNG; None where it has none or is no PNG.

    Raises:
        InputError: The file cannot be opened.
    """
    return _read(path, _png_text)


def ply_origin(path: Path) -> Origin | None:
    """Return the origin of a PLY; None where it has none or is no PLY.

    Raises:
        InputError: The file cannot be opened.
    """
    return _read(path, _ply_text)


def glb_origin(path: Path) -> Origin | None:
    """Return the origin of a GLB; None where it has none or is no GLB.

    Raises:
        InputError: The file cannot be opened.
    """
    return _read(path, _glb_text)


def _read(path: Path, text: Callable[[Path], str]) -> Origin | None:
    open_input(path).close()
    try:
        found: object = json.loads(text(path))
    except (OSError, ValueError, SyntaxError, LookupError, TypeError, RecursionError, struct.error):
        return None
    return found if isinstance(found, Mapping) else None


def _png_text(path: Path) -> str:
    with PngImageFile(path) as picture:
        return str(picture.info[KEY])


def _ply_text(path: Path) -> str:
    with path.open("rb") as file:
        header, _, _ = file.read(_MOST).partition(b"end_header\n")
    _, _, rest = header.decode("ascii").partition(f"\ncomment {KEY} ")
    return rest.partition("\n")[0]


def _glb_text(path: Path) -> str:
    with path.open("rb") as file:
        _, _, _, length, _ = struct.unpack("<4sIII4s", file.read(20))
        tree = json.loads(file.read(min(length, _MOST)))
    return json.dumps(tree["asset"]["extras"][KEY])
