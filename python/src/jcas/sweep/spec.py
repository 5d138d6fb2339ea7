"""The specification of a sweep: a TOML file with the lists of values."""

from __future__ import annotations

import hashlib
import itertools
import json
import sys
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from ..arguments import read_file, seed_of, shown, whole
from ..config import Config
from ..errors import ArgumentError, JcasError
from ..evaluation import EPISODES_MAX
from ..flown import WEIGHTS
from .cell import Cell, build

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib

KEYS = ("config", "episodes", "seed", "fields", "axes")
DEFAULTS: dict[str, list[Any]] = {"policy": ["teams"], "pilot": ["adaptive"]}
CELLS_MAX = 10**6


@dataclass(frozen=True)
class Sweep:
    """A sweep: lists of values, of which every combination is one cell."""

    axes: dict[str, list[Any]]
    """The values of `policy`, `pilot` and fields of the configuration, by name."""
    cells: tuple[Cell, ...]
    """Every combination, with the last axis varying fastest."""
    config_hashes: tuple[str, ...]
    """Hash of each cell's configuration."""
    weights: dict[str, bytes]
    """The file of each trained policy, by its name in the specification."""

    @classmethod
    def read(cls, path: Path) -> Sweep:
        """Read a specification. Paths in it start from the file's folder.

        Raises:
            MissingFileError: the file cannot be read.
            ArgumentError: the file is no specification; the message names the key.
            ConfigError: a cell has no legal configuration.

        """
        try:
            spec = tomllib.loads(read_file(path).decode("utf-8"))
        except ValueError as error:
            raise ArgumentError(f"{path}: not TOML: {error}") from error
        try:
            return cls.of(spec, path.parent)
        except JcasError as error:
            raise type(error)(f"{path}: {error}", error.status) from None

    @classmethod
    def of(cls, spec: Mapping[str, Any], folder: Path = Path()) -> Sweep:
        """Build the sweep of a specification that was read, and check every cell."""
        unknown = next((key for key in spec if key not in KEYS), None)
        if unknown is not None:
            raise ArgumentError(f"{unknown}: must be one of {', '.join(KEYS)}")
        episodes = whole("episodes", spec.get("episodes", 300), 1, EPISODES_MAX)
        seed = seed_of("seed", spec.get("seed", 1))
        fields, axes = _table(spec, "fields"), {**DEFAULTS, **_table(spec, "axes")}
        count = 1
        for name, values in axes.items():
            if not isinstance(values, list) or not values:
                raise ArgumentError(f"axes.{name} = {shown(values)}: must be a list of values")
            if name in fields:
                raise ArgumentError(f"axes.{name}: stands under fields too; must stand in one")
            count *= len(values)
        if count > CELLS_MAX:
            raise ArgumentError(f"axes: {count} combinations: must be at most {CELLS_MAX}")
        base = Config(_source(spec.get("config"), folder), **fields)
        weights = {
            name: read_file(file)
            for name, file in ((name, _file(name, folder)) for name in axes["policy"])
            if file is not None
        }
        cells, hashes = [], []
        for index, values in enumerate(itertools.product(*axes.values())):
            chosen = dict(zip(axes, values, strict=True))
            policy, pilot = chosen.pop("policy"), chosen.pop("pilot")
            if policy in weights and pilot != "adaptive":
                raise ArgumentError(
                    f"axes.pilot = {shown(pilot)}: must be 'adaptive' for the trained {policy}"
                )
            config = base.replace(**chosen)
            hashes.append(f"0x{config.hash:016x}")
            cells.append(Cell(index, values, policy, pilot, dict(config), episodes, seed))
        sweep = cls(axes, tuple(cells), tuple(hashes), weights)
        for cell in sweep._first_of_each_policy():
            cell.flown_by(weights.get(cell.policy))
        return sweep

    def _first_of_each_policy(self) -> Iterator[Cell]:
        seen = set()
        for cell in self.cells:
            if (cell.policy, cell.pilot) not in seen:
                seen.add((cell.policy, cell.pilot))
                yield cell

    def fingerprint(self) -> str:
        """Hash all that the table follows from: cells, episodes, seed, policies and the build."""
        digest = hashlib.sha256(build().encode())
        for cell, config_hash in zip(self.cells, self.config_hashes, strict=True):
            key = [list(self.axes), cell.values, config_hash, cell.episodes, cell.seed]
            digest.update(json.dumps(key).encode())
        for name, weights in sorted(self.weights.items()):
            digest.update(json.dumps([name, hashlib.sha256(weights).hexdigest()]).encode())
        return digest.hexdigest()


def _table(spec: Mapping[str, Any], key: str) -> dict[str, Any]:
    value = spec.get(key, {})
    if not isinstance(value, dict):
        raise ArgumentError(f"{key} = {shown(value)}: must be a table")
    return value


def _source(config: Any, folder: Path) -> Any:
    """The base configuration: a preset's name stays, a file is found from the folder."""
    if isinstance(config, str) and Path(config).suffix in (".toml", ".json"):
        return folder / config
    return config


def _file(policy: Any, folder: Path) -> Path | None:
    """The weights of a trained policy; a baseline has none."""
    if not isinstance(policy, str):
        raise ArgumentError(f"axes.policy = {shown(policy)}: must be a name or a folder")
    path = folder / policy
    if path.is_dir():
        return path / WEIGHTS
    return path if path.is_file() else None
