"""Configurations: a preset, a dict, a TOML or JSON file, keywords, or any of them on top of another.

The kernel's own reader checks every configuration, so that its errors are those of the command line.
"""

from __future__ import annotations

import json
import os
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any, Union

from . import _abi
from .errors import ConfigError

ConfigLike = Union["Config", Mapping[str, Any], str, "os.PathLike[str]", None]
"""What a configuration can be made of: a preset's name, a path of a TOML or JSON file, a mapping, or nothing."""


class Config(Mapping[str, Any]):
    """A legal configuration: an immutable mapping of every field to its value.

    Args:
        base: what to begin with; a preset's name (`mission`, the default, or `paper`), the path of a
            `.toml` or `.json` file, or a mapping.
        **fields: fields that replace those of `base`.

    Raises:
        ConfigError: a field is unknown or its value is not allowed.

    """

    __slots__ = ("_json", "_values")

    def __init__(self, base: ConfigLike = None, **fields: Any) -> None:
        if isinstance(base, Config) and not fields:
            self._json: str = base._json
        else:
            self._json = _abi.config_resolve(json.dumps({**_given(base), **_plain(fields)}))
        self._values: dict[str, Any] = json.loads(self._json)

    def __getitem__(self, field: str) -> Any:
        return self._values[field]

    def __iter__(self) -> Iterator[str]:
        return iter(self._values)

    def __len__(self) -> int:
        return len(self._values)

    def __repr__(self) -> str:
        return f"Config({', '.join(f'{field}={value!r}' for field, value in self._values.items())})"

    def __hash__(self) -> int:
        return hash(self._json)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Config) and self._json == other._json

    def __reduce__(self) -> tuple[type[Config], tuple[dict[str, Any]]]:
        return (Config, (self._values,))

    @property
    def json(self) -> str:
        """The configuration as JSON text, every field written out."""
        return self._json

    def replace(self, **fields: Any) -> Config:
        """Return this configuration with some fields replaced."""
        return Config(self, **fields)


def _given(base: ConfigLike) -> dict[str, Any]:
    if base is None:
        return {}
    if isinstance(base, Mapping):
        return _plain(base)
    path = Path(base)
    if path.suffix == ".json":
        return _read(path)
    if path.suffix == ".toml":
        return dict(json.loads(_abi.config_toml_to_json(path.read_text(encoding="utf-8"))))
    return {"preset": str(base)}


def _read(path: Path) -> dict[str, Any]:
    values = json.loads(path.read_text(encoding="utf-8"))
    if not isinstance(values, dict):
        raise ConfigError(f"{path}: allowed is an object of fields, not {type(values).__name__}")
    return values


def _plain(fields: Mapping[str, Any]) -> dict[str, Any]:
    """Turn NumPy scalars and arrays, as sweeps produce them, into what JSON can say."""
    return {name: value.tolist() if hasattr(value, "tolist") else value for name, value in fields.items()}
