"""PPO with the paper's settings, as an RLlib configuration."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from ray.rllib.algorithms.ppo import PPOConfig
from ray.rllib.callbacks.callbacks import RLlibCallback
from ray.rllib.core.rl_module.multi_rl_module import MultiRLModuleSpec
from ray.rllib.core.rl_module.rl_module import RLModuleSpec

from ..config import Config
from ..spaces import check_credit
from .env import SHARED_POLICY, JcasMultiAgentEnv
from .module import PAPER_HIDDEN, CentralCriticModule, check_critic


@dataclass(frozen=True)
class Hyperparameters:
    """PPO settings. The defaults are the paper's, or where it gives none RLlib's or common ones."""

    discount: float = 0.95
    learning_rate: float = 3e-4
    batch_steps: int = 4096
    """Environment steps of one iteration; each holds a sample of every UAV."""
    epochs: int = 10
    minibatch_samples: int = 4096
    gae_lambda: float = 0.95
    clip: float = 0.2
    entropy_weight: float = 0.0
    value_weight: float = 0.5
    gradient_norm_max: float = 0.5
    hidden: tuple[int, ...] = PAPER_HIDDEN
    credit: str = "team"
    """Whose reward a UAV learns from: the `team`'s, or with `uav` its own."""
    critic: str = "state"
    """What the critic sees: the global `state`, or as well what the `agent` observes."""


PAPER = Hyperparameters()

METRIC_OF = {"team_return": "return_sum", "success": "success", "mission_steps": "steps"}
"""Names in RLlib's results, and the metrics of an episode behind them. Means over 100 missions."""


def ppo_config(
    config: Config,
    hyperparameters: Hyperparameters = PAPER,
    *,
    env_runners: int = 2,
    envs_per_runner: int = 4,
    seed: int | None = None,
) -> PPOConfig:
    """Describe the training run to RLlib.

    Env runners that die are started again, on whichever node has room, and the run goes on
    meanwhile.
    """
    settings = {
        "hidden": list(hyperparameters.hidden),
        "critic": check_critic(hyperparameters.critic),
    }
    module = RLModuleSpec(module_class=CentralCriticModule, model_config=settings)
    fields: dict[str, Any] = {
        **config,
        "credit": check_credit(hyperparameters.credit),
        "seed": 0 if seed is None else seed,
    }
    return (
        PPOConfig()
        .environment(JcasMultiAgentEnv, env_config=fields)
        .env_runners(
            num_env_runners=env_runners,
            num_envs_per_env_runner=envs_per_runner,
            num_cpus_per_env_runner=1,
            rollout_fragment_length="auto",
        )
        .learners(num_learners=0)
        .multi_agent(policies={SHARED_POLICY}, policy_mapping_fn=_share)
        .rl_module(rl_module_spec=MultiRLModuleSpec(rl_module_specs={SHARED_POLICY: module}))
        .training(
            gamma=hyperparameters.discount,
            lr=hyperparameters.learning_rate,
            lambda_=hyperparameters.gae_lambda,
            clip_param=hyperparameters.clip,
            entropy_coeff=hyperparameters.entropy_weight,
            vf_loss_coeff=hyperparameters.value_weight,
            vf_clip_param=float("inf"),
            use_kl_loss=False,
            grad_clip=hyperparameters.gradient_norm_max,
            grad_clip_by="global_norm",
            train_batch_size_per_learner=hyperparameters.batch_steps,
            minibatch_size=hyperparameters.minibatch_samples,
            num_epochs=hyperparameters.epochs,
        )
        .fault_tolerance(restart_failed_env_runners=True, env_runner_health_probe_timeout_s=10)
        .callbacks(MissionMetrics)
        .debugging(seed=seed, log_level="ERROR")
    )


class MissionMetrics(RLlibCallback):
    """Logs what missions came to: the team's return, success, and mission time."""

    def on_episode_end(self, *, episode: Any, metrics_logger: Any, **_: Any) -> None:
        """Take the metrics that the environment left in the last info."""
        agent = next(iter(episode.agent_episodes.values()))
        metrics = agent.get_infos(-1)
        for name, metric in METRIC_OF.items():
            metrics_logger.log_value(name, float(metrics[metric]), reduce="mean", window=100)


def _share(agent: str, episode: Any, **_: Any) -> str:
    del agent, episode
    return SHARED_POLICY
