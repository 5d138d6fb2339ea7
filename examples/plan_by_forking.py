"""Plans without learning: forks the episode, tries joint moves and takes the best-paid one.

pip install ./python
python examples/plan_by_forking.py
"""

import argparse

import numpy as np

import jcas


def gather(sim: jcas.Sim, hotspot: int) -> np.ndarray:
    """Return actions that move the fleet one cell closer to a hotspot, at full pilot density."""
    motion = {(0, 1): 0, (0, -1): 1, (-1, 0): 2, (1, 0): 3, (0, 0): 4}
    away = sim.hotspot_cells()[hotspot].astype(int) - sim.cells().astype(int)
    step = np.sign(away)
    step[step[:, 0] != 0, 1] = 0
    chosen = [motion[x, y] for x, y in step.tolist()]
    return np.stack([np.array(chosen) * 0.4 - 0.8, np.ones(len(chosen))], axis=1).astype(np.float32)


def worth(sim: jcas.Sim, hotspot: int, lookahead: int) -> float:
    """Reward of heading for a hotspot for some steps, on a fork that nobody keeps."""
    fork, total = sim.fork(), 0.0
    for _ in range(lookahead):
        outcome = fork.step(gather(fork, hotspot))
        total += outcome.reward
        if outcome.terminated or outcome.truncated:
            break
    return total


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--lookahead", type=int, default=12)
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    sim = jcas.Sim(jcas.Model(uav_count=10, hotspot_count=5), seed=options.seed)
    while not (sim.terminated or sim.truncated):
        open_ones = np.flatnonzero(~sim.informed())
        best = max(open_ones, key=lambda hotspot: worth(sim, hotspot, options.lookahead))
        sim.step(gather(sim, best))
    print(sim.metrics())


if __name__ == "__main__":
    main()
