"""Checks of arguments, before any of them reaches the kernel.

The kernel cannot check the type behind an address, and ctypes silently truncates numbers. So every
number and every array passes through here first. As in NumPy, whole numbers of any integer type are
converted, and arrays and lists of any real dtype and memory order.
"""

from __future__ import annotations

import operator
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from .errors import ActionError, ArgumentError, JcasError, MissingFileError

Floats = npt.NDArray[np.float32]

SEED_MAX = 2**64 - 1

_REAL = "fiub"
"""Kinds of dtypes that stand for real numbers."""


def whole(name: str, value: Any, low: int, high: int) -> int:
    """Return a whole number between two bounds as a Python int."""
    try:
        number = None if isinstance(value, bool | np.bool_ | np.ndarray) else operator.index(value)
    except TypeError:
        number = None
    if number is None or not low <= number <= high:
        raise ArgumentError(f"{name} = {shown(value)}: must be a whole number from {low} to {high}")
    return number


def seed_of(name: str, value: Any) -> int:
    """Return a seed as a Python int."""
    return whole(name, value, 0, SEED_MAX)


def seeds_of(name: str, values: Any, count: int) -> npt.NDArray[np.uint64]:
    """Return `count` seeds as an array for the kernel."""
    if type(values) is np.ndarray and values.dtype == np.uint64 and values.shape == (count,):
        return np.ascontiguousarray(values)
    try:
        given = list(values)
    except TypeError:
        raise ArgumentError(
            f"{name} = {shown(values)}: must be {count} seeds, one for each mission"
        ) from None
    if len(given) != count:
        raise ArgumentError(
            f"{name} has {len(given)} entries: must have one for each of {count} missions"
        )
    return np.array(
        [seed_of(f"{name}[{place}]", value) for place, value in enumerate(given)], dtype=np.uint64
    )


def real(name: str, value: Any) -> float:
    """Return a finite number as a Python float."""
    try:
        number = None if isinstance(value, str | bytes | bool) else float(value)
    except (TypeError, ValueError):
        number = None
    if number is None or not np.isfinite(number):
        raise ArgumentError(f"{name} = {shown(value)}: must be a finite number")
    return number


def floats(
    name: str,
    values: Any,
    shape: tuple[int, ...],
    error: type[JcasError] = ActionError,
    what: str = "",
) -> Floats:
    """Return numbers of a shape as aligned, contiguous float32, without a needless copy."""
    if (
        type(values) is np.ndarray
        and values.dtype == np.float32
        and values.shape == shape
        and values.flags.c_contiguous
        and values.flags.aligned
    ):
        return values
    array = _array(name, values, error)
    if array.shape != shape:
        raise error(f"{name}: the shape is {array.shape}, must be {shape}{what}")
    with np.errstate(over="ignore"):
        return np.require(array, np.float32, ("C_CONTIGUOUS", "ALIGNED"))


def writable(name: str, out: Any, shape: tuple[int, ...]) -> Floats:
    """Return an array that the kernel may write to, or refuse it."""
    if not isinstance(out, np.ndarray):
        raise ArgumentError(f"{name} = {shown(out)}: must be an array, float32 of shape {shape}")
    if out.dtype != np.float32 or out.shape != shape or not out.flags.carray:
        raise ArgumentError(
            f"{name} is {out.dtype} of shape {out.shape}: must be writable, aligned, "
            f"contiguous float32 of {shape}"
        )
    return out


def flags(name: str, values: Any, count: int) -> npt.NDArray[np.bool_]:
    """Return `count` truth values as an array."""
    array = np.asarray(values) if _is_regular(values) else np.empty(0, object)
    if array.dtype != np.bool_ or array.shape != (count,):
        raise ArgumentError(
            f"{name} is {array.dtype} of shape {array.shape}: must be bool of shape ({count},)"
        )
    return array


def options_of(options: Any, *known: str) -> Mapping[str, Any]:
    """Return the options of a reset, of which none may be unknown."""
    if options is None:
        return {}
    if not isinstance(options, Mapping):
        raise ArgumentError(f"options = {shown(options)}: must be a dict or None")
    for name in options:
        if name not in known:
            raise ArgumentError(f"options: {shown(name)} is unknown, must be {' or '.join(known)}")
    return options


def read_file(path: Path) -> bytes:
    """Return what a file holds."""
    try:
        return path.read_bytes()
    except (OSError, ValueError) as error:  # A zero character in a path is a ValueError.
        words = getattr(error, "strerror", None) or error
        raise MissingFileError(f"{str(path)!r}: cannot be read: {words}") from error


def snapshot_of(name: str, value: Any) -> bytes:
    """Return saved bytes from any object with the buffer protocol."""
    try:
        return bytes(memoryview(value))
    except TypeError:
        raise ArgumentError(
            f"{name} = {shown(value)}: must be bytes, as save() returns them"
        ) from None


def shown(value: Any) -> str:
    """Write a value for a message, cut where it is long."""
    text = repr(value)
    return text if len(text) <= 80 else f"{text[:77]}..."


def _array(name: str, values: Any, error: type[JcasError]) -> npt.NDArray[Any]:
    if not _is_regular(values):
        raise error(f"{name} = {shown(values)}: must be an array of real numbers, is ragged")
    array = np.asarray(values)
    if array.dtype.kind not in _REAL:
        raise error(f"{name} = {shown(values)}: must be an array of real numbers, is {array.dtype}")
    return array


def _is_regular(values: Any) -> bool:
    try:
        np.asarray(values)
    except (ValueError, TypeError, RuntimeError):
        return False
    return True
