"""Policies flown by the library itself: trained fleets of any size, scripted baselines and plans.

The same code flies in C, C++, the command and the browser, with the same bits on every platform.
"""

from __future__ import annotations

import ctypes
import os
import weakref
from pathlib import Path
from typing import Literal

import numpy as np
import numpy.typing as npt

from ._library import check, check_with_message, lib, listed
from .arguments import read_file, shown, whole
from .batch import Batch
from .errors import ArgumentError, PolicyError, SnapshotError
from .futures import STEPS_MAX, Futures
from .model import Model, check_model
from .plan import Plan
from .sim import Sim

Mode = Literal["deterministic", "sampled"]
Actions = npt.NDArray[np.float32]

MODES: dict[str, int] = {"deterministic": 0, "sampled": 1}
WEIGHTS = "policy.safetensors"


class Policy:
    """What flies a fleet: made by `load`, `baseline` or `follow`, for missions of one model.

    A copy, also one that was pickled, flies as a policy that was just made: a baseline that plans
    over several steps plans anew.
    """

    def __init__(self, model: Model, handle: ctypes.c_void_p, name: str) -> None:
        self.model = model
        self.handle = handle
        self.name = name
        weakref.finalize(self, _free, handle, model)

    @classmethod
    def load(
        cls, path: str | os.PathLike[str], model: Model, *, mode: Mode | None = None
    ) -> Policy:
        """Read a trained policy.

        Args:
            path: a folder with a `policy.safetensors`, or that file.
            model: the model of the simulations that the policy will fly.
            mode: `deterministic` or `sampled`. A deterministic policy takes the most likely motion
                and the mean pilot density. With it, UAVs that choose in turn stay on a depot to
                charge, and draw where they would turn round without news. A sampled one draws from
                the mission's seed. None stands for the mode that the file names.

        Raises:
            PolicyError: the file is no policy, or reads other observations than the model has.
            MissingFileError: the file is not there or cannot be read.
            ArgumentError: an argument is not acceptable.

        """
        _check_mode(mode)
        fitting = check_model(model)
        file = Path(path)
        if file.is_dir():
            file /= WEIGHTS
        name = file.parent.name if file.name == WEIGHTS else file.stem
        try:
            return trained(fitting, name, read_file(file), mode)
        except SnapshotError as error:
            raise PolicyError(f"{file}: {error}", error.status) from None

    @staticmethod
    def names() -> tuple[str, ...]:
        """List the names of the baselines, and of the policies that plan."""
        return listed(lib.jcas_policy_name)

    @classmethod
    def baseline(cls, name: str, model: Model, *, pilot: str | float = "adaptive") -> Policy:
        """Build a scripted baseline by its name.

        `plan` follows one plan without feedback, and `replan` plans again after each confirmation,
        meeting and report. Either takes seconds for its first plan.

        Args:
            name: one of `names()`.
            model: what it will fly.
            pilot: min, mid, max, adaptive, or a density. A plan has its own densities.

        Raises:
            ArgumentError: there is none of that name, it needs hidden positions, or the fleet or
                the grid is too large.

        """
        fitting = check_model(model)
        chosen, density = _text("name", name), _text("pilot", pilot)
        handle = ctypes.c_void_p()
        check_with_message(
            lambda message, capacity: lib.jcas_policy_baseline(
                fitting.handle, chosen, density, ctypes.byref(handle), message, capacity
            )
        )
        policy = cls(fitting, handle, str(name))
        policy._made_by = (_scripted, (fitting, name, pilot))
        return policy

    @classmethod
    def follow(cls, plan: Plan) -> Policy:
        """Build the policy that follows a plan without feedback.

        Args:
            plan: the plan, for missions of its model.

        Raises:
            ArgumentError: `plan` is no plan.

        """
        if not isinstance(plan, Plan):
            raise ArgumentError(f"plan = {shown(plan)}: must be a jcas.Plan")
        handle = ctypes.c_void_p()
        check(lib.jcas_policy_follow(plan.model.handle, plan.handle, ctypes.byref(handle)))
        policy = cls(plan.model, handle, "plan")
        policy._made_by = (_following, (plan,))
        return policy

    def __reduce__(self) -> tuple[object, tuple[object, ...]]:
        return self._made_by

    def __repr__(self) -> str:
        return (
            f"<jcas.Policy {self.name}: {self.model.uav_count} UAVs, "
            f"{self.model.hotspot_count} hotspots>"
        )

    def act(self, sim: Sim) -> Actions:
        """Choose the actions of a simulation's present state, [N, 2], for `jcas.Sim.step`.

        teams, squads, line, answer and replan remember what they planned. They act in every state
        of one simulation, one after the other.

        Raises:
            PolicyError: the policy remembers another state, for instance one before `sim.load`.

        """
        if not isinstance(sim, Sim):
            raise ArgumentError(f"sim = {shown(sim)}: must be a jcas.Sim")
        self._check_model("sim", sim.model)
        actions = np.empty((self.model.uav_count, 2), np.float32)
        check(lib.jcas_policy_act(self.handle, sim.handle, actions.ctypes.data, actions.size))
        return actions

    def act_batch(self, batch: Batch) -> Actions:
        """Choose the actions of every simulation of a batch, [M, N, 2]."""
        if not isinstance(batch, Batch):
            raise ArgumentError(f"batch = {shown(batch)}: must be a jcas.Batch")
        self._check_model("batch", batch.model)
        actions = np.empty((batch.num_envs, self.model.uav_count, 2), np.float32)
        check(
            lib.jcas_policy_act_batch(self.handle, batch.handle, actions.ctypes.data, actions.size)
        )
        return actions

    def fork_batch(self, batch: Batch, sim: Sim, seeds: npt.ArrayLike | None = None) -> None:
        """Copy a simulation, and what the policy remembers of it, into every environment.

        Args:
            batch: the batch.
            sim: the simulation that the policy has acted for.
            seeds: as for `Batch.fork`.

        Raises:
            PolicyError: the policy remembers another state than the one of `sim`.

        """
        if not isinstance(batch, Batch):
            raise ArgumentError(f"batch = {shown(batch)}: must be a jcas.Batch")
        self._check_model("batch", batch.model)
        batch.fork_with(sim, self.handle, seeds)

    def rollout_batch(self, batch: Batch, steps: int) -> Futures:
        """Step every environment of a batch by this policy, until its episode ends.

        The results are those of `act_batch` and `Batch.step` in turn, on the batch's threads.
        """
        if not isinstance(batch, Batch):
            raise ArgumentError(f"batch = {shown(batch)}: must be a jcas.Batch")
        self._check_model("batch", batch.model)
        return batch.roll_out_with(self.handle, None, whole("steps", steps, 1, STEPS_MAX))

    def save_memory(self, sim: Sim) -> bytes:
        """Save what the policy remembers of a simulation; `sim.save()` gives the state itself."""
        if not isinstance(sim, Sim):
            raise ArgumentError(f"sim = {shown(sim)}: must be a jcas.Sim")
        length = ctypes.c_size_t()
        save, size = lib.jcas_policy_memory_save, ctypes.byref(length)
        check(save(self.handle, sim.handle, None, 0, size))
        memory = ctypes.create_string_buffer(length.value)
        check(save(self.handle, sim.handle, memory, length.value, size))
        return memory.raw

    def load_memory(self, sim: Sim, memory: bytes) -> None:
        """Load what an equal policy remembered in the state that `sim` is in.

        Raises:
            PolicyError: the memory belongs to another policy or another state.
            SnapshotError: `memory` holds no memory, or one of another configuration.

        """
        if not isinstance(sim, Sim):
            raise ArgumentError(f"sim = {shown(sim)}: must be a jcas.Sim")
        if not isinstance(memory, bytes):
            raise ArgumentError(f"memory = {shown(memory)}: must be bytes of save_memory")
        check(lib.jcas_policy_memory_load(self.handle, sim.handle, memory, len(memory)))

    def forget(self) -> None:
        """Forget everything: the policy begins anew in the next state that it acts in."""
        check(lib.jcas_policy_forget(self.handle))

    def _check_model(self, what: str, model: Model) -> None:
        if model.config_hash != self.model.config_hash:
            raise ArgumentError(
                f"{what} has another configuration than the policy: {model!r}, "
                f"the policy was made for {self.model!r}"
            )

    _made_by: tuple[object, tuple[object, ...]]
    """How pickle and copy make the policy again."""


def trained(model: Model, name: str, weights: bytes, mode: Mode | None) -> Policy:
    """Make a policy of a file's bytes."""
    handle = ctypes.c_void_p()
    check_with_message(
        lambda message, capacity: lib.jcas_policy_load(
            model.handle, weights, len(weights), ctypes.byref(handle), message, capacity
        )
    )
    policy = Policy(model, handle, name)
    policy._made_by = (trained, (model, name, weights, mode))
    if mode is not None:
        check(lib.jcas_policy_set_mode(handle, MODES[mode]))
    return policy


def _scripted(model: Model, name: str, pilot: str | float) -> Policy:
    """Make a baseline, as pickle calls it."""
    return Policy.baseline(name, model, pilot=pilot)


def _following(plan: Plan) -> Policy:
    """Make a follower, as pickle calls it."""
    return Policy.follow(plan)


def _check_mode(mode: str | None) -> None:
    if mode is not None and mode not in MODES:
        raise ArgumentError(f"mode = {shown(mode)}: must be one of {', '.join(MODES)}")


def _text(name: str, value: object) -> bytes:
    """Return a text as the library takes it, which ends at the first zero."""
    text = str(value)
    if "\0" in text:
        raise ArgumentError(f"{name} = {shown(value)}: must hold no zero character")
    return text.encode()


def _free(handle: ctypes.c_void_p, model: Model) -> None:
    """End a policy; that `model` is an argument keeps it alive until then."""
    lib.jcas_policy_free(handle)
