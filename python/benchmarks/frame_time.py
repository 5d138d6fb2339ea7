"""Measures the time of a picture.

    python python/benchmarks/frame_time.py

Fleets act at random. A frame is one `env.render()`, from the state of the simulation to an array.
The program prints the median and the least processor time on one core. It leaves out the first ten
frames, which fill the cache of sprites.
"""

from __future__ import annotations

import argparse
import statistics
import time

import jcas

CASES = {
    "one cell": {"uav_count": 10, "hotspot_count": 5, "move": False},
    "paper's largest": {"uav_count": 20, "hotspot_count": 11, "move": True},
    "long sensing range": {
        "uav_count": 10,
        "hotspot_count": 5,
        "detection_threshold_db": -23.8,
        "move": True,
    },
    "fleet of 100": {
        "uav_count": 100,
        "hotspot_count": 50,
        "grid_width": 40,
        "grid_height": 40,
        "move": True,
    },
}


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--frames", type=int, default=90)
    options = parser.parse_args()
    for name, case in CASES.items():
        fields = {field: value for field, value in case.items() if field != "move"}
        env = jcas.FleetEnv(render_mode="rgb_array", **fields)
        env.reset(seed=1)
        env.action_space.seed(1)
        stay = env.action_space.sample() * 0
        times = []
        for _ in range(options.frames):
            if any(env.step(env.action_space.sample() if case["move"] else stay)[2:4]):
                env.reset()
            began = time.process_time()
            env.render()
            times.append(time.process_time() - began)
        kept = [1000 * seconds for seconds in times[10:]]
        print(f"{name:20} median {statistics.median(kept):5.1f} ms a frame, least {min(kept):5.1f}")


if __name__ == "__main__":
    main()
