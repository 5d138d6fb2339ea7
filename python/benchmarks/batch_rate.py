"""Measures the batch step through Python beside the bare C calls, in one run.

    python python/benchmarks/batch_rate.py

Both make the same calls of the shared library with the same buffers. `kernel` times
`jcas_batch_step` alone in a loop. `vector env` times `make_vec(...).step(...)` with its defaults:
checks, copied arrays and infos. `views` times it with `copy=False` and `SameStep`, with two sets
of buffers and with one. With --command (a `jcas` binary), `jcas bench` runs in the same rounds.
"""

from __future__ import annotations

import argparse
import ctypes
import json
import statistics
import subprocess
import time
from collections.abc import Callable
from typing import Any

import numpy as np

import jcas
from jcas._library import lib


def rate(step: Callable[[int], Any], agent_steps: int, seconds: float) -> float:
    """Agent-steps a second."""
    for index in range(3):
        step(index)
    steps, began = 0, time.perf_counter()
    while (elapsed := time.perf_counter() - began) < seconds:
        step(steps)
        steps += 1
    return steps * agent_steps / elapsed


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--uavs", type=int, default=10)
    parser.add_argument("--hotspots", type=int, default=5)
    parser.add_argument("--envs", type=int, default=64)
    parser.add_argument("--threads", type=int, default=1)
    parser.add_argument("--seconds", type=float, default=2)
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--command", help="a jcas binary, to run its `bench` beside")
    options = parser.parse_args()

    fields = {
        "num_envs": options.envs,
        "threads": options.threads,
        "uav_count": options.uavs,
        "hotspot_count": options.hotspots,
    }
    envs = jcas.make_vec(**fields)
    viewed = {
        f"vector env, views of {sets}": jcas.make_vec(
            **fields, copy=False, buffer_sets=sets, autoreset_mode="SameStep"
        )
        for sets in (2, 1)
    }
    model = envs.model
    actions = (
        np.random.default_rng(0).uniform(-1, 1, (8, *envs.action_space.shape)).astype(np.float32)
    )
    bare = jcas.Batch(model, options.envs, threads=options.threads)
    buffers = jcas.BatchBuffers(model, options.envs)
    bare.reset(np.arange(options.envs, dtype=np.uint64), buffers)
    envs.reset(seed=0)
    for views in viewed.values():
        views.reset(seed=0)
    addresses = [part.ctypes.data for part in actions]
    out, call, handle, count = (
        ctypes.byref(buffers.record),
        lib.jcas_batch_step,
        bare.handle,
        actions[0].size,
    )
    agent_steps = options.envs * options.uavs

    rates: dict[str, list[float]] = {}
    for _ in range(options.rounds):
        kernel = rate(
            lambda step: call(handle, addresses[step % 8], count, 1, out),
            agent_steps,
            options.seconds,
        )
        python = rate(lambda step: envs.step(actions[step % 8]), agent_steps, options.seconds)
        rates.setdefault("kernel", []).append(kernel)
        for name, views in viewed.items():
            viewing = rate(
                lambda step, views=views: views.step(actions[step % 8]),
                agent_steps,
                options.seconds,
            )
            rates.setdefault(name, []).append(viewing)
        rates.setdefault("vector env", []).append(python)
        if options.command:
            rates.setdefault("jcas bench (Rust)", []).append(rust_rate(options))
    print(
        f"{options.envs} fleets of {options.uavs} UAVs, {options.hotspots} hotspots, "
        f"{options.threads} thread(s), "
        f"random actions; medians of {options.rounds} rounds of {options.seconds:g} s\n"
    )
    first = rates["kernel"]
    for name, values in rates.items():
        share = statistics.median(value / base for value, base in zip(values, first, strict=True))
        print(
            f"{name:24}{statistics.median(values):>14,.0f} agent-steps/s{100 * share:>8.1f} "
            "% of kernel"
        )


def rust_rate(options: argparse.Namespace) -> float:
    """Agent-steps a second of the Rust program, which runs on one thread."""
    command = [
        options.command, "bench", "--json", "--environments", str(options.envs), "--uavs",
        str(options.uavs),
        "--hotspots", str(options.hotspots), "--seconds", str(options.seconds),
    ]  # fmt: skip
    report = json.loads(subprocess.run(command, check=True, capture_output=True, text=True).stdout)
    return float(report["agent_steps_per_s"])


if __name__ == "__main__":
    main()
