"""Shows the configuration's fields where help(), IDEs and notebooks look for keywords."""

from __future__ import annotations

import inspect
from collections.abc import Callable
from typing import Any, Concatenate, ParamSpec, TypeVar

from ._fields import Fields

F = TypeVar("F", bound=Callable[..., Any])
P = ParamSpec("P")
R = TypeVar("R")


def shows_fields(function: F) -> F:
    """Write the fields into a function's signature, in place of its `**fields`."""
    signature = inspect.signature(function)
    own = [part for part in signature.parameters.values() if part.kind is not part.VAR_KEYWORD]
    taken = {part.name for part in own}
    fields = [
        inspect.Parameter(
            name, inspect.Parameter.KEYWORD_ONLY, default=None, annotation=_kind(annotation)
        )
        for name, annotation in Fields.__annotations__.items()
        if name not in taken
    ]
    shown = signature.replace(parameters=[*own, *fields])
    function.__signature__ = shown  # type: ignore[attr-defined]
    return function


def takes_what(
    init: Callable[Concatenate[Any, P], None],
) -> Callable[[Callable[..., R]], Callable[P, R]]:
    """Give a function the arguments of a constructor, for `help()` and for type checkers."""

    def decorate(function: Callable[..., R]) -> Callable[P, R]:
        own, made = inspect.signature(init), inspect.signature(function)
        function.__signature__ = own.replace(  # type: ignore[attr-defined]
            parameters=list(own.parameters.values())[1:], return_annotation=made.return_annotation
        )
        return function

    return decorate


def _kind(annotation: Any) -> type:
    """Return the type of a field's values in one word, which keeps the signature short."""
    first = str(getattr(annotation, "__forward_arg__", annotation)).split(" | ")[0]
    return {"int": int, "float": float}.get(first, list if first.startswith("Sequence") else str)
