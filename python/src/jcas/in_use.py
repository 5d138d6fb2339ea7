"""Which objects are in use: what NumPy's arrays and several calls in a row need beside the kernel's own marks."""

from __future__ import annotations

import threading

from .errors import BusyError


class Mark:
    """The mark of an object that one thread at a time may use; as a context manager it is held for a block.

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
            raise BusyError(f"{self._name} is in use by another thread: give each thread its own, or use a lock")

    def __exit__(self, *_: object) -> None:
        self._lock.release()

    def __reduce__(self) -> tuple[type[Mark], tuple[str]]:
        return (Mark, (self._name,))
