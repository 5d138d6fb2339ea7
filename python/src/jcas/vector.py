"""The Gymnasium vector environment: many fleets, stepped by one call of the kernel."""

from __future__ import annotations

import copy as copying
import os
from collections.abc import Sequence
from functools import cache
from typing import Any, Literal, get_args

import numpy as np
import numpy.typing as npt
from gymnasium.vector import AutoresetMode, VectorEnv
from gymnasium.vector.utils import batch_space
from typing_extensions import Unpack

from ._fields import Fields
from .arguments import flags, options_of, seed_of, shown, whole
from .batch import ENVS_MAX, THREADS_MAX, Batch, BatchBuffers
from .config import Config, ConfigLike
from .errors import ArgumentError, ConfigError, ResetNeededError
from .in_use import Mark
from .model import Model, derive_seed
from .signature import shows_fields, takes_what
from .spaces import ActionForm, ActionSpaceKind, Credit, check_credit

Array = npt.NDArray[Any]
Seeding = Literal["consecutive", "derived"]


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
        pilot_levels: int = 3,
        credit: Credit = "team",
        seeding: Seeding = "consecutive",
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
        if seeding not in get_args(Seeding):
            raise ConfigError(f"seeding = {shown(seeding)}: must be consecutive or derived")
        self._seeding = seeding
        self._autoreset = _check_autoreset(autoreset_mode)
        self.autoreset_mode = self._autoreset  # As Gymnasium's own vector environments name it.
        self.metadata = {
            "autoreset_mode": self._autoreset,
            "render_modes": ["rgb_array"],
            "render_fps": 8,
        }
        self.render_mode = render_mode
        self.model = Model(Config(config, **fields))
        self._form = ActionForm(self.model, action_space, pilot_levels)
        self.batch = Batch(self.model, self.num_envs, threads=_check_threads(threads))
        uavs = self.model.uav_count
        self.single_observation_space = self.model.observation_space(uavs)
        self.single_action_space = self._form.fleet_space(uavs)
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
        self._seeds = np.zeros(self.num_envs, np.uint64)

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

        Sub-environment m gets the m-th seed of a list, or of one seed `seed + m` (after 2^64 - 1
        comes 0), as in Gymnasium's own vector environments. With `seeding="derived"` it gets a seed
        derived from `seed` and m, so that neighbouring seeds share no episode. Without a seed
        follows the episode that each would have begun by itself.
        """
        mask = options_of(options, "reset_mask").get("reset_mask")
        chosen = None if mask is None else flags("reset_mask", mask, self.num_envs)
        with self._in_use:
            return self._reset(seed, chosen)

    def step(self, actions: Any) -> tuple[Array, Array, Array, Array, dict[str, Any]]:
        """Step every fleet.

        The infos have the same keys at every step. `reward_components` is [M, 12], in the order of
        `jcas.REWARD_NAMES`. The metrics of an episode that the step ended (`success`, `steps`,
        `confirmed`, ...) are [M]; elsewhere they are 0. With `SameStep`, `final_obs` holds the last
        observation of ended episodes, and `_final_obs` marks them. With `NextStep`, the step after
        ignores the ended fleet's action, begins its next episode and gives a reward of 0. With
        `global_state=True`, `global_state` is the critic's view, [M, global length].
        """
        encoded = self._form.encode_fleet(actions, self._action_shape)
        self._need_reset("step")
        with self._in_use:
            buffers = self._next_buffers()
            if self._autoreset is AutoresetMode.NEXT_STEP and self._ended.any():
                self._step_and_begin(encoded, buffers)
            else:
                at_once = self._autoreset is AutoresetMode.SAME_STEP
                self.batch.step(encoded, buffers, auto_reset=at_once)
            self._ended = buffers.terminated | buffers.truncated
            if self._autoreset is AutoresetMode.SAME_STEP:
                self._follow(self._ended)
            return (
                buffers.observations,
                buffers.rewards,
                buffers.terminated,
                buffers.truncated,
                self._infos(buffers, self._ended),
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
            self._seeds = np.array([sim.seed for sim in members], np.uint64)
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
            self._seeds = seeds
        else:
            self._need_reset("reset_mask")
            self.batch.observe(buffers)
            self.batch.reset(seeds, buffers, chosen)
            self._ended &= ~chosen
            self._seeds = np.where(chosen, seeds, self._seeds)
        buffers.forget_rewards(np.ones(self.num_envs, np.bool_))
        self.closed = False
        return buffers.observations, self._infos(buffers, np.zeros(self.num_envs, np.bool_))

    def _step_and_begin(self, encoded: npt.NDArray[np.float32], buffers: BatchBuffers) -> None:
        """Step the fleets that fly, and begin the next episode of those that ended a step ago.

        The kernel steps all fleets or none. So the ended ones are reset, stepped along and reset
        again.
        """
        waiting = self._ended.copy()
        moving = encoded.copy()
        moving[waiting] = 0
        self.batch.check_numbers(moving)
        self._follow(waiting)
        self.batch.reset(self._seeds, buffers, waiting)
        self.batch.step(moving, buffers, auto_reset=False)
        self.batch.reset(self._seeds, buffers, waiting)
        buffers.forget_rewards(waiting)

    def _follow(self, chosen: npt.NDArray[np.bool_]) -> None:
        """Take the seeds of the episodes that follow, as the kernel derives them."""
        for member in np.flatnonzero(chosen).tolist():
            self._seeds[member] = derive_seed(int(self._seeds[member]), 0)

    def _infos(self, buffers: BatchBuffers, ended: npt.NDArray[np.bool_]) -> dict[str, Any]:
        infos: dict[str, Any] = {
            "reward_components": buffers.reward_components,
            **buffers.episode_info(ended),
        }
        if buffers.uav_rewards is not None:
            infos["uav_rewards"] = buffers.uav_rewards
        if buffers.global_state is not None:
            infos["global_state"] = buffers.global_state
        if self._form.kind == "discrete":
            infos["action_mask"] = self._form.mask(buffers.observations)
        everywhere = np.ones(self.num_envs, np.bool_)
        infos.update(dict.fromkeys(_mask_names(tuple(infos)), everywhere))
        if self._autoreset is AutoresetMode.SAME_STEP and ended.any():
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

    def _need_reset(self, what: str) -> None:
        if self.closed or not self.batch.begun:
            raise ResetNeededError(
                f"{what} before the first reset, or after close: call reset first"
            )

    def _reset_seeds(self, seed: int | Sequence[int | None] | None) -> npt.NDArray[np.uint64]:
        if isinstance(seed, Sequence | np.ndarray) and not isinstance(seed, str | bytes):
            if len(seed) != self.num_envs:
                raise ArgumentError(
                    f"seed has {len(seed)} entries: "
                    f"must have one for each of {self.num_envs} missions"
                )
            following = self._following_seeds()
            return np.array(
                [
                    int(other) if one is None else seed_of(f"seed[{place}]", one)
                    for place, (one, other) in enumerate(zip(seed, following, strict=True))
                ],
                np.uint64,
            )
        if seed is None:
            return self._following_seeds()
        first = seed_of("seed", seed)
        super().reset(seed=first)
        members = range(self.num_envs)
        if self._seeding == "derived":
            return np.array([derive_seed(first, member) for member in members], np.uint64)
        return np.array([(first + member) % 2**64 for member in members], np.uint64)

    def _following_seeds(self) -> npt.NDArray[np.uint64]:
        """Give the seeds of the next episodes: any before the first reset."""
        if not self.batch.begun:
            return np.random.default_rng().integers(0, 2**64, self.num_envs, dtype=np.uint64)
        return np.array([derive_seed(int(seed), 0) for seed in self._seeds], np.uint64)


@cache
def _mask_names(names: tuple[str, ...]) -> tuple[str, ...]:
    return tuple(f"_{name}" for name in names)


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


@takes_what(FleetVectorEnv.__init__)
def make_vec(*arguments: Any, **options: Any) -> FleetVectorEnv:
    """Make a Gymnasium vector environment of `num_envs` fleets.

    Args:
        config: a preset's name, a TOML or JSON file, a mapping, or a `jcas.Config`. None stands
            for the preset `mission`.
        num_envs: the number of missions, M.
        action_space: `box` (u_dir, u_pilot), the hybrids `dict` and `tuple` of a discrete motion
            and a continuous pilot density, or `discrete`: `motion * pilot_levels + level`. The
            infos then hold an `action_mask`, [M, N, 5 levels].
        pilot_levels: pilot densities of `discrete`, evenly spaced.
        credit: with `uav`, `infos["uav_rewards"]` holds each UAV's own reward, [M, N]. Their mean
            is the team's reward.
        seeding: how the missions' seeds follow from one seed. `consecutive` is Gymnasium's way.
            With `derived`, neighbouring seeds share no episode.
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
    return FleetVectorEnv(*arguments, **options)
