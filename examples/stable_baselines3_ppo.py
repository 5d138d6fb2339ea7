"""Trains a shared policy with Stable-Baselines3's PPO and flies it.

pip install "./python[sb3]"
python examples/stable_baselines3_ppo.py --steps 250000
"""

import argparse

import torch
from stable_baselines3 import PPO

import jcas
from jcas.evaluation import evaluate
from jcas.sb3 import FleetVecEnv


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument(
        "--steps", type=int, default=250_000, help="steps of a mission, summed over missions"
    )
    parser.add_argument("--missions", type=int, default=32, help="missions side by side")
    parser.add_argument("--uavs", type=int, default=10)
    parser.add_argument("--hotspots", type=int, default=5)
    parser.add_argument("--episodes", type=int, default=100, help="missions of the evaluation")
    options = parser.parse_args()

    config = jcas.Config(uav_count=options.uavs, hotspot_count=options.hotspots)
    envs = FleetVecEnv(config, options.missions)
    model = PPO(
        "MlpPolicy",
        envs,
        learning_rate=3e-4,
        n_steps=128,
        batch_size=4096,
        n_epochs=10,
        gamma=0.95,
        policy_kwargs={"net_arch": [512, 256, 128], "activation_fn": torch.nn.ReLU},
        seed=1,
        verbose=1,
    )
    # Stable-Baselines3 counts a step for every UAV.
    model.learn(options.steps * options.uavs)

    def act(observations):
        missions, uavs, width = observations.shape
        actions, _ = model.predict(observations.reshape(-1, width), deterministic=True)
        return actions.reshape(missions, uavs, 2)

    print(
        evaluate(act, jcas.Model(config), episodes=options.episodes, policy="stable-baselines3 PPO")
    )


if __name__ == "__main__":
    main()
