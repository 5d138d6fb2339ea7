"""Shows the configuration's fields where help(), IDEs and notebooks look for keywords."""

from __future__ import annotations

import inspect
from collections.abc import Callable
from typing import Any, TypeVar

from ._fields import Fields

F = TypeVar("F", bound=Callable[..., Any])


def shows_fields(function: F) -> F:
    """Write the fields into a function's signature, in place of its `**fields`."""
    signature = inspect.signature(function)
    own = [
        part
        for part in signature.parameters.values()
        if part.kind is not inspect.Parameter.VAR_KEYWORD
    ]
    taken = {part.name for part in own}
    fields = [
        inspect.Parameter(
            name,
            inspect.Parameter.KEYWORD_ONLY,
            default=None,
            annotation=_kind(annotation),
        )
        for name, annotation in Fields.__annotations__.items()
        if name not in taken
    ]
    shown = signature.replace(parameters=[*own, *fields])
    function.__signature__ = shown  # type: ignore[attr-defined]
    return function


def _kind(annotation: Any) -> type:
    """Return the type of a field's values in one word, which keeps the signature short."""
    first = str(getattr(annotation, "__forward_arg__", annotation)).split(" | ")[0]
    return {"int": int, "float": float}.get(first, list if first.startswith("Sequence") else str)
