"""Reinforcement-learning environments of UAV fleets that sense and communicate with one waveform.

- `parallel_env`: PettingZoo, one agent for each UAV;
- `FleetEnv` (`gymnasium.make("jcas:jcas/Fleet-v0")`): one joint action for the fleet;
- `make_vec`: many fleets stepped by one call;
- `Sim`: the simulation itself, with every quantity, snapshots and forks;
- `Policy`: trained fleets and baselines that fly it;
- `Plan`: trajectories of least expected time, and a bound on it;
- `jcas.rllib`: the paper's training pipeline on Ray.
"""

from . import registration as _registration
from ._library import lib as _lib
from .batch import Batch, BatchBuffers
from .config import Config, ConfigLike
from .errors import (
    ActionError,
    ArgumentError,
    BusyError,
    ConfigError,
    EpisodeOverError,
    JcasError,
    MissingDependencyError,
    MissingFileError,
    PlanError,
    PolicyError,
    ResetNeededError,
    SnapshotError,
    TraceError,
    UnknownFieldError,
)
from .fleet import FleetEnv
from .flown import Policy
from .futures import Futures
from .model import Model
from .parallel import JcasEnv, JcasParallelEnv, env, parallel_env
from .plan import Plan
from .policy import Layer, MlpPolicy, trained_on
from .sim import REWARD_NAMES, Sim, StepOutcome
from .spaces import MOTIONS
from .trace import Recorder, Trace, replay_trace, run_episode
from .vector import FleetVectorEnv, make_vec

__all__ = [
    "MOTIONS",
    "REWARD_NAMES",
    "ActionError",
    "ArgumentError",
    "Batch",
    "BatchBuffers",
    "BusyError",
    "Config",
    "ConfigError",
    "ConfigLike",
    "EpisodeOverError",
    "FleetEnv",
    "FleetVectorEnv",
    "Futures",
    "JcasEnv",
    "JcasError",
    "JcasParallelEnv",
    "Layer",
    "MissingDependencyError",
    "MissingFileError",
    "MlpPolicy",
    "Model",
    "Plan",
    "PlanError",
    "Policy",
    "PolicyError",
    "Recorder",
    "ResetNeededError",
    "Sim",
    "SnapshotError",
    "StepOutcome",
    "Trace",
    "TraceError",
    "UnknownFieldError",
    "__version__",
    "env",
    "make_vec",
    "parallel_env",
    "replay_trace",
    "run_episode",
    "trained_on",
]

__version__: str = _lib.jcas_version().decode()
"""The kernel's version, which is the package's."""

_registration.register()
