"""Evaluates a policy over many episodes and reports in the form of `jcas evaluate`.

Episode k of a campaign has the seed that the command gives it, so both run the same episodes.
Success intervals are Wilson's and equal the command's. Intervals of means are bootstrap percentiles
in both. They use NumPy's resamples here, so their last digits differ.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import numpy.typing as npt

from .arguments import seed_of, shown, whole
from .batch import Batch, BatchBuffers
from .errors import ArgumentError
from .flown import Policy
from .model import Model, check_model, derive_seed
from .spaces import ActionForm, ActionSpaceKind

ACTIONS_AT_ONCE = 256
EPISODES_MAX = 10**7
RESAMPLES = 2000
BOOTSTRAP_SEED = 0x6A6361732D636931
WILSON_Z = 1.959963984540054

Act = Callable[[npt.NDArray[np.float32]], Any]
"""A function from observations [missions, N, observation length] to actions [missions, N, 2]."""

QUANTITIES = (
    ("success_rate", "success rate", "", "success"),
    ("mission_steps_mean", "mission time", "steps", "mission_steps"),
    ("energy_kwh_mean", "energy spent", "kWh", "energy_kwh"),
    ("co2_kg_mean", "CO2", "kg", "co2_kg"),
    ("throughput_mean", "throughput", "", "throughput_mean"),
    ("confirmed_mean", "hotspots confirmed", "", "confirmed"),
    ("false_confirmations_mean", "falsely confirmed", "", "false_confirmations"),
    ("pilot_density_mean", "pilot density", "", "pilot_density_mean"),
    ("return_mean", "return", "", "return_sum"),
)
"""Name in the command's output, title, unit, and the score of an episode behind it."""


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
    scores: Mapping[str, npt.NDArray[np.float64]] = field(repr=False)
    """The scores of each episode, [episodes]: `success`, `mission_steps`, `return_sum`, ..."""

    def __getitem__(self, name: str) -> Quantity:
        return next(quantity for quantity in self.quantities if quantity.name == name)

    def to_dict(self) -> dict[str, Any]:
        """Lay the report out flat, with the command's keys."""
        names = ("policy", "uavs", "hotspots", "seed", "config_hash", "episodes")
        report: dict[str, Any] = {name: getattr(self, name) for name in names}
        for quantity in self.quantities:
            report[quantity.name] = quantity.value
            report[f"{quantity.name}_low"] = quantity.low
            report[f"{quantity.name}_high"] = quantity.high
        return report

    def __str__(self) -> str:
        lines = [
            f"{self.episodes} episodes: {self.uavs} UAVs, {self.hotspots} hotspots, "
            f"policy {self.policy}, seed {self.seed}",
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
        note = "In brackets 95 % intervals. An episode without success counts as"
        return "\n".join([*lines, "", f"{note} {self.horizon_steps} steps."])


def evaluate(
    act: Act | Policy,
    model: Model,
    *,
    episodes: int = 100,
    seed: int = 1,
    policy: str = "policy",
    threads: int = 1,
    action_space: ActionSpaceKind = "box",
    pilot_levels: int = 3,
) -> Report:
    """Run `episodes` episodes with a policy or with a function from observations to actions.

    Args:
        act: a policy, or a function from observations [missions, N, length] to actions. If it has a
            method `reset`, that is called with the number of missions before their first
            observations. So a recurrent policy begins with fresh memory.
        model: the model of the missions.
        episodes: how many.
        seed: of the campaign; episode k has the k-th seed that is derived from it.
        policy: the name in the report.
        threads: threads that step missions.
        action_space: the form of the function's actions, as of `jcas.make_vec`.
        pilot_levels: pilot densities of `discrete`.

    """
    episodes, seed = whole("episodes", episodes, 1, EPISODES_MAX), seed_of("seed", seed)
    if not (callable(act) or isinstance(act, Policy)):
        raise ArgumentError(
            f"act = {shown(act)}: must be a jcas.Policy or a function from observations to actions"
        )
    form = ActionForm(check_model(model), action_space, pilot_levels)
    seeds = [derive_seed(seed, k) for k in range(episodes)]
    shares = [seeds[k : k + ACTIONS_AT_ONCE] for k in range(0, episodes, ACTIONS_AT_ONCE)]
    metrics = np.concatenate([_run(act, form, model, share, threads) for share in shares])
    horizon, success = int(model.config["horizon_steps"]), metrics["terminated"] != 0
    scores = {
        name: metrics[name].astype(np.float64)
        for *_, name in QUANTITIES
        if name not in ("success", "mission_steps")
    }
    scores["success"] = success.astype(np.float64)
    scores["mission_steps"] = np.where(success, metrics["steps"], horizon).astype(np.float64)
    rows = np.stack([scores[name] for *_, name in QUANTITIES[1:]], axis=1)
    intervals = [wilson(int(success.sum()), episodes), *zip(*bootstrap_means(rows), strict=True)]
    quantities = tuple(
        Quantity(name, title, unit, *map(float, interval))
        for (name, title, unit, _), interval in zip(QUANTITIES, intervals, strict=True)
    )
    return Report(
        policy=policy,
        uavs=model.uav_count,
        hotspots=model.hotspot_count,
        horizon_steps=horizon,
        seed=seed,
        config_hash=f"0x{model.config_hash:016x}",
        episodes=episodes,
        quantities=quantities,
        scores=scores,
    )


def rliable_scores(
    runs: Mapping[str, Sequence[Sequence[Report]]], score: str = "success"
) -> dict[str, npt.NDArray[np.float64]]:
    """Lay reports out as rliable takes them: for each algorithm the mean scores, [runs, tasks].

    Args:
        runs: for each algorithm its runs, and for each run a report for each task.
        score: one of the names of `Report.scores`.

    """
    return {
        algorithm: np.array([[report.scores[score].mean() for report in run] for run in reports])
        for algorithm, reports in runs.items()
    }


def _run(
    act: Act | Policy, form: ActionForm, model: Model, seeds: list[int], threads: int
) -> npt.NDArray[np.void]:
    """Run one episode for each seed in one batch. Steps after a member's end do not count."""
    batch = Batch(model, len(seeds), threads=threads)
    buffers = BatchBuffers(model, len(seeds))
    batch.reset(np.array(seeds, dtype=np.uint64), buffers)
    if hasattr(act, "reset"):
        act.reset(len(seeds))
    running = np.ones(len(seeds), np.bool_)
    metrics = np.zeros_like(buffers.final_metrics)
    shape = (len(seeds), model.uav_count, 2)
    while running.any():
        actions = (
            act.act_batch(batch)
            if isinstance(act, Policy)
            else form.encode_fleet(act(buffers.observations), shape)
        )
        batch.step(actions, buffers)
        ended = running & (buffers.terminated | buffers.truncated)
        metrics[ended] = buffers.final_metrics[ended]
        running &= ~ended
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
