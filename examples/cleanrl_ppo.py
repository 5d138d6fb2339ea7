"""Trains a fleet with PPO in one file, in the style of CleanRL: one policy for all UAVs.

pip install "./python[torchrl]"
python examples/cleanrl_ppo.py --task meet --seconds 120 --curve curve.csv
"""

import argparse
import csv
import time
from pathlib import Path

import numpy as np
import torch
from torch import nn
from torch.distributions import Categorical

import jcas
from jcas.evaluation import evaluate
from jcas.spaces import ActionForm
from jcas.tasks import TASKS

LEVELS = 2  # Pilot densities: lowest and highest.
EPOCHS, MINIBATCH, STEPS = 4, 1024, 32
CLIP, DISCOUNT, LAMBDA, ENTROPY, RATE = 0.2, 0.95, 0.9, 0.01, 1.5e-3


class Agent(nn.Module):
    """Actor and critic, both of one UAV's observation."""

    def __init__(self, inputs: int, actions: int, width: int) -> None:
        super().__init__()
        self.actor = self.network(inputs, actions, width, 0.01)
        self.critic = self.network(inputs, 1, width, 1.0)

    @staticmethod
    def network(inputs: int, outputs: int, width: int, gain: float) -> nn.Sequential:
        layers = [nn.Linear(inputs, width), nn.Linear(width, width), nn.Linear(width, outputs)]
        for layer, scale in zip(layers, (2**0.5, 2**0.5, gain), strict=True):
            nn.init.orthogonal_(layer.weight, scale)
            nn.init.zeros_(layer.bias)
        return nn.Sequential(layers[0], nn.Tanh(), layers[1], nn.Tanh(), layers[2])

    def policy(self, rows: torch.Tensor, masks: torch.Tensor) -> Categorical:
        return Categorical(logits=self.actor(rows).masked_fill(masks == 0, -1e9))


def collect(envs, agent, rows, masks):
    """Step every fleet STEPS times; returns the batch, what comes next, and the episodes' ends."""
    batch, ended, won = [], 0, 0
    for _ in range(STEPS):
        seen, allowed = torch.from_numpy(rows), torch.from_numpy(masks)
        with torch.no_grad():
            chosen = agent.policy(seen, allowed)
            actions, values = chosen.sample(), agent.critic(seen).squeeze(-1)
        rows, _, terminated, truncated, infos = envs.step(actions.numpy())
        masks, done = infos["action_mask"], terminated | truncated
        rewards = torch.from_numpy(infos["uav_rewards"].astype(np.float32))
        if truncated.any():  # A mission at its horizon goes on as far as its learner knows.
            last = torch.from_numpy(infos["final_obs"][truncated])
            with torch.no_grad():
                rewards[truncated] += DISCOUNT * agent.critic(last).squeeze(-1)
        over = torch.from_numpy(done)[:, None].expand_as(values).float()
        batch.append((seen, allowed, actions, chosen.log_prob(actions), values, rewards, over))
        ended, won = ended + int(done.sum()), won + int(infos["success"].sum())
    return [torch.stack(part) for part in zip(*batch, strict=True)], rows, masks, ended, won


def advantages(rewards, values, over, following):
    out, running = torch.zeros_like(rewards), torch.zeros_like(following)
    for step in reversed(range(STEPS)):
        after = values[step + 1] if step + 1 < STEPS else following
        error = rewards[step] + DISCOUNT * after * (1 - over[step]) - values[step]
        running = error + DISCOUNT * LAMBDA * (1 - over[step]) * running
        out[step] = running
    return out


def learn(agent, optimiser, batch, following):
    rows, masks, actions, log_probs, values, rewards, over = batch
    gained = advantages(rewards, values, over, following)
    flat = [
        part.flatten(0, 2) for part in (rows, masks, actions, log_probs, gained, gained + values)
    ]
    for _ in range(EPOCHS):
        for share in torch.randperm(len(flat[0])).split(MINIBATCH):
            seen, allowed, acted, before, gain, target = (part[share] for part in flat)
            chosen = agent.policy(seen, allowed)
            ratio = (chosen.log_prob(acted) - before).exp()
            gain = (gain - gain.mean()) / (gain.std() + 1e-8)
            objective = torch.min(ratio * gain, ratio.clamp(1 - CLIP, 1 + CLIP) * gain).mean()
            error = (agent.critic(seen).squeeze(-1) - target).pow(2).mean()
            loss = 0.5 * error - objective - ENTROPY * chosen.entropy().mean()
            optimiser.zero_grad()
            loss.backward()
            nn.utils.clip_grad_norm_(agent.parameters(), 0.5)
            optimiser.step()


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--task", choices=list(TASKS), default="meet")
    parser.add_argument("--seconds", type=float, default=120.0, help="processor time of training")
    parser.add_argument("--missions", type=int, default=64, help="missions side by side")
    parser.add_argument("--width", type=int, default=64)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--curve", type=Path, help="write the success of each batch as CSV")
    options = parser.parse_args()
    torch.manual_seed(options.seed)
    torch.set_num_threads(1)

    envs = jcas.make_vec(
        TASKS[options.task].config(training=True),
        num_envs=options.missions,
        action_space="discrete",
        pilot_levels=LEVELS,
        credit="uav",
        seeding="derived",
        autoreset_mode="SameStep",
    )
    agent = Agent(envs.model.observation_len, envs.single_action_space.nvec[0], options.width)
    optimiser = torch.optim.Adam(agent.parameters(), lr=RATE, eps=1e-5)
    rows, infos = envs.reset(seed=options.seed)
    masks, began, steps, curve = infos["action_mask"], time.process_time(), 0, []
    while (spent := time.process_time() - began) < options.seconds:
        optimiser.param_groups[0]["lr"] = RATE * max(1 - spent / options.seconds, 0.05)
        batch, rows, masks, ended, won = collect(envs, agent, rows, masks)
        with torch.no_grad():
            following = agent.critic(torch.from_numpy(rows)).squeeze(-1)
        learn(agent, optimiser, batch, following)
        steps += STEPS * options.missions
        curve.append((round(spent, 1), steps, won / max(ended, 1)))
        if len(curve) % 20 == 1:
            print("{:6.1f} s  {:8} steps  success {:.2f}".format(*curve[-1]), flush=True)

    model = jcas.Model(TASKS[options.task].config())
    form = ActionForm(model, "discrete", LEVELS)

    def act(seen):
        masks = torch.from_numpy(form.mask(seen))
        with torch.no_grad():
            return agent.policy(torch.from_numpy(seen), masks).probs.argmax(-1).numpy()

    print(evaluate(act, model, episodes=200, policy="PPO", action_space="discrete",
                   pilot_levels=LEVELS))  # fmt: skip
    if options.curve:
        with options.curve.open("w", newline="") as file:
            csv.writer(file).writerows([("processor_s", "steps", "success"), *curve])


if __name__ == "__main__":
    main()
