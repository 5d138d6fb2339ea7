"""Measures steps of jcas and of other libraries by processor time, for the table of README.md.

    python3 python/benchmarks/peers.py

The program builds the C library and compiles two C programs. It installs the peers, which all run
on the CPU, into an environment under `target/peers` (5 GB with PyTorch). It reports a peer that
cannot be installed and leaves it out. It needs cargo, cc and Python 3.11. Every case runs in its
own process on one thread, in interleaved rounds. The table gives the median agent-steps per second
of processor time, user and system. The cases compute different models, which the last column names.
"""

from __future__ import annotations

import argparse
import json
import os
import resource
import statistics
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

REPOSITORY = Path(__file__).resolve().parents[2]
BUILT = Path(os.environ.get("CARGO_TARGET_DIR", REPOSITORY / "target"))
TARGET = BUILT / "peers"

PACKAGES = ["vmas==1.5.2", "jaxmarl==0.2.0", "envpool==1.2.5"]

CASES = {
    "jcas, C batch": (
        "the whole model: radar, links, consensus, energy, carbon, rewards; 81 entries observed"
    ),
    "target, told again in C": "kinematics and distances; 48 entries observed",
    "EnvPool CartPole-v1": "one pole on a cart; 4 entries observed",
    "JaxMARL MPE simple_spread": (
        "continuous 2-D physics, collisions, no sensing, no links; compiled by XLA"
    ),
    "VMAS discovery": "continuous 2-D physics in PyTorch, lidar, no links, no energy",
}


def rate(step: Callable[[], Any], agent_steps: int, seconds: float) -> float:
    """Measure the agent-steps per processor-second of a `step` that makes `agent_steps`."""

    def spent() -> float:
        usage = resource.getrusage(resource.RUSAGE_SELF)
        return usage.ru_utime + usage.ru_stime

    for _ in range(3):
        step()
    steps, began = 0, spent()
    while (elapsed := spent() - began) < seconds:
        step()
        steps += 1
    return steps * agent_steps / elapsed


def run_envpool(options: argparse.Namespace) -> float:
    import envpool
    import numpy as np

    envs = envpool.make_gymnasium("CartPole-v1", num_envs=options.envs, num_threads=1)
    envs.reset()
    actions = np.random.default_rng(0).integers(0, 2, options.envs)
    return rate(lambda: envs.step(actions), options.envs, options.seconds)


def run_jaxmarl(options: argparse.Namespace) -> float:
    import jax
    import jaxmarl

    env = jaxmarl.make(
        "MPE_simple_spread_v3", num_agents=options.agents, num_landmarks=options.targets
    )
    keys = jax.random.split(jax.random.PRNGKey(0), options.envs)
    _, states = jax.jit(jax.vmap(env.reset))(keys)

    def one(key: Any, state: Any) -> Any:
        choose, go = jax.random.split(key)
        picks = jax.random.split(choose, env.num_agents)
        actions = {
            agent: env.action_space(agent).sample(pick)
            for agent, pick in zip(env.agents, picks, strict=True)
        }
        return env.step(go, state, actions)

    @jax.jit
    def ten(states: Any) -> Any:
        def turn(states: Any, key: Any) -> Any:
            observed, states, rewards, done, _ = jax.vmap(one)(
                jax.random.split(key, options.envs), states
            )
            return states, (observed, rewards, done)

        return jax.lax.scan(turn, states, jax.random.split(jax.random.PRNGKey(1), 10))

    return rate(
        lambda: jax.block_until_ready(ten(states)),
        10 * options.envs * options.agents,
        options.seconds,
    )


def run_vmas(options: argparse.Namespace) -> float:
    import torch
    import vmas

    torch.set_num_threads(1)
    env = vmas.make_env(
        scenario="discovery", num_envs=options.envs, device="cpu", continuous_actions=True, seed=1,
        n_agents=options.agents, n_targets=options.targets,
    )  # fmt: skip
    env.reset()
    actions = [env.get_random_action(agent) for agent in env.agents]
    with torch.no_grad():
        return rate(lambda: env.step(actions), options.envs * options.agents, options.seconds)


PYTHON_CASES = {
    "EnvPool CartPole-v1": run_envpool,
    "JaxMARL MPE simple_spread": run_jaxmarl,
    "VMAS discovery": run_vmas,
}


def prepare() -> dict[str, list[str]]:
    """Build what is missing, and return the command of each case."""
    TARGET.mkdir(parents=True, exist_ok=True)
    run = lambda *command: subprocess.run(command, check=True, cwd=REPOSITORY)  # noqa: E731
    run("cargo", "build", "--release", "--locked", "--package", "jcas-ffi")
    sources = REPOSITORY / "python/benchmarks/peers"
    library = BUILT / "release/libjcas.a"
    run("cc", "-O2", "-I", "include", str(sources / "jcas_batch.c"), str(library), "-lm",
    "-lpthread", "-ldl",
        "-o", str(TARGET / "jcas_batch"))  # fmt: skip
    run("cc", "-O2", str(sources / "target.c"), "-lm", "-o", str(TARGET / "target"))
    python = TARGET / "venv/bin/python"
    if not python.exists():
        run(sys.executable, "-m", "venv", str(TARGET / "venv"))
        run(str(python), "-m", "pip", "install", "--quiet", "--disable-pip-version-check", "uv")
    # PyTorch does not load without its CUDA libraries, but it does without its GPU compiler.
    overrides = TARGET / "overrides.txt"
    overrides.write_text('triton; sys_platform == "never"\n')
    for package in PACKAGES:
        uv = [str(TARGET / "venv/bin/uv"), "pip", "install", "--quiet", "--python", str(python)]
        subprocess.run([*uv, "--override", str(overrides), package], check=False)
    return {
        "jcas, C batch": [str(TARGET / "jcas_batch")],
        "target, told again in C": [str(TARGET / "target")],
        **{case: [str(python), __file__, "--case", case] for case in PYTHON_CASES},
    }


def measure(case: str, command: list[str], options: argparse.Namespace) -> float | str:
    """Run a case in a process on one thread, and return its rate, or the reason for no rate."""
    threads = {"OMP_NUM_THREADS": "1", "MKL_NUM_THREADS": "1", "JAX_PLATFORMS": "cpu"}
    threads["XLA_FLAGS"] = "--xla_cpu_multi_thread_eigen=false intra_op_parallelism_threads=1"
    if case in PYTHON_CASES:
        arguments = [
            "--seconds",
            str(options.seconds),
            "--envs",
            str(options.envs),
            "--agents",
            str(options.agents),
        ]
        arguments += ["--targets", str(options.targets)]
    else:
        arguments = [str(options.seconds), str(options.envs)]
        arguments += [str(options.agents), str(options.targets)] if case == "jcas, C batch" else []
    done = subprocess.run(
        [*command, *arguments], env={**os.environ, **threads}, capture_output=True, text=True
    )
    if done.returncode:
        return (done.stderr.strip() or f"exit {done.returncode}").splitlines()[-1]
    return float(json.loads(done.stdout.splitlines()[-1]))


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--agents", type=int, default=15)
    parser.add_argument("--targets", type=int, default=7)
    parser.add_argument("--envs", type=int, default=256, help="environments of a batch")
    parser.add_argument(
        "--seconds", type=float, default=2, help="of processor time, each measurement"
    )
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--case", choices=PYTHON_CASES, help=argparse.SUPPRESS)
    options = parser.parse_args()
    if options.case:
        print(json.dumps(PYTHON_CASES[options.case](options)))
        return

    commands = prepare()
    rates: dict[str, list[float | str]] = {case: [] for case in CASES}
    for _ in range(options.rounds):
        for case in CASES:
            rates[case].append(measure(case, commands[case], options))
    numbers = {
        case: [rate for rate in own if not isinstance(rate, str)] for case, own in rates.items()
    }
    best = statistics.median(numbers["jcas, C batch"])
    print(
        f"{options.agents} agents, {options.targets} targets, batches of {options.envs}, "
        "random actions, one thread; "
        f"median of {options.rounds} rounds of {options.seconds:g} s of processor time\n"
    )
    print("| | million agent-steps per processor-second | jcas is | what a step computes |")
    print("| --- | ---: | ---: | --- |")
    for case, what in CASES.items():
        if own := numbers[case]:
            middle = statistics.median(own)
            print(f"| {case} | {middle / 1e6:.3f} | {best / middle:.2f} | {what} |")
        else:
            print(f"| {case} | not measured: {rates[case][0]} | | {what} |")


if __name__ == "__main__":
    main()
