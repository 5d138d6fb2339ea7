"""Flies a trained policy and reports.

pip install "./python[render]"
python examples/fly_policy.py policies/mission --uavs 15 --hotspots 7 --picture policy.png
python examples/fly_policy.py policies/paper --uavs 20
"""

import argparse
from pathlib import Path

import jcas
from jcas.evaluation import evaluate


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("policy", type=Path, help="a folder that a trainer wrote")
    parser.add_argument("--uavs", type=int, help="default: as trained")
    parser.add_argument("--hotspots", type=int, help="the same")
    parser.add_argument("--episodes", type=int, default=100)
    parser.add_argument("--picture", type=Path, help="draw the end of the first mission")
    options = parser.parse_args()

    fields = {"uav_count": options.uavs, "hotspot_count": options.hotspots}
    given = {name: value for name, value in fields.items() if value is not None}
    model = jcas.Model(jcas.trained_on(options.policy), **given)
    policy = jcas.Policy.load(options.policy, model)
    print(evaluate(policy, model, episodes=options.episodes, policy=options.policy.name))

    if options.picture:
        from PIL import Image

        env = jcas.FleetEnv(model.config, render_mode="rgb_array")
        env.reset(seed=1)
        over = False
        while not over:
            _, _, terminated, truncated, _ = env.step(policy.act(env.sim))
            over = terminated or truncated
        Image.fromarray(env.render()).save(options.picture)


if __name__ == "__main__":
    main()
