"""Flies a trained policy, from its safetensors weights or its ONNX graph, and reports.

pip install "./python[policy,onnx,render]"
python examples/fly_policy.py policies/fleet --uavs 15 --hotspots 7 --picture policy.png
python examples/fly_policy.py policies/search --uavs 20
"""

import argparse
from pathlib import Path

import numpy as np

import jcas
from jcas.evaluation import evaluate


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("policy", type=Path, help="a folder that a trainer wrote, or an .onnx file")
    parser.add_argument("--uavs", type=int, help="default: as trained, which an .onnx file does not say")
    parser.add_argument("--hotspots", type=int, help="the same")
    parser.add_argument("--episodes", type=int, default=100)
    parser.add_argument("--picture", type=Path, help="draw the end of the first mission")
    options = parser.parse_args()

    policy = jcas.load_policy(options.policy)
    fields = {"uav_count": options.uavs, "hotspot_count": options.hotspots}
    config = jcas.Config(policy.config, **{name: value for name, value in fields.items() if value is not None})
    model = jcas.Model(config)
    policy = policy.for_model(model)
    rng = np.random.default_rng(1)

    def act(observations: np.ndarray) -> np.ndarray:
        return policy.act(observations, deterministic=policy.mode == "deterministic", rng=rng)

    print(evaluate(act, model, episodes=options.episodes, policy=options.policy.stem))

    if options.picture:
        from PIL import Image

        env = jcas.FleetEnv(config, render_mode="rgb_array")
        observation, _ = env.reset(seed=1)
        over = False
        while not over:
            observation, _, terminated, truncated, _ = env.step(act(observation))
            over = terminated or truncated
        Image.fromarray(env.render()).save(options.picture)


if __name__ == "__main__":
    main()
