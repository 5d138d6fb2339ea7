"""Measures a network in jcas-policy, in onnxruntime and in the trainer's own forward pass.

    cargo build --release --manifest-path lab/Cargo.toml -p jcas-train --example inference
    cargo lab export POLICY --uavs 15 --hotspots 7 -o POLICY/policy.onnx
    python python/benchmarks/inference.py --command lab/target/release/examples/inference POLICY...

POLICY names folders of trained policies, each with an ONNX graph for the given N and n. A batch is
a number of missions whose observations, N rows each, are passed in one call. All three compute the
same rows, and the program checks that they agree. Each runs on one thread of one core, in turns.
The results are the processor time of the fastest tenth of the turns and the median.
"""

from __future__ import annotations

import argparse
import os
import statistics
import subprocess
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
import onnxruntime

Run = Callable[[int], np.ndarray]
"""A function that makes a number of calls, and returns the outputs of a single call."""


class Library:
    """A worker process that runs the network in jcas-policy or in the trainer."""

    def __init__(self, command: Path, policy: Path, uavs: int, hotspots: int, seen: Path) -> None:
        self.process = subprocess.Popen(
            [command, policy, str(uavs), str(hotspots), seen],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
            env=os.environ | {"RAYON_NUM_THREADS": "1"},
        )
        self.clock = (~self.process.pid << 3) | 2  # clock_getcpuclockid(3)
        self.run("ours", 1)(1)  # the observations are written before it answers

    def run(self, who: str, rows: int) -> Run:
        """Return the calls of "ours" or of the "trainer" for a number of rows."""

        def run(calls: int) -> np.ndarray:
            assert self.process.stdin is not None and self.process.stdout is not None
            self.process.stdin.write(f"{who} {rows} {calls}\n")
            self.process.stdin.flush()
            numbers = np.array(self.process.stdout.readline().split(), np.float32)
            return numbers.reshape(rows, -1) if calls == 1 else numbers

        return run


def session(policy: Path) -> onnxruntime.InferenceSession:
    options = onnxruntime.SessionOptions()
    options.intra_op_num_threads = options.inter_op_num_threads = 1
    return onnxruntime.InferenceSession(
        policy / "policy.onnx", options, providers=["CPUExecutionProvider"]
    )


def onnx(of: onnxruntime.InferenceSession, rows: np.ndarray) -> Run:
    """Bind the arrays in advance, which leaves out Python's overhead in a call."""
    binding = of.io_binding()
    binding.bind_cpu_input(of.get_inputs()[0].name, rows)
    binding.bind_output(of.get_outputs()[0].name)

    def run(calls: int) -> np.ndarray:
        for _ in range(calls):
            of.run_with_iobinding(binding)
        return binding.copy_outputs_to_cpu()[0]

    return run


def timed(run: Run, clock: int, calls: int) -> float:
    began = time.clock_gettime(clock)
    run(calls)
    return (time.clock_gettime(clock) - began) / calls


def measure(ways: dict[str, tuple[Run, int]], turns: int, turn_s: float) -> dict[str, list[float]]:
    calls = {}
    for name, (run, clock) in ways.items():
        run(3)
        calls[name] = max(2, round(turn_s / max(timed(run, clock, 3), 1e-7)))
    times: dict[str, list[float]] = {name: [] for name in ways}
    for _ in range(turns):
        for name, (run, clock) in ways.items():
            times[name].append(timed(run, clock, calls[name]))
    return times


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("policies", metavar="POLICY", nargs="+", type=Path)
    parser.add_argument(
        "--command", type=Path, required=True, help="the example `inference` of jcas-train"
    )
    parser.add_argument("--uavs", type=int, default=15)
    parser.add_argument("--hotspots", type=int, default=7)
    parser.add_argument("--turns", type=int, default=60)
    parser.add_argument("--turn-ms", type=float, default=20)
    options = parser.parse_args()
    os.sched_setaffinity(0, {min(os.sched_getaffinity(0))})
    print(
        f"onnxruntime {onnxruntime.__version__}, N = {options.uavs}, n = {options.hotspots}, "
        "us a call"
    )
    for policy in options.policies:
        with tempfile.TemporaryDirectory() as folder:
            seen = Path(folder) / "observations"
            library = Library(options.command, policy, options.uavs, options.hotspots, seen)
            of = session(policy)
            fields = of.get_inputs()[0].shape[1]
            observations = np.fromfile(seen, np.float32).reshape(-1, fields)
        for what, rows in (
            ("1 row", 1),
            ("1 mission", options.uavs),
            ("64 missions", 64 * options.uavs),
        ):
            runs = {
                "ours": (library.run("ours", rows), library.clock),
                "onnxruntime": (
                    onnx(of, observations[:rows].copy()),
                    time.CLOCK_PROCESS_CPUTIME_ID,
                ),
                "trainer": (library.run("trainer", rows), library.clock),
            }
            outputs = {name: run(1) for name, (run, _) in runs.items()}
            for name, got in outputs.items():
                np.testing.assert_allclose(got, outputs["ours"], rtol=1e-3, atol=1e-4, err_msg=name)
            times = measure(runs, options.turns, options.turn_ms / 1000)
            least = {
                name: sorted(of_one)[len(of_one) // 10] * 1e6 for name, of_one in times.items()
            }
            middle = {name: statistics.median(of_one) * 1e6 for name, of_one in times.items()}
            told = ", ".join(f"{name} {us:.1f} ({middle[name]:.1f})" for name, us in least.items())
            ratios = ", ".join(
                f"ours / {name} {least['ours'] / least[name]:.2f}"
                for name in ("onnxruntime", "trainer")
            )
            print(f"{policy.name:12} {what:11} {told}; {ratios}", flush=True)
        library.process.kill()


if __name__ == "__main__":
    main()
