"""Many simulations of one model, stepped by one call into buffers that NumPy owns."""

from __future__ import annotations

import ctypes
import weakref
from typing import Any

import numpy as np
import numpy.typing as npt

from . import _abi
from ._library import check, fail, lib, read_text
from .model import Model
from .sim import REWARD_NAMES, Sim

METRICS = np.dtype(_abi.jcas_metrics)
METRIC_NAMES = tuple(name for name in METRICS.names or () if name != "struct_size")


class BatchBuffers:
    """What a step of M missions writes, allocated once. The kernel writes these arrays itself.

    Attributes:
        observations: [M, N, observation length].
        rewards: the team's, [M].
        terminated: where the step ended the episode with success, [M].
        truncated: where the horizon ended it, [M].
        reward_components: [M, 12], in the order of `REWARD_NAMES`.
        global_state: [M, global length], or None.
        final_observations: as `observations`, valid where an episode was just reset.
        final_global_state: as `global_state`, valid where an episode was just reset.
        final_metrics: structured, [M], valid where an episode just ended.

    """

    def __init__(self, model: Model, num_envs: int, global_state: bool = False) -> None:
        rows = (num_envs, model.uav_count, model.observation_len)
        wide = (num_envs, model.global_len)
        self.observations = np.zeros(rows, np.float32)
        self.rewards = np.zeros(num_envs, np.float32)
        self.terminated = np.zeros(num_envs, np.bool_)
        self.truncated = np.zeros(num_envs, np.bool_)
        self.reward_components = np.zeros((num_envs, len(REWARD_NAMES)))
        self.global_state = np.zeros(wide, np.float32) if global_state else None
        self.final_observations = np.zeros(rows, np.float32)
        self.final_global_state = np.zeros(wide, np.float32) if global_state else None
        self.final_metrics = np.zeros(num_envs, METRICS)
        self.record = _abi.jcas_batch_out(struct_size=ctypes.sizeof(_abi.jcas_batch_out), metrics_size=METRICS.itemsize)
        for field, count, array in (
            ("observations", "observation_count", self.observations),
            ("rewards", "reward_count", self.rewards),
            ("terminated", "terminated_count", self.terminated),
            ("truncated", "truncated_count", self.truncated),
            ("components", "component_count", self.reward_components),
            ("global", "global_count", self.global_state),
            ("final_observations", "final_observation_count", self.final_observations),
            ("final_global", "final_global_count", self.final_global_state),
            ("final_metrics", "final_metrics_count", self.final_metrics),
        ):
            if array is not None:
                setattr(self.record, field, array.ctypes.data)
                setattr(self.record, count, array.size)

    def final_metrics_by_name(self, ended: npt.NDArray[np.bool_]) -> dict[str, npt.NDArray[Any]]:
        """Metrics of the episodes that just ended, by name; zeros elsewhere."""
        return {name: np.where(ended, self.final_metrics[name], 0) for name in METRIC_NAMES}

    def observed(self) -> tuple[int | None, int, int | None, int]:
        """Addresses and lengths of what a reset writes."""
        record = self.record
        return record.observations, record.observation_count, getattr(record, "global"), record.global_count


class Batch:
    """M environments of one model.

    Args:
        model: the model; kept alive by its batches.
        num_envs: M.
        threads: how many step at once; results do not depend on it.

    """

    def __init__(self, model: Model, num_envs: int, threads: int = 1) -> None:
        self.model = model
        self.num_envs = num_envs
        handle = ctypes.c_void_p()
        check(lib.jcas_batch_new(model.handle, num_envs, threads, ctypes.byref(handle)))
        self.handle = handle
        weakref.finalize(self, _free, handle, model)
        self._action_count = num_envs * model.uav_count * 2

    def reset(self, seeds: npt.NDArray[np.uint64], buffers: BatchBuffers) -> None:
        """Begin the episodes of M seeds, and observe."""
        seeds = np.ascontiguousarray(seeds, dtype=np.uint64)
        self._check(lib.jcas_batch_reset(self.handle, seeds.ctypes.data, seeds.size, *buffers.observed()))

    def step(self, actions: npt.NDArray[np.float32], buffers: BatchBuffers, auto_reset: bool = True) -> None:
        """Step every environment. `actions` is contiguous float32, [M, N, 2]."""
        status = lib.jcas_batch_step(
            self.handle, actions.ctypes.data, actions.size, auto_reset, ctypes.byref(buffers.record)
        )
        if status:
            self._check(status)

    def observe(self, buffers: BatchBuffers) -> None:
        """Write what the environments observe now."""
        self._check(lib.jcas_batch_observe(self.handle, *buffers.observed()))

    def member(self, index: int) -> Sim:
        """Copy an environment into a simulation of its own, to read every quantity or to save it."""
        sim = Sim(self.model)
        self._check(lib.jcas_batch_get(self.handle, index, sim.handle))
        return sim

    def set_member(self, index: int, sim: Sim) -> None:
        """Put the state of a simulation in an environment's place."""
        self._check(lib.jcas_batch_set(self.handle, index, sim.handle))

    def _check(self, status: int) -> None:
        if status:
            fail(
                status,
                read_text(lambda out, size, length: lib.jcas_batch_message(self.handle, out, size, length)),
            )


def _free(handle: ctypes.c_void_p, model: Model) -> None:
    """Free a batch; that `model` is an argument keeps it alive until then."""
    lib.jcas_batch_free(handle)
