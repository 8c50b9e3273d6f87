"""Loops over pixels, compiled by numba at their first call and kept in its cache."""

from collections.abc import Callable
from typing import TypeVar, cast

from numba import njit

Kernel = TypeVar("Kernel", bound=Callable[..., object])


def compiled(kernel: Kernel) -> Kernel:
    """Return the function compiled: a few seconds at its first call after an installation."""
    return cast(Kernel, njit(cache=True, error_model="numpy")(kernel))
