"""A task for BenchMARL: MAPPO, IPPO, QMIX and its other algorithms train a fleet.

task = jcas.benchmarl.FleetTask("paper", {"config": "paper", "uav_count": 5})
Experiment(task=task, algorithm_config=MappoConfig.get_from_yaml(), ...).run()
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from .errors import MissingDependencyError

try:
    from benchmarl.environments.common import TaskClass
except ImportError as error:
    raise MissingDependencyError("benchmarl", "jcas.benchmarl", "benchmarl") from error

from .torchrl import GROUP, JcasVecEnv


class FleetTask(TaskClass):
    """A mission as a BenchMARL task. Continuous actions are `box`, discrete ones `discrete`.

    Args:
        name: of the task in logs.
        config: the arguments of `jcas.torchrl.JcasVecEnv`: `config`, `pilot_levels`, `credit`, and
            fields of the configuration.

    """

    def get_env_fun(
        self, num_envs: int, continuous_actions: bool, seed: int | None, device: Any
    ) -> Callable[[], JcasVecEnv]:
        """Return what makes the batched environment."""
        kind: Any = "box" if continuous_actions else "discrete"
        return lambda: JcasVecEnv(
            num_envs=num_envs, action_space=kind, seed=seed, device=device, **self.config
        )

    def supports_continuous_actions(self) -> bool:
        """Both kinds of actions are there."""
        return True

    def supports_discrete_actions(self) -> bool:
        """Both kinds of actions are there."""
        return True

    def has_render(self, env: Any) -> bool:
        """Pictures are drawn only on request."""
        return False

    def max_steps(self, env: Any) -> int:
        """Return the horizon."""
        return int(env.model.config["horizon_steps"])

    def group_map(self, env: Any) -> dict[str, list[str]]:
        """Put all UAVs in one group."""
        return dict(env.group_map)

    def observation_spec(self, env: Any) -> Any:
        """Describe what a UAV observes."""
        spec = env.full_observation_spec_unbatched.clone()
        del spec["state"], spec["info"]
        if "action_mask" in spec[GROUP].keys():
            del spec[GROUP, "action_mask"]
        return spec

    def info_spec(self, env: Any) -> None:
        """The metrics belong to the team and not to a group; `log_info` reads them."""

    def state_spec(self, env: Any) -> Any:
        """Describe what a centralised critic or mixer sees."""
        spec = env.full_observation_spec_unbatched.clone()
        del spec[GROUP], spec["info"]
        return spec

    def action_spec(self, env: Any) -> Any:
        """Describe the actions."""
        return env.full_action_spec_unbatched

    def action_mask_spec(self, env: Any) -> Any:
        """Describe the masks of discrete actions."""
        spec = env.full_observation_spec_unbatched.clone()
        if "action_mask" not in spec[GROUP].keys():
            return None
        del spec["state"], spec["info"], spec[GROUP, "observation"]
        return spec

    @staticmethod
    def env_name() -> str:
        """Return the name under which BenchMARL logs."""
        return "jcas"

    @staticmethod
    def log_info(batch: Any) -> dict[str, float]:
        """Log the success rate and the steps of the episodes that ended in a batch."""
        ended = batch["next", "done"].squeeze(-1)
        if not ended.any():
            return {}
        info = batch["next", "info"]
        return {
            f"{name} of episodes": info[name][ended].double().mean().item()
            for name in ("success", "steps", "confirmed")
        }
