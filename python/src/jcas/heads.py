"""What the outputs of a policy's network mean: distributions over a motion and a pilot command."""

from __future__ import annotations

from typing import Literal

import numpy as np

from .arguments import Floats
from .errors import PolicyError
from .spaces import MOTIONS, motion_to_command

Head = Literal["gaussian", "hybrid"]

HEAD_OUTPUTS = {"gaussian": 4, "hybrid": len(MOTIONS) + 2}
LOG_STD = (-2.3, 1.0)
"""Bounds of a Gaussian head's log standard deviation."""


def act(
    head: Head,
    outputs: Floats,
    deterministic: bool,
    rng: np.random.Generator | None,
    constant_pilot: float | None,
) -> Floats:
    """Choose actions: the most likely motion and the mean pilot, or draws, which need a generator."""
    if not deterministic and rng is None:
        raise PolicyError("deterministic = False: sampled actions need rng, a NumPy generator")
    actions = decode(head, outputs, None if deterministic else rng)
    if constant_pilot is not None:
        actions[..., 1] = constant_pilot
    return actions


def decode(head: Head, outputs: Floats, rng: np.random.Generator | None) -> Floats:
    """Turn a head's outputs into actions: the most likely ones, or draws where there is a generator."""
    actions = np.empty((*outputs.shape[:-1], 2), np.float32)
    if head == "gaussian":
        actions[:] = outputs[..., :2]
        if rng is not None:
            deviation = np.exp(np.clip(outputs[..., 2:], *LOG_STD))
            actions += deviation * rng.standard_normal(actions.shape, np.float32)
        return np.clip(actions, -1, 1)
    logits = outputs[..., : len(MOTIONS)]
    concentration = 1 + np.logaddexp(0, outputs[..., len(MOTIONS) :])
    alpha, beta = concentration[..., 0], concentration[..., 1]
    if rng is None:
        motion, pilot = logits.argmax(axis=-1), alpha / (alpha + beta)
    else:
        motion = (logits + rng.gumbel(size=logits.shape)).argmax(axis=-1)
        pilot = rng.beta(alpha, beta)
    actions[..., 0] = motion_to_command(motion)
    actions[..., 1] = 2 * pilot - 1
    return actions
