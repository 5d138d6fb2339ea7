"""Evaluates a policy over many episodes and reports in the form of `jcas evaluate`.

Episode k of a campaign has the seed that the command gives it, so both run the same episodes.
Success intervals are Wilson's and equal the command's. Intervals of means are bootstrap percentiles
in both. They use NumPy's resamples here, so their last digits differ.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from .arguments import seed_of, shown, whole
from .batch import Batch, BatchBuffers
from .errors import ArgumentError
from .flown import Policy
from .model import Model, derive_seed

ACTIONS_AT_ONCE = 256
EPISODES_MAX = 10**7
RESAMPLES = 2000
BOOTSTRAP_SEED = 0x6A6361732D636931
WILSON_Z = 1.959963984540054

Act = Callable[[npt.NDArray[np.float32]], npt.NDArray[np.float32]]
"""A function from observations [missions, N, observation length] to actions [missions, N, 2]."""


@dataclass(frozen=True)
class Quantity:
    """A quantity of a report: how to show it, its value and its 95 % interval."""

    name: str
    title: str
    unit: str
    value: float
    low: float
    high: float


@dataclass(frozen=True)
class Report:
    """The results of a campaign."""

    policy: str
    uavs: int
    hotspots: int
    horizon_steps: int
    seed: int
    config_hash: str
    episodes: int
    quantities: tuple[Quantity, ...]

    def __getitem__(self, name: str) -> Quantity:
        return next(quantity for quantity in self.quantities if quantity.name == name)

    def to_dict(self) -> dict[str, Any]:
        """Lay the report out flat, with the command's keys."""
        report: dict[str, Any] = {
            "policy": self.policy,
            "uavs": self.uavs,
            "hotspots": self.hotspots,
            "seed": self.seed,
            "config_hash": self.config_hash,
            "episodes": self.episodes,
        }
        for quantity in self.quantities:
            report[quantity.name] = quantity.value
            report[f"{quantity.name}_low"] = quantity.low
            report[f"{quantity.name}_high"] = quantity.high
        return report

    def __str__(self) -> str:
        lines = [
            f"{self.episodes} missions: {self.uavs} UAVs, {self.hotspots} hotspots, "
            f"policy {self.policy}, "
            f"seed {self.seed}",
            "",
        ]
        for quantity in self.quantities:
            if quantity.name == "false_confirmations_mean" and quantity.high == 0.0:
                continue
            digits = _decimals(quantity.value)
            lines.append(
                f"{quantity.title:20} {quantity.value:>10.{digits}f}  "
                f"[{quantity.low:.{digits}f}, {quantity.high:.{digits}f}] {quantity.unit}".rstrip()
            )
        return "\n".join(
            [
                *lines,
                "",
                "In brackets 95 % intervals. A mission without success counts as "
                f"{self.horizon_steps} steps.",
            ]
        )


def evaluate(
    act: Act | Policy,
    model: Model,
    *,
    episodes: int = 100,
    seed: int = 1,
    policy: str = "policy",
    threads: int = 1,
) -> Report:
    """Run `episodes` episodes with a policy or with a function from observations to actions."""
    episodes, seed = whole("episodes", episodes, 1, EPISODES_MAX), seed_of("seed", seed)
    if not (callable(act) or isinstance(act, Policy)):
        raise ArgumentError(
            f"act = {shown(act)}: must be a jcas.Policy or a function from observations to actions"
        )
    flown = [
        _fly(
            act,
            model,
            [derive_seed(seed, k) for k in range(first, min(first + ACTIONS_AT_ONCE, episodes))],
            threads,
        )
        for first in range(0, episodes, ACTIONS_AT_ONCE)
    ]
    metrics = np.concatenate(flown)
    config = model.config
    horizon = int(config["horizon_steps"])
    success = metrics["terminated"] != 0
    rows = np.stack(
        [
            np.where(success, metrics["steps"], horizon),
            metrics["energy_kwh"],
            metrics["co2_kg"],
            metrics["throughput_mean"],
            metrics["confirmed"],
            metrics["false_confirmations"],
            metrics["pilot_density_mean"],
            metrics["return_sum"],
        ],
        axis=1,
    ).astype(np.float64)
    quantities = [
        Quantity("success_rate", "success rate", "", *wilson(int(success.sum()), episodes))
    ]
    titles = (
        ("mission_steps_mean", "mission time", "steps"),
        ("energy_kwh_mean", "energy spent", "kWh"),
        ("co2_kg_mean", "CO2", "kg"),
        ("throughput_mean", "throughput", ""),
        ("confirmed_mean", "hotspots confirmed", ""),
        ("false_confirmations_mean", "falsely confirmed", ""),
        ("pilot_density_mean", "pilot density", ""),
        ("return_mean", "return", ""),
    )
    values, lows, highs = bootstrap_means(rows)
    for place, (name, title, unit) in enumerate(titles):
        quantities.append(
            Quantity(
                name, title, unit, float(values[place]), float(lows[place]), float(highs[place])
            )
        )
    return Report(
        policy=policy,
        uavs=model.uav_count,
        hotspots=model.hotspot_count,
        horizon_steps=horizon,
        seed=seed,
        config_hash=f"0x{model.config_hash:016x}",
        episodes=episodes,
        quantities=tuple(quantities),
    )


def _fly(act: Act | Policy, model: Model, seeds: list[int], threads: int) -> npt.NDArray[np.void]:
    """Run one episode for each seed in one batch. Steps after a member's end do not count."""
    batch = Batch(model, len(seeds), threads=threads)
    buffers = BatchBuffers(model, len(seeds))
    batch.reset(np.array(seeds, dtype=np.uint64), buffers)
    metrics = np.zeros_like(buffers.final_metrics)
    flying = np.ones(len(seeds), dtype=np.bool_)
    while flying.any():
        actions = act.act_batch(batch) if isinstance(act, Policy) else act(buffers.observations)
        batch.step(actions, buffers, auto_reset=True)
        landed = flying & (buffers.terminated | buffers.truncated)
        metrics[landed] = buffers.final_metrics[landed]
        flying &= ~landed
    return metrics


def wilson(successes: int, trials: int) -> tuple[float, float, float]:
    """Give a proportion and its Wilson score interval."""
    share, z = successes / trials, WILSON_Z
    spread = 1 + z * z / trials
    centre = (share + z * z / (2 * trials)) / spread
    half = z / spread * math.sqrt(share * (1 - share) / trials + z * z / (4 * trials * trials))
    return (
        share,
        0.0 if successes == 0 else centre - half,
        1.0 if successes == trials else centre + half,
    )


def bootstrap_means(
    rows: npt.NDArray[np.float64],
) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.float64], npt.NDArray[np.float64]]:
    """Give the mean of each column and its bootstrap percentile interval."""
    rng = np.random.default_rng(BOOTSTRAP_SEED)
    means = np.stack(
        [rows[rng.integers(0, len(rows), len(rows))].mean(axis=0) for _ in range(RESAMPLES)]
    )
    return rows.mean(axis=0), *np.quantile(means, (0.025, 0.975), axis=0)


def _decimals(value: float) -> int:
    """Decimals that leave about four significant digits."""
    size = abs(value)
    if size >= 100:
        return 1
    if size >= 10:
        return 2
    return 3 if size >= 1 or size == 0 else 4
