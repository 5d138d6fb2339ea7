"""Measures what a cell of `python -m jcas.sweep` costs beside its missions.

    python python/benchmarks/sweep_cost.py

It needs jcas[sweep] and psutil. The bytes are those that Ray carries to and from a worker. `short`
cells fly one mission, so the time is the scheduler's. `long` cells fly 300. Rates count from the
first cell that ends, since Ray takes seconds to start. 0 processes is the same sweep without Ray.

Processor time is that of the driver, and of the driver with all its descendants: workers, the
scheduler and the object store. Other programs on the machine hardly change it.
"""

from __future__ import annotations

import argparse
import os
import time

import psutil
from ray import cloudpickle

from jcas.sweep import Sweep, fly
from jcas.sweep.runners import in_process, on_ray


def sweep(cells: int, episodes: int) -> Sweep:
    """The paper's mission with many ranges, so that all cells cost about the same."""
    ranges = [100.0 + index / cells for index in range(cells)]
    axes = {"sensing_range_m": ranges}
    return Sweep.of({"config": "paper", "episodes": episodes, "axes": axes})


def processor_seconds() -> float:
    """Processor time of this process and of all its descendants that live."""
    driver = psutil.Process()
    total = 0.0
    for process in [driver, *driver.children(recursive=True)]:
        times = process.cpu_times()
        total += times.user + times.system
    return total


def rate(cells: Sweep, processes: int) -> tuple[float, float, float]:
    """Cells a second, and processor seconds a cell: the driver's, and those of all processes."""
    indices = list(range(len(cells.cells)))
    os.environ["RAY_OVERRIDE_RESOURCES"] = f'{{"CPU": {processes}}}'
    outcomes = on_ray(cells, indices, "local") if processes else in_process(cells, indices)
    assert next(outcomes).row is not None
    began, spent, spent_by_all = time.perf_counter(), time.process_time(), processor_seconds()
    for outcome in outcomes:
        assert outcome.row is not None, outcome.error
        # Here, since the workers are gone when the loop ends.
        ended, used, used_by_all = time.perf_counter(), time.process_time(), processor_seconds()
    others = len(indices) - 1
    return (
        others / (ended - began),
        (used - spent) / others,
        (used_by_all - spent_by_all) / others,
    )


def report_bytes(cells: Sweep) -> None:
    """Print the bytes that Ray carries for a cell."""
    cell = cells.cells[0]
    result = fly(cell, None)
    print(f"to a worker      {len(cloudpickle.dumps(cell)):6} bytes a cell")
    print(f"from a worker    {len(cloudpickle.dumps(result)):6} bytes a cell")


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--short", type=int, default=300, help="short cells")
    parser.add_argument("--long", type=int, default=24, help="long cells")
    options = parser.parse_args()
    kinds = {"short": sweep(options.short, 1), "long": sweep(options.long, 300)}
    report_bytes(kinds["short"])
    for kind, cells in kinds.items():
        for processes in (0, 1, 2):
            cells_per_second, by_driver, by_all = rate(cells, processes)
            print(
                f"{kind:5}  {processes} processes  {cells_per_second:8.2f} cells a second  "
                f"processor time a cell: driver {1e3 * by_driver:6.2f} ms, "
                f"all {1e3 * by_all:7.2f} ms",
                flush=True,
            )


if __name__ == "__main__":
    main()
