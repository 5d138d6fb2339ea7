"""Trains the same mission with `jcas train`, RLlib and Stable-Baselines3, and prints the time to equal success.

    python python/benchmarks/time_to_success.py --command target/release/jcas

Same environment, same networks, same PPO settings (the paper's), one run each after the other on this machine.
Success is what each trainer sees in its own missions, sampled actions, as a mean over the last hundred, from the
hundredth on: the first to end are those that went well.

The mission is one that PPO learns from nothing: a small grid, one detection is enough, a radar that sees a
hotspot below it in every other step, no reward for throughput. `--set` makes another of it.
"""

from __future__ import annotations

import argparse
import csv
import json
import subprocess
import sys
import tempfile
import time
from collections import deque
from pathlib import Path
from typing import Any

import jcas

EASY = {"grid_width": 8, "grid_height": 8, "quorum": 1, "detection_threshold_db": 7.0, "reward_throughput": 0.0}


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--command", required=True, help="the jcas binary")
    parser.add_argument("--uavs", type=int, default=5)
    parser.add_argument("--hotspots", type=int, default=3)
    parser.add_argument("--set", action="append", default=[], metavar="FIELD=NUMBER", help="more of the mission")
    parser.add_argument("--steps", type=int, default=163_840, help="environment steps at most")
    parser.add_argument("--success", type=float, default=0.75, help="share of missions to reach")
    parser.add_argument("--runners", type=int, default=2, help="RLlib's processes")
    parser.add_argument("--trainers", default="jcas,rllib,sb3")
    options = parser.parse_args()
    given = dict(assignment.split("=", 1) for assignment in options.set)
    options.set = EASY | {field: json.loads(value) for field, value in given.items()}
    print(
        f"{options.uavs} UAVs, {options.hotspots} hotspots, to a success of {options.success:g}, "
        f"at most {options.steps} environment steps\n"
    )
    print(f"{'trainer':22}{'to success':>12}{'in all':>10}{'env steps/s':>13}{'last success':>14}")
    for name in options.trainers.split(","):
        curve = {"jcas": train_jcas, "rllib": train_rllib, "sb3": train_sb3}[name](options)
        reached = next((seconds for seconds, _, success in curve if success >= options.success), None)
        seconds, steps, success = curve[-1]
        shown = "not reached" if reached is None else f"{reached:.0f} s"
        print(f"{name:22}{shown:>12}{seconds:>8.0f} s{steps / seconds:>13,.0f}{success:>14.2f}", flush=True)


def assignments(options: argparse.Namespace) -> list[str]:
    """The mission's fields as both commands read them."""
    return [word for field, value in options.set.items() for word in ("--set", f"{field}={value}")]


Curve = list[tuple[float, int, float]]
"""Seconds since the start, environment steps, share of successes."""


def train_jcas(options: argparse.Namespace) -> Curve:
    with tempfile.TemporaryDirectory() as folder:
        began = time.monotonic()
        subprocess.run(
            [options.command, "train", "--training", "paper", "--uavs", str(options.uavs), "--hotspots",
             str(options.hotspots), "--steps", str(options.steps),
             "--out", folder, "--train-set", "evaluation_episodes=1", *assignments(options)],
            check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
        )  # fmt: skip
        total = time.monotonic() - began
        with (Path(folder) / "metrics.csv").open() as file:
            rows = list(csv.DictReader(file))
    seconds = total - sum(float(row["wall_s"]) for row in rows)
    curve: Curve = []
    recent: deque[tuple[int, float]] = deque()
    for row in rows:
        seconds += float(row["wall_s"])
        if row["success_rate"]:
            recent.append((int(row["missions"]), float(row["success_rate"])))
            while len(recent) > 1 and sum(missions for missions, _ in list(recent)[1:]) >= 100:
                recent.popleft()
        flown = sum(missions for missions, _ in recent)
        share = sum(missions * success for missions, success in recent) / flown if flown >= 100 else 0.0
        curve.append((seconds, int(row["environment_steps"]), share))
    return curve


def train_rllib(options: argparse.Namespace) -> Curve:
    with tempfile.TemporaryDirectory() as folder:
        began = time.monotonic()
        subprocess.run(
            [sys.executable, "-m", "jcas.rllib", "train", "--uavs", str(options.uavs), "--hotspots",
             str(options.hotspots), "--steps", str(options.steps), "--runners", str(options.runners), "--out", folder,
             *assignments(options)],
            check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
        )  # fmt: skip
        total = time.monotonic() - began
        with (Path(folder) / "progress.csv").open() as file:
            rows = list(csv.DictReader(file))
    before = total - float(rows[-1]["seconds"])
    return [(float(row["seconds"]) + before, int(row["env_steps"]), float(row["success"])) for row in rows]


def train_sb3(options: argparse.Namespace) -> Curve:
    import torch
    from stable_baselines3 import PPO
    from stable_baselines3.common.callbacks import BaseCallback

    from jcas.sb3 import FleetVecEnv

    missions, curve = 32, []

    class Watch(BaseCallback):
        def __init__(self) -> None:
            super().__init__()
            self.last: deque[bool] = deque(maxlen=100)

        def _on_step(self) -> bool:
            self.last.extend(
                info["is_success"] for info in self.locals["infos"][:: options.uavs] if "is_success" in info
            )
            return True

        def _on_rollout_end(self) -> None:
            share = sum(self.last) / 100 if len(self.last) == 100 else 0.0
            curve.append((time.monotonic() - began, self.num_timesteps // options.uavs, share))

    began = time.monotonic()
    config = jcas.Config(uav_count=options.uavs, hotspot_count=options.hotspots, **options.set)
    envs: Any = FleetVecEnv(config, missions)
    PPO(
        "MlpPolicy", envs, learning_rate=3e-4, n_steps=4096 // missions, batch_size=4096, n_epochs=10, gamma=0.95,
        policy_kwargs={"net_arch": [512, 256, 128], "activation_fn": torch.nn.ReLU}, seed=1,
    ).learn(options.steps * options.uavs, callback=Watch())  # fmt: skip
    curve.append((time.monotonic() - began, options.steps, curve[-1][2] if curve else 0.0))
    return curve


if __name__ == "__main__":
    main()
