"""Runs a list of experiments: trains, evaluates, and appends rows to the tables.

A run whose rows are in the table is not repeated, and an unfinished training resumes.
"""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import time
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pandas as pd

from . import tables
from .experiments import Run

QUANTITIES = {
    "success": "success_rate",
    "steps": "mission_steps_mean",
    "energy_kwh": "energy_kwh_mean",
    "throughput": "throughput_mean",
    "return": "return_mean",
}
SEED_OF_EPISODES = 1


@dataclass(frozen=True)
class Tools:
    """The commands, the folder of the trainings, and the commit that the commands come from."""

    jcas: str
    lab: str
    folder: Path
    sources: str
    threads: int


def missing(runs: list[Run], present: pd.DataFrame) -> list[Run]:
    """The runs of which a row is not in the table."""
    done = {tables.key_of(row) for row in present.to_dict("records")}
    return [run for run in runs if any(tables.key_of(key) not in done for key in run.keys())]


def run_list(runs: list[Run], tools: Tools) -> None:
    """Does what the tables lack, one run after the other."""
    for run in missing(runs, tables.read(tables.RUNS)):
        print(run.name, flush=True)
        seconds = train(run, tools) if run.learns else None
        rows = []
        for key in run.keys():
            row = {"sources": tools.sources, **key, "episodes": run.episodes}
            rows.append({**row, **evaluate(run, key["mode"], tools), "train_seconds": seconds})
        tables.append(tables.RUNS, rows)
        if run.learns:
            keep(run, tools)


def configuration(run: Run) -> list[str]:
    """The options that select the run's configuration."""
    options = ["--preset", "paper", "--uavs", str(run["uavs"]), "--hotspots", str(run["hotspots"])]
    fields = ("motion_map", "inform_payment", "sensing_range_m")
    for change in [f"{field}={run[field]}" for field in fields] + list(run.changes):
        options += ["--set", change]
    return options


def training(run: Run, tools: Tools) -> list[str]:
    """The command that trains the run's policy."""
    command = [tools.lab, "train", "--train-preset", "paper", *configuration(run)]
    command += ["--seed", str(run["seed"]), "--threads", str(tools.threads), "--half"]
    if run["pilot"] != "adaptive":
        command += ["--train-set", f"constant_pilot={run['pilot']}"]
    for setting in run.training:
        command += ["--train-set", setting]
    return [*command, "--out", str(tools.folder / run.name), "--resume"]


def train(run: Run, tools: Tools) -> float:
    """Trains, or goes on with a training, and returns the seconds of the iterations."""
    call(training(run, tools))
    metrics = tools.folder / run.name / "metrics.csv"
    return round(float(pd.read_csv(metrics)["wall_s"].sum()), 1)


def evaluation(run: Run, mode: str, tools: Tools) -> list[str]:
    """The command that evaluates the run's policy in a mode."""
    if run.learns:
        policy = [str(tools.folder / run.name), "--mode", mode]
    else:
        policy = [run.policy, "--pilot", str(run["pilot"])]
    command = [tools.jcas, "evaluate", *policy, *configuration(run)]
    command += ["--episodes", str(run.episodes), "--seed", str(SEED_OF_EPISODES)]
    return [*command, "--threads", str(tools.threads), "--json"]


def evaluate(run: Run, mode: str, tools: Tools) -> dict[str, float]:
    """The means over the episodes of one mode."""
    report = json.loads(call(evaluation(run, mode, tools)))
    return {name: report[field] for name, field in QUANTITIES.items()}


def keep(run: Run, tools: Tools) -> None:
    """Keeps the weights and the course of a training beside the tables."""
    folder = tools.folder / run.name
    tables.WEIGHTS.mkdir(parents=True, exist_ok=True)
    target = tables.WEIGHTS / f"{run.name}.safetensors"
    shutil.copy(folder / "policy.safetensors", target.with_suffix(".part"))
    os.replace(target.with_suffix(".part"), target)
    metrics = pd.read_csv(folder / "metrics.csv")
    first = run.keys()[0]
    course = metrics[["iteration", "return_mean", "success_rate", "wall_s"]]
    tables.append(
        tables.TRAININGS,
        [
            {**{name: first[name] for name in tables.COURSE_KEY}, **line}
            for line in course.to_dict("records")
        ],
    )


def call(command: list[str]) -> str:
    """Runs a command and returns its output; an error names the command."""
    begun = time.monotonic()
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    if done.returncode != 0:
        text = " ".join(map(str, command))
        raise RunError(f"{text}\nended with status {done.returncode}:\n{done.stderr.strip()}")
    if (passed := time.monotonic() - begun) > 60:
        print(f"  {passed:.0f} s", flush=True)
    return done.stdout


class RunError(Exception):
    """Says which command ended with an error, and what it printed."""


def describe(run: Run, tools: Tools) -> list[str]:
    """The commands of a run, as a person would type them."""
    commands: list[list[Any]] = [training(run, tools)] if run.learns else []
    modes = [key["mode"] for key in run.keys()]
    return [" ".join(map(str, c)) for c in commands + [evaluation(run, m, tools) for m in modes]]
