"""The depth of photos that nobody measured, on one sheet to be looked at.

    python benchmarks/wild.py PHOTOS -o SHEET.jpg [--model NAME] [--with-photos]

Each panel has its own colours: near is yellow, far is dark, sky is blue. Without --with-photos the
sheet shows depth alone, and may be kept where the photos may not.
"""

import argparse
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from PIL import Image

import flexdepth
from flexdepth.runtime.errors import InputError
from flexdepth.runtime.images import photos_in, read_photo
from flexdepth.runtime.picture import panels, preview

COLUMNS, WIDTH, HEIGHT = 4, 320, 240


def framed(picture: NDArray[np.uint8]) -> NDArray[np.uint8]:
    """Return a picture in the middle of a white panel, as large as it can be there."""
    image = Image.fromarray(picture)
    image.thumbnail((WIDTH, HEIGHT))
    panel = Image.new("RGB", (WIDTH, HEIGHT), "white")
    panel.paste(image, ((WIDTH - image.width) // 2, (HEIGHT - image.height) // 2))
    return np.asarray(panel)


def main() -> None:
    """Predict, draw and write."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("photos", type=Path)
    parser.add_argument("-o", "--output", type=Path, required=True)
    parser.add_argument("--model", default="compact")
    parser.add_argument("--with-photos", action="store_true")
    asked = parser.parse_args()
    predictor = flexdepth.load(asked.model)
    shown, names = [], []
    for path in photos_in(asked.photos, "*"):
        photo = read_photo(path)
        if asked.with_photos:
            shown.append(framed(photo.pixels))
            names.append(path.stem)
        shown.append(framed(preview(predictor.predict(photo))))
        names.append(path.stem)
    blank = np.full((HEIGHT, WIDTH, 3), 255, np.uint8)
    while len(shown) % COLUMNS:
        shown.append(blank)
        names.append("")
    starts = range(0, len(shown), COLUMNS)
    rows = [panels(shown[i : i + COLUMNS], names[i : i + COLUMNS]) for i in starts]
    Image.fromarray(np.concatenate(rows)).save(asked.output, quality=88)


if __name__ == "__main__":
    try:
        main()
    except InputError as error:
        raise SystemExit(f"error: {error}") from error
