"""Which focal length a photo was taken with: given, written in the photo, or assumed."""

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


def intrinsics(
    width: int, height: int, lens: Lens | None, focal_in_diagonals: float | None
) -> Intrinsics:
    """Return the camera of a photo: `lens` before the photo's own word before the assumption.

    Args:
        width: Of the photo as a person sees it, in pixels.
        height: In pixels.
        lens: What the user says; None leaves it to the photo.
        focal_in_diagonals: What the photo says, in diagonals of the image; None where it is
            silent.
    """
    match lens:
        case FocalLength(pixels):
            return Intrinsics.centred(width, height, pixels, FocalSource.GIVEN)
        case FieldOfView(degrees):
            return Intrinsics.from_field_of_view(width, height, degrees, FocalSource.GIVEN)
        case None if focal_in_diagonals is not None:
            focal = focal_in_diagonals * hypot(width, height)
            return Intrinsics.centred(width, height, focal, FocalSource.EXIF)
        case None:
            focal = ASSUMED_FOCAL_IN_DIAGONALS * hypot(width, height)
            return Intrinsics.centred(width, height, focal, FocalSource.ASSUMED)
    raise InputError(f"a lens is a FocalLength or a FieldOfView, got {lens!r}")
