"""Configurations: a preset, a mapping, or a TOML or JSON file, with keywords that replace fields.

The kernel's own reader checks every configuration, so that its errors are those of the command
line.
"""

from __future__ import annotations

import ctypes
import json
import os
from collections.abc import Callable, Iterator, Mapping
from functools import cache
from pathlib import Path
from typing import Any, Union

import numpy as np
from typing_extensions import Unpack

from . import _abi
from ._fields import Fields
from ._library import check, check_with_message, lib, read_text
from .arguments import read_file, shown
from .errors import ConfigError, UnknownFieldError
from .signature import shows_fields

ConfigLike = Union["Config", Mapping[str, Any], str, "os.PathLike[str]", None]
"""A source of a configuration: a preset's name, a TOML or JSON file's path, a mapping, or None."""


class Config(Mapping[str, Any]):
    """A legal configuration: an immutable mapping of fields to values.

    Fields that the kernel derives from others (`detection_threshold_db`, `range_min_m`,
    `range_resolution_m`, `depots`) are absent unless they were given; `config["depots"]` is then
    None.

    Args:
        base: what to begin with; a preset's name (`mission`, the default, or `paper`), the path of
            a `.toml` or `.json` file, or a mapping.
        **fields: fields that replace those of `base`; None takes a field back to its derived value.

    Raises:
        ConfigError: a field is unknown or its value is not allowed.

    """

    __slots__ = ("_json", "_record", "_values")

    @shows_fields
    def __init__(self, base: ConfigLike = None, **fields: Unpack[Fields]) -> None:
        given = {**_given(base), **_plain(fields)}
        for name, value in given.items():
            _check_kind(name, value)
        text = _toml({name: value for name, value in given.items() if value is not None}).encode()
        record = _abi.jcas_config()
        size = ctypes.sizeof(record)
        try:
            check_with_message(
                lambda message, capacity: lib.jcas_config_from_toml(
                    text, len(text), ctypes.byref(record), size, message, capacity
                )
            )
        except ConfigError as error:
            words = str(error).replace("`jcas config show`", "jcas.Config.fields()")
            strange = next((name for name in fields if name not in {"preset", *_described()}), None)
            if strange is not None and strange in words:
                told = f"got an unexpected keyword argument '{strange}': {words}"
                raise UnknownFieldError(told, error.status) from None
            raise ConfigError(words, error.status) from None
        self._record = record
        self._json = read_text(
            lambda out, capacity, length: lib.jcas_config_to_json(
                ctypes.byref(record), out, capacity, length
            )
        )
        self._values: dict[str, Any] = json.loads(self._json)

    def __getitem__(self, field: str) -> Any:
        if field not in self._values and field in _described():
            return None
        return self._values[field]

    def __contains__(self, field: object) -> bool:
        return field in self._values

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
        """Fingerprint of the configuration, which states, snapshots and traces carry."""
        value = ctypes.c_uint64()
        check(lib.jcas_config_hash(ctypes.byref(self._record), ctypes.byref(value)))
        return value.value

    def replace(self, **fields: Unpack[Fields]) -> Config:
        """Return this configuration with some fields replaced."""
        return Config(self, **fields)

    @staticmethod
    def fields() -> list[dict[str, Any]]:
        """Return every field with its name, unit, legal range and meaning."""
        return list(json.loads(read_text(lib.jcas_config_fields)))


def _given(base: ConfigLike) -> dict[str, Any]:
    if base is None:
        return {}
    if isinstance(base, Mapping):
        return _plain(base)
    if not isinstance(base, str | os.PathLike):
        raise ConfigError(
            f"config = {shown(base)}: must be a preset's name, "
            "the path of a TOML or JSON file, a mapping, "
            "a jcas.Config or None",
            _abi.JCAS_ERROR_CONFIG,
        )
    path = Path(base)
    if path.suffix == ".json":
        return _read_json(path)
    if path.suffix == ".toml":
        return _read_toml(path)
    return {"preset": str(base)}


def _read_json(path: Path) -> dict[str, Any]:
    try:
        values = json.loads(read_file(path).decode("utf-8"))
    except ValueError as error:
        raise ConfigError(f"{path}: not JSON: {error}", _abi.JCAS_ERROR_CONFIG) from error
    if not isinstance(values, dict):
        raise ConfigError(f"{path}: must be an object of fields", _abi.JCAS_ERROR_CONFIG)
    return values


def _read_toml(path: Path) -> dict[str, Any]:
    """Read a TOML file by the kernel's own reader; its fields come back with all the others'."""
    text, record = read_file(path), _abi.jcas_config()
    size = ctypes.sizeof(record)
    check_with_message(
        lambda message, capacity: lib.jcas_config_from_toml(
            text, len(text), ctypes.byref(record), size, message, capacity
        )
    )
    return dict(
        json.loads(
            read_text(
                lambda out, capacity, length: lib.jcas_config_to_json(
                    ctypes.byref(record), out, capacity, length
                )
            )
        )
    )


def _plain(fields: Mapping[str, Any]) -> dict[str, Any]:
    """Turn NumPy scalars and arrays, as sweeps produce them, into plain numbers and lists."""
    plain = {}
    for name, value in fields.items():
        if not isinstance(name, str):
            raise ConfigError(
                f"{shown(name)}: a field's name must be a text", _abi.JCAS_ERROR_CONFIG
            )
        plain[name] = value.tolist() if isinstance(value, np.generic | np.ndarray) else value
    return plain


def _check_kind(name: str, value: Any) -> None:
    """Refuse a value of the wrong kind in Python's words; the kernel judges everything else."""
    field, kind = _described().get(name), _kinds().get(name)
    if field is None or value is None:
        return
    span = f"from {field['low']:g} to {field['high']:g} ({field['unit']})"
    choices = [choice.strip() for choice in field["unit"].split("|")]
    if kind is int:
        fits, allowed = _is_whole(value), f"a whole number {span}"
    elif kind is float:
        fits, allowed = (
            _is_number(value),
            f"a number {span}",
        )
    elif kind is str:
        fits, allowed = value in choices, f"one of {', '.join(choices)}"
    elif name == "depots":
        fits, allowed = _is_cells(value), "a list of cells (x, y), each of two whole numbers"
    elif name == "detection_table":
        fits, allowed = _is_pairs(value), "a list of pairs (m, P_d), each of two numbers"
    else:
        return
    if not fits:
        raise ConfigError(f"{name} = {shown(value)}: must be {allowed}", _abi.JCAS_ERROR_CONFIG)


def _is_whole(value: Any) -> bool:
    return isinstance(value, int) and not isinstance(value, bool) and 0 <= value < 2**32


def _is_number(value: Any) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool)


def _is_pairs(value: Any, fits: Callable[[Any], bool] = _is_number) -> bool:
    return isinstance(value, list | tuple) and all(
        isinstance(pair, list | tuple) and len(pair) == 2 and all(fits(part) for part in pair)
        for pair in value
    )


def _is_cells(value: Any) -> bool:
    return _is_pairs(value, _is_whole)


@cache
def _described() -> dict[str, dict[str, Any]]:
    return {field["name"]: field for field in Config.fields()}


@cache
def _kinds() -> dict[str, type]:
    """What a field of the C struct is in Python: numbers are numbers, choices are texts."""
    python = {ctypes.c_uint32: int, ctypes.c_double: float, ctypes.c_int32: str}
    return {
        name: python[kind]
        for name, kind, *_ in _abi.jcas_config._fields_
        if kind in python and name in _described()
    }


def _toml(fields: Mapping[str, Any]) -> str:
    """Write fields as TOML. Unlike JSON, TOML has NaN, which the kernel then refuses by name."""
    return "".join(
        f"{json.dumps(name, ensure_ascii=False)} = {_toml_value(name, value)}\n"
        for name, value in fields.items()
    )


def _toml_value(name: str, value: Any) -> str:
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, int | float):
        return repr(value)
    if isinstance(value, str):
        return json.dumps(value, ensure_ascii=False)
    if isinstance(value, list | tuple):
        return f"[{', '.join(_toml_value(name, part) for part in value)}]"
    raise ConfigError(
        f"{name} = {shown(value)}: must be a number, a text or a list", _abi.JCAS_ERROR_CONFIG
    )
