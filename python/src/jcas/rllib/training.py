"""A training run in a folder: progress, checkpoints, resuming, and the trained policy.

The folder holds `progress.csv` with a row for each iteration, and `checkpoint` with RLlib's state
and `run.json`. Once the run has ended it also holds `policy.safetensors` and `policy.json`. A
checkpoint is written atomically.
"""

from __future__ import annotations

import csv
import json
import shutil
import signal
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import asdict
from pathlib import Path
from typing import Any

import ray

from ..config import Config
from ..errors import JcasError
from .algorithm import Hyperparameters
from .env import SHARED_POLICY
from .module import export_policy

COLUMNS = (
    "iteration",
    "env_steps",
    "seconds",
    "team_return",
    "success",
    "mission_steps",
    "entropy",
    "env_runners",
)
PROGRESS, CHECKPOINT, RUN = "progress.csv", "checkpoint", "run.json"


class Run:
    """A run in a folder.

    Args:
        folder: the folder of the run. It is made if it does not exist.
        config: the configuration of the episodes.
        hyperparameters: the settings of PPO. The defaults are mostly the paper's.
        seed: the seed of the run.
        resume: continue from the checkpoint, if there is one. Without it, a folder that has one is
            refused.

    """

    def __init__(
        self,
        folder: Path,
        config: Config,
        hyperparameters: Hyperparameters,
        seed: int,
        resume: bool = False,
    ) -> None:
        self.folder = folder
        self._config = config
        self._hyperparameters = hyperparameters
        self._seed = seed
        self._resumes = False
        self.last: dict[str, Any] = dict.fromkeys(COLUMNS, 0)
        folder.mkdir(parents=True, exist_ok=True)
        found = self._found()
        if found is None:
            return
        if not resume:
            raise JcasError(
                f"{folder} holds a checkpoint: go on with --resume, or choose another folder"
            )
        described = json.loads((found / RUN).read_text(encoding="utf-8"))
        own = self._description()
        for name, value in own.items():
            if described[name] != value:
                changed = _first_difference(described[name], value)
                raise JcasError(f"{folder} is a run with another {name}: {changed}")
        self.last = described["last"]
        self._resumes = True

    def train(self, algorithm: Any, steps: int, checkpoint_every: int) -> bool:
        """Train until `steps` environment steps are sampled; return False if Ctrl-C stopped it.

        Either way, a checkpoint of the last iteration is written.
        """
        began, before = time.monotonic(), float(self.last["seconds"])
        if self._resumes:
            found = self._found()
            algorithm.restore_from_path(str(((found or self.folder) / "state").resolve()))
        with self._progress() as write, _interruptions() as interrupted:
            while self.last["env_steps"] < steps and not interrupted():
                self.last = iteration_row(algorithm.train(), before + time.monotonic() - began)
                write(self.last)
                done = self.last["env_steps"] >= steps
                if done or interrupted() or self.last["iteration"] % checkpoint_every == 0:
                    self._save(algorithm)
        return bool(self.last["env_steps"] >= steps)

    def write_policy(self, algorithm: Any) -> None:
        """Write the policy and its card."""
        about = {
            "trainer": f"jcas.rllib (Ray {ray.__version__})",
            "seed": self._seed,
            "hyperparameters": asdict(self._hyperparameters),
            "last_iteration": self.last,
        }
        policy = export_policy(algorithm.get_module(SHARED_POLICY))
        policy.save(self.folder, self.folder.resolve().name, self._config, about)

    def _description(self) -> dict[str, Any]:
        described = {
            "config": dict(self._config),
            "hyperparameters": asdict(self._hyperparameters),
            "seed": self._seed,
        }
        return dict(json.loads(json.dumps(described)))

    def _found(self) -> Path | None:
        """The newest whole checkpoint: the other name is that of one which was being replaced."""
        for name in (CHECKPOINT, f"{CHECKPOINT}.old"):
            if (self.folder / name / RUN).is_file():
                return self.folder / name
        return None

    def _save(self, algorithm: Any) -> None:
        whole, part, old = (
            self.folder / f"{CHECKPOINT}{suffix}" for suffix in ("", ".part", ".old")
        )
        shutil.rmtree(part, ignore_errors=True)
        algorithm.save_to_path(str((part / "state").resolve()))
        text = json.dumps({**self._description(), "last": self.last}, indent=2) + "\n"
        (part / RUN).write_text(text, encoding="utf-8")
        if whole.exists():
            shutil.rmtree(old, ignore_errors=True)
            whole.rename(old)
        part.rename(whole)
        shutil.rmtree(old, ignore_errors=True)

    @contextmanager
    def _progress(self) -> Iterator[Callable[[dict[str, Any]], None]]:
        """Write rows to a file and the screen. A resumed run drops rows after its checkpoint."""
        path = self.folder / PROGRESS
        rows: list[dict[str, Any]] = []
        if self._resumes and path.is_file():
            with path.open(newline="", encoding="utf-8") as file:
                rows = [
                    row
                    for row in csv.DictReader(file)
                    if int(row["iteration"]) <= self.last["iteration"]
                ]
        with path.open("w", newline="", encoding="utf-8") as file:
            writer = csv.DictWriter(file, COLUMNS)
            writer.writeheader()
            writer.writerows(rows)

            def write(row: dict[str, Any]) -> None:
                writer.writerow(row)
                file.flush()
                print(
                    f"{row['iteration']:4}  {row['env_steps']:>8} steps  {row['seconds']:7.1f} s  "
                    f"return {row['team_return']:8.2f}  success {row['success']:.2f}  "
                    f"mission {row['mission_steps']:5.1f} steps",
                    flush=True,
                )

            yield write


def iteration_row(result: dict[str, Any], seconds: float) -> dict[str, Any]:
    """Pick the row of `progress.csv` out of RLlib's result.

    Runners that are late by more than RLlib waits for, or that died, leave an iteration without
    samples.
    """
    sampled = result.get("env_runners", {})
    learned = result.get("learners", {}).get(SHARED_POLICY, {})
    nan = float("nan")
    return {
        "iteration": result["training_iteration"],
        "env_steps": int(result.get("num_env_steps_sampled_lifetime", 0)),
        "seconds": seconds,
        "team_return": float(sampled.get("team_return", nan)),
        "success": float(sampled.get("success", nan)),
        "mission_steps": float(sampled.get("mission_steps", nan)),
        "entropy": float(learned.get("entropy", nan)),
        "env_runners": int(result["fault_tolerance"]["num_healthy_workers"]),
    }


def _first_difference(before: Any, now: Any) -> str:
    if not isinstance(before, dict):
        return f"{before}, not {now}"
    name = next(name for name in {**before, **now} if before.get(name) != now.get(name))
    return f"{name} = {before.get(name)}, not {now.get(name)}"


@contextmanager
def _interruptions() -> Iterator[Callable[[], bool]]:
    """Let the first Ctrl-C ask for an end after the iteration; the second ends at once."""
    asked = False

    def ask(number: int, frame: Any) -> None:
        nonlocal asked
        if asked:
            raise KeyboardInterrupt
        asked = True
        print(
            "stopping after this iteration; once more to stop at once", file=sys.stderr, flush=True
        )

    before = signal.signal(signal.SIGINT, ask)
    try:
        yield lambda: asked
    finally:
        signal.signal(signal.SIGINT, before)
