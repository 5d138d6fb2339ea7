"""Trained policies on disk: the card of a folder, and a writer for other trainers.

A policy is a folder with weights (`policy.safetensors`) and a card (`policy.json`). The card
describes the policy and its training. `jcas-lab train` and `jcas.rllib` write both, and
`jcas.Policy` runs them.
"""

from __future__ import annotations

import json
import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from typing import Any, Literal

import numpy as np
import numpy.typing as npt

from .arguments import read_file
from .config import Config
from .errors import MissingDependencyError, PolicyError
from .files import write_whole

Array = npt.NDArray[np.float32]
Head = Literal["gaussian", "hybrid"]

CARD = "policy.json"
WEIGHTS = "policy.safetensors"
CARD_FORMAT = 1
HEAD_OUTPUTS = {"gaussian": 4, "hybrid": 7}


@dataclass(frozen=True)
class Layer:
    """A linear layer: weights [inputs, outputs] and biases [outputs]."""

    weight: Array
    bias: Array


class MlpPolicy:
    """Linear layers with ReLU between them, to be written for `jcas.Policy.load`.

    Args:
        layers: the layers from the observation to the head's outputs.
        head: `gaussian` or `hybrid`. A gaussian head has two means and two log standard deviations.
            A hybrid head has five motion logits and the two parameters of a Beta distribution.
            The Beta distribution gives the pilot density.
        inputs: mean and scale that normalise the observations. None stands for no normalisation.

    Raises:
        PolicyError: the layers do not fit each other or the head, or hold NaN or an infinity.

    """

    def __init__(
        self,
        layers: Sequence[Layer],
        head: Head = "gaussian",
        *,
        inputs: tuple[Array, Array] | None = None,
    ) -> None:
        if head not in HEAD_OUTPUTS:
            raise PolicyError(f"head = {head!r}: must be one of {', '.join(HEAD_OUTPUTS)}")
        widths = [(layer.weight.shape, layer.bias.shape) for layer in layers]
        chained = all(left[0][1] == right[0][0] for left, right in pairwise(widths))
        if not widths or not chained or any(weight[1:] != bias for weight, bias in widths):
            raise PolicyError(f"layers of shapes {widths} do not follow on each other")
        if widths[-1][1] != (HEAD_OUTPUTS[head],):
            raise PolicyError(
                f"{widths[-1][1][0]} outputs: a {head} head must have {HEAD_OUTPUTS[head]}"
            )
        for index, layer in enumerate(layers):
            for name, array in (("weight", layer.weight), ("bias", layer.bias)):
                _require_finite(f"layers[{index}].{name}", array)
        for name, array in zip(("mean", "scale"), inputs or (), strict=False):
            _require_finite(f"the {name} of inputs", array)
        self.layers = list(layers)
        self.head = head
        self.inputs = inputs

    def save(
        self, folder: str | os.PathLike[str], name: str, config: Config, about: Mapping[str, Any]
    ) -> None:
        """Write weights and card.

        Args:
            folder: the folder to write to. It is made if it does not exist.
            name: the name of the policy in reports.
            config: the configuration of the training. The card repeats it.
            about: further entries of the card, such as the trainer's settings.

        """
        try:
            from safetensors.numpy import save_file
        except ImportError as error:
            raise MissingDependencyError("safetensors", "writing a policy", "policy") from error
        target = Path(folder)
        target.mkdir(parents=True, exist_ok=True)
        arrays: dict[str, Array] = {}
        for index, layer in enumerate(self.layers):
            arrays[f"{index}.weight"] = np.ascontiguousarray(layer.weight, np.float32)
            arrays[f"{index}.bias"] = np.ascontiguousarray(layer.bias, np.float32).reshape(1, -1)
        if self.inputs is not None:
            arrays["inputs.offset"], arrays["inputs.scale"] = self.inputs
        sizes = [
            int(self.layers[0].weight.shape[0]),
            *(int(layer.weight.shape[1]) for layer in self.layers),
        ]
        card = {
            "format": CARD_FORMAT,
            "name": name,
            "head": self.head,
            "architecture": {"kind": "mlp", "sizes": sizes},
            "normalised_inputs": self.inputs is not None,
            "constant_pilot_density": None,
            "mode": "deterministic",
            "trained_on": [[config["uav_count"], config["hotspot_count"]]],
            "config": dict(config),
            "config_hash": f"0x{config.hash:016x}",
            **about,
        }
        write_whole(target / WEIGHTS, lambda path: save_file(arrays, path))
        text = json.dumps(card, indent=2) + "\n"
        write_whole(target / CARD, lambda path: path.write_text(text, encoding="utf-8"))


def _require_finite(name: str, array: Array) -> None:
    """Refuse an array with NaN or an infinity, which a training that diverged leaves behind."""
    wrong = np.argwhere(~np.isfinite(array))
    if len(wrong):
        place = tuple(int(index) for index in wrong[0])
        shown = ", ".join(map(str, place))
        raise PolicyError(f"{name}[{shown}] = {array[place]}: must be finite")


def trained_on(folder: str | os.PathLike[str]) -> Config:
    """Read the configuration that a policy was trained on from its card.

    Args:
        folder: of the policy, with a `policy.json`.

    Raises:
        MissingFileError: there is no such card.
        PolicyError: the file is no card.

    """
    path = Path(folder) / CARD
    try:
        card = json.loads(read_file(path).decode("utf-8"))
    except ValueError as error:
        raise PolicyError(f"{path}: not JSON: {error}") from error
    if not isinstance(card, dict) or card.get("format") != CARD_FORMAT:
        raise PolicyError(f"{path}: must be a policy's card of format {CARD_FORMAT}")
    if "config" not in card:
        raise PolicyError(f"{path}: there is no 'config'")
    return Config(card["config"])
