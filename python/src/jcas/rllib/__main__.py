"""`python -m jcas.rllib train` and `python -m jcas.rllib evaluate`."""

from __future__ import annotations

import argparse
import csv
import json
import sys
import time
from dataclasses import replace
from pathlib import Path
from typing import Any

import ray

from ..config import Config
from ..errors import JcasError
from ..evaluation import evaluate
from ..model import Model
from ..policy import load_policy
from . import PAPER, SHARED_POLICY, Hyperparameters, export_policy, ppo_config

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


def main(arguments: list[str] | None = None) -> int:
    """Run a command; returns the exit status."""
    options = _parser().parse_args(arguments)
    try:
        options.run(options)
    except (JcasError, OSError) as error:
        print(f"error: {error}", file=sys.stderr)
        return 2
    return 0


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog="python -m jcas.rllib", description=__doc__)
    commands = parser.add_subparsers(required=True, metavar="COMMAND")

    train = commands.add_parser("train", help="train a shared policy with PPO on this machine or a Ray cluster")
    _mission_options(train)
    train.add_argument("--out", type=Path, required=True, help="folder for the policy, its card and the progress")
    train.add_argument(
        "--steps", type=int, default=250_000, help="environment steps (default: the paper's %(default)s)"
    )
    train.add_argument(
        "--batch", type=int, default=PAPER.batch_steps, help="environment steps an iteration (%(default)s)"
    )
    train.add_argument("--minibatch", type=int, help="samples of a minibatch (default: as many as --batch)")
    train.add_argument("--epochs", type=int, default=PAPER.epochs, help="passes over a batch (%(default)s)")
    train.add_argument("--learning-rate", type=float, default=PAPER.learning_rate, help="(%(default)s)")
    train.add_argument("--hidden", default="512,256,128", help="widths of the hidden layers (%(default)s)")
    train.add_argument("--runners", type=int, default=2, help="env runners, each a process of its own (%(default)s)")
    train.add_argument("--envs-per-runner", type=int, default=4, help="missions side by side in a runner (%(default)s)")
    train.add_argument("--address", help="a running Ray cluster, as host:port or `auto`; otherwise this machine alone")
    train.add_argument("--seed", type=int, default=1, help="(%(default)s)")
    train.set_defaults(run=_train)

    fly = commands.add_parser("evaluate", help="fly a policy over many missions and report")
    fly.add_argument("policy", type=Path, help="a folder that train wrote, or a policy file")
    _mission_options(fly)
    fly.add_argument("--episodes", type=int, default=100, help="missions (%(default)s)")
    fly.add_argument("--seed", type=int, default=1, help="(%(default)s)")
    fly.add_argument("--json", action="store_true", help="print JSON")
    fly.set_defaults(run=_evaluate)
    return parser


def _mission_options(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--config", help="a preset's name, or a TOML or JSON file")
    parser.add_argument("--uavs", type=int, help="UAVs in the fleet")
    parser.add_argument("--hotspots", type=int, help="hotspots to find")
    parser.add_argument("--set", action="append", default=[], metavar="FIELD=VALUE", help="replace a field; repeatable")


def mission_config(options: argparse.Namespace, base: Config | None = None) -> Config:
    """Read the options of a mission, on top of a base where no `--config` is given."""
    fields: dict[str, Any] = {}
    for assignment in options.set:
        name, equals, text = assignment.partition("=")
        if not equals:
            raise JcasError(f"--set {assignment}: must be of the form field=value")
        fields[name.strip()] = _value(text.strip())
    if options.uavs is not None:
        fields["uav_count"] = options.uavs
    if options.hotspots is not None:
        fields["hotspot_count"] = options.hotspots
    return Config(options.config if options.config is not None else base, **fields)


def _value(text: str) -> Any:
    try:
        return json.loads(text)
    except ValueError:
        return text


def _train(options: argparse.Namespace) -> None:
    config = mission_config(options)
    hyperparameters = replace(
        PAPER,
        batch_steps=options.batch,
        minibatch_samples=min(options.minibatch or options.batch, options.batch),
        epochs=options.epochs,
        learning_rate=options.learning_rate,
        hidden=tuple(int(width) for width in options.hidden.split(",")),
    )
    options.out.mkdir(parents=True, exist_ok=True)
    join_cluster(options.address, options.runners)
    algorithm = ppo_config(
        config,
        hyperparameters,
        env_runners=options.runners,
        envs_per_runner=options.envs_per_runner,
        seed=options.seed,
    ).build_algo()
    try:
        last = _iterate(algorithm, options.steps, options.out / "progress.csv")
        policy = export_policy(algorithm.get_module(SHARED_POLICY))
        policy.save(options.out, options.out.name, config, _about(options.seed, hyperparameters, last))
        print(f"wrote {options.out}")
    finally:
        algorithm.stop()
        ray.shutdown()


def join_cluster(address: str | None, runners: int) -> None:
    """Join a running cluster, or begin one that is this machine alone."""
    if address:
        ray.init(address=address, logging_level="warning")
    else:
        ray.init(address="local", num_cpus=runners + 1, include_dashboard=False, logging_level="warning")


def _iterate(algorithm: Any, steps: int, progress: Path) -> dict[str, Any]:
    """Train until so many environment steps are sampled, and keep one row for each iteration."""
    began, row = time.monotonic(), dict.fromkeys(COLUMNS, 0)
    with progress.open("w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, COLUMNS)
        writer.writeheader()
        while row["env_steps"] < steps:
            row = iteration_row(algorithm.train(), time.monotonic() - began)
            writer.writerow(row)
            file.flush()
            print(
                f"{row['iteration']:4}  {row['env_steps']:>8} steps  {row['seconds']:7.1f} s  "
                f"return {row['team_return']:8.2f}  success {row['success']:.2f}  "
                f"mission {row['mission_steps']:5.1f} steps",
                flush=True,
            )
    return row


def iteration_row(result: dict[str, Any], seconds: float) -> dict[str, Any]:
    """Pick what is worth keeping out of RLlib's result."""
    sampled = result["env_runners"]
    nan = float("nan")
    return {
        "iteration": result["training_iteration"],
        "env_steps": int(result["num_env_steps_sampled_lifetime"]),
        "seconds": seconds,
        "team_return": float(sampled.get("team_return", nan)),
        "success": float(sampled.get("success", nan)),
        "mission_steps": float(sampled.get("mission_steps", nan)),
        "entropy": float(result["learners"][SHARED_POLICY].get("entropy", nan)),
        "env_runners": int(result["fault_tolerance"]["num_healthy_workers"]),
    }


def _about(seed: int, hyperparameters: Hyperparameters, last: dict[str, Any]) -> dict[str, Any]:
    return {
        "trainer": f"jcas.rllib (Ray {ray.__version__})",
        "seed": seed,
        "hyperparameters": {name: getattr(hyperparameters, name) for name in hyperparameters.__dataclass_fields__},
        "last_iteration": last,
    }


def _evaluate(options: argparse.Namespace) -> None:
    policy = load_policy(options.policy)
    model = Model(mission_config(options, policy.config))
    policy = policy.for_model(model)
    report = evaluate(policy.act, model, episodes=options.episodes, seed=options.seed, policy=str(options.policy))
    print(json.dumps(report.to_dict(), indent=2) if options.json else report)


if __name__ == "__main__":
    sys.exit(main())
