"""Actor and critic: the actor sees what its UAV sees, the critic the state of the whole mission."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import torch
from ray.rllib.core.columns import Columns
from ray.rllib.core.rl_module.apis.value_function_api import ValueFunctionAPI
from ray.rllib.core.rl_module.torch import TorchRLModule
from torch import nn

from ..errors import ArgumentError
from ..policy import Layer, MlpPolicy

PAPER_HIDDEN = (512, 256, 128)

LOG_STD = (-2.3, 1.0)
"""Bounds of the log standard deviation: from a quarter of a motion bin to beyond the full range."""


class CentralCriticModule(TorchRLModule, ValueFunctionAPI):
    """A Gaussian actor on `observation` and a value function on `state`, both plain MLPs.

    As in RLlib's own modules the actor gives the means and the log standard deviations. With
    `model_config["critic"] = "agent"` the value function sees the UAV's own observation beside the
    state, so that each UAV has a value of its own.
    """

    def setup(self) -> None:
        """Build the networks from the spaces and the `hidden` and `critic` of `model_config`."""
        hidden = self.model_config.get("hidden", PAPER_HIDDEN)
        self.agent_specific = check_critic(self.model_config.get("critic", "state")) == "agent"
        outputs = 2 * self.action_space.shape[0]
        own, state = (self.observation_space[name].shape[0] for name in ("observation", "state"))
        self.actor = mlp(own, hidden, outputs, output_gain=0.01)
        self.critic = mlp(state + own * self.agent_specific, hidden, 1, output_gain=1.0)

    def _forward(self, batch: dict[str, Any], **_: Any) -> dict[str, Any]:
        mean, log_std = self.actor(batch[Columns.OBS]["observation"]).chunk(2, dim=-1)
        return {Columns.ACTION_DIST_INPUTS: torch.cat([mean, log_std.clamp(*LOG_STD)], dim=-1)}

    def compute_values(self, batch: dict[str, Any], embeddings: Any = None) -> Any:
        """Give the value of the global state, or of a UAV in it."""
        del embeddings
        seen = batch[Columns.OBS]
        inputs = (
            torch.cat([seen["state"], seen["observation"]], dim=-1)
            if self.agent_specific
            else seen["state"]
        )
        return self.critic(inputs).squeeze(-1)


def check_critic(critic: str) -> str:
    """Refuse a critic that does not exist."""
    if critic not in ("state", "agent"):
        raise ArgumentError(f"critic = {critic!r}: must be state or agent")
    return critic


def mlp(inputs: int, hidden: Sequence[int], outputs: int, output_gain: float) -> nn.Sequential:
    """Stack orthogonally initialised layers with ReLU between them."""
    layers: list[nn.Module] = []
    for width in hidden:
        layers += [_linear(inputs, width, 2**0.5), nn.ReLU()]
        inputs = width
    return nn.Sequential(*layers, _linear(inputs, outputs, output_gain))


def _linear(inputs: int, outputs: int, gain: float) -> nn.Linear:
    layer = nn.Linear(inputs, outputs)
    nn.init.orthogonal_(layer.weight, gain)
    nn.init.zeros_(layer.bias)
    return layer


def export_policy(module: CentralCriticModule) -> MlpPolicy:
    """Take the actor out as a policy that can be written."""
    linears = [layer for layer in module.actor if isinstance(layer, nn.Linear)]
    layers = [Layer(_array(linear.weight.T), _array(linear.bias)) for linear in linears]
    return MlpPolicy(layers, head="gaussian")


def _array(parameter: Any) -> Any:
    return parameter.detach().cpu().numpy().copy()
