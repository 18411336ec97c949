"""Checks of shape and type for arguments that people write by hand, with messages that name them."""

from collections.abc import Iterable, Sequence
from operator import index
from typing import SupportsIndex, TypeAlias, TypeVar, cast

import numpy as np
import numpy.typing as npt

from .errors import InputError

Vector: TypeAlias = Sequence[float] | npt.NDArray[np.floating]
"""Three numbers."""

Triple: TypeAlias = tuple[float, float, float]

T = TypeVar("T")


def number(name: str, value: object) -> float:
    """A finite float."""
    try:
        result = float(cast(float, value))
    except (TypeError, ValueError):
        raise InputError(f"{name}: expected a number, got {value!r}") from None
    if not np.isfinite(result):
        raise InputError(f"{name}: {result} is not finite")
    return result


def integer(name: str, value: object) -> int:
    """A whole number."""
    try:
        return index(cast(SupportsIndex, value))
    except TypeError:
        raise InputError(f"{name}: expected a whole number, got {value!r}") from None


def text(name: str, value: object) -> str:
    """A string."""
    if not isinstance(value, str):
        raise InputError(f"{name}: expected text, got {value!r}")
    return value


def object_id(name: str, value: object) -> int:
    """The number of what is called `name` in the object-id pass."""
    result = integer(f"{name}: object_id", value)
    if not 0 < result < 2**32:
        raise InputError(f"{name}: object_id {result} is not from 1 to 2³² − 1")
    return result


def label_index(name: str, value: object) -> int:
    """A number in a pass of indices, which single precision holds."""
    result = integer(name, value)
    if not 0 <= result < 2**24:
        raise InputError(f"{name} {result} is not from 0 to 2²⁴ − 1")
    return result


def items(name: str, value: Iterable[T], what: str) -> tuple[T, ...]:
    """All of an iterable, `what` in words."""
    try:
        return tuple(value)
    except TypeError:
        raise InputError(f"{name}: expected {what}, got {type(value).__name__}") from None


def triple(name: str, value: object) -> Triple:
    """Three finite floats."""
    try:
        items = tuple(cast(Iterable[object], value))
    except TypeError:
        items = ()
    if len(items) != 3:
        raise InputError(f"{name}: expected three numbers, got {value!r}")
    x, y, z = (number(name, item) for item in items)
    return x, y, z


def direction(name: str, value: object) -> Triple:
    """Three finite floats that are not all zero."""
    result = triple(name, value)
    if not any(result):
        raise InputError(f"{name}: the zero vector has no direction")
    return result


def matrix(name: str, value: object) -> npt.NDArray[np.float64]:
    """A finite 4×4 matrix that acts on column vectors; a read-only copy."""
    try:
        result = np.array(value, dtype=np.float64)
    except (TypeError, ValueError):
        raise InputError(f"{name}: expected a 4×4 matrix, got {type(value).__name__}") from None
    if result.shape != (4, 4):
        raise InputError(f"{name}: expected a 4×4 matrix, got shape {result.shape}")
    if not np.isfinite(result).all():
        row, column = np.argwhere(~np.isfinite(result))[0]
        raise InputError(f"{name}: entry [{row}, {column}] is {result[row, column]}")
    result.flags.writeable = False
    return result


def pixels(name: str, value: object) -> tuple[int, int]:
    """Width and height."""
    try:
        width, height = (int(item) for item in cast(Iterable[int], value))
    except (TypeError, ValueError):
        raise InputError(f"{name}: expected width and height in pixels, got {value!r}") from None
    if width < 1 or height < 1:
        raise InputError(f"{name}: {width}×{height} pixels hold no picture")
    return width, height


def from_top_left(region: tuple[int, int, int, int], size: tuple[int, int]) -> tuple[int, int, int, int]:
    """Left, top, width, height of a region given by two corners from the bottom left."""
    try:
        x0, y0, x1, y1 = (int(value) for value in region)
    except (TypeError, ValueError):
        raise InputError(f"region: expected x0, y0, x1, y1 in pixels, got {region!r}") from None
    width, height = size
    if not (0 <= x0 < x1 <= width and 0 <= y0 < y1 <= height):
        raise InputError(f"region: ({x0}, {y0}) to ({x1}, {y1}) is empty or reaches beyond {width}×{height} pixels")
    return x0, height - y1, x1 - x0, y1 - y0
