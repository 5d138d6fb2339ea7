"""A ladder of named tasks, from easy to hard, with what scripts and plans reach on each.

`jcas.tasks.TASKS["meet"].config()` is a task's configuration, for every environment.
`python -m jcas.tasks meet` measures a task: random, the best script, the planner and its bound.
"""

from __future__ import annotations

import argparse
import sys
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from .config import Config
from .errors import JcasError
from .evaluation import evaluate
from .flown import Policy
from .model import Model, derive_seed
from .plan import Plan
from .sim import Sim

TRAINING_REWARD: dict[str, Any] = {
    "shaping_goal_weight": 66.0,
    "shaping_unconfirmed_weight": 0.25,
    "shaping_discount": 1.0,
    "shaping_charge_weight": 0.0,
    "penalty_energy_per_kwh": 20.0,
    "reward_throughput": 0.1,
}
"""The reward of the trainer's settings `tuned`, as far as it is one of the configuration: it pays
for coming nearer, and charges for energy. Success means the same."""

EASIER_DB = 20.0
"""How much larger the radar cross section of a hotspot is where a curriculum begins."""


@dataclass(frozen=True)
class Task:
    """A configuration with a name."""

    about: str
    fields: dict[str, Any]
    scripts: tuple[str, ...] = ("teams", "squads")
    """Scripted policies that suit the task."""
    reward: dict[str, Any] = field(default_factory=lambda: TRAINING_REWARD)

    def config(self, *, training: bool = False) -> Config:
        """Return the configuration, or with `training` the same mission with a denser reward."""
        return Config(self.fields, **(self.reward if training else {}))

    def curriculum(self, stages: int) -> list[Config]:
        """Return training configurations for one stage after another, the last being the task's.

        Hotspots begin with a large radar cross section, which a radar detects from far.
        """
        last = self.config(training=True)
        end = last["radar_cross_section_dbsm"]
        easier = np.linspace(end + EASIER_DB, end, stages)
        return [last.replace(radar_cross_section_dbsm=float(each)) for each in easier]


TASKS: dict[str, Task] = {
    "meet": Task(
        "three UAVs, one known hotspot that two must detect together, 5 x 5 cells",
        {
            "grid_width": 5, "grid_height": 5, "uav_count": 3, "hotspot_count": 1, "quorum": 2,
            "horizon_steps": 25, "radar_cross_section_dbsm": 12.0,
        },
    ),
    "gather": Task(
        "four UAVs, two known hotspots, 8 x 8 cells",
        {
            "grid_width": 8, "grid_height": 8, "uav_count": 4, "hotspot_count": 2, "quorum": 2,
            "horizon_steps": 50, "radar_cross_section_dbsm": 6.0,
        },
    ),
    "paper": Task("ten UAVs, five known hotspots, a radar that sees 150 m", {"preset": "paper"}),
    "mission": Task("the same, a radar that sees its own cell alone", {"preset": "mission"}),
    "search": Task("ten UAVs, five hidden hotspots", {"preset": "search"}, ("line",), {}),
    "isac": Task("the same with false alarms and reports", {"preset": "isac"}, ("answer",), {}),
}  # fmt: skip
"""The tasks, from easy to hard."""

BOUNDED_MISSIONS = 20


def measure(task: Task, episodes: int) -> dict[str, tuple[float, float]]:
    """Return success rate and mean steps of random, each script and the planner, and its bound."""
    model = Model(task.config())
    rows = {}
    for name in dict.fromkeys(("random", *task.scripts, "replan")):
        report = evaluate(Policy.baseline(name, model), model, episodes=episodes, policy=name)
        rows[name] = report["success_rate"].value, report["mission_steps_mean"].value
    if model.config["target_visibility"] == "hidden":
        bound = Plan.search(model).bound_steps
    else:  # A plan for each mission, because it knows the cells.
        missions = [Sim(model, derive_seed(1, k)) for k in range(BOUNDED_MISSIONS)]
        bounds = [Plan.tour(model, each.hotspot_cells(), iterations=0) for each in missions]
        bound = float(np.mean([plan.bound_steps for plan in bounds]))
    return {**rows, "bound": (1.0, bound)}


def main() -> int:
    """Measure the tasks that the command line names."""
    parser = argparse.ArgumentParser(prog="python -m jcas.tasks", description=__doc__)
    parser.add_argument("tasks", nargs="+", choices=list(TASKS), metavar="TASK")
    parser.add_argument("--episodes", type=int, default=100)
    options = parser.parse_args()
    try:
        for name in options.tasks:
            for policy, (success, steps) in measure(TASKS[name], options.episodes).items():
                print(f"{name:8} {policy:8} {success:6.2f} {steps:7.1f} steps", flush=True)
    except JcasError as error:
        print(f"error: {error}", file=sys.stderr)
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main())
