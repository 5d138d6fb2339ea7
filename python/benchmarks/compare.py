"""Steps many multi-agent environments side by side and prints their rates and ratios.

    pip install "./python[benchmark]"
    python python/benchmarks/compare.py --agents 10 --targets 5

Every case runs in its own process, with one thread or one for each core. Rounds are interleaved,
and the table gives the median. A case whose package is missing says so. PufferLib needs an
environment of its own (`pip install pufferlib==1.0.1 filelock psutil`), whose interpreter
--pufferlib-python names.
"""

from __future__ import annotations

import argparse
import json
import os
import statistics
import subprocess
import sys
import time
from collections.abc import Callable
from typing import Any

CASES: dict[str, tuple[str, str]] = {
    "jcas batch": (
        "run_jcas_batch",
        "the whole model: radar, links, consensus, energy, carbon, observations",
    ),
    "jcas PettingZoo": ("run_jcas_pettingzoo", "the same, one mission, dicts of agents"),
    "VMAS discovery": (
        "run_vmas",
        "continuous 2-D physics in PyTorch, lidar observations, no links, no energy",
    ),
    "MPE simple_spread": (
        "run_mpe",
        "continuous 2-D physics in NumPy, no sensing, no links, dicts of agents",
    ),
    "MPE under PufferLib": (
        "run_pufferlib",
        "the same MPE with discrete actions, under PufferLib's wrapper, "
        "whose rate is the Python's beneath",
    ),
}


def rate(step: Callable[[], Any], agent_steps: int, seconds: float) -> float:
    """Measure the agent-steps per second of a `step` that makes `agent_steps`."""
    for _ in range(3):
        step()
    steps, began = 0, time.perf_counter()
    while (elapsed := time.perf_counter() - began) < seconds:
        step()
        steps += 1
    return steps * agent_steps / elapsed


def run_jcas_batch(options: argparse.Namespace) -> float:
    import numpy as np

    import jcas

    envs = jcas.make_vec(
        num_envs=options.envs,
        threads=options.cores,
        uav_count=options.agents,
        hotspot_count=options.targets,
        autoreset_mode="SameStep",
        copy=False,
    )
    envs.reset(seed=1)
    actions = (
        np.random.default_rng(0).uniform(-1, 1, (8, *envs.action_space.shape)).astype(np.float32)
    )
    turn = iter(range(10**9))
    return rate(
        lambda: envs.step(actions[next(turn) % 8]), options.envs * options.agents, options.seconds
    )


def run_jcas_pettingzoo(options: argparse.Namespace) -> float:
    import jcas

    return rate_of_parallel_env(
        jcas.parallel_env(uav_count=options.agents, hotspot_count=options.targets), options
    )


def rate_of_parallel_env(env: Any, options: argparse.Namespace) -> float:
    env.reset(seed=1)
    actions = {agent: env.action_space(agent).sample() for agent in env.possible_agents}

    def step() -> None:
        env.step(actions)
        if not env.agents:
            env.reset()

    return rate(step, options.agents, options.seconds)


def run_vmas(options: argparse.Namespace) -> float:
    import torch
    import vmas

    torch.set_num_threads(options.cores)
    env = vmas.make_env(
        scenario="discovery",
        num_envs=options.envs,
        device="cpu",
        continuous_actions=True,
        seed=1,
        n_agents=options.agents,
        n_targets=options.targets,
    )
    env.reset()
    actions = [env.get_random_action(agent) for agent in env.agents]
    with torch.no_grad():
        return rate(lambda: env.step(actions), options.envs * options.agents, options.seconds)


def run_mpe(options: argparse.Namespace) -> float:
    from mpe2 import simple_spread_v3

    return rate_of_parallel_env(
        simple_spread_v3.parallel_env(N=options.agents, continuous_actions=True, max_cycles=100),
        options,
    )


def run_pufferlib(options: argparse.Namespace) -> float:
    import pufferlib.emulation
    import pufferlib.vector
    from pettingzoo.mpe import simple_spread_v3

    def make() -> Any:
        env = simple_spread_v3.parallel_env(
            N=options.agents, continuous_actions=False, max_cycles=100
        )
        return pufferlib.emulation.PettingZooPufferEnv(env=env)

    envs = pufferlib.vector.make(make, num_envs=4, backend=pufferlib.vector.Serial)
    envs.reset(seed=1)
    actions = envs.action_space.sample()
    return rate(lambda: envs.step(actions), 4 * options.agents, options.seconds)


PROCESSES_FOR_ALL_CORES = ("jcas PettingZoo", "MPE simple_spread", "MPE under PufferLib")
"""Cases that know one core only: on all cores, one process runs on each and the rates add up."""


def measure(case: str, cores: int, options: argparse.Namespace) -> float | str:
    """Run a case in one or more processes, and return its rate, or the reason why there is none."""
    python = options.pufferlib_python if case == "MPE under PufferLib" else sys.executable
    if python is None:
        return "no --pufferlib-python"
    copies = cores if case in PROCESSES_FOR_ALL_CORES else 1
    threads = str(cores if copies == 1 else 1)
    environment = {
        **os.environ,
        "OMP_NUM_THREADS": threads,
        "MKL_NUM_THREADS": threads,
        "OPENBLAS_NUM_THREADS": threads,
    }
    command = [
        python, __file__, "--case", case, "--cores", threads, "--agents", str(options.agents),
        "--targets", str(options.targets), "--envs", str(options.envs), "--seconds",
        str(options.seconds),
    ]  # fmt: skip
    running = [
        subprocess.Popen(
            command, env=environment, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
        )
        for _ in range(copies)
    ]
    total = 0.0
    for process in running:
        output, complaint = process.communicate()
        if process.returncode:
            return (
                complaint.strip().splitlines()[-1]
                if complaint.strip()
                else f"exit {process.returncode}"
            )
        total += float(json.loads(output.splitlines()[-1]))
    return total


def run_case(options: argparse.Namespace) -> None:
    """Measure one case in this process."""
    print(json.dumps(globals()[CASES[options.case][0]](options)))


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--agents", type=int, default=10)
    parser.add_argument("--targets", type=int, default=5)
    parser.add_argument("--envs", type=int, default=1024, help="environments of a batch")
    parser.add_argument("--seconds", type=float, default=3, help="of each measurement")
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--pufferlib-python", help="interpreter that has PufferLib")
    parser.add_argument("--json", action="store_true")
    parser.add_argument("--case", choices=CASES, help=argparse.SUPPRESS)
    parser.add_argument("--cores", type=int, default=1, help=argparse.SUPPRESS)
    options = parser.parse_args()
    if options.case:
        run_case(options)
        return

    cores = (
        len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
    )
    rates: dict[tuple[str, int], list[float | str]] = {}
    for _ in range(options.rounds):
        for count in sorted({1, cores}):
            for case in CASES:
                rates.setdefault((case, count), []).append(measure(case, count, options))
    rows = [
        {"case": case, "cores": count, "agent_steps_per_s": middle(values), "what": CASES[case][1]}
        for (case, count), values in rates.items()
    ]
    if options.json:
        print(
            json.dumps(
                {
                    "agents": options.agents,
                    "targets": options.targets,
                    "envs": options.envs,
                    "rows": rows,
                }
            )
        )
        return
    print(
        f"{options.agents} agents, {options.targets} targets, batches of {options.envs}, "
        "random actions; "
        f"median of {options.rounds} rounds of {options.seconds:g} s\n"
    )
    print(
        f"{'environment':26}{'cores':>6}{'agent-steps/s':>16}{'jcas batch is':>15}  what a "
        "step computes"
    )
    for row in rows:
        own = row["agent_steps_per_s"]
        best = next(
            other["agent_steps_per_s"]
            for other in rows
            if other["case"] == "jcas batch" and other["cores"] == row["cores"]
        )
        if isinstance(own, str) or isinstance(best, str):
            print(
                f"{row['case']:26}{row['cores']:>6}  not measured: "
                f"{own if isinstance(own, str) else best}"
            )
        else:
            print(
                f"{row['case']:26}{row['cores']:>6}{own:>16,.0f}{best / own:>13.1f} "
                f"x  {row['what']}"
            )


def middle(values: list[float | str]) -> float | str:
    numbers = [value for value in values if not isinstance(value, str)]
    return statistics.median(numbers) if numbers else values[0]


if __name__ == "__main__":
    main()
