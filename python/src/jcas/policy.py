"""Trained policies: read from files, flown on NumPy or ONNX Runtime, written by trainers.

A policy lies in a folder: weights (`policy.safetensors`), the same function for other programs
(`policy.onnx`), and a card (`policy.json`) that says what it is and what it was trained on. `jcas train`
writes all three, `jcas.rllib` the first and the last.
"""

from __future__ import annotations

import json
import os
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from typing import Any, TypeAlias

import numpy as np
import numpy.typing as npt

from .arguments import numbers_of, read_file
from .config import Config
from .errors import MissingDependencyError, MissingFileError, PolicyError
from .heads import HEAD_OUTPUTS, Head, act, decode
from .model import Model
from .set_policy import SetPolicy

Array = npt.NDArray[np.float32]

CARD = "policy.json"
WEIGHTS = "policy.safetensors"
ONNX = "policy.onnx"
CARD_FORMAT = 1

INPUTS_CLIP = 10.0
"""Normalised observations are clipped to this on either side."""


@dataclass(frozen=True)
class Layer:
    """A linear layer: weights [inputs, outputs] and biases [outputs]."""

    weight: Array
    bias: Array


class MlpPolicy:
    """Linear layers with ReLU between them, evaluated by NumPy.

    Args:
        layers: from the observation to the head's outputs.
        head: `gaussian` (two means, two log standard deviations) or `hybrid` (five motion logits, two
            parameters of a Beta distribution of the pilot density).
        inputs: mean and scale by which observations are normalised first.
        constant_pilot: a pilot command that is held whatever the outputs say.
        config: the configuration that the policy was trained on.
        mode: how it is meant to be flown, `deterministic`, `sampled` or, which only :class:`jcas.Policy` can,
            `stratified`; :meth:`act` does as it is told.

    """

    def __init__(
        self,
        layers: Sequence[Layer],
        head: Head = "gaussian",
        *,
        inputs: tuple[Array, Array] | None = None,
        constant_pilot: float | None = None,
        config: Config | None = None,
        mode: str = "deterministic",
    ) -> None:
        if head not in HEAD_OUTPUTS:
            raise PolicyError(f"head = {head!r}: must be one of {', '.join(HEAD_OUTPUTS)}")
        widths = [(layer.weight.shape, layer.bias.shape) for layer in layers]
        chained = all(left[0][1] == right[0][0] for left, right in pairwise(widths))
        if not widths or not chained or any(weight[1:] != bias for weight, bias in widths):
            raise PolicyError(f"layers of shapes {widths} do not follow on each other")
        if widths[-1][1] != (HEAD_OUTPUTS[head],):
            raise PolicyError(f"{widths[-1][1][0]} outputs: a {head} head must have {HEAD_OUTPUTS[head]}")
        self.layers = list(layers)
        self.head = head
        self.inputs = inputs
        self.constant_pilot = constant_pilot
        self.config = config
        self.mode = mode

    @property
    def observation_len(self) -> int:
        """Length of the observations that the policy reads."""
        return int(self.layers[0].weight.shape[0])

    def for_model(self, model: Model) -> MlpPolicy:
        """Return the policy that flies a model: itself, or a refusal where observations do not fit."""
        _check_length(self.observation_len, model)
        return self

    def outputs(self, observations: Array) -> Array:
        """Evaluate the network: [..., observation length] to [..., outputs]."""
        hidden = numbers_of("observations", observations)
        if self.inputs is not None:
            hidden = np.clip((hidden - self.inputs[0]) / self.inputs[1], -INPUTS_CLIP, INPUTS_CLIP)
        for layer in self.layers[:-1]:
            hidden = np.maximum(hidden @ layer.weight + layer.bias, 0)
        last = self.layers[-1]
        return np.asarray(hidden @ last.weight + last.bias, np.float32)

    def act(self, observations: Array, *, deterministic: bool = True, rng: np.random.Generator | None = None) -> Array:
        """Choose actions: [..., observation length] to [..., 2].

        Deterministic actions take the most likely motion and the mean pilot density; sampled ones need a
        generator.
        """
        return act(self.head, self.outputs(observations), deterministic, rng, self.constant_pilot)

    def save(self, folder: str | os.PathLike[str], name: str, config: Config, about: Mapping[str, Any]) -> None:
        """Write weights and card.

        Args:
            folder: where to; made if it is not there.
            name: of the policy, in reports.
            config: what it was trained on.
            about: whatever else the card should tell, such as the trainer's settings.

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
        sizes = [self.observation_len, *(layer.weight.shape[1] for layer in self.layers)]
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
        _write_whole(target / WEIGHTS, lambda path: save_file(arrays, path))
        text = json.dumps(card, indent=2) + "\n"
        _write_whole(target / CARD, lambda path: path.write_text(text, encoding="utf-8"))


def _check_length(length: int, model: Model) -> None:
    if length != model.observation_len:
        raise PolicyError(
            f"the policy reads observations of length {length}, those of this configuration have length "
            f"{model.observation_len} ({model.uav_count} UAVs, {model.hotspot_count} hotspots)"
        )


class OnnxPolicy:
    """A policy in ONNX, evaluated by ONNX Runtime, for the one size that its graph was written for.

    Args:
        path: the file; its inputs are `observations`, its outputs `distribution` and `actions`.
        head: which distribution the outputs describe, for sampling.
        config: the configuration that the policy was trained on.
        threads: of ONNX Runtime.

    """

    def __init__(
        self,
        path: str | os.PathLike[str],
        head: Head = "gaussian",
        *,
        config: Config | None = None,
        threads: int = 1,
    ) -> None:
        if not Path(path).is_file():
            raise MissingFileError(f"{path}: there is no such file")
        try:
            import onnxruntime
        except ImportError as error:
            raise MissingDependencyError("onnxruntime", "an ONNX policy", "onnx") from error
        settings = onnxruntime.SessionOptions()
        settings.intra_op_num_threads = threads
        settings.log_severity_level = 3  # Errors; unused constants of a graph are none.
        try:
            self._session: Any = onnxruntime.InferenceSession(str(path), settings, providers=["CPUExecutionProvider"])
        except Exception as error:
            raise PolicyError(f"{path}: not read by ONNX Runtime: {error}") from error
        self.head = head
        self.config = config
        self.mode = "deterministic"
        self.observation_len = int(self._session.get_inputs()[0].shape[1])

    def for_model(self, model: Model) -> OnnxPolicy:
        """Return the policy that flies a model: itself, or a refusal where observations do not fit."""
        _check_length(self.observation_len, model)
        return self

    def act(self, observations: Array, *, deterministic: bool = True, rng: np.random.Generator | None = None) -> Array:
        """Choose actions, as :meth:`MlpPolicy.act`."""
        given = numbers_of("observations", observations)
        rows = np.ascontiguousarray(given).reshape(-1, self.observation_len)
        wanted = "actions" if deterministic else "distribution"
        (values,) = self._session.run([wanted], {"observations": rows})
        if not deterministic:
            if rng is None:
                raise PolicyError("deterministic = False: sampled actions need rng, a NumPy generator")
            values = decode(self.head, values, rng)
        return np.asarray(values, np.float32).reshape(*given.shape[:-1], 2)


Policy: TypeAlias = "MlpPolicy | SetPolicy | OnnxPolicy"
"""What :func:`load_policy` gives."""


def load_policy(path: str | os.PathLike[str]) -> Policy:
    """Read a policy: its folder, which needs safetensors, or an `.onnx` file by itself, which needs onnxruntime.

    A network over sets flies any fleet against any number of hotspots: `load_policy(folder).for_model(model)`.
    """
    given = Path(path)
    if given.suffix == ".onnx":
        return OnnxPolicy(given)
    card_path = given / CARD
    try:
        card = json.loads(read_file(card_path).decode("utf-8"))
    except ValueError as error:
        raise PolicyError(f"{card_path}: not JSON: {error}") from error
    if not isinstance(card, dict) or card.get("format") != CARD_FORMAT:
        raise PolicyError(f"{card_path}: must be a policy's card of format {CARD_FORMAT}")
    try:
        config, head, architecture = Config(card["config"]), card["head"], card["architecture"]
        kind, normalised = architecture["kind"], card["normalised_inputs"]
    except KeyError as error:
        raise PolicyError(f"{card_path}: there is no {error}") from error
    arrays, pilot = _load_arrays(given / WEIGHTS), _pilot_command(card, config)
    mode = card.get("mode", "deterministic")
    try:
        if kind == "set_actor":
            size = bool(architecture.get("fleet_size", False))
            tours = bool(architecture.get("tours", False))
            return SetPolicy(arrays, head, config, pilot, mode=mode, fleet_size=size, tours=tours)
        if kind != "mlp":
            raise PolicyError(f"architecture = {kind}: must be mlp or set_actor")
        depth = len(architecture["sizes"]) - 1
        layers = [Layer(arrays[f"{index}.weight"], arrays[f"{index}.bias"].reshape(-1)) for index in range(depth)]
        inputs = (arrays["inputs.offset"], arrays["inputs.scale"]) if normalised else None
        return MlpPolicy(layers, head, inputs=inputs, constant_pilot=pilot, config=config, mode=mode)
    except KeyError as error:
        raise PolicyError(f"{given / WEIGHTS}: there is no array {error}") from error
    except PolicyError as error:
        raise PolicyError(f"{given}: {error}") from error


def _load_arrays(path: Path) -> dict[str, Array]:
    try:
        from safetensors import SafetensorError
        from safetensors.numpy import load
    except ImportError as error:
        raise MissingDependencyError("safetensors", "reading a policy", "policy") from error
    try:
        return {name: array.astype(np.float32) for name, array in load(read_file(path)).items()}
    except SafetensorError as error:
        raise PolicyError(f"{path}: not safetensors: {error}") from error


def _pilot_command(card: dict[str, Any], config: Config) -> float | None:
    """Turn the pilot density that a policy holds into the command that gives it."""
    density = card.get("constant_pilot_density")
    if density is None:
        return None
    low, high = config["pilot_density_min"], config["pilot_density_max"]
    return 2 * (density - low) / (high - low) - 1 if high > low else 0.0


def _write_whole(path: Path, write: Callable[[Path], Any]) -> None:
    """Write under another name and rename, so that no half-written file ever carries the name."""
    temporary = path.with_name(f".{path.name}.{os.getpid()}")
    write(temporary)
    temporary.replace(path)
