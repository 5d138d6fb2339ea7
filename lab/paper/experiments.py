"""Lists of experiments, one TOML file each."""

from __future__ import annotations

import itertools
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import tomllib

FOLDER = Path(__file__).parent / "experiments"
KEYS = {"question", "policy", "pilot", "modes", "episodes", "axes", "fields", "training"}
MODES = ("sampled", "deterministic")

# The axes that have a column of their own; every other change stands in the column `changes`.
COLUMNS = {
    "motion_map": "udlrs",
    "inform_payment": "every_step",
    "sensing_range_m": 150.0,
    "uavs": 10,
    "hotspots": 5,
    "pilot": "adaptive",
    "seed": 0,
}


class ExperimentError(Exception):
    """Says which key of which file is wrong, its value and what is allowed."""


@dataclass(frozen=True)
class Run:
    """One policy in one cell: what is trained, if anything, and evaluated."""

    experiment: str
    policy: str
    cell: tuple[tuple[str, Any], ...]
    changes: tuple[str, ...]
    training: tuple[str, ...]
    modes: tuple[str, ...]
    episodes: int

    def __getitem__(self, axis: str) -> Any:
        return dict(self.cell)[axis]

    @property
    def learns(self) -> bool:
        """Whether the policy is trained."""
        return self.policy == "ppo"

    @property
    def name(self) -> str:
        """The name of the run's folder."""
        cell = dict(self.cell)
        parts = [
            self.policy,
            cell["motion_map"],
            cell["inform_payment"],
            f"{cell['sensing_range_m']:g}m",
            f"{cell['uavs']}x{cell['hotspots']}",
            str(cell["pilot"]),
            *(change.replace("=", "") for change in (*self.changes, *self.training)),
            f"s{cell['seed']}",
        ]
        return "-".join(parts)

    def keys(self) -> list[dict[str, Any]]:
        """The key of each row that the run gives, one for each mode."""
        fixed = {"experiment": self.experiment, "policy": self.policy, **dict(self.cell)}
        fixed["changes"] = " ".join((*self.changes, *self.training))
        return [{**fixed, "mode": mode} for mode in self.modes]


def names() -> list[str]:
    """The names of all lists, in the order of their letters."""
    return sorted(path.stem for path in FOLDER.glob("*.toml"))


def read(name: str) -> list[Run]:
    """The runs of a list, ordered so that each prefix is balanced over the conditions."""
    path = FOLDER / f"{name}.toml"
    if not path.exists():
        raise ExperimentError(f"{name}: no such list; there are {', '.join(names())}")
    try:
        return parse(name, tomllib.loads(path.read_text(encoding="utf-8")))
    except tomllib.TOMLDecodeError as error:
        raise ExperimentError(f"{path}: {error}") from error


def parse(name: str, table: dict[str, Any]) -> list[Run]:
    """The runs of a parsed list."""

    def refuse(key: str, value: Any, allowed: str) -> ExperimentError:
        return ExperimentError(f"{name}: {key} = {value!r} is not allowed, allowed: {allowed}")

    for key in table:
        if key not in KEYS:
            raise refuse("key", key, ", ".join(sorted(KEYS)))
    axes = {axis: list(values) for axis, values in table.get("axes", {}).items()}
    for axis, values in axes.items():
        if not values:
            raise refuse(axis, values, "a list with at least one value")
    policy = table.get("policy", "ppo")
    modes = tuple(table.get("modes", MODES if policy == "ppo" else ["fixed"]))
    if policy == "ppo" and not (modes and set(modes) <= set(MODES)):
        raise refuse("modes", list(modes), ", ".join(MODES))
    episodes = table.get("episodes", 1000)
    if not (isinstance(episodes, int) and episodes >= 1):
        raise refuse("episodes", episodes, "a whole number of at least 1")
    fixed = {**COLUMNS, "pilot": table.get("pilot", "adaptive"), **table.get("fields", {})}
    training = tuple(f"{key}={value}" for key, value in table.get("training", {}).items())
    runs = []
    for cell in in_balanced_order(axes):
        values = {**fixed, **cell}
        changes = tuple(f"{k}={v}" for k, v in values.items() if k not in COLUMNS)
        columns = tuple((k, v) for k, v in values.items() if k in COLUMNS)
        run = Run(name, policy, columns, changes, training, modes, episodes)
        runs.append(run)
    return runs


def in_balanced_order(axes: dict[str, list[Any]]) -> list[dict[str, Any]]:
    """Every combination, seed by seed; within a seed the half with an even sum of indices first.

    With axes of two values that half is a fractional factorial design, which has each value of each
    axis equally often.
    """
    places = itertools.product(*(range(len(values)) for values in axes.values()))
    seed = list(axes).index("seed") if "seed" in axes else None

    def order(place: tuple[int, ...]) -> tuple[Any, ...]:
        rest = [k for axis, k in enumerate(place) if axis != seed]
        return (place[seed] if seed is not None else 0, sum(rest) % 2, place)

    return [
        {axis: axes[axis][k] for axis, k in zip(axes, place, strict=True)}
        for place in sorted(places, key=order)
    ]
