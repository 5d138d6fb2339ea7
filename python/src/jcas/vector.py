"""The Gymnasium vector environment: many fleets, stepped by one call of the kernel."""

from __future__ import annotations

import os
from collections.abc import Sequence
from typing import Any

import numpy as np
import numpy.typing as npt
from gymnasium.vector import AutoresetMode, VectorEnv
from gymnasium.vector.utils import batch_space

from .batch import Batch, BatchBuffers
from .config import Config, ConfigLike
from .errors import ConfigError
from .model import Model
from .sim import Sim
from .spaces import ActionSpaceKind, check_kind, encode_fleet_action, fleet_action_space

Array = npt.NDArray[Any]


class FleetVectorEnv(VectorEnv[Array, Any, Array]):
    """M missions side by side. Each sub-environment is a whole fleet. Made by :func:`make_vec`.

    A sub-environment's observation is [N, observation length], its action [N, 2]; rewards, terminations
    and truncations are the team's, one for each mission, so their arrays have the shape [M].

    The arrays that :meth:`reset` and :meth:`step` return are the ones that the kernel wrote. There are two
    sets of them, used in turn: what a step returned stays as it is until the step after the next. Give
    `copy=True` for arrays that nobody writes to again.
    """

    def __init__(
        self,
        config: ConfigLike = None,
        num_envs: int = 1,
        *,
        action_space: ActionSpaceKind = "box",
        threads: int | None = 1,
        autoreset_mode: AutoresetMode | str = AutoresetMode.SAME_STEP,
        global_state: bool = False,
        copy: bool = False,
        render_mode: str | None = None,
        **fields: Any,
    ) -> None:
        if num_envs < 1:
            raise ConfigError(f"num_envs = {num_envs}: must be at least 1")
        if render_mode not in (None, "rgb_array"):
            raise ConfigError(f"render_mode = {render_mode!r}: must be 'rgb_array' or None")
        self._kind = check_kind(action_space)
        self._autoreset = _check_autoreset(autoreset_mode)
        self.metadata = {"autoreset_mode": self._autoreset, "render_modes": ["rgb_array"], "render_fps": 8}
        self.render_mode = render_mode
        self.num_envs = num_envs
        self.model = Model(Config(config, **fields))
        self.batch = Batch(self.model, num_envs, threads=threads or os.cpu_count() or 1)
        uavs = self.model.uav_count
        self.single_observation_space = self.model.observation_space(uavs)
        self.single_action_space = fleet_action_space(self._kind, uavs)
        self.observation_space = batch_space(self.single_observation_space, num_envs)
        self.action_space = batch_space(self.single_action_space, num_envs)
        self._action_shape = (num_envs, uavs, 2)
        self._copy = copy
        self._buffers = [BatchBuffers(self.model, num_envs, global_state) for _ in range(2)]
        self._turn = 0
        self._everywhere = np.ones(num_envs, dtype=np.bool_)

    def reset(
        self, *, seed: int | Sequence[int | None] | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Array, dict[str, Any]]:
        """Begin an episode in every sub-environment, or in those of `options["reset_mask"]`.

        Sub-environment m gets the seed `seed + m`, as in Gymnasium's own vector environments, or the m-th
        of a list. Without a seed, the next ones of the stream that the last seed began.
        """
        seeds = self._reset_seeds(seed)
        mask = (options or {}).get("reset_mask")
        buffers = self._next_buffers()
        if mask is None:
            self.batch.reset(seeds, buffers)
        else:
            mask = np.asarray(mask, dtype=np.bool_)
            if mask.shape != (self.num_envs,):
                raise ConfigError(f"reset_mask has shape {mask.shape}: must be ({self.num_envs},)")
            for member in np.flatnonzero(mask).tolist():
                self.batch.set_member(member, Sim(self.model, int(seeds[member])))
            self.batch.observe(buffers)
        infos: dict[str, Any] = {}
        if buffers.global_state is not None:
            infos["global_state"] = self._given(buffers.global_state)
            infos["_global_state"] = self._everywhere
        return self._given(buffers.observations), infos

    def step(self, actions: Any) -> tuple[Array, Array, Array, Array, dict[str, Any]]:
        """Step every fleet.

        `infos["reward_components"]` is [M, 12], in the order of :data:`jcas.REWARD_NAMES`. Where an episode
        ended, `infos["final_obs"]` and `infos["final_info"]` hold its last observation and its metrics, and
        `infos["_final_obs"]` says where that is. With `global_state=True`, `infos["global_state"]` is the
        critic's view, [M, global length].
        """
        encoded = encode_fleet_action(self._kind, actions, self._action_shape)
        buffers = self._next_buffers()
        self.batch.step(encoded, buffers, auto_reset=self._autoreset is AutoresetMode.SAME_STEP)
        given = self._given
        return (
            given(buffers.observations),
            given(buffers.rewards),
            given(buffers.terminated),
            given(buffers.truncated),
            self._infos(buffers),
        )

    def render(self) -> tuple[npt.NDArray[np.uint8], ...] | None:
        """Draw every sub-environment."""
        if self.render_mode is None:
            return None
        from .render import draw

        return tuple(draw(self.batch.member(member).scene()) for member in range(self.num_envs))

    def _infos(self, buffers: BatchBuffers) -> dict[str, Any]:
        given, everywhere = self._given, self._everywhere
        infos: dict[str, Any] = {
            "reward_components": given(buffers.reward_components),
            "_reward_components": everywhere,
        }
        if buffers.global_state is not None:
            infos["global_state"] = given(buffers.global_state)
            infos["_global_state"] = everywhere
        ended = buffers.terminated | buffers.truncated
        if ended.any():
            infos["final_info"] = {"metrics": buffers.final_metrics_by_name(ended), "_metrics": ended}
            infos["_final_info"] = ended
            if self._autoreset is AutoresetMode.SAME_STEP:
                infos["final_obs"] = given(buffers.final_observations)
                infos["_final_obs"] = ended
                if buffers.final_global_state is not None:
                    infos["final_global_state"] = given(buffers.final_global_state)
                    infos["_final_global_state"] = ended
        return infos

    def _next_buffers(self) -> BatchBuffers:
        self._turn ^= 1
        return self._buffers[self._turn]

    def _given(self, array: Array) -> Array:
        return array.copy() if self._copy else array

    def _reset_seeds(self, seed: int | Sequence[int | None] | None) -> npt.NDArray[np.uint64]:
        if isinstance(seed, Sequence | np.ndarray):
            if len(seed) != self.num_envs:
                raise ConfigError(f"seed has {len(seed)} entries: must have one for each of {self.num_envs}")
            drawn = self.np_random.integers(0, 2**64, self.num_envs, dtype=np.uint64)
            chosen = [own if own is not None else int(other) for own, other in zip(seed, drawn, strict=True)]
            return np.array([int(own) for own in chosen], dtype=np.uint64)
        super().reset(seed=seed)
        if seed is None:
            return self.np_random.integers(0, 2**64, self.num_envs, dtype=np.uint64)
        return np.uint64(seed) + np.arange(self.num_envs, dtype=np.uint64)


def _check_autoreset(mode: AutoresetMode | str) -> AutoresetMode:
    try:
        chosen = AutoresetMode(mode)
    except ValueError:
        chosen = None
    if chosen not in (AutoresetMode.SAME_STEP, AutoresetMode.DISABLED):
        raise ConfigError(f"autoreset_mode = {mode}: must be SameStep or Disabled")
    return chosen


def make_vec(config: ConfigLike = None, num_envs: int = 1, **options: Any) -> FleetVectorEnv:
    """Make a Gymnasium vector environment of `num_envs` fleets.

    Args:
        config: a preset's name, a TOML or JSON file, a mapping, or a :class:`~jcas.Config`.
        num_envs: how many missions fly side by side.
        **options: `action_space` (`box`, `dict`, `tuple`), `threads` (None: all cores), `autoreset_mode`
            (`SameStep`, the default, or `Disabled`), `global_state`, `copy`, `render_mode`; anything else is
            a configuration field.

    """
    return FleetVectorEnv(config, num_envs, **options)
