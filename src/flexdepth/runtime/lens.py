"""Which focal length a photo was taken with: given, written in it, seen in it, or assumed."""

from dataclasses import dataclass
from math import hypot, radians, tan

from flexdepth.runtime.depthmap import FocalSource, Intrinsics
from flexdepth.runtime.errors import InputError

ASSUMED_FOCAL_IN_DIAGONALS = 0.4 / tan(radians(30))
"""The focal length of a photo that says nothing, in diagonals of the image: 0.693.

A landscape photo of 4:3 is 0.8 diagonals wide, so it is taken to see 60 degrees from left to
right, like a 30 mm lens on full-frame film. The same lens is assumed for every other shape.
"""


@dataclass(frozen=True)
class FocalLength:
    """A focal length in pixels of the photo, for photos of one camera at one size."""

    pixels: float

    def __post_init__(self) -> None:
        """Refuse a length that is no length."""
        if not 1e-3 <= self.pixels <= 1e9:
            raise InputError(
                f"a focal length is a number of pixels from 0.001 to 1e9, got {self.pixels:g}"
            )


@dataclass(frozen=True)
class FieldOfView:
    """The angle that a photo sees from its left edge to its right edge, in degrees."""

    degrees: float

    def __post_init__(self) -> None:
        """Refuse an angle that no pinhole camera sees."""
        if not 0 < self.degrees < 180:
            raise InputError(
                f"a field of view lies between 0 and 180 degrees, got {self.degrees:g}"
            )


Lens = FocalLength | FieldOfView
"""What a user can say about the camera."""


@dataclass(frozen=True)
class Said:
    """What a photo says of its focal length, in diagonals of the image; None is silence.

    Attributes:
        written: In the file.
        seen: By a network, in the picture.
    """

    written: float | None = None
    seen: float | None = None


def intrinsics(width: int, height: int, lens: Lens | None, said: Said) -> Intrinsics:
    """Return the camera of a photo: what the user says, or the file, or the picture, or nobody.

    Args:
        width: Of the photo as a person sees it, in pixels.
        height: In pixels.
        lens: What the user says; None leaves it to the photo.
        said: What the photo says.
    """
    diagonal = hypot(width, height)
    match lens:
        case FocalLength(pixels):
            return Intrinsics.centred(width, height, pixels, FocalSource.GIVEN)
        case FieldOfView(degrees):
            return Intrinsics.from_field_of_view(width, height, degrees, FocalSource.GIVEN)
        case None if said.written is not None:
            return Intrinsics.centred(width, height, said.written * diagonal, FocalSource.EXIF)
        case None if said.seen is not None:
            return Intrinsics.centred(width, height, said.seen * diagonal, FocalSource.PREDICTED)
        case None:
            focal = ASSUMED_FOCAL_IN_DIAGONALS * diagonal
            return Intrinsics.centred(width, height, focal, FocalSource.ASSUMED)
    raise InputError(f"a lens is a FocalLength or a FieldOfView, got {lens!r}")
