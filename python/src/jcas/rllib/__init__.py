"""The paper's training pipeline on Ray RLlib: PPO, one policy shared by all UAVs, a central critic.

`python -m jcas.rllib train` and `python -m jcas.rllib evaluate` are the commands; the pieces below
are for programs that build their own. Everything runs on one machine or on a Ray cluster.
"""

from ..errors import MissingDependencyError

try:
    import ray.rllib  # noqa: F401
    import torch  # noqa: F401
except ImportError as error:
    raise MissingDependencyError("ray[rllib] and torch", "jcas.rllib", "rllib") from error

from .algorithm import PAPER, Hyperparameters, ppo_config
from .env import SHARED_POLICY, JcasMultiAgentEnv
from .module import CentralCriticModule, export_policy

__all__ = [
    "PAPER",
    "SHARED_POLICY",
    "CentralCriticModule",
    "Hyperparameters",
    "JcasMultiAgentEnv",
    "export_policy",
    "ppo_config",
]
