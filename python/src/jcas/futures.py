"""Futures of a state: one simulation forked into a batch, and every environment rolled out."""

from __future__ import annotations

import ctypes
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from . import _abi
from ._library import lib
from .arguments import seeds_of
from .sim import Sim

STEPS_MAX = 2**32 - 1
METRICS = np.dtype(_abi.jcas_metrics)


@dataclass(frozen=True)
class Futures:
    """What M environments made in a rollout.

    Attributes:
        returns: the sum of the team's rewards, [M].
        steps: the steps made, [M]. They are fewer where an episode ended.
        terminated: whether the episode has ended with success, [M].
        truncated: whether the episode has ended at the horizon, [M].
        metrics: structured, [M]: the metrics of the episode up to the last state.

    """

    returns: npt.NDArray[np.float64]
    steps: npt.NDArray[np.uint32]
    terminated: npt.NDArray[np.bool_]
    truncated: npt.NDArray[np.bool_]
    metrics: npt.NDArray[Any]


def fork(batch: Any, sim: Sim, policy: ctypes.c_void_p | None, seeds: npt.ArrayLike | None) -> int:
    """Copy a simulation, and what a policy remembers of it, into a batch; return the status."""
    numbers = None if seeds is None else seeds_of("seeds", seeds, batch.num_envs)
    address, count = (None, 0) if numbers is None else (numbers.ctypes.data, numbers.size)
    return int(lib.jcas_batch_fork(batch.handle, sim.handle, policy, address, count))


def roll_out(
    batch: Any,
    policy: ctypes.c_void_p | None,
    actions: npt.NDArray[np.float32] | None,
    steps: int,
) -> tuple[int, Futures]:
    """Step every environment of a batch; return the status, and what they made."""
    count = batch.num_envs
    made = Futures(
        returns=np.zeros(count),
        steps=np.zeros(count, np.uint32),
        terminated=np.zeros(count, np.bool_),
        truncated=np.zeros(count, np.bool_),
        metrics=np.zeros(count, METRICS),
    )
    out = _abi.jcas_rollout_out(
        struct_size=ctypes.sizeof(_abi.jcas_rollout_out),
        returns=made.returns.ctypes.data,
        return_count=count,
        steps=made.steps.ctypes.data,
        step_count=count,
        terminated=made.terminated.ctypes.data,
        terminated_count=count,
        truncated=made.truncated.ctypes.data,
        truncated_count=count,
        metrics=made.metrics.ctypes.data,
        metrics_count=count,
        metrics_size=METRICS.itemsize,
    )
    address, length = (None, 0) if actions is None else (actions.ctypes.data, actions.size)
    status = lib.jcas_batch_rollout(batch.handle, policy, address, length, steps, ctypes.byref(out))
    return int(status), made
