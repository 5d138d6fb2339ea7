"""TorchRL over the batch call: M fleets are one environment of batch size [M].

env = jcas.torchrl.JcasVecEnv("paper", num_envs=64)
task = jcas.torchrl.FleetTask("paper", {"config": "paper"})     # for benchmarl.experiment
"""

from __future__ import annotations

from typing import Any, cast

import numpy as np
import numpy.typing as npt
from typing_extensions import Unpack

from ._fields import Fields
from .arguments import seed_of, whole
from .batch import ENVS_MAX, Batch, BatchBuffers
from .config import Config, ConfigLike
from .errors import MissingDependencyError
from .model import Model, derive_seed
from .signature import shows_fields
from .sim import EPISODE_INFO
from .spaces import ActionForm, ActionSpaceKind, Credit, check_credit

try:
    import torch
    from tensordict import TensorDict
    from torchrl.data import Binary, Bounded, Categorical, Composite, Unbounded
    from torchrl.envs import EnvBase
except ImportError as error:
    raise MissingDependencyError("torchrl", "jcas.torchrl", "torchrl") from error

GROUP = "uav"
"""The group of agents: every UAV of the fleet."""


class JcasVecEnv(EnvBase):
    """M fleets as a TorchRL environment, stepped by one call of the kernel.

    The group `uav` holds `observation` [M, N, length], `action`, `reward` [M, N, 1] and, with
    discrete actions, `action_mask`. `state` [M, length] is the critic's view. `info` holds the
    metrics of an episode that a step ended (`success`, `steps`, `confirmed`, ...), and zeros
    otherwise. Mission m begins with the m-th seed that is derived from the environment's seed.

    Args:
        config: a preset's name, a TOML or JSON file, a mapping, or a `jcas.Config`. None stands
            for the preset `mission`.
        num_envs: the number of missions, M.
        action_space: `box` (u_dir, u_pilot), or `discrete`: `motion * pilot_levels + level`.
        pilot_levels: pilot densities of `discrete`, evenly spaced.
        credit: with `team` each UAV receives the team's reward. With `uav` it receives its own.
        threads: threads that step missions, 1 to 256.
        seed: of the missions. None stands for any.
        device: where the tensors are. The kernel runs on the processor.
        **fields: configuration fields that replace those of `config`.

    """

    @shows_fields
    def __init__(
        self,
        config: ConfigLike = None,
        num_envs: int = 1,
        *,
        action_space: ActionSpaceKind = "box",
        pilot_levels: int = 3,
        credit: Credit = "team",
        threads: int = 1,
        seed: int | None = None,
        device: Any = "cpu",
        **fields: Unpack[Fields],
    ) -> None:
        missions = whole("num_envs", num_envs, 1, ENVS_MAX)
        super().__init__(device=device, batch_size=[missions])
        self.model = Model(Config(config, **fields))
        self.batch = Batch(self.model, missions, threads)
        self.group_map = {GROUP: [f"uav_{uav}" for uav in range(self.model.uav_count)]}
        self._form = ActionForm(self.model, action_space, pilot_levels)
        self._own = check_credit(credit) == "uav"
        self._out = BatchBuffers(self.model, missions, global_state=True, uav_rewards=self._own)
        self._shape = (missions, self.model.uav_count)
        self._make_specs()
        self._set_seed(int(torch.empty((), dtype=torch.int64).random_()) if seed is None else seed)

    def _make_specs(self) -> None:
        (missions, uavs), model = self._shape, self.model

        def bounded(space: Any, *leading: int) -> Bounded:
            low, high = (
                torch.as_tensor(end).expand(*leading, -1) for end in (space.low, space.high)
            )
            return Bounded(low.clone(), high.clone(), dtype=torch.float32)

        group: dict[str, Any] = {"observation": bounded(model.observation_space(), missions, uavs)}
        action: Any = Bounded(-1.0, 1.0, (missions, uavs, 2), dtype=torch.float32)
        if self._form.kind == "discrete":
            group["action_mask"] = Binary(
                shape=(missions, uavs, self._form.count), dtype=torch.bool
            )
            action = Categorical(self._form.count, (missions, uavs), dtype=torch.int64)
        kinds = {bool: torch.bool, int: torch.int64, float: torch.float64}
        info = {
            name: Unbounded((missions, 1), dtype=kinds[type(zero)])
            for name, zero in EPISODE_INFO.items()
        }
        batch, of_group = (missions,), (missions, uavs)
        self.observation_spec = Composite(
            {
                GROUP: Composite(group, shape=of_group),
                "state": bounded(model.global_space(), missions),
                "info": Composite(info, shape=batch),
            },
            shape=batch,
        )
        self.action_spec = Composite(
            {GROUP: Composite({"action": action}, shape=of_group)}, shape=batch
        )
        reward = Unbounded((missions, uavs, 1), dtype=torch.float32)
        self.reward_spec = Composite(
            {GROUP: Composite({"reward": reward}, shape=of_group)}, shape=batch
        )
        ends = ("done", "terminated", "truncated")
        self.done_spec = Composite(
            {name: Binary(shape=(missions, 1), dtype=torch.bool) for name in ends}, shape=batch
        )
        self.to(self.device)

    def _set_seed(self, seed: int | None) -> None:
        first = seed_of("seed", 0 if seed is None else seed)
        members = range(self._shape[0])
        self._next = np.array([derive_seed(first, member) for member in members], np.uint64)

    def _reset(self, tensordict: Any = None, **_: Any) -> Any:
        mask = None if tensordict is None else tensordict.get("_reset", None)
        chosen = np.ones(self._shape[0], np.bool_)
        if mask is not None and self.batch.begun:
            chosen = mask.cpu().numpy().reshape(-1)
            observed = [array.copy() for array in self._observed()]
        self._out.renew()
        if not chosen.all():
            for array, before in zip(self._observed(), observed, strict=True):
                array[:] = before
        self.batch.reset(self._next, self._out, None if chosen.all() else chosen)
        for member in np.flatnonzero(chosen).tolist():
            self._next[member] = derive_seed(int(self._next[member]), 0)
        return self._given(np.zeros(self._shape[0], np.bool_))

    def _step(self, tensordict: Any) -> Any:
        action = tensordict[GROUP, "action"].detach().cpu().numpy()
        buffers = self._out
        pairs = self._form.encode_fleet(action, (*self._shape, 2))
        buffers.renew()
        self.batch.step(pairs, buffers, auto_reset=False)
        ended = buffers.terminated | buffers.truncated
        out = self._given(ended)
        paid = buffers.uav_rewards if self._own else buffers.rewards[:, None]
        reward = torch.from_numpy(paid).expand(self._shape)[..., None]
        out.set((GROUP, "reward"), reward.to(self.device))
        for name, flags in (
            ("done", ended), ("terminated", buffers.terminated), ("truncated", buffers.truncated)
        ):  # fmt: skip
            out.set(name, torch.from_numpy(flags)[:, None].to(self.device))
        return out

    def _observed(self) -> tuple[npt.NDArray[Any], npt.NDArray[Any]]:
        return self._out.observations, self._out.global_state

    def _given(self, ended: npt.NDArray[np.bool_]) -> Any:
        rows, state = self._observed()
        group = {"observation": torch.from_numpy(rows)}
        if self._form.kind == "discrete":
            group["action_mask"] = torch.from_numpy(self._form.mask(rows)).bool()
        info = {
            name: torch.from_numpy(values)[:, None]
            for name, values in self._out.episode_info(ended).items()
        }
        missions = self._shape[:1]
        nested = {
            GROUP: TensorDict(cast(Any, group), self._shape),
            "state": torch.from_numpy(state),
            "info": TensorDict(cast(Any, info), missions),
        }
        return TensorDict(nested, missions).to(self.device)

    def render(self, **_: Any) -> npt.NDArray[np.uint8]:
        """Draw the first mission."""
        from .render import draw

        return draw(self.batch.member(0).scene())
