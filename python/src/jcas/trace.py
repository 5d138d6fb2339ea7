"""Traces: recorded episodes that are replayed and compared byte by byte."""

from __future__ import annotations

import ctypes
import json
import os
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Union

import numpy as np
import numpy.typing as npt

from . import _abi
from ._library import check, lib
from .arguments import read_file
from .config import Config
from .errors import TraceError
from .model import Model
from .sim import Sim

FORMAT = "jcas-trace"
FORMAT_VERSIONS = (1, 2)

TraceLike = Union["Trace", str, "os.PathLike[str]"]


@dataclass(frozen=True)
class Trace:
    """An episode on file."""

    text: bytes = field(repr=False)
    """The file as it is, which `replay_trace` flies."""
    header: dict[str, Any]
    steps: list[dict[str, Any]]
    end: dict[str, Any]
    host: list[list[dict[str, Any]]]
    """The calls of a host simulator before each step, and after the last."""

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
        if end.get("kind") != "end":
            raise TraceError(f"{path}: cut short: it does not close with its end")
        steps = [line for line in between if line.get("kind") == "step"]
        trace = cls(content, header, steps, end, _by_step(between))
        try:
            _Replay(trace).advance()
        except TraceError as error:
            raise TraceError(f"{path}: {error}") from error
        return trace

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
    """Fly a trace again, compare every byte, and return the simulation at its end.

    Args:
        trace: a trace or its file.
        watch: called with the simulation after the reset and after every step, to draw it for
            example.

    Raises:
        TraceError: a line is not flown as recorded; the message names the line and the field.

    """
    replay = _Replay(trace if isinstance(trace, Trace) else Trace.load(trace))
    sim = replay.sim
    watched = -1
    while not replay.over():
        replay.advance()
        if watch and sim.t > watched:
            watched = sim.t
            watch(sim)
    return sim


class _Replay:
    """A trace that the library flies, step by step."""

    def __init__(self, trace: Trace) -> None:
        self._text = trace.text
        self._offset = ctypes.c_size_t()
        self._message = ctypes.create_string_buffer(1024)
        config = _abi.jcas_config()
        # Before the model, for a message that names the line.
        self._check(lib.jcas_trace_config, ctypes.byref(config), ctypes.sizeof(config))
        self.sim = Sim(Model(trace.config))
        size, alignment = ctypes.c_size_t(), ctypes.c_size_t()
        check(
            lib.jcas_trace_layout(
                self.sim.model.handle, ctypes.byref(size), ctypes.byref(alignment)
            )
        )
        self._memory = np.zeros(size.value // 8, np.uint64)

    def over(self) -> bool:
        """Whether the last line has been flown."""
        return self._offset.value == len(self._text)

    def advance(self) -> None:
        """Replay to the end of the next step; the first call replays the reset."""
        memory = (self.sim.handle, self._memory.ctypes.data, self._memory.nbytes)
        self._check(lambda *rest: lib.jcas_trace_step(*memory, *rest), ctypes.byref(self._offset))

    def _check(self, call: Callable[..., int], *arguments: object) -> None:
        status = call(self._text, len(self._text), *arguments, self._message, len(self._message))
        if status:
            words = self._message.value.decode("utf-8", "replace")
            raise TraceError(words or lib.jcas_status_string(status).decode(), status)


def _by_step(lines: list[dict[str, Any]]) -> list[list[dict[str, Any]]]:
    """Gather the calls of a host before each step, and after the last."""
    host: list[list[dict[str, Any]]] = [[]]
    for line in lines:
        if line.get("kind") == "step":
            host.append([])
        else:
            host[-1].append(line)
    return host
