"""Many simulations of one model, stepped by one call into buffers that NumPy owns."""

from __future__ import annotations

import ctypes
import weakref
from functools import partial
from itertools import pairwise
from typing import Any

import numpy as np
import numpy.typing as npt

from . import _abi, futures
from ._library import check, fail_saying, lib
from .arguments import flags, floats, seeds_of, shown, snapshot_of, whole
from .errors import ActionError, ArgumentError, ResetNeededError, SnapshotError
from .futures import METRICS, Futures
from .in_use import Mark
from .model import Model, check_model
from .sim import EPISODE_INFO, REWARD_NAMES, Sim

WHOLE_METRICS = tuple(name for name, zero in EPISODE_INFO.items() if type(zero) is int)
REAL_METRICS = tuple(name for name, zero in EPISODE_INFO.items() if type(zero) is float)

ENVS_MAX = 2**20
THREADS_MAX = 256


class BatchBuffers:
    """Output arrays of a step of M missions. The kernel writes them: they cannot be replaced.

    Attributes:
        observations: [M, N, observation length]. Each row is one UAV's observation.
        rewards: the team's reward, [M]. It is the sum of the reward components.
        uav_rewards: each UAV's own reward, [M, N], or None. Its mean over UAVs is the team's.
        terminated: [M]. It marks the episodes that the step ended with success.
        truncated: [M]. It marks the episodes that ended at the horizon.
        reward_components: [M, 12]. They have the order of `REWARD_NAMES`.
        global_state: [M, global length], or None. It is what a centralised critic reads.
        final_observations: as `observations`. A row is valid if its episode was just reset.
        final_global_state: as `global_state`. A row is valid if its episode was just reset.
        final_metrics: structured, [M]. An element is valid if its episode just ended.

    """

    def __init__(
        self, model: Model, num_envs: int, global_state: bool = False, uav_rewards: bool = False
    ) -> None:
        check_model(model)
        missions = whole("num_envs", num_envs, 1, ENVS_MAX)
        rows = (missions, model.uav_count, model.observation_len)
        self.shape = (*rows, model.global_len)
        self._arrays: dict[str, npt.NDArray[Any]] = {
            "observations": np.zeros(rows, np.float32),
            "rewards": np.zeros(missions, np.float32),
            "terminated": np.zeros(missions, np.bool_),
            "truncated": np.zeros(missions, np.bool_),
            "reward_components": np.zeros((missions, len(REWARD_NAMES))),
            "final_observations": np.zeros(rows, np.float32),
            "final_metrics": np.zeros(missions, METRICS),
        }
        if uav_rewards:
            self._arrays["uav_rewards"] = np.zeros(rows[:2], np.float32)
        if global_state:
            for name in ("global_state", "final_global_state"):
                self._arrays[name] = np.zeros((missions, model.global_len), np.float32)
        self._point()

    observations = property(lambda self: self._arrays["observations"])
    rewards = property(lambda self: self._arrays["rewards"])
    uav_rewards = property(lambda self: self._arrays.get("uav_rewards"))
    terminated = property(lambda self: self._arrays["terminated"])
    truncated = property(lambda self: self._arrays["truncated"])
    reward_components = property(lambda self: self._arrays["reward_components"])
    global_state = property(lambda self: self._arrays.get("global_state"))
    final_observations = property(lambda self: self._arrays["final_observations"])
    final_global_state = property(lambda self: self._arrays.get("final_global_state"))
    final_metrics = property(lambda self: self._arrays["final_metrics"])

    @property
    def record(self) -> _abi.jcas_batch_out:
        """The addresses and lengths as the C interface takes them. Not to be changed."""
        return self._record

    def renew(self) -> None:
        """Take new arrays for the next step, so that nobody writes to the present ones again."""
        with self.in_use:
            for name in _RENEWED:
                if (array := self._arrays.get(name)) is not None:
                    fresh = self._arrays[name] = np.empty_like(array)
                    setattr(self._record, _FIELDS[name][0], fresh.ctypes.data)

    def episode_info(self, ended: npt.NDArray[np.bool_]) -> dict[str, npt.NDArray[Any]]:
        """Metrics of the episodes that just ended, by name; zeros elsewhere."""
        whole = np.zeros((len(WHOLE_METRICS), len(ended)), np.int64)
        real = np.zeros((len(REAL_METRICS), len(ended)))
        if ended.any():
            for names, rows in ((WHOLE_METRICS, whole), (REAL_METRICS, real)):
                for name, row in zip(names, rows, strict=True):
                    row[ended] = self.final_metrics[name][ended]
        return {
            "success": ended & self.terminated,
            **dict(zip(WHOLE_METRICS, whole, strict=True)),
            **dict(zip(REAL_METRICS, real, strict=True)),
        }

    def forget_rewards(self, members: npt.NDArray[np.bool_]) -> None:
        """Set what the last step of some members gave to zero."""
        for name in ("rewards", "uav_rewards", "reward_components", "terminated", "truncated"):
            if (array := self._arrays.get(name)) is not None:
                array[members] = 0

    def observed(self) -> tuple[int | None, int, int | None, int]:
        """Addresses and lengths of what a reset writes."""
        record = self._record
        return (
            record.observations,
            record.observation_count,
            getattr(record, "global"),
            record.global_count,
        )

    def __getstate__(self) -> dict[str, Any]:
        return {"shape": self.shape, "_arrays": self._arrays}

    def __setstate__(self, state: dict[str, Any]) -> None:
        self.__dict__.update(state)
        self._point()

    def _point(self) -> None:
        """Write the addresses of all arrays into the record."""
        self.in_use = Mark("a set of buffers")
        size = ctypes.sizeof(_abi.jcas_batch_out)
        self._record = _abi.jcas_batch_out(struct_size=size, metrics_size=METRICS.itemsize)
        for name, array in self._arrays.items():
            field, count = _FIELDS[name]
            setattr(self._record, field, array.ctypes.data)
            setattr(self._record, count, array.size)


_NAMES = {
    "components": "reward_components",
    "global": "global_state",
    "final_global": "final_global_state",
}
"""Names of arrays that differ from those of the C interface."""

_FIELDS = {
    _NAMES.get(name, name): (name, count)
    for (name, *_), (count, *_) in pairwise(_abi.jcas_batch_out._fields_)
    if count.endswith("_count")
}
"""Arrays, and where their address and length stand in the record."""

_RENEWED = tuple(name for name in _FIELDS if not name.startswith("final_"))


class Batch:
    """M environments of one model.

    Args:
        model: the model. Its batches keep it alive.
        num_envs: M, 1 to 2^20.
        threads: threads that step environments, 1 to 256. Results do not depend on the number.

    """

    def __init__(self, model: Model, num_envs: int, threads: int = 1) -> None:
        self.model = check_model(model)
        self.num_envs = whole("num_envs", num_envs, 1, ENVS_MAX)
        self.threads = whole("threads", threads, 1, THREADS_MAX)
        handle = ctypes.c_void_p()
        check(lib.jcas_batch_new(model.handle, self.num_envs, self.threads, ctypes.byref(handle)))
        self.handle = handle
        weakref.finalize(self, _free, handle, model)
        self._action_shape = (self.num_envs, model.uav_count, 2)
        self._buffers_shape = (
            self.num_envs,
            model.uav_count,
            model.observation_len,
            model.global_len,
        )
        self.begun = False
        """Whether the environments have been reset, or a saved state taken up."""

    def __repr__(self) -> str:
        model = self.model
        return (
            f"<jcas.Batch of {self.num_envs} missions: {model.uav_count} UAVs, "
            f"{model.hotspot_count} hotspots, "
            f"threads={self.threads}>"
        )

    def __reduce__(self) -> tuple[Any, tuple[Model, int, int, bytes | None]]:
        return (
            _restore,
            (self.model, self.num_envs, self.threads, self.save() if self.begun else None),
        )

    def reset(
        self,
        seeds: npt.ArrayLike,
        buffers: BatchBuffers,
        chosen: npt.NDArray[np.bool_] | None = None,
    ) -> None:
        """Begin the episodes of M seeds, and observe; or of the chosen members alone."""
        numbers = seeds_of("seeds", seeds, self.num_envs)
        self._check_buffers(buffers)
        begun = (numbers.ctypes.data, numbers.size, *buffers.observed())
        with buffers.in_use:
            if chosen is None:
                self._check(lib.jcas_batch_reset(self.handle, *begun))
                self.begun = True
                return
            mask = flags("chosen", chosen, self.num_envs).astype(np.uint8)
            self._check(lib.jcas_batch_reset_some(self.handle, mask.ctypes.data, mask.size, *begun))

    def step(self, actions: npt.ArrayLike, buffers: BatchBuffers, auto_reset: bool = True) -> None:
        """Step every environment. `actions` is [M, N, 2]; contiguous float32 is read in place."""
        pairs = floats("actions", actions, self._action_shape)
        self._check_buffers(buffers)
        if not self.begun:
            raise ResetNeededError("step before the first reset: call reset first")
        with buffers.in_use:
            out = ctypes.byref(buffers.record)
            status = lib.jcas_batch_step(
                self.handle, pairs.ctypes.data, pairs.size, bool(auto_reset), out
            )
        if status:
            self.check_numbers(pairs)
            self._check(status)

    def check_numbers(self, actions: npt.NDArray[np.float32]) -> None:
        """Refuse NaN by the mission and the UAV."""
        if np.isnan(actions).any():
            mission, uav, place = np.argwhere(np.isnan(actions))[0].tolist()
            raise ActionError(
                f"actions[{mission}, {uav}, {place}] = NaN (mission {mission}, UAV {uav}): must be "
                "a number, clipped to -1 to 1"
            )

    def observe(self, buffers: BatchBuffers) -> None:
        """Write what the environments observe now."""
        self._check_buffers(buffers)
        with buffers.in_use:
            self._check(lib.jcas_batch_observe(self.handle, *buffers.observed()))

    def member(self, index: int, sim: Sim | None = None) -> Sim:
        """Copy an environment into `sim` or a new simulation, to read or to save it."""
        copy = Sim(self.model) if sim is None else self._check_sim(sim)
        place = whole("index", index, 0, self.num_envs - 1)
        self._check(lib.jcas_batch_get(self.handle, place, copy.handle))
        return copy

    def set_member(self, index: int, sim: Sim) -> None:
        """Put the state of a simulation in an environment's place."""
        place = whole("index", index, 0, self.num_envs - 1)
        self._check(lib.jcas_batch_set(self.handle, place, self._check_sim(sim).handle))

    def fork(self, sim: Sim, seeds: npt.ArrayLike | None = None) -> None:
        """Copy the state of a simulation into every environment.

        Args:
            sim: a simulation of the batch's configuration.
            seeds: M seeds, from which all later draws follow. What was drawn before stays, such as
                the hotspots. None keeps the seed: equal actions then give equal futures.

        """
        self.fork_with(self._check_sim(sim), None, seeds)

    def rollout(self, actions: npt.ArrayLike) -> Futures:
        """Step every environment by given actions, [M, K, N, 2], until its episode ends.

        An environment whose episode has ended already makes no step.
        """
        try:
            given = np.shape(actions)
        except ValueError:  # Rows of unequal lengths have no shape.
            given = ()
        steps = max(given[1], 1) if len(given) == len(self._action_shape) + 1 else 1
        rows = floats("actions", actions, (self.num_envs, steps, *self._action_shape[1:]))
        return self.roll_out_with(None, rows, steps)

    def fork_with(
        self, sim: Sim, policy: ctypes.c_void_p | None, seeds: npt.ArrayLike | None
    ) -> None:
        """Copy a simulation, and what the policy of a handle remembers of it."""
        self._check(futures.fork(self, self._check_sim(sim), policy, seeds))
        self.begun = True

    def roll_out_with(
        self, policy: ctypes.c_void_p | None, actions: npt.NDArray[np.float32] | None, steps: int
    ) -> Futures:
        """Step every environment by the policy of a handle, or by given actions."""
        if not self.begun:
            raise ResetNeededError("rollout before the first reset: call reset or fork first")
        status, made = futures.roll_out(self, policy, actions, steps)
        self._check(status)
        return made

    def save(self) -> bytes:
        """Save all environments: their snapshots, one after another."""
        return b"".join(self.member(index).save() for index in range(self.num_envs))

    def load(self, snapshot: bytes) -> None:
        """Take up what `save` gave; anything else is refused and changes nothing."""
        saved, size = snapshot_of("snapshot", snapshot), self.model.snapshot_size
        if len(saved) != size * self.num_envs:
            raise SnapshotError(
                f"snapshot has {len(saved)} bytes: "
                f"must have {size} for each of {self.num_envs} missions"
            )
        sims = [Sim(self.model) for _ in range(self.num_envs)]
        for index, sim in enumerate(sims):
            sim.load(saved[index * size : (index + 1) * size])
        for index, sim in enumerate(sims):
            self.set_member(index, sim)
        self.begun = True

    def _check_sim(self, sim: Sim) -> Sim:
        if not isinstance(sim, Sim):
            raise ArgumentError(f"sim = {shown(sim)}: must be a jcas.Sim")
        if sim.model.config_hash != self.model.config_hash:
            raise ArgumentError(f"sim = {shown(sim)}: must be of the batch's configuration")
        return sim

    def _check_buffers(self, buffers: BatchBuffers) -> None:
        if not isinstance(buffers, BatchBuffers):
            raise ArgumentError(f"buffers = {shown(buffers)}: must be jcas.BatchBuffers")
        if buffers.shape != self._buffers_shape:
            raise ArgumentError(
                f"buffers have sizes {buffers.shape} (missions, UAVs, observation, global state): "
                f"must have {self._buffers_shape}"
            )

    def _check(self, status: int) -> None:
        if status:
            fail_saying(status, partial(lib.jcas_batch_message, self.handle))


def _free(handle: ctypes.c_void_p, model: Model) -> None:
    """Free a batch; that `model` is an argument keeps it alive until then."""
    lib.jcas_batch_free(handle)


def _restore(model: Model, num_envs: int, threads: int, snapshot: bytes | None) -> Batch:
    batch = Batch(model, num_envs, threads)
    if snapshot is not None:
        batch.load(snapshot)
    return batch
