"""Stable-Baselines3 over the batch call: every UAV of every mission is one of its environments.

All UAVs share one policy, as in the paper. Stable-Baselines3 sees M · N environments. Those of one
mission end together and receive the same reward.
"""

from __future__ import annotations

import copy
from collections.abc import Sequence
from typing import Any, Literal

import numpy as np
import numpy.typing as npt
from gymnasium.vector import AutoresetMode
from typing_extensions import Unpack

from ._fields import Fields
from .arguments import shown
from .config import ConfigLike
from .errors import ActionError, ArgumentError, MissingDependencyError
from .signature import shows_fields
from .sim import EPISODE_INFO
from .spaces import Credit
from .vector import Seeding, make_vec

try:
    from stable_baselines3.common.vec_env import VecEnv
except ImportError as error:
    raise MissingDependencyError("stable-baselines3", "jcas.sb3", "sb3") from error


class FleetVecEnv(VecEnv):
    """M missions of N UAVs as a Stable-Baselines3 vector environment of M · N members.

    Args:
        config: a preset's name, a TOML or JSON file, a mapping, or a `jcas.Config`. None stands
            for the preset `mission`.
        missions: the number of missions, M.
        action_space: `box`, or `discrete` for algorithms such as DQN; MaskablePPO finds the masks.
        pilot_levels: pilot densities of `discrete`, evenly spaced.
        credit: with `team` each member receives its team's reward. With `uav` it receives its own.
        seeding: `consecutive` or `derived`, as of `jcas.make_vec`.
        threads: threads that step missions, 1 to 256. None stands for one for each core.
        render_mode: `rgb_array` or None.
        **fields: configuration fields that replace those of `config`; `jcas.Config.fields()` lists
            them.

    """

    @shows_fields
    def __init__(
        self,
        config: ConfigLike = None,
        missions: int = 16,
        *,
        action_space: Literal["box", "discrete"] = "box",
        pilot_levels: int = 3,
        credit: Credit = "team",
        seeding: Seeding = "consecutive",
        threads: int | None = 1,
        render_mode: str | None = None,
        **fields: Unpack[Fields],
    ) -> None:
        if action_space not in ("box", "discrete"):
            raise ArgumentError(f"action_space = {shown(action_space)}: must be box or discrete")
        refused = {"autoreset_mode", "copy", "global_state"} & set(fields)
        if refused:
            name = sorted(refused)[0]
            raise ArgumentError(
                f"{name}: not to be chosen, because Stable-Baselines3 takes one way only"
            )
        mode = AutoresetMode.SAME_STEP
        self.envs = make_vec(
            config,
            missions,
            action_space=action_space,
            pilot_levels=pilot_levels,
            credit=credit,
            seeding=seeding,
            threads=threads,
            render_mode=render_mode,
            autoreset_mode=mode,
            **fields,
        )
        self.uavs = self.envs.model.uav_count
        self.render_mode = render_mode
        self._actions: npt.NDArray[np.float32] | None = None
        super().__init__(
            self.envs.num_envs * self.uavs,
            self.envs.model.observation_space(),
            self.envs._form.uav_space(),
        )

    def reset(self) -> npt.NDArray[np.float32]:
        """Begin an episode in every mission."""
        seed = self._seeds[0]
        self._reset_seeds()
        return self._rows(self.envs.reset(seed=seed)[0])

    def step_async(self, actions: npt.NDArray[np.float32]) -> None:
        """Take the actions of the coming step."""
        given = np.asarray(actions)
        if len(given) != self.num_envs:
            raise ActionError(f"actions: the length is {len(given)}, must be {self.num_envs}")
        self._actions = given.reshape(self.envs.num_envs, self.uavs, *given.shape[1:])

    def step_wait(self) -> tuple[Any, Any, Any, list[dict[str, Any]]]:
        """Step every fleet. Ended episodes restart; the infos keep their last observations."""
        observations, rewards, terminated, truncated, infos = self.envs.step(self._actions)
        members: list[dict[str, Any]] = [{} for _ in range(self.num_envs)]
        ended = terminated | truncated
        for mission in np.flatnonzero(ended).tolist():
            metrics = {name: infos[name][mission].item() for name in EPISODE_INFO}
            episode = {"r": float(metrics["return_sum"]), "l": int(metrics["steps"]), "t": 0.0}
            for uav in range(self.uavs):
                members[mission * self.uavs + uav] = {
                    "terminal_observation": infos["final_obs"][mission, uav],
                    "TimeLimit.truncated": bool(truncated[mission]),
                    **metrics,
                    "episode": dict(episode),
                    "is_success": bool(terminated[mission]),
                }
        paid = (
            infos["uav_rewards"].reshape(-1)
            if "uav_rewards" in infos
            else np.repeat(rewards, self.uavs)
        )
        return self._rows(observations), paid, np.repeat(ended, self.uavs), members

    def close(self) -> None:
        """Release the missions."""
        self.envs.close()

    def get_images(self) -> list[npt.NDArray[np.uint8] | None]:
        """Draw the missions, one picture for each."""
        return list(self.envs.render() or ())

    def save(self) -> bytes:
        """Save the missions."""
        return self.envs.save()

    def load(self, snapshot: bytes) -> npt.NDArray[np.float32]:
        """Take up what `save` gave and return the observations."""
        return self._rows(self.envs.load(snapshot))

    def fork(self) -> FleetVecEnv:
        """Return an independent environment in the same state and with the same seeds to come."""
        return copy.deepcopy(self)

    def get_attr(self, attr_name: str, indices: Any = None) -> list[Any]:
        """Read an attribute of the missions, once for each member asked for."""
        if attr_name == "action_masks":  # MaskablePPO asks whether there are masks.
            return [self.action_masks] * len(self._chosen(indices))
        return [getattr(self.envs, attr_name)] * len(self._chosen(indices))

    def action_masks(self) -> npt.NDArray[np.bool_]:
        """Which discrete actions make a difference, [M * N, 5 levels]."""
        if self.envs._form.kind != "discrete":
            raise AttributeError("action_masks: there are none without action_space='discrete'")
        return self.envs._form.mask(self._seen).astype(bool).reshape(self.num_envs, -1)

    def set_attr(self, attr_name: str, value: Any, indices: Any = None) -> None:
        """Refuse: members of a batch have no attributes of their own."""
        raise AttributeError(f"{attr_name}: the members of a batch cannot be changed one by one")

    def env_method(
        self, method_name: str, *method_args: Any, indices: Any = None, **method_kwargs: Any
    ) -> list[Any]:
        """Call a method of the missions, once for each member asked for."""
        if method_name == "action_masks":
            return list(self.action_masks()[self._chosen(indices)])
        return [
            getattr(self.envs, method_name)(*method_args, **method_kwargs)
            for _ in self._chosen(indices)
        ]

    def env_is_wrapped(self, wrapper_class: Any, indices: Any = None) -> list[bool]:
        """Members are never wrapped."""
        return [False] * len(self._chosen(indices))

    def _rows(self, observations: npt.NDArray[np.float32]) -> npt.NDArray[np.float32]:
        self._seen = observations
        return observations.reshape(self.num_envs, -1)

    def _chosen(self, indices: Any) -> Sequence[int]:
        return list(self._get_indices(indices))
