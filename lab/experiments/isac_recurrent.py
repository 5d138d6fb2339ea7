"""Asks whether memory helps in `isac`: PPO with a feed-forward network and with an LSTM.

pip install "./python[sb3]" sb3-contrib
python lab/experiments/isac_recurrent.py --out lab/results/isac_recurrent.csv

Ten UAVs share one policy, which reads the UAV's own observation. It chooses a motion and one of
five pilot densities. Each UAV is paid its own reward. The arms are `PPO` of Stable-Baselines3 and
`RecurrentPPO` of sb3-contrib. They differ in the LSTM alone: seeds, missions, agent-steps and all
other settings are equal. In the table, rows `all` are means over seeds with half of a 95 % interval
by Student's t. `difference` is the LSTM minus the other, seed by seed.
"""

import argparse
import csv
import time
from pathlib import Path

import jcas
import numpy as np
import torch
from gymnasium.spaces import MultiDiscrete
from jcas.evaluation import evaluate
from jcas.sb3 import FleetVecEnv
from sb3_contrib import RecurrentPPO
from stable_baselines3 import PPO
from stable_baselines3.common.vec_env import VecEnvWrapper

ARMS = {"feed_forward": (PPO, "MlpPolicy"), "lstm": (RecurrentPPO, "MlpLstmPolicy")}
CONFIG = {"uav_count": 10, "hotspot_count": 7}
WIDTH = 128
# Centres of the five motions' bins, and the densities from the least to the highest.
VALUES = np.stack([np.linspace(-0.8, 0.8, 5), np.linspace(-1.0, 1.0, 5)]).astype(np.float32)
MISSIONS_AT_ONCE = 16
MISSIONS_MAX = jcas.evaluation.ACTIONS_AT_ONCE
EVALUATION_SEED = 1_000_000
# The names in the table, and those of an evaluation.
MEASURES = {
    "success": "success_rate",
    "steps": "mission_steps_mean",
    "energy_kwh": "energy_kwh_mean",
}
COLUMNS = ["arm", "seed", "agent_steps", "seconds"]
COLUMNS += [name + end for name in MEASURES for end in ("", "_half")]
# Quantile 0.975 of Student's t for 1 to 9 degrees of freedom.
STUDENT_T = (12.706, 4.303, 3.182, 2.776, 2.571, 2.447, 2.365, 2.306, 2.262)


def actions(choices: np.ndarray) -> np.ndarray:
    """The kernel's actions (u_dir, u_pilot) of choices [..., 2]."""
    return np.stack([VALUES[0][choices[..., 0]], VALUES[1][choices[..., 1]]], axis=-1)


class Choices(VecEnvWrapper):
    """The fleet with a motion and a density to choose in place of two real numbers."""

    def __init__(self, fleet: FleetVecEnv) -> None:
        super().__init__(fleet, action_space=MultiDiscrete([5, 5]))

    def reset(self):
        return self.venv.reset()

    def step_async(self, choices: np.ndarray) -> None:
        self.venv.step_async(actions(choices))

    def step_wait(self):
        return self.venv.step_wait()


def trained(arm: str, seed: int, agent_steps: int):
    """Trains one policy for about this number of agent-steps."""
    algorithm, policy = ARMS[arm]
    fleet = FleetVecEnv("isac", MISSIONS_AT_ONCE, credit="uav", **CONFIG)
    recurrent = {"lstm_hidden_size": WIDTH, "enable_critic_lstm": False} if arm == "lstm" else {}
    learner = algorithm(
        policy,
        Choices(fleet),
        learning_rate=lambda left: 7e-4 * left,
        n_steps=32,
        batch_size=1280,
        n_epochs=4,
        gamma=0.97,
        gae_lambda=0.9,
        ent_coef=0.01,
        policy_kwargs={"net_arch": [WIDTH, WIDTH], **recurrent},
        seed=seed,
        device="cpu",
    )
    return learner.learn(agent_steps)


class Flight:
    """A policy as an evaluation flies it, with drawn actions; each UAV has its own memory."""

    def __init__(self, learner) -> None:
        self.learner = learner
        self.memory = None

    def __call__(self, observations: np.ndarray) -> np.ndarray:
        rows = observations.reshape(-1, observations.shape[-1])
        begins = np.full(len(rows), self.memory is None)
        choices, self.memory = self.learner.predict(rows, self.memory, begins)
        return actions(choices).reshape(*observations.shape[:2], 2)


def measured(arm: str, seed: int, given: argparse.Namespace) -> dict:
    """Trains and evaluates one policy; returns its row."""
    begun = time.process_time()
    learner = trained(arm, seed, given.agent_steps)
    seconds = time.process_time() - begun
    torch.manual_seed(EVALUATION_SEED)
    model = jcas.Model("isac", **CONFIG)
    report = evaluate(Flight(learner), model, episodes=given.missions, seed=EVALUATION_SEED)
    row = {"arm": arm, "seed": seed, "agent_steps": learner.num_timesteps, "seconds": seconds}
    return row | {name: report[quantity].value for name, quantity in MEASURES.items()}


def over_seeds(arm: str, rows: list[dict]) -> dict:
    """Means over seeds, and halves of their 95 % intervals."""
    means = {"arm": arm, "seed": "all", "agent_steps": rows[0]["agent_steps"]}
    for name in ("seconds", *MEASURES):
        values = np.array([row[name] for row in rows])
        means[name] = values.mean()
        if name in MEASURES and len(rows) > 1:
            means[f"{name}_half"] = STUDENT_T[len(rows) - 2] * values.std(ddof=1) / len(rows) ** 0.5
    return means


def write(rows: list[dict], path: Path) -> None:
    """Writes a row for each training, and those over seeds."""
    arms = {arm: [row for row in rows if row["arm"] == arm] for arm in ARMS}
    pairs = zip(arms["lstm"], arms["feed_forward"], strict=True)
    apart = [a | {name: a[name] - b[name] for name in ("seconds", *MEASURES)} for a, b in pairs]
    means = [over_seeds(arm, of) for arm, of in (*arms.items(), ("difference", apart))]
    part = path.with_suffix(".part")
    with part.open("w", newline="") as file:
        writer = csv.DictWriter(file, COLUMNS, lineterminator="\n")
        writer.writeheader()
        for row in rows + means:
            rounded = {name: round(row[name], 4) for name in row if isinstance(row[name], float)}
            writer.writerow(row | rounded)
    part.replace(path)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--agent-steps", type=int, default=700_000, help="for each training")
    parser.add_argument("--seeds", type=int, nargs="+", default=[1, 2, 3, 4, 5], help="at most ten")
    parser.add_argument("--missions", type=int, default=200, help="of an evaluation, at most 256")
    parser.add_argument("--out", type=Path, default=Path("isac_recurrent.csv"))
    given = parser.parse_args()
    if len(given.seeds) > len(STUDENT_T) + 1:
        parser.error(f"--seeds: {len(given.seeds)} are given, at most 10 are allowed")
    if given.missions > MISSIONS_MAX:
        # An evaluation of more missions flies them one part after another, with one memory.
        parser.error(f"--missions: {given.missions} is given, at most {MISSIONS_MAX} is allowed")
    torch.set_num_threads(1)
    rows = []
    for seed in given.seeds:
        for arm in ARMS:
            rows.append(measured(arm, seed, given))
            print("  ".join(f"{name} {value}" for name, value in rows[-1].items()), flush=True)
        write(rows, given.out)


if __name__ == "__main__":
    main()
