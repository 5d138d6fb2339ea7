"""The Gymnasium vector environment: many fleets, stepped by one call of the kernel."""

from __future__ import annotations

import copy as copying
import os
from collections.abc import Sequence
from typing import Any

import numpy as np
import numpy.typing as npt
from gymnasium.vector import AutoresetMode, VectorEnv
from gymnasium.vector.utils import batch_space
from typing_extensions import Unpack

from ._fields import Fields
from .arguments import flags, options_of, seed_of, shown, whole
from .batch import ENVS_MAX, THREADS_MAX, Batch, BatchBuffers
from .config import Config, ConfigLike
from .errors import ActionError, ArgumentError, ConfigError, ResetNeededError
from .in_use import Mark
from .model import Model, derive_seed
from .signature import shows_fields
from .sim import Sim
from .spaces import (
    ActionSpaceKind,
    Credit,
    check_credit,
    check_kind,
    encode_fleet_action,
    fleet_action_space,
)

Array = npt.NDArray[Any]


class FleetVectorEnv(VectorEnv[Array, Any, Array]):
    """A vector environment of M fleets, made by `make_vec`.

    Each sub-environment is a whole fleet. Its observation is [N, observation length], its action
    [N, 2]. Rewards, terminations and truncations belong to the team, so their arrays have the shape
    [M].

    The caller owns the arrays that `reset` and `step` return. With `copy=False` they
    are the kernel's own, in `buffer_sets` sets that alternate. With two sets, the next step keeps
    the arrays and the one after overwrites them. With one set, as in Gymnasium's own vector
    environments, the next step overwrites them.
    """

    @shows_fields
    def __init__(
        self,
        config: ConfigLike = None,
        num_envs: int = 1,
        *,
        action_space: ActionSpaceKind = "box",
        credit: Credit = "team",
        threads: int | None = 1,
        autoreset_mode: AutoresetMode | str = AutoresetMode.NEXT_STEP,
        global_state: bool = False,
        copy: bool = True,
        buffer_sets: int = 2,
        render_mode: str | None = None,
        **fields: Unpack[Fields],
    ) -> None:
        if isinstance(config, int | np.integer):
            raise ArgumentError(
                f"config = {config}: must be a configuration; "
                f"so many missions are num_envs={config}"
            )
        self.num_envs = whole("num_envs", num_envs, 1, ENVS_MAX)
        if render_mode not in (None, "rgb_array"):
            raise ConfigError(f"render_mode = {shown(render_mode)}: must be 'rgb_array' or None")
        self._kind = check_kind(action_space)
        self._autoreset = _check_autoreset(autoreset_mode)
        self.autoreset_mode = self._autoreset  # As Gymnasium's own vector environments name it.
        self.metadata = {
            "autoreset_mode": self._autoreset,
            "render_modes": ["rgb_array"],
            "render_fps": 8,
        }
        self.render_mode = render_mode
        self.model = Model(Config(config, **fields))
        self.batch = Batch(self.model, self.num_envs, threads=_check_threads(threads))
        uavs = self.model.uav_count
        self.single_observation_space = self.model.observation_space(uavs)
        self.single_action_space = fleet_action_space(self._kind, uavs)
        self.observation_space = batch_space(self.single_observation_space, self.num_envs)
        self.action_space = batch_space(self.single_action_space, self.num_envs)
        self._action_shape = (self.num_envs, uavs, 2)
        self._copy = copy
        own = check_credit(credit) == "uav"
        sets = whole("buffer_sets", buffer_sets, 1, 2)
        self._buffers = [
            BatchBuffers(self.model, self.num_envs, global_state, own)
            for _ in range(1 if copy else sets)
        ]
        self._turn = 0
        self._in_use = Mark("the environment")
        self._ended = np.zeros(self.num_envs, np.bool_)
        self._begun: list[Sim] = []

    def __repr__(self) -> str:
        return (
            f"<jcas.FleetVectorEnv of {self.num_envs} missions: {self.model!r}, "
            f"{self._autoreset.value}>"
        )

    def reset(
        self,
        *,
        seed: int | Sequence[int | None] | None = None,
        options: dict[str, Any] | None = None,
    ) -> tuple[Array, dict[str, Any]]:
        """Begin an episode in every sub-environment, or in those of `options["reset_mask"]`.

        Sub-environment m gets the seed `seed + m` (after 2^64 - 1 comes 0), as in Gymnasium's own
        vector environments, or the m-th of a list. Without a seed, the next ones of the stream that
        the last seed began.
        """
        mask = options_of(options, "reset_mask").get("reset_mask")
        chosen = None if mask is None else flags("reset_mask", mask, self.num_envs)
        with self._in_use:
            return self._reset(seed, chosen)

    def step(self, actions: Any) -> tuple[Array, Array, Array, Array, dict[str, Any]]:
        """Step every fleet.

        `infos["reward_components"]` is [M, 12], in the order of `jcas.REWARD_NAMES`. Where an
        episode ended, `infos["final_info"]` holds its metrics. With `SameStep`,
        `infos["final_obs"]` holds its last observation, and `infos["_final_obs"]` marks the ended
        fleets. With `NextStep`, the step after ignores the ended fleet's action, begins its next
        episode and gives a reward of 0. With `global_state=True`, `infos["global_state"]` is the
        critic's view, [M, global length].
        """
        encoded = encode_fleet_action(self._kind, actions, self._action_shape)
        self._need_reset("step")
        with self._in_use:
            buffers = self._next_buffers()
            if self._autoreset is AutoresetMode.NEXT_STEP and self._ended.any():
                self._step_and_begin(encoded, buffers)
            else:
                at_once = self._autoreset is AutoresetMode.SAME_STEP
                self.batch.step(encoded, buffers, auto_reset=at_once)
            self._ended = buffers.terminated | buffers.truncated
            return (
                buffers.observations,
                buffers.rewards,
                buffers.terminated,
                buffers.truncated,
                self._infos(buffers),
            )

    def render(self) -> tuple[npt.NDArray[np.uint8], ...] | None:
        """Draw every sub-environment."""
        if self.render_mode is None:
            return None
        from .render import draw

        self._need_reset("render")
        return tuple(draw(self.batch.member(member).scene()) for member in range(self.num_envs))

    def save(self) -> bytes:
        """Save the missions, but not the stream from which a reset without a seed draws."""
        self._need_reset("save")
        return self.batch.save()

    def load(self, snapshot: bytes) -> Array:
        """Take up what `save` gave and return the observations."""
        with self._in_use:
            self.batch.load(snapshot)
            members = [self.batch.member(member) for member in range(self.num_envs)]
            self._ended = np.array([sim.terminated or sim.truncated for sim in members])
            buffers = self._next_buffers()
            self.batch.observe(buffers)
            return buffers.observations

    def fork(self) -> FleetVectorEnv:
        """Return an independent environment in the same state and with the same seeds to come."""
        return copying.deepcopy(self)

    def _reset(
        self, seed: int | Sequence[int | None] | None, chosen: npt.NDArray[np.bool_] | None
    ) -> tuple[Array, dict[str, Any]]:
        """Begin an episode in every sub-environment, or in the chosen ones."""
        seeds = self._reset_seeds(seed)
        buffers = self._next_buffers()
        if chosen is None:
            self.batch.reset(seeds, buffers)
            self._ended[:] = False
        else:
            self._need_reset("reset_mask")
            for member in np.flatnonzero(chosen).tolist():
                self.batch.set_member(member, Sim(self.model, int(seeds[member])))
            self.batch.observe(buffers)
            self._ended &= ~chosen
        infos: dict[str, Any] = {}
        if buffers.global_state is not None:
            infos["global_state"] = buffers.global_state
            infos["_global_state"] = self._everywhere()
        return buffers.observations, infos

    def _step_and_begin(self, encoded: npt.NDArray[np.float32], buffers: BatchBuffers) -> None:
        """Step the fleets that fly, and begin the next episode of those that ended a step ago.

        The kernel steps all fleets or none. So the ended ones are reset, stepped along and then put
        back to their start.
        """
        waiting = np.flatnonzero(self._ended).tolist()
        moving = encoded.copy()
        moving[waiting] = 0
        if np.isnan(moving).any():
            raise ActionError("actions hold NaN: must be numbers, clipped to -1 to 1")
        while len(self._begun) < len(waiting):
            self._begun.append(Sim(self.model))
        for member, sim in zip(waiting, self._begun, strict=False):
            self.batch.member(member, sim)
            sim.reset(derive_seed(sim.seed, 0))
            self.batch.set_member(member, sim)
        self.batch.step(moving, buffers, auto_reset=False)
        for member, sim in zip(waiting, self._begun, strict=False):
            self.batch.set_member(member, sim)
            sim.observe(buffers.observations[member])
            if buffers.global_state is not None:
                sim.observe_global(buffers.global_state[member])
        paid = (buffers.rewards, buffers.uav_rewards, buffers.reward_components)
        for array in (*paid, buffers.terminated, buffers.truncated):
            if array is not None:
                array[waiting] = 0

    def _infos(self, buffers: BatchBuffers) -> dict[str, Any]:
        infos: dict[str, Any] = {
            "reward_components": buffers.reward_components,
            "_reward_components": self._everywhere(),
        }
        if buffers.uav_rewards is not None:
            infos["uav_rewards"] = buffers.uav_rewards
            infos["_uav_rewards"] = self._everywhere()
        if buffers.global_state is not None:
            infos["global_state"] = buffers.global_state
            infos["_global_state"] = self._everywhere()
        ended = self._ended
        if ended.any():
            infos["final_info"] = {
                "metrics": buffers.final_metrics_by_name(ended),
                "_metrics": ended.copy(),
            }
            infos["_final_info"] = ended.copy()
            if self._autoreset is AutoresetMode.SAME_STEP:
                infos["final_obs"] = self._given(buffers.final_observations)
                infos["_final_obs"] = ended.copy()
                if buffers.final_global_state is not None:
                    infos["final_global_state"] = self._given(buffers.final_global_state)
                    infos["_final_global_state"] = ended.copy()
        return infos

    def _next_buffers(self) -> BatchBuffers:
        if self._copy:
            self._buffers[0].renew()
            return self._buffers[0]
        self._turn = (self._turn + 1) % len(self._buffers)
        return self._buffers[self._turn]

    def _given(self, array: Array) -> Array:
        return array.copy() if self._copy else array

    def _everywhere(self) -> npt.NDArray[np.bool_]:
        return np.ones(self.num_envs, np.bool_)

    def _need_reset(self, what: str) -> None:
        if not self.batch.begun:
            raise ResetNeededError(f"{what} before the first reset: call reset first")

    def _reset_seeds(self, seed: int | Sequence[int | None] | None) -> npt.NDArray[np.uint64]:
        if isinstance(seed, Sequence | np.ndarray) and not isinstance(seed, str | bytes):
            if len(seed) != self.num_envs:
                raise ArgumentError(
                    f"seed has {len(seed)} entries: "
                    f"must have one for each of {self.num_envs} missions"
                )
            own = [
                None if one is None else seed_of(f"seed[{place}]", one)
                for place, one in enumerate(seed)
            ]
            drawn = self.np_random.integers(0, 2**64, self.num_envs, dtype=np.uint64)
            return np.array(
                [int(other) if one is None else one for one, other in zip(own, drawn, strict=True)],
                np.uint64,
            )
        if seed is None:
            return self.np_random.integers(0, 2**64, self.num_envs, dtype=np.uint64)
        first = seed_of("seed", seed)
        super().reset(seed=first)
        return np.uint64(first) + np.arange(self.num_envs, dtype=np.uint64)


def _check_autoreset(mode: AutoresetMode | str) -> AutoresetMode:
    try:
        return AutoresetMode(mode)
    except ValueError:
        allowed = ", ".join(known.value for known in AutoresetMode)
        raise ConfigError(f"autoreset_mode = {shown(mode)}: must be one of {allowed}") from None


def _check_threads(threads: int | None) -> int:
    if threads is None:
        return min(os.cpu_count() or 1, THREADS_MAX)
    return whole("threads", threads, 1, THREADS_MAX)


@shows_fields
def make_vec(
    config: ConfigLike = None,
    num_envs: int = 1,
    *,
    action_space: ActionSpaceKind = "box",
    credit: Credit = "team",
    threads: int | None = 1,
    autoreset_mode: AutoresetMode | str = AutoresetMode.NEXT_STEP,
    global_state: bool = False,
    copy: bool = True,
    buffer_sets: int = 2,
    render_mode: str | None = None,
    **fields: Unpack[Fields],
) -> FleetVectorEnv:
    """Make a Gymnasium vector environment of `num_envs` fleets.

    Args:
        config: a preset's name, a TOML or JSON file, a mapping, or a `jcas.Config`. None stands
            for the preset `mission`.
        num_envs: the number of missions, M.
        action_space: `box` (u_dir, u_pilot), or the hybrids `dict` and `tuple` of (motion, pilot).
            Hybrid actions have a discrete motion and a continuous pilot density.
        credit: with `uav`, `infos["uav_rewards"]` holds each UAV's own reward, [M, N]. Their mean
            is the team's reward.
        threads: threads that step missions, 1 to 256. None stands for one for each core. Results
            do not depend on the number.
        autoreset_mode: `NextStep`, `SameStep` or `Disabled`. `NextStep` is Gymnasium's default.
            `SameStep` is the fastest if episodes are short.
        global_state: whether the infos hold the global state. A centralised critic reads it.
        copy: whether each step returns new arrays. False gives views of the kernel's buffers.
        buffer_sets: sets of buffers that alternate with `copy=False`. With 2, the arrays of a step
            keep their values through the next step. With 1 they do not, which is 3 to 5 % faster.
        render_mode: `rgb_array` or None.
        **fields: configuration fields that replace those of `config`; `jcas.Config.fields()` lists
            them.

    """
    return FleetVectorEnv(
        config,
        num_envs,
        action_space=action_space,
        credit=credit,
        threads=threads,
        autoreset_mode=autoreset_mode,
        global_state=global_state,
        copy=copy,
        buffer_sets=buffer_sets,
        render_mode=render_mode,
        **fields,
    )
