"""Flies a fleet through PettingZoo with random actions and saves the last picture.

pip install "./python[render]"
python examples/random_fleet.py
"""

from PIL import Image

import jcas

env = jcas.parallel_env(uav_count=10, hotspot_count=5, render_mode="rgb_array")
observations, infos = env.reset(seed=1)
while env.agents:
    actions = {agent: env.action_space(agent).sample() for agent in env.agents}
    observations, rewards, terminated, truncated, infos = env.step(actions)
print(infos["uav_0"]["metrics"])
Image.fromarray(env.render()).save("fleet.png")
