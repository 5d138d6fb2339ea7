"""What a host simulator supplied to an episode, as its trace tells it: each call made again on a simulation."""

from __future__ import annotations

import ctypes
from collections.abc import Callable
from typing import Any

import numpy as np
import numpy.typing as npt

from . import _abi
from ._library import lib
from .sim import Sim

Line = dict[str, Any]

STEP_PARTS = ("step_sense_with", "step_communicate_with")
WITHIN_A_STEP = ("set_positions", "ground", "confirm_hotspot", *STEP_PARTS)


def step_with_host(sim: Sim, actions: npt.NDArray[np.float32], host: list[Line]) -> None:
    """Take a step in which the host owns something: what came before it, then the step by its parts."""
    own_between_steps(sim, host)
    within = {line["kind"]: line for line in host if line["kind"] in STEP_PARTS}
    if not any(line["kind"] in WITHIN_A_STEP for line in host):
        sim.step(actions)
        return
    sim._check(lib.jcas_sim_step_begin(sim.handle, actions.ctypes.data, actions.size))
    for line in host:
        if line["kind"] in WITHIN_A_STEP and line["kind"] not in STEP_PARTS:
            _CALLS[line["kind"]](sim, line)
    if "step_sense_with" in within:
        _sense_with(sim, within["step_sense_with"])
    else:
        sim._check(lib.jcas_sim_step_sense(sim.handle))
    if "step_communicate_with" in within:
        _communicate_with(sim, within["step_communicate_with"])
    else:
        sim._check(lib.jcas_sim_step_communicate(sim.handle))
    sim._check(lib.jcas_sim_step_end(sim.handle, ctypes.byref(sim._outcome)))


def own_between_steps(sim: Sim, host: list[Line]) -> None:
    """Make the calls that stand between two steps."""
    for line in host:
        if line["kind"] not in WITHIN_A_STEP:
            _CALLS[line["kind"]](sim, line)


def _cells(call: Any) -> Callable[[Sim, Line], None]:
    def make(sim: Sim, line: Line) -> None:
        cells = np.array(line["cells"], dtype=np.uint32)
        sim._check(call(sim.handle, cells.ctypes.data_as(_CELL), len(cells)))

    return make


def _set_batteries(sim: Sim, line: Line) -> None:
    charges = np.array(line["charges_uj"], dtype=np.uint64)
    sim._check(lib.jcas_sim_set_batteries(sim.handle, charges.ctypes.data, charges.size))


def _sense_with(sim: Sim, line: Line) -> None:
    detections = np.zeros((sim.model.uav_count, sim.model.hotspot_count), np.uint8)
    for uav, hotspot in line["detections"]:
        detections[uav, hotspot] = 1
    sim._check(lib.jcas_sim_step_sense_with(sim.handle, detections.ctypes.data, detections.size))


def _communicate_with(sim: Sim, line: Line) -> None:
    links = np.zeros((sim.model.uav_count, sim.model.uav_count), np.uint8)
    for i, k in line["links"]:
        links[i, k] = links[k, i] = 1
    measured = np.array([] if line["throughput"] is None else line["throughput"], dtype=np.float64)
    pointer = measured.ctypes.data if measured.size else None
    sim._check(lib.jcas_sim_step_communicate_with(sim.handle, links.ctypes.data, links.size, pointer, measured.size))


_CELL = ctypes.POINTER(_abi.jcas_cell)

_CALLS: dict[str, Callable[[Sim, Line], None]] = {
    "set_starts": _cells(lib.jcas_sim_set_starts),
    "set_hotspots": _cells(lib.jcas_sim_set_hotspots),
    "set_positions": _cells(lib.jcas_sim_set_positions),
    "set_batteries": _set_batteries,
    "set_battery": lambda sim, line: sim._check(lib.jcas_sim_set_battery(sim.handle, line["uav"], line["charge_uj"])),
    "move_hotspot": lambda sim, line: sim._check(lib.jcas_sim_move_hotspot(sim.handle, line["hotspot"], *line["cell"])),
    "ground": lambda sim, line: sim._check(lib.jcas_sim_ground(sim.handle, line["uav"])),
    "confirm_hotspot": lambda sim, line: sim._check(lib.jcas_sim_confirm_hotspot(sim.handle, line["hotspot"])),
    "step_sense_with": _sense_with,
    "step_communicate_with": _communicate_with,
}

KINDS = frozenset(_CALLS)
