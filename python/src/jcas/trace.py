"""Traces: recorded episodes that are shown as a page, replayed and compared byte by byte."""

from __future__ import annotations

import ctypes
import html
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
from .arguments import read_file, seed_of, shown
from .config import Config
from .errors import ArgumentError, TraceError
from .evaluation import Act
from .files import write_whole
from .flown import Policy
from .model import Model, check_model
from .registration import PRESETS
from .sim import Sim
from .spaces import ActionForm, ActionSpaceKind

FORMAT = "jcas-trace"
FORMAT_VERSION = 1

_WRITE = ctypes.CFUNCTYPE(ctypes.c_int32, ctypes.c_void_p, ctypes.c_size_t, ctypes.c_void_p)

TraceLike = Union["Trace", str, "os.PathLike[str]"]


@dataclass(frozen=True, repr=False)
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
        return cls.of(read_file(Path(path)), str(path))

    @classmethod
    def of(cls, content: bytes, path: str = "trace") -> Trace:
        """Take a trace from its text, with the same checks."""
        try:
            lines = [json.loads(line) for line in content.splitlines()]
        except ValueError as error:
            raise TraceError(f"{path}: not JSON lines: {error}") from error
        if not lines or not all(isinstance(line, dict) for line in lines):
            raise TraceError(f"{path}: must be JSON objects, one on each line")
        header, *between, end = lines if len(lines) > 1 else (lines[0], {})
        if header.get("format") != FORMAT or header.get("format_version") != FORMAT_VERSION:
            raise TraceError(f"{path}: must be a {FORMAT} of version {FORMAT_VERSION}")
        if end.get("kind") != "end":
            raise TraceError(f"{path}: cut short: it does not close with its end")
        steps = [line for line in between if line.get("kind") == "step"]
        trace = cls(content, header, steps, end, _by_step(between))
        try:
            _Replay(trace).advance()
        except TraceError as error:
            raise TraceError(f"{path}: {error}") from error
        return trace

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write the trace to a file, which `jcas trace verify` and `jcas replay` read."""
        write_whole(Path(path), lambda part: part.write_bytes(self.text))

    def to_html(self) -> str:
        """Return one page that plays the episode and loads nothing, as `jcas replay` writes it."""
        page = Path(__file__).parent / "_native" / "replay.html"
        data = json.dumps(_page_data(self), separators=(",", ":")).replace("<", "\\u003c")
        filled = read_file(page).decode().replace("{{title}}", html.escape(repr(self)), 1)
        return filled.replace("{{presets}}", _page_presets(), 1).replace("{{data}}", data, 1)

    def save_html(self, path: str | os.PathLike[str]) -> None:
        """Write the page of `to_html` to a file."""
        text = self.to_html()
        write_whole(Path(path), lambda part: part.write_text(text, encoding="utf-8"))

    def _repr_html_(self) -> str:
        """Show the page in a notebook."""
        style = "width:100%;height:900px;border:0"
        page = html.escape(self.to_html())
        return f'<iframe sandbox="allow-scripts" style="{style}" srcdoc="{page}"></iframe>'

    def __repr__(self) -> str:
        outcome = "success" if self.end["metrics"]["terminated"] else "no success"
        return (
            f"<jcas.Trace of {self.header['policy']}, seed {self.seed}: {outcome} "
            f"in {len(self.steps)} steps>"
        )

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


class Recorder:
    """Records an episode of a simulation: it begins that of a seed.

    Any replacement of the state (a reset, `load`) ends the recording without a trace.

    Args:
        sim: the simulation.
        seed: of the episode.
        policy: the name of what steers, for the trace.

    """

    def __init__(self, sim: Sim, seed: int, policy: str = "host") -> None:
        if not isinstance(sim, Sim):
            raise ArgumentError(f"sim = {shown(sim)}: must be a jcas.Sim")
        self._sim = sim
        self._pieces: list[bytes] = []
        self._memory = _memory(sim.model)
        self._take = _WRITE(self._piece)
        self._name = ctypes.create_string_buffer(str(policy).replace("\0", " ").encode())
        record = _abi.jcas_recorder(
            struct_size=ctypes.sizeof(_abi.jcas_recorder),
            write=ctypes.cast(self._take, ctypes.c_void_p),
            policy=ctypes.cast(self._name, ctypes.c_void_p),
            pilot=ctypes.cast(self._name, ctypes.c_void_p),
            memory=self._memory.ctypes.data,
            memory_size=self._memory.nbytes,
        )
        check(lib.jcas_sim_record(sim.handle, seed_of("seed", seed), ctypes.byref(record)))

    def trace(self) -> Trace:
        """End the recording and return the trace."""
        check(lib.jcas_sim_record_end(self._sim.handle))
        return Trace.of(b"".join(self._pieces))

    def _piece(self, data: int, count: int, _: object) -> int:
        self._pieces.append(ctypes.string_at(data, count))
        return 0


def run_episode(
    act: Act | Policy,
    model: Model | None = None,
    *,
    seed: int = 1,
    name: str | None = None,
    action_space: ActionSpaceKind = "box",
    pilot_levels: int = 3,
) -> Trace:
    """Run one episode and return its trace, which shows itself in a notebook.

    Args:
        act: a policy, or a function from observations to actions, as `jcas.evaluation.evaluate`
            takes it.
        model: the model of the episode; a policy brings its own.
        seed: of the episode.
        name: of the policy in the trace.
        action_space: the form of the function's actions, as of `jcas.make_vec`.
        pilot_levels: pilot densities of `discrete`.

    """
    if model is None and isinstance(act, Policy):
        model = act.model
    sim = Sim(check_model(model))
    form = ActionForm(sim.model, action_space, pilot_levels)
    known = getattr(act, "name", None) or getattr(act, "__name__", "policy")
    recorder = Recorder(sim, seed, name or str(known))
    if hasattr(act, "reset"):
        act.reset(1)
    shape = (1, sim.model.uav_count, 2)
    while not (sim.terminated or sim.truncated):
        if isinstance(act, Policy):
            sim.step(act.act(sim))
        else:
            sim.step(form.encode_fleet(act(sim.observe()[None]), shape)[0])
    return recorder.trace()


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
        self._memory = _memory(self.sim.model)

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


def _memory(model: Model) -> npt.NDArray[np.uint64]:
    """Return the working memory of recordings and replays."""
    size, alignment = ctypes.c_size_t(), ctypes.c_size_t()
    check(lib.jcas_trace_layout(model.handle, ctypes.byref(size), ctypes.byref(alignment)))
    return np.zeros(size.value // 8, np.uint64)


def _page_presets() -> str:
    """Return the presets, by which the page names that of its episode, and no command for it."""
    presets = {name: dict(Config(name)) for name in PRESETS}
    return json.dumps({"first": PRESETS[0], "presets": presets, "baselines": []})


def _page_data(trace: Trace) -> dict[str, Any]:
    """Lay a trace out as the page reads it: a host's own start replaces the drawn one."""
    header = json.loads(json.dumps(trace.header))
    initial = header["initial"]
    for call in trace.host[0]:
        match call["kind"]:
            case "set_starts":
                initial["positions"] = call["cells"]
            case "set_hotspots":
                header["hotspots"] = call["cells"]
            case "set_batteries":
                initial["battery_uj"] = call["charges_uj"]
            case "set_battery":
                initial["battery_uj"][call["uav"]] = call["charge_uj"]
            case "move_hotspot":
                header["hotspots"][call["hotspot"]] = call["cell"]
    steps = [dict(step) for step in trace.steps]
    for step, calls in zip(steps[1:], trace.host[1:], strict=False):
        moved = [
            (call["hotspot"], call["cell"]) for call in calls if call["kind"] == "move_hotspot"
        ]
        if moved:
            step["moved_hotspots"] = moved
    hosted = {"hosted": True} if any(trace.host) else {}
    return {"header": header, "steps": steps, "end": trace.end, **hosted}
