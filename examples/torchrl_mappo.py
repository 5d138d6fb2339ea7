"""Trains a fleet with TorchRL: MAPPO, a shared actor and a critic that sees every UAV.

pip install "./python[torchrl]"
python examples/torchrl_mappo.py --iterations 40
"""

import argparse

import torch
from tensordict.nn import TensorDictModule
from tensordict.nn.distributions import NormalParamExtractor
from torch import nn
from torchrl.modules import MultiAgentMLP, ProbabilisticActor, TanhNormal, ValueOperator
from torchrl.objectives import ClipPPOLoss

from jcas.torchrl import GROUP, JcasVecEnv


def make_networks(
    env: JcasVecEnv, uavs: int, width: int
) -> tuple[ProbabilisticActor, ValueOperator]:
    inputs = env.observation_spec[GROUP, "observation"].shape[-1]

    def network(outputs: int, centralised: bool) -> MultiAgentMLP:
        return MultiAgentMLP(
            n_agent_inputs=inputs,
            n_agent_outputs=outputs,
            n_agents=uavs,
            centralized=centralised,
            share_params=True,
            num_cells=(width, width),
            activation_class=nn.ReLU,
        )

    actor = ProbabilisticActor(
        TensorDictModule(
            nn.Sequential(network(4, centralised=False), NormalParamExtractor()),
            in_keys=[(GROUP, "observation")],
            out_keys=[(GROUP, "loc"), (GROUP, "scale")],
        ),
        spec=env.full_action_spec_unbatched,
        in_keys=[(GROUP, "loc"), (GROUP, "scale")],
        out_keys=[(GROUP, "action")],
        distribution_class=TanhNormal,
        return_log_prob=True,
        log_prob_key=(GROUP, "sample_log_prob"),
    )
    critic = ValueOperator(
        network(1, centralised=True),
        in_keys=[(GROUP, "observation")],
        out_keys=[(GROUP, "state_value")],
    )
    return actor, critic


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--iterations", type=int, default=40)
    parser.add_argument("--missions", type=int, default=64, help="missions side by side")
    parser.add_argument("--steps", type=int, default=128, help="steps of an iteration")
    parser.add_argument("--uavs", type=int, default=6)
    parser.add_argument("--hotspots", type=int, default=3)
    parser.add_argument("--width", type=int, default=256)
    options = parser.parse_args()
    torch.manual_seed(1)

    env = JcasVecEnv(
        num_envs=options.missions, uav_count=options.uavs, hotspot_count=options.hotspots, seed=1
    )
    actor, critic = make_networks(env, options.uavs, options.width)
    loss = ClipPPOLoss(
        actor, critic, clip_epsilon=0.2, entropy_coeff=1e-3, normalize_advantage=True
    )
    loss.set_keys(
        reward=(GROUP, "reward"),
        action=(GROUP, "action"),
        sample_log_prob=(GROUP, "sample_log_prob"),
        value=(GROUP, "state_value"),
        done=(GROUP, "done"),
        terminated=(GROUP, "terminated"),
    )
    loss.make_value_estimator(gamma=0.95, lmbda=0.95)
    optimiser = torch.optim.Adam(loss.parameters(), lr=3e-4)

    for iteration in range(1, options.iterations + 1):
        with torch.no_grad():
            data = env.rollout(options.steps, policy=actor, break_when_any_done=False)
            for end in ("done", "terminated"):  # The team's, for each UAV.
                shape = data["next", GROUP, "reward"].shape
                data["next", GROUP, end] = data["next", end].unsqueeze(-2).expand(shape)
            ended = data["next", "done"]
            success = data["next", "info", "success"][ended].double().mean().item()
            loss.value_estimator(
                data,
                params=loss.critic_network_params,
                target_params=loss.target_critic_network_params,
            )
        data = data.reshape(-1)
        for _ in range(10):
            for rows in torch.randperm(data.shape[0]).split(256):
                losses = loss(data[rows])
                total = losses["loss_objective"] + losses["loss_critic"] + losses["loss_entropy"]
                optimiser.zero_grad()
                total.backward()
                nn.utils.clip_grad_norm_(loss.parameters(), 0.5)
                optimiser.step()
        reward = data["next", GROUP, "reward"].mean().item()
        print(
            f"iteration {iteration:3}: mean reward of a step {reward:7.4f}, success {success:.2f}",
            flush=True,
        )


if __name__ == "__main__":
    main()
