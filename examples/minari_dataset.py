"""Writes a Minari data set of a policy's episodes, for offline learners.

pip install "./python[minari]"
python examples/minari_dataset.py teams replan --id jcas/Paper-v0 --episodes 200
"""

import argparse

import gymnasium
import minari

import jcas
from jcas.model import derive_seed


def write(policy: str, env_id: str, episodes: int, seed: int = 1) -> minari.MinariDataset:
    """Record episodes; a baseline by its name, or a trained policy by its folder."""
    env = minari.DataCollector(gymnasium.make(env_id), record_infos=True)
    fleet = env.unwrapped
    if policy in jcas.Policy.names():
        acting = jcas.Policy.baseline(policy, fleet.model)
    else:
        acting = jcas.Policy.load(policy, fleet.model)
    for episode in range(episodes):
        env.reset(seed=derive_seed(seed, episode) % 2**63)
        over = False
        while not over:
            _, _, terminated, truncated, _ = env.step(acting.act(fleet.sim))
            over = terminated or truncated
    name = f"jcas/{env_id.split('/')[1].split('-')[0].lower()}-{acting.name}-v0"
    return env.create_dataset(
        name,
        eval_env=env_id,
        algorithm_name=acting.name,
        description=f"{episodes} episodes of {acting.name}, seed {seed}, jcas {jcas.__version__}",
    )


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("policies", nargs="+", help="baselines, or folders of trained policies")
    parser.add_argument("--id", default="jcas/Paper-v0", help="of the environment (%(default)s)")
    parser.add_argument("--episodes", type=int, default=200)
    options = parser.parse_args()
    for policy in options.policies:
        data = write(policy, options.id, options.episodes)
        print(f"{data.spec.dataset_id}: {data.total_episodes} episodes, {data.total_steps} steps")


if __name__ == "__main__":
    main()
