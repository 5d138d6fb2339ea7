"""Configurations: a preset, a dict, a TOML or JSON file, keywords, or any of them on top of another.

The kernel's own reader checks every configuration, so that its errors are those of the command line.
"""

from __future__ import annotations

import ctypes
import json
import os
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any, Union

from . import _abi
from ._library import check, check_with_message, lib, read_text
from .errors import ConfigError

ConfigLike = Union["Config", Mapping[str, Any], str, "os.PathLike[str]", None]
"""What a configuration can be made of: a preset's name, a path of a TOML or JSON file, a mapping, or nothing."""


class Config(Mapping[str, Any]):
    """A legal configuration: an immutable mapping of fields to values.

    Fields that the kernel derives from others (`detection_threshold_db`, `range_min_m`,
    `range_resolution_m`, `depots`) are absent unless they were given.

    Args:
        base: what to begin with; a preset's name (`mission`, the default, or `paper`), the path of a
            `.toml` or `.json` file, or a mapping.
        **fields: fields that replace those of `base`; None takes a field back to its derived value.

    Raises:
        ConfigError: a field is unknown or its value is not allowed.

    """

    __slots__ = ("_json", "_record", "_values")

    def __init__(self, base: ConfigLike = None, **fields: Any) -> None:
        given = {**_given(base), **_plain(fields)}
        text = _toml({name: value for name, value in given.items() if value is not None}).encode()
        record = _abi.jcas_config()
        size = ctypes.sizeof(record)
        check_with_message(
            lambda message, capacity: lib.jcas_config_from_toml(
                text, len(text), ctypes.byref(record), size, message, capacity
            )
        )
        self._record = record
        self._json = read_text(
            lambda out, capacity, length: lib.jcas_config_to_json(ctypes.byref(record), out, capacity, length)
        )
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
    def record(self) -> _abi.jcas_config:
        """The configuration as the C interface takes it. Not to be changed."""
        return self._record

    @property
    def hash(self) -> int:
        """The fingerprint that states, snapshots and traces carry."""
        value = ctypes.c_uint64()
        check(lib.jcas_config_hash(ctypes.byref(self._record), ctypes.byref(value)))
        return value.value

    def replace(self, **fields: Any) -> Config:
        """Return this configuration with some fields replaced."""
        return Config(self, **fields)

    @staticmethod
    def fields() -> list[dict[str, Any]]:
        """Every field there is: its name, unit, legal range and meaning."""
        return list(json.loads(read_text(lib.jcas_config_fields)))


def _given(base: ConfigLike) -> dict[str, Any]:
    if base is None:
        return {}
    if isinstance(base, Mapping):
        return _plain(base)
    path = Path(base)
    if path.suffix == ".json":
        return _read_json(path)
    if path.suffix == ".toml":
        return _read_toml(path)
    return {"preset": str(base)}


def _read_json(path: Path) -> dict[str, Any]:
    try:
        values = json.loads(path.read_text(encoding="utf-8"))
    except ValueError as error:
        raise ConfigError(f"{path}: not JSON: {error}", _abi.JCAS_ERROR_CONFIG) from error
    if not isinstance(values, dict):
        raise ConfigError(f"{path}: must be an object of fields", _abi.JCAS_ERROR_CONFIG)
    return values


def _read_toml(path: Path) -> dict[str, Any]:
    """Read a TOML file by the kernel's own reader; its fields come back with all the others'."""
    text, record = path.read_bytes(), _abi.jcas_config()
    size = ctypes.sizeof(record)
    check_with_message(
        lambda message, capacity: lib.jcas_config_from_toml(
            text, len(text), ctypes.byref(record), size, message, capacity
        )
    )
    return dict(
        json.loads(
            read_text(
                lambda out, capacity, length: lib.jcas_config_to_json(ctypes.byref(record), out, capacity, length)
            )
        )
    )


def _plain(fields: Mapping[str, Any]) -> dict[str, Any]:
    """Turn NumPy scalars and arrays, as sweeps produce them, into plain numbers and lists."""
    return {name: value.tolist() if hasattr(value, "tolist") else value for name, value in fields.items()}


def _toml(fields: Mapping[str, Any]) -> str:
    """Write fields as TOML, which unlike JSON can say NaN, so that the kernel can refuse it by name."""
    return "".join(f"{json.dumps(name)} = {_toml_value(name, value)}\n" for name, value in fields.items())


def _toml_value(name: str, value: Any) -> str:
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, int | float):
        return repr(value)
    if isinstance(value, str):
        return json.dumps(value)
    if isinstance(value, list | tuple):
        return f"[{', '.join(_toml_value(name, part) for part in value)}]"
    raise ConfigError(f"{name} = {value!r}: must be a number, a text or a list", _abi.JCAS_ERROR_CONFIG)
