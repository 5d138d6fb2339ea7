"""`python -m jcas.rllib train` and `python -m jcas.rllib evaluate`."""

from __future__ import annotations

import argparse
import json
import sys
from dataclasses import replace
from pathlib import Path
from typing import Any

import ray

from ..arguments import whole
from ..config import Config
from ..errors import JcasError
from ..evaluation import evaluate
from ..flown import Policy
from ..model import Model
from ..policy import trained_on
from . import PAPER, ppo_config
from .training import Run

INTERRUPTED = 130
"""Exit status of a run that Ctrl-C stopped."""


def main(arguments: list[str] | None = None) -> int:
    """Run a command; returns the exit status."""
    options = _parser().parse_args(arguments)
    try:
        return int(options.run(options))
    except (JcasError, OSError) as error:
        print(f"error: {error}", file=sys.stderr)
        return 2
    except KeyboardInterrupt:
        return INTERRUPTED


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog="python -m jcas.rllib", description=__doc__)
    commands = parser.add_subparsers(required=True, metavar="COMMAND")

    train = commands.add_parser(
        "train", help="train a shared policy with PPO on this machine or a Ray cluster"
    )
    _mission_options(train)
    train.add_argument(
        "--out", type=Path, required=True, help="folder for the policy, its card and the progress"
    )
    train.add_argument(
        "--steps",
        type=int,
        default=250_000,
        help="environment steps (default: the paper's %(default)s)",
    )
    train.add_argument(
        "--batch",
        type=int,
        default=PAPER.batch_steps,
        help="environment steps an iteration (%(default)s)",
    )
    train.add_argument(
        "--minibatch", type=int, help="samples of a minibatch (default: as many as --batch)"
    )
    train.add_argument(
        "--epochs", type=int, default=PAPER.epochs, help="passes over a batch (%(default)s)"
    )
    train.add_argument(
        "--learning-rate", type=float, default=PAPER.learning_rate, help="(%(default)s)"
    )
    train.add_argument(
        "--hidden", default="512,256,128", help="widths of the hidden layers (%(default)s)"
    )
    train.add_argument(
        "--credit",
        choices=("team", "uav"),
        default="team",
        help="whose reward a UAV learns from (%(default)s)",
    )
    train.add_argument(
        "--critic",
        choices=("state", "agent"),
        default="state",
        help="what the critic sees: the state, or each UAV's own observation as well (%(default)s)",
    )
    train.add_argument(
        "--runners",
        type=int,
        default=2,
        help="env runners, each a process of its own (%(default)s)",
    )
    train.add_argument(
        "--envs-per-runner",
        type=int,
        default=4,
        help="missions side by side in a runner (%(default)s)",
    )
    train.add_argument(
        "--address",
        help="a running Ray cluster, as host:port or `auto`; otherwise this machine alone",
    )
    train.add_argument("--seed", type=int, default=1, help="(%(default)s)")
    train.add_argument(
        "--resume", action="store_true", help="go on from the checkpoint in --out, if there is one"
    )
    train.add_argument(
        "--checkpoint-every", type=int, default=5, metavar="K", help="iterations (%(default)s)"
    )
    train.set_defaults(run=_train)

    fly = commands.add_parser("evaluate", help="fly a policy over many missions and report")
    fly.add_argument("policy", type=Path, help="a folder that train wrote")
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
    parser.add_argument(
        "--set",
        action="append",
        default=[],
        metavar="FIELD=VALUE",
        help="replace a field; repeatable",
    )


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


def _train(options: argparse.Namespace) -> int:
    config = mission_config(options)
    every = whole("--checkpoint-every", options.checkpoint_every, 1, 10**9)
    hyperparameters = replace(
        PAPER,
        batch_steps=options.batch,
        minibatch_samples=min(options.minibatch or options.batch, options.batch),
        epochs=options.epochs,
        learning_rate=options.learning_rate,
        credit=options.credit,
        critic=options.critic,
        hidden=tuple(int(width) for width in options.hidden.split(",")),
    )
    run = Run(options.out, config, hyperparameters, options.seed, options.resume)
    join_cluster(options.address, options.runners)
    try:
        algorithm = ppo_config(
            config,
            hyperparameters,
            env_runners=options.runners,
            envs_per_runner=options.envs_per_runner,
            seed=options.seed,
        ).build_algo()
        try:
            done = run.train(algorithm, options.steps, every)
            run.write_policy(algorithm)
        finally:
            algorithm.stop()
    finally:
        ray.shutdown()
    if not done:
        print(f"stopped after {run.last['env_steps']} steps; go on with --resume", file=sys.stderr)
        return INTERRUPTED
    print(f"wrote {options.out}")
    return 0


def join_cluster(address: str | None, runners: int) -> None:
    """Join a running cluster, or begin one that is this machine alone."""
    if address:
        ray.init(address=address, logging_level="warning")
    else:
        ray.init(
            address="local", num_cpus=runners + 1, include_dashboard=False, logging_level="warning"
        )


def _evaluate(options: argparse.Namespace) -> int:
    before = trained_on(options.policy)
    config = mission_config(options, before)
    _say_changes(options.policy, before, config)
    model = Model(config)
    policy = Policy.load(options.policy, model)
    report = evaluate(
        policy, model, episodes=options.episodes, seed=options.seed, policy=str(options.policy)
    )
    print(json.dumps(report.to_dict(), indent=2) if options.json else report)
    return 0


def _say_changes(policy: Path, base: Config, config: Config) -> None:
    """Say on standard error where a mission differs from what a policy was trained on."""
    before = dict(base)
    changes = [
        f"{name} = {config.get(name, 'derived')} (not {before.get(name, 'derived')})"
        for name in {**before, **config}
        if before.get(name) != config.get(name)
    ]
    if changes:
        print(f"{policy}: its card's configuration, but {', '.join(changes)}", file=sys.stderr)


if __name__ == "__main__":
    sys.exit(main())
