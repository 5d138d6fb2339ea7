"""Finds and loads the kernel's shared library, and turns its statuses into errors."""

from __future__ import annotations

import ctypes
import os
from collections.abc import Callable
from contextlib import suppress
from itertools import count
from pathlib import Path
from typing import TypeAlias

from . import _abi
from .errors import (
    ActionError,
    ArgumentError,
    BusyError,
    ConfigError,
    EpisodeOverError,
    JcasError,
    PolicyError,
    SnapshotError,
)

_SUFFIXES = (".so", ".dylib", ".dll")
_MESSAGE_CAPACITY = 1024
_BUSY = "the object is in use by another thread: give each thread its own, or use a lock"

TextCall: TypeAlias = "Callable[[ctypes.Array[ctypes.c_char] | None, int, object], int]"
"""A call that writes a text. It takes a buffer, its capacity and the address of the length."""

_ERRORS: dict[int, type[JcasError]] = {
    _abi.JCAS_ERROR_CONFIG: ConfigError,
    _abi.JCAS_ERROR_ARGUMENT: ArgumentError,
    _abi.JCAS_ERROR_NAN: ActionError,
    _abi.JCAS_ERROR_EPISODE_OVER: EpisodeOverError,
    _abi.JCAS_ERROR_CORRUPT: SnapshotError,
    _abi.JCAS_ERROR_MODEL_MISMATCH: SnapshotError,
    _abi.JCAS_ERROR_BUSY: BusyError,
    _abi.JCAS_ERROR_MEMORY: PolicyError,
}


def _load() -> ctypes.CDLL:
    path = os.environ.get("JCAS_LIBRARY") or _bundled()
    try:
        library = ctypes.CDLL(str(path))
    except OSError as error:
        raise JcasError(f"cannot load the kernel's library {path}: {error}") from error
    _abi.declare(library)
    if library.jcas_abi_check(_abi.JCAS_ABI_VERSION):
        raise JcasError(
            f"{path} has version {_version(library.jcas_abi_version())} of the interface, "
            f"this package needs {_version(_abi.JCAS_ABI_VERSION)}"
        )
    return library


def _version(number: int) -> str:
    """Write a version of the interface: major and minor. Development headers have major 0."""
    return f"{number >> 24}.{number >> 16 & 0xFF}"


def _bundled() -> Path:
    folder = Path(__file__).parent / "_native"
    for file in sorted(folder.glob("*")):
        if file.suffix in _SUFFIXES:
            return file
    raise JcasError(
        f"{folder} holds no library: install the package (pip install ./python), "
        "or name a library in JCAS_LIBRARY"
    )


lib = _load()


def fail(status: int, message: str = "") -> None:
    """Raise the error of a status, with the kernel's message if it has one."""
    own = _BUSY if status == _abi.JCAS_ERROR_BUSY else lib.jcas_status_string(status).decode()
    words = message or own
    raise _ERRORS.get(status, JcasError)(words, status)


def fail_saying(status: int, message: TextCall) -> None:
    """Raise the error of a status with the message that an object keeps of its last refusal.

    A call that finds the object in use keeps no message, and another thread may be using it now.
    """
    words = ""
    if status != _abi.JCAS_ERROR_BUSY:
        with suppress(BusyError):
            words = read_text(message)
    fail(status, words)


def check(status: int) -> None:
    """Raise the error of a status unless it means success."""
    if status:
        fail(status)


def check_with_message(call: Callable[[ctypes.Array[ctypes.c_char], int], int]) -> None:
    """Make a call that takes a buffer for the reason of a refusal, and raise with that reason."""
    message = ctypes.create_string_buffer(_MESSAGE_CAPACITY)
    status = call(message, _MESSAGE_CAPACITY)
    if status:
        fail(status, message.value.decode("utf-8", "replace"))


def listed(name: Callable[[int], bytes | None]) -> tuple[str, ...]:
    """List the names that a call gives by their index, until it gives none."""
    return tuple(text.decode() for text in iter(map(name, count()).__next__, None) if text)


def read_text(call: TextCall) -> str:
    """Make a call that writes a text: once for its length, once for the text."""
    length = ctypes.c_size_t()
    check(call(None, 0, ctypes.byref(length)))
    text = ctypes.create_string_buffer(length.value + 1)
    check(call(text, len(text), ctypes.byref(length)))
    return text.value.decode()
