"""Asks whether memory helps in `isac`: PPO with a feed-forward actor and with a GRU.

pip install torch ./python
python lab/experiments/isac_recurrent.py --out lab/results/isac_recurrent.csv

Ten UAVs share one actor, which sees the UAV's own observation. It chooses a motion and one of five
pilot densities. The arms differ in the second hidden layer of the actor. It is linear in one, and a
GRU in the other, whose state begins at 0 with each mission. The critic sees the UAV's observation
and the global state, and has no memory. Each UAV is paid its own reward. Seeds, missions and
agent-steps are equal. In the table, rows `all` are means over seeds with half of a 95 % interval by
Student's t. `difference` is the GRU minus the other, seed by seed.
"""

import argparse
import csv
import math
import time
from dataclasses import dataclass
from pathlib import Path

import jcas
import numpy as np
import torch
from torch import nn

MOTIONS = 5
DENSITIES = 5
# Centres of the five motions' bins, and the densities from the least to the highest.
MOTION_VALUES = np.linspace(-0.8, 0.8, MOTIONS, dtype=np.float32)
DENSITY_VALUES = np.linspace(-1.0, 1.0, DENSITIES, dtype=np.float32)
ARMS = ("feed_forward", "gru")
MEASURES = ("success", "steps", "confirmed", "energy_kwh", "false_confirmations")
COLUMNS = ("arm", "seed", "agent_steps", "seconds", *MEASURES)
COLUMNS += tuple(f"{name}_half" for name in MEASURES)
# Quantile 0.975 of Student's t for 1 to 9 degrees of freedom.
STUDENT_T = (12.706, 4.303, 3.182, 2.776, 2.571, 2.447, 2.365, 2.306, 2.262)
EVALUATION_SEED = 1_000_000


@dataclass(frozen=True)
class Settings:
    """What both arms share."""

    uavs: int = 10
    hotspots: int = 7
    fleets: int = 16
    rollout: int = 32
    epochs: int = 4
    minibatches: int = 4
    width: int = 128
    learning_rate: float = 7e-4
    discount: float = 0.97
    trace: float = 0.9
    clip: float = 0.2
    entropy: float = 0.01
    gradient_norm: float = 0.5
    reward_scale: float = 0.1

    def fleet(self, missions: int, **options) -> jcas.FleetVectorEnv:
        """The vector environment of these missions, which begin anew in the step they end."""
        options |= {"uav_count": self.uavs, "hotspot_count": self.hotspots}
        return jcas.make_vec("isac", missions, autoreset_mode="SameStep", **options)


class Actor(nn.Module):
    """Logits of the motions and the densities, from the observations of one or more steps."""

    def __init__(self, inputs: int, width: int, recurrent: bool) -> None:
        super().__init__()
        self.first = nn.Linear(inputs, width)
        self.second = nn.GRUCell(width, width) if recurrent else nn.Linear(width, width)
        self.logits = nn.Linear(width, MOTIONS + DENSITIES)
        nn.init.orthogonal_(self.logits.weight, 0.01)
        nn.init.zeros_(self.logits.bias)

    def forward(self, observations, begins, memory):
        """Logits [T, rows, 10] and the memory [rows, width] after the last step.

        Where begins [T, rows] is 1, a mission begins and the memory is 0.
        """
        hidden = torch.tanh(self.first(observations))
        if isinstance(self.second, nn.Linear):
            return self.logits(torch.tanh(self.second(hidden))), memory
        states = []
        for step in range(len(hidden)):
            memory = self.second(hidden[step], memory * (1 - begins[step])[:, None])
            states.append(memory)
        return self.logits(torch.stack(states)), memory


def critic(inputs: int, width: int) -> nn.Module:
    layers = (nn.Linear(inputs, width), nn.Tanh(), nn.Linear(width, width), nn.Tanh())
    return nn.Sequential(*layers, nn.Linear(width, 1))


def heads(logits):
    """Distributions of the motion and of the density."""
    motion, density = logits.split((MOTIONS, DENSITIES), dim=-1)
    return [torch.distributions.Categorical(logits=part) for part in (motion, density)]


def log_probability(both, choices):
    return both[0].log_prob(choices[..., 0]) + both[1].log_prob(choices[..., 1])


def actions(choices, fleets: int) -> np.ndarray:
    pair = (MOTION_VALUES[choices[..., 0]], DENSITY_VALUES[choices[..., 1]])
    return np.stack(pair, axis=-1).reshape(fleets, -1, 2)


def choose(actor, observations, begins, memory):
    """Draws choices [rows, 2] for one step."""
    logits, memory = actor(observations[None], begins[None], memory)
    both = heads(logits[0])
    choices = torch.stack([head.sample() for head in both], dim=-1)
    return choices, log_probability(both, choices), memory


class Learner:
    """One training: its environment, its networks and what they have seen."""

    def __init__(self, recurrent: bool, seed: int, settings: Settings) -> None:
        self.settings = settings
        torch.manual_seed(seed)
        self.env = settings.fleet(settings.fleets, credit="uav", global_state=True)
        observations, infos = self.env.reset(seed=seed)
        inputs = observations.shape[-1]
        self.actor = Actor(inputs, settings.width, recurrent)
        self.critic = critic(inputs + infos["global_state"].shape[-1], settings.width)
        self.parameters = [*self.actor.parameters(), *self.critic.parameters()]
        self.optimiser = torch.optim.Adam(self.parameters, lr=settings.learning_rate, eps=1e-5)
        self.rows = settings.fleets * settings.uavs
        self.seen = self.tensors(observations, infos["global_state"])
        self.begins = torch.ones(self.rows)
        self.memory = torch.zeros(self.rows, settings.width)

    def tensors(self, observations, state):
        """The actor's and the critic's inputs, one row for each UAV."""
        state = np.repeat(state[:, None], self.settings.uavs, axis=1)
        both = np.concatenate([observations, state], axis=-1).reshape(self.rows, -1)
        both = torch.from_numpy(both.astype(np.float32))
        return both[:, : observations.shape[-1]], both

    @torch.no_grad()
    def rollout(self) -> dict:
        """Flies `rollout` steps. A truncated mission is paid the value of its last state."""
        settings = self.settings
        start = self.memory
        kept = {name: [] for name in ("own", "both", "begins", "choices", "old", "reward", "value")}
        for _ in range(settings.rollout):
            own, both = self.seen
            choices, old, self.memory = choose(self.actor, own, self.begins, self.memory)
            value = self.critic(both)[:, 0]
            begins = self.begins
            flown = self.env.step(actions(choices, settings.fleets))
            observations, _, terminated, truncated, infos = flown
            reward = torch.from_numpy(infos["uav_rewards"].astype(np.float32)).reshape(-1)
            reward = reward * settings.reward_scale
            if truncated.any():
                last = self.tensors(infos["final_obs"], infos["final_global_state"])[1]
                cut = torch.from_numpy(truncated & ~terminated).repeat_interleave(settings.uavs)
                reward = reward + settings.discount * self.critic(last)[:, 0] * cut
            ended = torch.from_numpy(terminated | truncated)
            self.begins = ended.repeat_interleave(settings.uavs).float()
            self.seen = self.tensors(observations, infos["global_state"])
            parts = (own, both, begins, choices, old, reward, value)
            for name, part in zip(kept, parts, strict=True):
                kept[name].append(part)
        batch = {name: torch.stack(parts) for name, parts in kept.items()}
        after = self.critic(self.seen[1])[:, 0]
        batch["advantage"] = self.advantages(batch, after)
        batch["target"] = batch["advantage"] + batch["value"]
        batch["memory"] = start
        return batch

    def advantages(self, batch: dict, after):
        """Generalised advantage estimates; nothing passes the end of a mission."""
        settings = self.settings
        sums = torch.zeros_like(batch["reward"])
        following, running, begins = after, torch.zeros(self.rows), self.begins
        for step in reversed(range(settings.rollout)):
            goes_on = 1 - begins
            error = batch["reward"][step] + settings.discount * following * goes_on
            error = error - batch["value"][step]
            running = error + settings.discount * settings.trace * goes_on * running
            sums[step] = running
            following, begins = batch["value"][step], batch["begins"][step]
        return sums

    def update(self, batch: dict) -> None:
        """Some epochs over minibatches of whole rows, since a GRU needs its steps in order."""
        settings = self.settings
        for _ in range(settings.epochs):
            for rows in torch.randperm(self.rows).chunk(settings.minibatches):
                part = {name: tensor[:, rows] for name, tensor in batch.items() if name != "memory"}
                logits, _ = self.actor(part["own"], part["begins"], batch["memory"][rows])
                both = heads(logits)
                advantage = part["advantage"]
                advantage = (advantage - advantage.mean()) / (advantage.std() + 1e-6)
                ratio = (log_probability(both, part["choices"]) - part["old"]).exp()
                clipped = ratio.clamp(1 - settings.clip, 1 + settings.clip)
                gain = torch.minimum(ratio * advantage, clipped * advantage).mean()
                entropy = sum(head.entropy().mean() for head in both)
                error = (self.critic(part["both"])[..., 0] - part["target"]).square().mean()
                self.optimiser.zero_grad()
                (0.5 * error - gain - settings.entropy * entropy).backward()
                nn.utils.clip_grad_norm_(self.parameters, settings.gradient_norm)
                self.optimiser.step()

    def train(self, agent_steps: int) -> int:
        """Trains for at least this number of agent-steps and returns how many there were."""
        updates = math.ceil(agent_steps / (self.settings.rollout * self.rows))
        for update in range(updates):
            rate = self.settings.learning_rate * (1 - update / updates)
            self.optimiser.param_groups[0]["lr"] = rate
            self.update(self.rollout())
        return updates * self.settings.rollout * self.rows


@torch.no_grad()
def evaluate(actor: Actor, missions: int, settings: Settings) -> dict:
    """Means over missions whose seeds are the same for every policy; actions are drawn."""
    torch.manual_seed(EVALUATION_SEED)
    env = settings.fleet(missions)
    observations, _ = env.reset(seed=EVALUATION_SEED)
    rows = missions * settings.uavs
    begins, memory = torch.ones(rows), torch.zeros(rows, settings.width)
    ended = np.zeros(missions, dtype=bool)
    results = {name: np.zeros(missions) for name in MEASURES}
    while not ended.all():
        seen = torch.from_numpy(observations.reshape(rows, -1))
        choices, _, memory = choose(actor, seen, begins, memory)
        observations, _, _, _, infos = env.step(actions(choices, missions))
        over = np.zeros(missions, dtype=bool)
        if "final_info" in infos:
            over = infos["final_info"]["_metrics"]
            for name in MEASURES:
                found = infos["final_info"]["metrics"]["terminated" if name == "success" else name]
                results[name] = np.where(over & ~ended, found, results[name])
            ended |= over
        begins = torch.from_numpy(over).repeat_interleave(settings.uavs).float()
    return {name: float(values.mean()) for name, values in results.items()}


def summary(arm: str, rows: list[dict]) -> dict:
    """Means over seeds and halves of their 95 % intervals."""
    means = {"arm": arm, "seed": "all", "agent_steps": rows[0]["agent_steps"]}
    for name in ("seconds", *MEASURES):
        values = np.array([row[name] for row in rows])
        means[name] = float(values.mean())
        if name in MEASURES and len(rows) > 1:
            means[f"{name}_half"] = STUDENT_T[len(rows) - 2] * values.std(ddof=1) / len(rows) ** 0.5
    return means


def write(rows: list[dict], path: Path) -> None:
    """Writes one row for each training, and those over seeds."""
    by_arm = {arm: [row for row in rows if row["arm"] == arm] for arm in ARMS}
    pairs = zip(by_arm["gru"], by_arm["feed_forward"], strict=True)
    numbers = ("seconds", *MEASURES)
    apart = [a | {name: a[name] - b[name] for name in numbers} for a, b in pairs]
    means = [*(summary(arm, by_arm[arm]) for arm in ARMS), summary("difference", apart)]
    with path.open("w", newline="") as file:
        writer = csv.DictWriter(file, COLUMNS, lineterminator="\n")
        writer.writeheader()
        for row in rows + means:
            fractions = {name: round(row[name], 4) for name in row if isinstance(row[name], float)}
            writer.writerow(row | fractions)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--agent-steps", type=int, default=700_000, help="for each training")
    parser.add_argument("--seeds", type=int, nargs="+", default=[1, 2, 3], help="at most ten")
    parser.add_argument("--missions", type=int, default=200, help="missions of an evaluation")
    parser.add_argument("--out", type=Path, default=Path("isac_recurrent.csv"))
    given = parser.parse_args()
    if len(given.seeds) > len(STUDENT_T) + 1:
        parser.error(f"--seeds: {len(given.seeds)} are given, at most 10 are allowed")
    torch.set_num_threads(1)
    settings = Settings()
    rows = []
    for seed in given.seeds:
        for arm in ARMS:
            learner = Learner(arm == "gru", seed, settings)
            begun = time.process_time()
            row = {"arm": arm, "seed": seed, "agent_steps": learner.train(given.agent_steps)}
            row["seconds"] = time.process_time() - begun
            rows.append(row | evaluate(learner.actor, given.missions, settings))
            print("  ".join(f"{name} {value}" for name, value in rows[-1].items()), flush=True)
        write(rows, given.out)


if __name__ == "__main__":
    main()
