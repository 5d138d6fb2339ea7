"""Policies flown by the library itself: trained fleets of any size, and the scripted baselines.

The same code flies in C, C++, the command and the browser, with the same bits on every platform. For inference in
other programs, or outside the library, see :func:`jcas.load_policy`.
"""

from __future__ import annotations

import ctypes
import os
import weakref
from pathlib import Path
from typing import Literal

import numpy as np
import numpy.typing as npt

from ._library import check, check_with_message, lib
from .batch import Batch
from .errors import ArgumentError, PolicyError
from .model import Model, check_model
from .sim import Sim

Mode = Literal["deterministic", "sampled", "stratified"]
Actions = npt.NDArray[np.float32]

MODES: dict[str, int] = {"deterministic": 0, "sampled": 1, "stratified": 2}
WEIGHTS = "policy.safetensors"


class Policy:
    """What flies a fleet: made by :meth:`load` or :meth:`baseline`, for missions of one model."""

    def __init__(self, model: Model, handle: ctypes.c_void_p, name: str) -> None:
        self.model = model
        self.handle = handle
        self.name = name
        weakref.finalize(self, _free, handle, model)

    @classmethod
    def load(cls, path: str | os.PathLike[str], model: Model, *, mode: Mode | None = None) -> Policy:
        """Read a trained policy.

        Args:
            path: a folder with a `policy.safetensors`, or that file.
            model: what it will fly.
            mode: `deterministic`, the most likely motion and the mean pilot density; `sampled`, draws that follow
                from the mission's seed; `stratified`, motions shared out among the UAVs of each cell, and the mean
                pilot density. By default as the file says.

        Raises:
            PolicyError: the file is no policy, or reads other observations than the model has.
            ArgumentError: an argument is not acceptable.

        """
        if mode is not None and mode not in MODES:
            raise ArgumentError(f"mode = {mode!r}: must be one of {', '.join(MODES)}")
        file = Path(path)
        if file.is_dir():
            file /= WEIGHTS
        try:
            weights = file.read_bytes()
        except OSError as error:
            raise PolicyError(f"{file}: {error.strerror}") from error
        fitting = check_model(model)
        handle = ctypes.c_void_p()
        check_with_message(
            lambda message, capacity: lib.jcas_policy_load(
                fitting.handle, weights, len(weights), ctypes.byref(handle), message, capacity
            )
        )
        policy = cls(fitting, handle, file.parent.name if file.name == WEIGHTS else file.stem)
        if mode is not None:
            check(lib.jcas_policy_set_mode(handle, MODES[mode]))
        return policy

    @classmethod
    def baseline(cls, name: str, model: Model, *, pilot: str | float = "adaptive") -> Policy:
        """Build a baseline: random, greedy, swarm, teams, sweep, line, frontier, relay, charging or clean.

        Args:
            name: which.
            model: what it will fly.
            pilot: min, mid, max, adaptive, or a density.

        Raises:
            ArgumentError: there is none of that name, or it steers by positions that the model hides.

        """
        fitting = check_model(model)
        handle = ctypes.c_void_p()
        check_with_message(
            lambda message, capacity: lib.jcas_policy_baseline(
                fitting.handle, str(name).encode(), str(pilot).encode(), ctypes.byref(handle), message, capacity
            )
        )
        return cls(fitting, handle, str(name))

    def __repr__(self) -> str:
        return f"<jcas.Policy {self.name}: {self.model.uav_count} UAVs, {self.model.hotspot_count} hotspots>"

    def act(self, sim: Sim) -> Actions:
        """Choose the actions of a simulation's present state, [N, 2], for :meth:`jcas.Sim.step`."""
        if not isinstance(sim, Sim):
            raise ArgumentError(f"sim = {sim!r}: must be a jcas.Sim")
        actions = np.empty((self.model.uav_count, 2), np.float32)
        check(lib.jcas_policy_act(self.handle, sim.handle, actions.ctypes.data, actions.size))
        return actions

    def act_batch(self, batch: Batch) -> Actions:
        """Choose the actions of every simulation of a batch, [M, N, 2]."""
        if not isinstance(batch, Batch):
            raise ArgumentError(f"batch = {batch!r}: must be a jcas.Batch")
        actions = np.empty((batch.num_envs, self.model.uav_count, 2), np.float32)
        check(lib.jcas_policy_act_batch(self.handle, batch.handle, actions.ctypes.data, actions.size))
        return actions


def _free(handle: ctypes.c_void_p, model: Model) -> None:
    """End a policy; that `model` is an argument keeps it alive until then."""
    lib.jcas_policy_free(handle)
