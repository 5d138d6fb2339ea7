"""Marks objects as in use across NumPy operations and several kernel calls."""

from __future__ import annotations

import threading

from .errors import BusyError


class Mark:
    """The mark of an object that one thread at a time may use: a context manager.

    A copy, also one that was pickled, is free.

    Args:
        name: of the object, for the message.

    """

    __slots__ = ("_lock", "_name")

    def __init__(self, name: str) -> None:
        self._name = name
        self._lock = threading.Lock()

    def __enter__(self) -> None:
        if not self._lock.acquire(blocking=False):
            raise BusyError(
                f"{self._name} is in use by another thread: give each thread its own, or use a lock"
            )

    def __exit__(self, *_: object) -> None:
        self._lock.release()

    def __reduce__(self) -> tuple[type[Mark], tuple[str]]:
        return (Mark, (self._name,))
