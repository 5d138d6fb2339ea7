"""Traces: episodes on file, as `jcas trace record` writes them, flown again and compared bit for bit."""

from __future__ import annotations

import json
import os
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Union

import numpy as np
import numpy.typing as npt

from .arguments import read_file
from .config import Config
from .errors import TraceError
from .hosted import KINDS, own_between_steps, step_with_host
from .model import Model
from .sim import Sim

FORMAT = "jcas-trace"
FORMAT_VERSIONS = (1, 2)

_FNV_BASIS = 0xCBF29CE484222325
_FNV_PRIME = 0x100000001B3
_MASK = 2**64 - 1

TraceLike = Union["Trace", str, "os.PathLike[str]"]


@dataclass(frozen=True)
class Trace:
    """An episode on file."""

    header: dict[str, Any]
    steps: list[dict[str, Any]]
    end: dict[str, Any]
    host: list[list[dict[str, Any]]] = field(default_factory=list)
    """What a host simulator supplied before each step, and after the last; empty where there was no host."""

    @classmethod
    def load(cls, path: str | os.PathLike[str]) -> Trace:
        """Read a trace and check that it is whole: its form, its end, its checksum."""
        content = read_file(Path(path))
        try:
            lines = [json.loads(line) for line in content.splitlines()]
        except ValueError as error:
            raise TraceError(f"{path}: not JSON lines: {error}") from error
        if not lines or not all(isinstance(line, dict) for line in lines):
            raise TraceError(f"{path}: must be JSON objects, one on each line")
        header, *between, end = lines if len(lines) > 1 else (lines[0], {})
        if header.get("format") != FORMAT or header.get("format_version") not in FORMAT_VERSIONS:
            raise TraceError(f"{path}: must be a {FORMAT} of version 1 or 2")
        steps = [line for line in between if line.get("kind") not in KINDS]
        if end.get("kind") != "end" or any(step.get("kind") != "step" for step in steps):
            raise TraceError(f"{path}: cut short: it does not close with its end")
        body = content[: content.rindex(b',"checksum":')]
        if end["checksum"] != f"0x{_fnv1a(body):016x}":
            raise TraceError(f"{path}: the checksum does not match the content")
        return cls(header, steps, end, _by_step(between))

    @property
    def config(self) -> Config:
        """The configuration that was flown."""
        return Config(self.header["config"])

    @property
    def seed(self) -> int:
        """The episode's seed."""
        return int(self.header["seed"], 16)

    def actions(self, step: int) -> npt.NDArray[np.float32]:
        """The actions of a step, counted from 0: [N, 2]."""
        return np.array(self.steps[step]["actions"], dtype=np.float32)


def replay_trace(trace: TraceLike, watch: Callable[[Sim], None] | None = None) -> Sim:
    """Fly a trace again from its seed and actions, and return the simulation at its end.

    Args:
        trace: a trace or its file.
        watch: called with the simulation after the reset and after every step, to draw it for example.

    Raises:
        TraceError: something does not come out as recorded; the message says when, what, and how.

    """
    recorded = trace if isinstance(trace, Trace) else Trace.load(trace)
    model = Model(recorded.config)
    _compare("the header", "config_hash", recorded.header, f"0x{model.config_hash:016x}")
    sim = Sim(model, seed=recorded.seed)
    _compare_moment("reset", sim, recorded.header["initial"])
    if watch:
        watch(sim)
    for index, step in enumerate(recorded.steps):
        step_with_host(sim, recorded.actions(index), recorded.host[index] if recorded.host else [])
        moment = f"step {index + 1}"
        _compare_moment(moment, sim, step)
        _compare(moment, "reward", step, sim.reward_components())
        _compare(moment, "pilot_density", step, sim.pilot_densities().tolist())
        _compare(moment, "throughput", step, sim.mean_throughput)
        if watch:
            watch(sim)
    own_between_steps(sim, recorded.host[-1] if recorded.host else [])
    _compare("the end", "steps", recorded.end, sim.t)
    _compare("the end", "terminated", recorded.end, sim.terminated)
    _compare("the end", "truncated", recorded.end, sim.truncated)
    return sim


def _by_step(lines: list[dict[str, Any]]) -> list[list[dict[str, Any]]]:
    """Gather the calls of a host before each step, and after the last."""
    host: list[list[dict[str, Any]]] = [[]]
    for line in lines:
        if line.get("kind") == "step":
            host.append([])
        else:
            host[-1].append(line)
    return host


def _compare_moment(moment: str, sim: Sim, recorded: dict[str, Any]) -> None:
    _compare(moment, "positions", recorded, sim.cells().tolist())
    _compare(moment, "battery_uj", recorded, sim.batteries_uj().tolist())
    observations = sim.observe().astype("<f4", copy=False)
    _compare(moment, "observation_hash", recorded, f"0x{_fnv1a(observations.tobytes()):016x}")
    _compare(moment, "state_hash", recorded, f"0x{sim.state_hash():016x}")


def _compare(moment: str, quantity: str, recorded: dict[str, Any], flown: Any) -> None:
    if recorded.get(quantity) != flown:
        raise TraceError(f"{moment}: {quantity} is {flown}, recorded was {recorded.get(quantity)}")


def _fnv1a(content: bytes) -> int:
    """Hash bytes as trace files do (FNV-1a, 64 bits)."""
    value = _FNV_BASIS
    for byte in content:
        value = ((value ^ byte) * _FNV_PRIME) & _MASK
    return value
