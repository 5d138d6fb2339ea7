"""The tables of results, and their means with intervals."""

from __future__ import annotations

import math
import os
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pandas as pd
from scipy import stats

RESULTS = Path(__file__).parent.parent / "results"
RUNS = RESULTS / "runs.csv"
TRAININGS = RESULTS / "trainings.csv"
WEIGHTS = RESULTS / "weights"

KEY = ["experiment", "policy", "motion_map", "inform_payment", "sensing_range_m"]
KEY += ["uavs", "hotspots", "pilot", "seed", "changes", "mode"]
RUN_COLUMNS = ["sources", *KEY, "episodes", "success", "steps", "energy_kwh", "throughput"]
RUN_COLUMNS += ["return", "train_seconds"]
COURSE_KEY = [name for name in KEY if name not in ("changes", "mode")]
COURSE_COLUMNS = [*COURSE_KEY, "iteration", "return_mean", "success_rate", "wall_s"]
CELL = ["motion_map", "inform_payment", "sensing_range_m", "uavs", "hotspots", "pilot"]


def columns_of(path: Path) -> list[str]:
    """The columns of a table."""
    return RUN_COLUMNS if path.name == RUNS.name else COURSE_COLUMNS


def read(path: Path) -> pd.DataFrame:
    """A table, empty where there is no file."""
    if not path.exists():
        return pd.DataFrame(columns=columns_of(path))
    table = pd.read_csv(path, dtype={"pilot": str, "changes": str, "sources": str})
    if list(table.columns) != columns_of(path):
        raise ValueError(f"{path}: columns {list(table.columns)}, expected {columns_of(path)}")
    return table.fillna({"changes": ""}) if "changes" in table else table


def key_of(row: dict[str, Any]) -> tuple[str, ...]:
    """The key of a row, equal for equal numbers however they are written."""

    def text(value: Any) -> str:
        return f"{value:g}" if isinstance(value, int | float) else str(value)

    return tuple(text(row[name]) for name in KEY)


def append(path: Path, rows: Iterable[dict[str, Any]]) -> None:
    """Adds rows to a table, which is written to a temporary name and renamed."""
    added = pd.DataFrame(list(rows), columns=columns_of(path))
    table = added if (present := read(path)).empty else pd.concat([present, added])
    path.parent.mkdir(parents=True, exist_ok=True)
    part = path.with_suffix(".part")
    table.to_csv(part, index=False, lineterminator="\n")
    os.replace(part, path)


def wilson(share: float, episodes: int) -> tuple[float, float]:
    """The 95 % Wilson interval of a success rate."""
    interval = stats.binomtest(round(share * episodes), episodes).proportion_ci(method="wilson")
    return float(interval.low), float(interval.high)


@dataclass(frozen=True)
class Spread:
    """The standard deviation between trainings, pooled over cells, on the scale of a quantity."""

    deviation: float
    freedom: int

    def half_width(self, trainings: int) -> float:
        """Half the 95 % interval of the mean of some trainings of one cell."""
        t = float(stats.t.ppf(0.975, self.freedom))
        return t * self.deviation / math.sqrt(trainings)


def over_seeds(values: pd.Series) -> tuple[float, float, float]:
    """The mean over trainings and its 95 % t interval."""
    mean, count = float(values.mean()), len(values)
    half = float(stats.t.ppf(0.975, count - 1)) * float(values.std(ddof=1)) / math.sqrt(count)
    return mean, mean - half, mean + half


def to_scale(quantity: str, values: pd.Series, episodes: int) -> pd.Series:
    """The values on the scale on which trainings scatter alike: logit of success, log of others."""
    if quantity != "success":
        return values.map(math.log)
    shares = (values * episodes + 0.5) / (episodes + 1.0)
    return (shares / (1.0 - shares)).map(math.log)


def pooled_spread(runs: pd.DataFrame, quantity: str) -> Spread:
    """The spread over all cells with several trainings by PPO."""
    squares, freedom = 0.0, 0
    trained = select(runs, policy="ppo")
    for _, cell in trained.groupby(["experiment", *CELL, "changes", "mode"]):
        if len(cell) > 1:
            scaled = to_scale(quantity, cell[quantity], int(cell["episodes"].iloc[0]))
            squares += float(((scaled - scaled.mean()) ** 2).sum())
            freedom += len(cell) - 1
    return Spread(math.sqrt(squares / freedom), freedom)


def cell_interval(cell: pd.DataFrame, quantity: str, spread: Spread) -> tuple[float, float, float]:
    """The mean over the trainings of one cell, and its 95 % interval."""
    mean, half = float(cell[quantity].mean()), spread.half_width(len(cell))
    if quantity != "success":
        return mean, mean * math.exp(-half), mean * math.exp(half)
    centre = math.log(max(mean, 5e-4) / max(1.0 - mean, 5e-4))
    return mean, min(mean, expit(centre - half)), max(mean, expit(centre + half))


def mean_interval(
    rows: pd.DataFrame, quantity: str, spread: Spread, over: str = "hotspots"
) -> tuple[float, float, float]:
    """The mean over cells with equal weights, and its 95 % interval."""
    cells = [cell for _, cell in rows.groupby(over)]
    mean = sum(float(cell[quantity].mean()) for cell in cells) / len(cells)
    squares = 0.0
    for cell in cells:
        value = float(cell[quantity].mean())
        slope = value * (1.0 - value) if quantity == "success" else value
        squares += (slope * spread.half_width(len(cell))) ** 2
    half = math.sqrt(squares) / len(cells)
    return mean, mean - half, mean + half


def expit(value: float) -> float:
    """The inverse of the logit."""
    return 1.0 / (1.0 + math.exp(-value))


def select(table: pd.DataFrame, **wanted: Any) -> pd.DataFrame:
    """The rows whose columns have the wanted values."""
    for name, value in wanted.items():
        table = table[table[name] == value]
    return table
