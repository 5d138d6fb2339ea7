"""Trains with `jcas-lab train`, RLlib and Stable-Baselines3, and prints the times to success.

    python python/benchmarks/time_to_success.py --command target/release/jcas

The defaults are the paper's preset at N = 10, n = 5 and three seeds, with the trainers in turns.
Time is the processor time, user and system, of a trainer's whole tree of processes. It is read from
/proc, so the program needs Linux. Other programs on the machine do not lengthen it. A run ends at
the highest success rate asked for, after the paper's 2.5e5 environment steps, or when its processor
time is used up. The success rate is the mean over the trainer's last hundred episodes with sampled
actions. It is reported from the hundredth on, because successful episodes end first.

`jcas` is `jcas-lab train` with its defaults: the set network of the preset `tuned`, a categorical
motion and a Beta pilot density. The others train an MLP of 512-256-128 with normal actions by PPO.
They have the paper's rate, discount, clip and epochs, on batches of 4096 environment steps.
`jcas-paper` is `jcas-lab train --train-preset paper`. It and RLlib have one actor for all UAVs and
a critic of the global state. Stable-Baselines3 treats every UAV as a separate episode, and its
critic reads one observation.
"""

from __future__ import annotations

import argparse
import csv
import os
import signal
import statistics
import subprocess
import sys
import tempfile
import time
from collections import deque
from collections.abc import Callable
from pathlib import Path
from typing import Any

STEPS = "250000"
"""Environment steps at most, as in the paper."""


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--command", help="the jcas-lab binary")
    parser.add_argument("--preset", default="paper")
    parser.add_argument("--uavs", type=int, default=10)
    parser.add_argument("--hotspots", type=int, default=5)
    parser.add_argument(
        "--set", action="append", default=[], metavar="FIELD=NUMBER", help="more of the mission"
    )
    parser.add_argument(
        "--success", default="0.73,0.9", help="shares of missions to reach (%(default)s)"
    )
    parser.add_argument(
        "--seconds", type=float, default=600, help="of processor time, each run (%(default)s)"
    )
    parser.add_argument("--seeds", default="1,2,3")
    parser.add_argument("--trainers", default="jcas,jcas-paper,rllib,sb3")
    parser.add_argument("--credit", choices=("team", "uav"), default="uav", help="of all but jcas")
    parser.add_argument("--sb3", type=Path, help=argparse.SUPPRESS)
    options = parser.parse_args()
    if options.sb3:
        train_sb3(options)
        return
    if options.command is None and "jcas" in options.trainers:
        parser.error("--command: where the jcas binary is")

    # Told to end, it ends its trainers first.
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(143))
    shares = [float(share) for share in options.success.split(",")]
    trainers = options.trainers.split(",")
    times: dict[str, list[list[float | None]]] = {trainer: [] for trainer in trainers}
    for seed in map(int, options.seeds.split(",")):
        for trainer in trainers:
            reached, last = watch(trainer, seed, shares, options)
            times[trainer].append(reached)
            told = ", ".join(shown(seconds, options.seconds) for seconds in reached)
            print(
                f"{trainer}, seed {seed}: {told}; at last {last[1]} environment steps, "
                f"{last[2]:.2f}",
                file=sys.stderr,
            )
    print(
        f"{options.preset}, N = {options.uavs}, n = {options.hotspots}, "
        f"credit of the {options.credit} but for jcas: "
        "processor seconds to a success of\n"
    )
    print("| | " + " | ".join(f"{share:g}" for share in shares) + " |")
    print("| --- |" + " --- |" * len(shares))
    for trainer, runs in times.items():
        cells = (
            ", ".join(shown(run[place], options.seconds) for run in runs)
            for place in range(len(shares))
        )
        print(f"| {trainer} | " + " | ".join(cells) + " |")
    for trainer, runs in times.items():
        first = [run[0] for run in runs if run[0] is not None]
        if len(first) == len(runs):
            print(f"\n{trainer}: median {statistics.median(first):.0f} s to {shares[0]:g}")


def shown(seconds: float | None, limit: float) -> str:
    return f"not within {limit:.0f}" if seconds is None else f"{seconds:.0f}"


Point = tuple[float, int, float]
"""Processor seconds since the start, environment steps, share of successes."""


def watch(
    trainer: str, seed: int, shares: list[float], options: argparse.Namespace
) -> tuple[list[float | None], Point]:
    """Train until the last share is reached or the time is up."""
    start, progress = TRAINERS[trainer]
    reached: list[float | None] = [None] * len(shares)
    last: Point = (0.0, 0, 0.0)
    with tempfile.TemporaryDirectory() as folder:
        out = Path(folder) / "run"
        threads = {name: "1" for name in ("OMP_NUM_THREADS", "MKL_NUM_THREADS")}
        process = subprocess.Popen(
            start(out, seed, options), env={**os.environ, **threads,
            "RAY_USAGE_STATS_ENABLED": "0"},
            stdout=subprocess.DEVNULL, stderr=(Path(folder) / "errors").open("w"),
            start_new_session=True,
        )  # fmt: skip
        try:
            while None in reached:
                ended = process.poll() is not None
                spent = processor_seconds(process.pid)
                if point := progress(out):
                    last = (spent, *point)
                    for place, share in enumerate(shares):
                        if reached[place] is None and point[1] >= share:
                            reached[place] = spent
                if ended and process.returncode:
                    raise RuntimeError(
                        f"{trainer}: {(Path(folder) / 'errors').read_text()[-2000:]}"
                    )
                if ended or spent > options.seconds:
                    break
                time.sleep(0.5)
        finally:
            stop(process)
    return reached, last


def tree(root: int) -> list[tuple[int, float]]:
    """Return the processor seconds of `root` and its descendants, with their ended children."""
    tick = os.sysconf("SC_CLK_TCK")
    parents: dict[int, list[int]] = {}
    spent: dict[int, float] = {}
    for folder in Path("/proc").iterdir():
        if not folder.name.isdigit():
            continue
        try:
            fields = (folder / "stat").read_text().rpartition(")")[2].split()
        except OSError:
            continue
        parents.setdefault(int(fields[1]), []).append(int(folder.name))
        spent[int(folder.name)] = sum(map(int, fields[11:15])) / tick
    found, left = [], [root]
    while left:
        process = left.pop()
        left += parents.get(process, [])
        if process in spent:
            found.append((process, spent[process]))
    return found


def processor_seconds(root: int) -> float:
    return sum(seconds for _, seconds in tree(root))


def stop(process: subprocess.Popen[bytes]) -> None:
    """End a trainer and all that it started: Ray's workers have sessions of their own."""
    for pid, _ in tree(process.pid):
        try:
            os.kill(pid, signal.SIGKILL)
        except ProcessLookupError:
            pass
    process.wait()


def mission(options: argparse.Namespace) -> list[str]:
    """Options of the mission that both commands read."""
    fields = [word for assignment in options.set for word in ("--set", assignment)]
    return ["--uavs", str(options.uavs), "--hotspots", str(options.hotspots), *fields]


def rows(file: Path) -> list[dict[str, str]]:
    if not file.exists():
        return []
    with file.open() as text:
        return list(csv.DictReader(text))


def jcas_command(out: Path, seed: int, options: argparse.Namespace) -> list[str]:
    """Start RLlib with a checkpoint after each batch, because progress is written with it."""
    return [
        options.command, "train", "--preset", options.preset, *mission(options), "--steps", STEPS,
        "--seed", str(seed),
        "--threads", "1", "--out", str(out), "--train-set", "checkpoint_every=1",
    ]  # fmt: skip


def jcas_paper_command(out: Path, seed: int, options: argparse.Namespace) -> list[str]:
    return [
        *jcas_command(out, seed, options),
        "--train-preset",
        "paper",
        "--train-set",
        f"credit={options.credit}",
    ]


def jcas_progress(out: Path) -> tuple[int, float] | None:
    """Steps and success over the last batches that hold a hundred missions."""
    batches = rows(out / "metrics.csv")
    flown = succeeded = 0.0
    for row in reversed(batches):
        if flown < 100 and row["success_rate"]:
            flown += int(row["missions"])
            succeeded += int(row["missions"]) * float(row["success_rate"])
    return (
        (int(batches[-1]["environment_steps"]), succeeded / flown if flown >= 100 else 0.0)
        if batches
        else None
    )


def rllib_command(out: Path, seed: int, options: argparse.Namespace) -> list[str]:
    return [
        sys.executable, "-m", "jcas.rllib", "train", "--config", options.preset, *mission(options),
        "--steps",
        STEPS, "--seed", str(seed), "--runners", "1", "--credit", options.credit, "--out", str(out),
    ]  # fmt: skip


def rllib_progress(out: Path) -> tuple[int, float] | None:
    """Read RLlib's mean of up to a hundred episodes, which is of a hundred after three batches."""
    batches = rows(out / "progress.csv")
    if not batches:
        return None
    success = batches[-1]["success"] if len(batches) >= 3 else ""
    return int(float(batches[-1]["env_steps"])), float(success) if success else 0.0


def sb3_command(out: Path, seed: int, options: argparse.Namespace) -> list[str]:
    return [
        sys.executable, __file__, "--sb3", str(out), "--seeds", str(seed), "--preset",
        options.preset,
        "--credit", options.credit, *mission(options),
    ]  # fmt: skip


def sb3_progress(out: Path) -> tuple[int, float] | None:
    batches = rows(out / "progress.csv")
    return (int(batches[-1]["steps"]), float(batches[-1]["success"])) if batches else None


Starter = Callable[[Path, int, argparse.Namespace], list[str]]
Progress = Callable[[Path], tuple[int, float] | None]

TRAINERS: dict[str, tuple[Starter, Progress]] = {
    "jcas": (jcas_command, jcas_progress),
    "jcas-paper": (jcas_paper_command, jcas_progress),
    "rllib": (rllib_command, rllib_progress),
    "sb3": (sb3_command, sb3_progress),
}


def train_sb3(options: argparse.Namespace) -> None:
    """PPO of Stable-Baselines3, which writes its progress as it goes."""
    import torch
    from stable_baselines3 import PPO
    from stable_baselines3.common.callbacks import BaseCallback

    import jcas
    from jcas.sb3 import FleetVecEnv

    torch.set_num_threads(1)
    options.sb3.mkdir(parents=True)
    missions, batch = 32, 4096

    class Watch(BaseCallback):
        def __init__(self) -> None:
            super().__init__()
            self.last: deque[bool] = deque(maxlen=100)
            self.progress = (options.sb3 / "progress.csv").open("w", buffering=1)
            self.progress.write("steps,success\n")

        def _on_step(self) -> bool:
            self.last.extend(
                info["is_success"]
                for info in self.locals["infos"][:: options.uavs]
                if "is_success" in info
            )
            return True

        def _on_rollout_end(self) -> None:
            share = sum(self.last) / 100 if len(self.last) == 100 else 0.0
            self.progress.write(f"{self.num_timesteps // options.uavs},{share}\n")

    fields: dict[str, Any] = {
        name: float(value) for name, value in (pair.split("=", 1) for pair in options.set)
    }
    config = jcas.Config(
        options.preset, uav_count=options.uavs, hotspot_count=options.hotspots, **fields
    )
    envs: Any = FleetVecEnv(config, missions, credit=options.credit)
    PPO(
        "MlpPolicy", envs, learning_rate=3e-4, n_steps=batch // missions, batch_size=batch,
        n_epochs=10, gamma=0.95,
        clip_range=0.2, policy_kwargs={"net_arch": [512, 256, 128], "activation_fn": torch.nn.ReLU},
        seed=int(options.seeds),
    ).learn(int(STEPS) * options.uavs, callback=Watch())  # fmt: skip


if __name__ == "__main__":
    main()
