"""Any set of images with depth as a folder that `Folder` reads.

DIR/image/NAME.png      as the set's loader gives it
DIR/depth/NAME.npz      (or another format) with its meaning and its camera
"""

from collections.abc import Callable
from pathlib import Path

from PIL import Image

from flexdepth.data.doctor import Things, as_pair
from flexdepth.runtime.atomic import replacing
from flexdepth.runtime.errors import InputError
from flexdepth.runtime.files import write_depth


def convert(
    pairs: Things, folder: Path, suffix: str, origin: str, watch: Callable[[int], None]
) -> int:
    """Write every pair, and return how many were written.

    Files that are there already are left alone, so that an interrupted conversion goes on.

    Args:
        pairs: What the set's `load()` gave.
        folder: Where to; made where it is missing.
        suffix: Of the depth files, such as ".npz".
        origin: Name of the set, which each depth file then tells.
        watch: Is told how many are done.

    Raises:
        InputError: The set holds something else than images with depth, a file is broken, two
            pairs have one name, or the folder cannot be written.
    """
    names: set[str] = set()
    written = 0
    for number in range(len(pairs)):
        pair = as_pair(pairs[number])
        if pair.name in names:
            raise InputError(f"two pairs of {origin} are called {pair.name}; convert parts of it")
        names.add(pair.name)
        image = folder / "image" / f"{pair.name}.png"
        depth = folder / "depth" / f"{pair.name}{suffix}"
        if not (image.is_file() and depth.is_file()):
            write_depth(depth, pair.truth, {"data_set": origin, "name": pair.name})
            with replacing(image) as temporary:
                Image.fromarray(pair.image).save(temporary, format="PNG", compress_level=1)
            written += 1
        watch(number + 1)
    return written
