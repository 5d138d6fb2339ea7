"""Fleets of UAVs that sense and communicate with one waveform, as environments for reinforcement learning.

- :func:`parallel_env`: PettingZoo, one agent for each UAV;
- :class:`FleetEnv` (`gymnasium.make("jcas/Fleet-v0")`): one joint action for the fleet;
- :func:`make_vec`: many fleets stepped by one call;
- :class:`Sim`: the simulation itself, with every quantity, snapshots and forks;
- :mod:`jcas.rllib`: the paper's training pipeline on Ray.
"""

import gymnasium as _gymnasium

from .batch import Batch, BatchBuffers
from .config import Config, ConfigLike
from .errors import (
    ActionError,
    ConfigError,
    EpisodeOverError,
    JcasError,
    MissingDependencyError,
    PolicyError,
    SnapshotError,
    TraceError,
)
from .fleet import FleetEnv
from .model import Model
from .parallel import JcasParallelEnv, env, parallel_env
from .policy import MlpPolicy, load_policy
from .sim import REWARD_NAMES, Sim, StepOutcome
from .spaces import MOTIONS
from .trace import Trace, replay_trace
from .vector import FleetVectorEnv, make_vec

__all__ = [
    "MOTIONS",
    "REWARD_NAMES",
    "ActionError",
    "Batch",
    "BatchBuffers",
    "Config",
    "ConfigError",
    "ConfigLike",
    "EpisodeOverError",
    "FleetEnv",
    "FleetVectorEnv",
    "JcasError",
    "JcasParallelEnv",
    "MissingDependencyError",
    "MlpPolicy",
    "Model",
    "PolicyError",
    "Sim",
    "SnapshotError",
    "StepOutcome",
    "Trace",
    "TraceError",
    "env",
    "load_policy",
    "make_vec",
    "parallel_env",
    "replay_trace",
]

_gymnasium.register(
    id="jcas/Fleet-v0", entry_point="jcas.fleet:FleetEnv", vector_entry_point="jcas.vector:FleetVectorEnv"
)
