"""Photos decoded as a person sees them, whatever the file holds."""

import struct
import warnings
import zlib
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from importlib import import_module
from io import BytesIO
from pathlib import Path
from threading import Lock
from typing import BinaryIO

import numpy as np
from numpy.typing import NDArray
from PIL import ExifTags, Image, ImageCms, UnidentifiedImageError
from PIL.TiffImagePlugin import TiffImageFile

from flexdepth.runtime.errors import InputError, reason
from flexdepth.runtime.opening import open_input

FULL_FRAME_DIAGONAL = 43.27
"""Millimetres across the 36 mm x 24 mm film that `FocalLengthIn35mmFilm` refers to."""

_FORMATS = {
    "JPEG": (".jpg", ".jpeg", ".jpe", ".jfif", ".mpo"),
    "PNG": (".png", ".apng"),
    "TIFF": (".tif", ".tiff"),
    "WEBP": (".webp",),
    "BMP": (".bmp",),
    "GIF": (".gif",),
    "PPM": (".ppm", ".pgm", ".pbm", ".pnm"),
    "JPEG2000": (".jp2", ".j2k", ".jpx", ".j2c"),
    "AVIF": (".avif",),
}
_HEIC = {"HEIF": (".heic", ".heif", ".hif")}
_FORMAT_OF_SUFFIX = {
    suffix: name for name, suffixes in (_FORMATS | _HEIC).items() for suffix in suffixes
}
_STARTS = (b"\xff\xd8\xff", b"\x89PNG\r\n", b"GIF8", b"II*\0", b"MM\0*")
# A raw file is a TIFF whose first picture is a thumbnail: it would be read, and wrongly.
_RAW_SUFFIXES = (".dng", ".nef", ".cr2", ".cr3", ".arw", ".orf", ".rw2", ".raf", ".pef", ".srw")

_UPRIGHT = {
    2: Image.Transpose.FLIP_LEFT_RIGHT,
    3: Image.Transpose.ROTATE_180,
    4: Image.Transpose.FLIP_TOP_BOTTOM,
    5: Image.Transpose.TRANSPOSE,
    6: Image.Transpose.ROTATE_270,
    7: Image.Transpose.TRANSVERSE,
    8: Image.Transpose.ROTATE_90,
}
_PROFILED = {"RGB": "RGB ", "CMYK": "CMYK", "L": "GRAY"}

# What Pillow is known to raise on bytes that are not as they should be.
_DAMAGE = (
    OSError,
    SyntaxError,
    ValueError,
    TypeError,
    LookupError,
    ArithmeticError,
    EOFError,
    RuntimeError,
    struct.error,
    zlib.error,
)

_pillow = Lock()


@dataclass(frozen=True, eq=False)
class Photo:
    """A picture as a person sees it.

    Attributes:
        pixels: Height by width by 3, RGB, 0 to 255, upright and laid on white.
        focal_in_diagonals: Focal length divided by the image's diagonal, from EXIF; None where
            EXIF does not say or says what cannot be.
        warnings: What a user should know of how the file was read; one line each, naming it.
    """

    pixels: NDArray[np.uint8]
    focal_in_diagonals: float | None
    warnings: tuple[str, ...]


def is_picture_name(path: Path) -> bool:
    """Return whether a file of this name is taken for a photo when a folder is listed.

    HEIC counts, though it cannot be read without an extra: a photo that is left out without a
    word is worse than a message that says what to do.
    """
    return path.suffix.lower() in _FORMAT_OF_SUFFIX


def photos_in(folder: Path, pattern: str) -> list[Path]:
    """Return the photos in a folder, sorted by their paths.

    Args:
        folder: Where they are looked for.
        pattern: Of their paths in it: `*` are those in the folder itself, `**/*` those below too.

    Raises:
        InputError: There is no such folder, or no photo in it.
    """
    if not folder.is_dir():
        raise InputError(f"{folder}: no such folder of photos")
    found = sorted(
        path for path in folder.glob(pattern) if path.is_file() and is_picture_name(path)
    )
    if not found:
        raise InputError(f"{folder}: holds no photo; put .jpg or .png files into it")
    return found


def starts_like_picture(path: Path) -> bool:
    """Return whether the file starts as JPEG, PNG, GIF or TIFF do, which no video does."""
    try:
        with open_input(path) as file:
            return file.read(16).startswith(_STARTS)
    except InputError:
        return False


def read_photo(path: Path, max_pixels: int = 200_000_000) -> Photo:
    """Read a photo as a person sees it: RGB, 8 bits, upright, opaque, the first frame.

    Orientation comes from EXIF or XMP, colours from an embedded profile, transparent pixels
    become white, more than 8 bits are scaled to 8. Threads take turns here, since Pillow keeps
    its limit on the size of pictures, and Python its warnings, for the whole process; both are
    as before afterwards.

    Args:
        path: The file; its content and not its name says what it is.
        max_pixels: The most pixels that are decoded; checked before any is.

    Raises:
        InputError: The file is missing, unreadable, empty, damaged, too large or no picture.
    """
    if path.suffix.lower() in _RAW_SUFFIXES:
        raise InputError(f"{path}: camera raw is not read; develop it to JPEG, PNG or TIFF")
    with _pillow, open_input(path) as file, warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        try:
            pixels, focal = _decode(path, file, max_pixels)
        except InputError:
            raise
        except UnidentifiedImageError as error:
            kinds = ", ".join(_FORMATS)
            raise InputError(
                f"{path}: is no picture that can be read, or its start is damaged; save it as one "
                f"of {kinds}"
            ) from error
        except MemoryError as error:
            raise InputError(f"{path}: does not fit in memory; make it smaller") from error
        except _DAMAGE as error:
            raise InputError(
                f"{path}: is truncated or damaged ({reason(error)}); get a whole copy of it"
            ) from error
    notes = (f"{path}: {reason(w.message)}" for w in caught if w.category is UserWarning)
    return Photo(pixels, focal, tuple(notes))


def _decode(path: Path, file: BinaryIO, max_pixels: int) -> tuple[NDArray[np.uint8], float | None]:
    with _without_pillows_limit(), _opened(path, file) as image:
        if image.width * image.height > max_pixels:
            raise InputError(
                f"{path}: has {image.width} x {image.height} pixels, the limit is {max_pixels}; "
                "shrink it or raise the limit (--max-pixels)"
            )
        image.load()
        _warn_of_name(path, image.format or "")
        turn, focal = _exif(image)
        colours = _in_srgb(_opaque(path, image), image.info.get("icc_profile"))
        return np.array(colours if turn is None else colours.transpose(turn)), focal


def _opened(path: Path, file: BinaryIO) -> Image.Image:
    start = file.read(32)
    file.seek(0)
    if start[4:8] != b"ftyp" or b"hei" not in start:
        return Image.open(file, formats=tuple(_FORMATS))
    try:
        opened: Image.Image = import_module("pillow_heif").HeifImageFile(file)
    except ModuleNotFoundError as missing:
        raise InputError(
            f'{path}: is HEIC; pip install "flexdepth[heic]" reads it, or export it as JPEG or PNG'
        ) from missing
    return opened


@contextmanager
def _without_pillows_limit() -> Iterator[None]:
    before = Image.MAX_IMAGE_PIXELS
    Image.MAX_IMAGE_PIXELS = None
    try:
        yield
    finally:
        Image.MAX_IMAGE_PIXELS = before


def _warn_of_name(path: Path, name: str) -> None:
    held = "JPEG" if name == "MPO" else name  # several JPEGs in one file, of which one is shown
    if path.suffix and _FORMAT_OF_SUFFIX.get(path.suffix.lower()) != held:
        warnings.warn(f"holds a {held} picture in spite of its name, and was read", stacklevel=2)


def _exif(image: Image.Image) -> tuple[Image.Transpose | None, float | None]:
    """Return the turn that puts the picture upright, and the focal length in diagonals."""
    turn = focal = None
    try:
        exif = image.getexif()
        turn = _UPRIGHT.get(exif.get(ExifTags.Base.Orientation, 1))
        film = exif.get_ifd(ExifTags.IFD.Exif).get(ExifTags.Base.FocalLengthIn35mmFilm, 0)
        if 3 <= float(film) <= 3000:  # from a circular fisheye to the longest zoom
            focal = float(film) / FULL_FRAME_DIAGONAL
    except _DAMAGE as error:
        warnings.warn(f"its EXIF is damaged ({reason(error)}), part was not used", stacklevel=2)
    return turn, focal


def _opaque(path: Path, image: Image.Image) -> Image.Image:
    """Return the picture on white, with 8 bits, as RGB, CMYK or gray."""
    if image.mode.startswith(("I", "F")):
        return Image.fromarray(_eight_bits(path, image))
    if image.has_transparency_data:
        straight = image.convert("LA") if image.mode == "La" else image
        layer = straight.convert("RGBA")
        white = Image.new("RGB", image.size, "white")
        white.paste(layer, mask=layer)
        return white
    return image if image.mode in _PROFILED else image.convert("RGB")


def _eight_bits(path: Path, image: Image.Image) -> NDArray[np.uint8]:
    values = np.asarray(image)
    tags = image.tag_v2 if isinstance(image, TiffImageFile) else {}
    bits = min(tags.get(ExifTags.Base.BitsPerSample, (16,))[0], 16)
    whites = (1, 255, 65535) if image.mode == "F" else (2**bits - 1,)
    low, high = values.min(), values.max()
    white = next((white for white in whites if low >= 0 and high <= white), None)
    if white is None:
        raise InputError(
            f"{path}: holds numbers from {low:g} to {high:g}, not shades of gray; "
            "save it with 8 or 16 bits"
        )
    if image.mode == "F":
        warnings.warn(f"holds floats, and was read with {white} as white", stacklevel=2)
    shades = np.rint(values * np.float32(255 / white)).astype(np.uint8)
    if tags.get(ExifTags.Base.PhotometricInterpretation) == 0:
        shades = 255 - shades
    return np.where(values == image.info.get("transparency"), np.uint8(255), shades)


def _in_srgb(image: Image.Image, profile: bytes | None) -> Image.Image:
    try:
        source = _source_profile(image.mode, profile)
        if source is not None:
            managed = ImageCms.profileToProfile(
                image, source, ImageCms.createProfile("sRGB"), outputMode="RGB"
            )
            return managed or image
    except (ImageCms.PyCMSError, OSError) as error:
        warnings.warn(f"its colour profile is damaged ({reason(error)}) and ignored", stacklevel=2)
    return image.convert("RGB")


def _source_profile(mode: str, profile: bytes | None) -> ImageCms.ImageCmsProfile | None:
    if not profile or mode not in _PROFILED:
        return None
    source = ImageCms.ImageCmsProfile(BytesIO(profile))
    fits = source.profile.xcolor_space == _PROFILED[mode]
    return source if fits and "sRGB" not in ImageCms.getProfileDescription(source) else None
