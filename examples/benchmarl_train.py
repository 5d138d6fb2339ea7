"""Trains a fleet with an algorithm of BenchMARL.

pip install "./python[benchmarl]"
python examples/benchmarl_train.py Mappo --uavs 5 --hotspots 3
"""

import argparse

from benchmarl import algorithms
from benchmarl.experiment import Experiment, ExperimentConfig
from benchmarl.models.mlp import MlpConfig

from jcas.benchmarl import FleetTask


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("algorithm", choices=["Mappo", "Ippo", "Qmix", "Vdn", "Iql", "Masac"])
    parser.add_argument("--uavs", type=int, default=5)
    parser.add_argument("--hotspots", type=int, default=3)
    parser.add_argument("--frames", type=int, default=1_000_000, help="environment steps")
    options = parser.parse_args()

    config = ExperimentConfig.get_from_yaml()
    config.loggers, config.max_n_frames, config.render = ["csv"], options.frames, False
    config.on_policy_n_envs_per_worker = config.off_policy_n_envs_per_worker = 64
    fields = {"uav_count": options.uavs, "hotspot_count": options.hotspots}
    Experiment(
        task=FleetTask("mission", fields),
        algorithm_config=getattr(algorithms, f"{options.algorithm}Config").get_from_yaml(),
        model_config=MlpConfig.get_from_yaml(),
        critic_model_config=MlpConfig.get_from_yaml(),
        seed=1,
        config=config,
    ).run()


if __name__ == "__main__":
    main()
