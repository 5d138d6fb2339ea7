"""Where the cells of a sweep run: in this process, or on a Ray cluster."""

from __future__ import annotations

from collections.abc import Generator
from dataclasses import dataclass
from itertools import islice
from typing import Any

from ..errors import JcasError
from .cell import Row, build, fly
from .spec import Sweep

POLL_SECONDS = 1.0
TASKS_AHEAD = 4
"""Submitted cells for each processor: workers never wait, and the scheduler's queue is short."""
RETRIES = 5
"""Times that a cell starts again after its worker or its node was lost."""


@dataclass(frozen=True)
class Outcome:
    """A cell that has run: its row, or why there is none."""

    index: int
    row: Row | None
    error: str = ""


def in_process(sweep: Sweep, indices: list[int]) -> Generator[Outcome, None, None]:
    """Run the cells in this process, one after another."""
    for index in indices:
        cell = sweep.cells[index]
        try:
            row, _ = fly(cell, sweep.weights.get(cell.policy))
        except JcasError as error:
            yield Outcome(index, None, str(error))
        else:
            yield Outcome(index, row)


def on_ray(sweep: Sweep, indices: list[int], address: str) -> Generator[Outcome, None, None]:
    """Run the cells on a Ray cluster, each as one task, in the order in which they end.

    A cell whose worker or node is lost starts again elsewhere. The weights of trained policies
    travel with the tasks, so the nodes need the package alone.

    Raises:
        JcasError: a node has another build of jcas.

    """
    import ray

    ray.init(
        address=address,
        **({"include_dashboard": False} if address == "local" else {}),
        logging_level="warning",
        log_to_driver=False,
    )
    try:
        yield from _results(sweep, indices)
    finally:
        ray.shutdown()


def _results(sweep: Sweep, indices: list[int]) -> Generator[Outcome, None, None]:
    import ray

    task = ray.remote(num_cpus=1, max_retries=RETRIES)(fly)
    weights = {name: ray.put(data) for name, data in sweep.weights.items()}
    waiting = iter(indices)
    running: dict[Any, int] = {}
    while True:
        processors = int(ray.cluster_resources().get("CPU", 1))
        for index in islice(waiting, max(0, TASKS_AHEAD * processors - len(running))):
            cell = sweep.cells[index]
            running[task.remote(cell, weights.get(cell.policy))] = index
        if not running:
            return
        ended, _ = ray.wait(list(running), num_returns=1, timeout=POLL_SECONDS)
        if ended:
            ended, _ = ray.wait(list(running), num_returns=len(running), timeout=0)
        for reference in ended:
            yield _outcome(running.pop(reference), reference)


def _outcome(index: int, reference: Any) -> Outcome:
    import ray

    try:
        row, built = ray.get(reference)
    except ray.exceptions.RayTaskError as error:
        return Outcome(index, None, str(error.cause))
    except ray.exceptions.RayError as error:
        return Outcome(index, None, f"lost after {RETRIES} retries: {error}")
    if built != build():
        raise JcasError(f"a worker has another build: {built}, must be {build()}")
    return Outcome(index, row)
