"""One simulation: stepping, observing, every quantity of its state, snapshots and forks."""

from __future__ import annotations

import ctypes
import weakref
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np
import numpy.typing as npt

from . import _abi
from ._library import check, fail_saying, lib, listed
from .arguments import floats, seed_of, snapshot_of, writable
from .model import Model, check_model
from .scene import Scene

Floats = npt.NDArray[np.float32]

UAV = np.dtype(_abi.jcas_uav)
HOTSPOT = np.dtype(_abi.jcas_hotspot)


REWARD_NAMES = listed(lib.jcas_reward_name)
"""The components of a reward, in the order in which they are summed."""

EPISODE_INFO: dict[str, Any] = {
    "success": False,
    **{
        name: 0.0 if kind is ctypes.c_double else 0
        for name, kind, *_ in _abi.jcas_metrics._fields_
        if name not in ("struct_size", "terminated", "truncated")
    },
}
"""What the infos of environments say of an episode at its end; these zeros before."""


@dataclass(frozen=True)
class StepOutcome:
    """The result of a step: the team's reward, and whether and how the episode ended."""

    reward: float
    terminated: bool
    truncated: bool


class Sim:
    """One state of a model. Equal models, seeds and actions give equal bits, everywhere.

    Args:
        model: the model; kept alive by its simulations.
        seed: of the first episode.

    """

    def __init__(self, model: Model, seed: int = 0) -> None:
        self.model = check_model(model)
        first = seed_of("seed", seed)
        handle = ctypes.c_void_p()
        check(lib.jcas_sim_new(model.handle, ctypes.byref(handle)))
        self.handle = handle
        weakref.finalize(self, _free, handle, model)
        self._outcome = _abi.jcas_outcome(struct_size=ctypes.sizeof(_abi.jcas_outcome))
        self._action_len = 2 * model.uav_count
        if first:
            self.reset(first)

    def __reduce__(self) -> tuple[Any, tuple[Model, bytes]]:
        return (_restore, (self.model, self.save()))

    def __copy__(self) -> Sim:
        return self.fork()

    def __repr__(self) -> str:
        return (
            f"<jcas.Sim: {self.model.uav_count} UAVs, {self.model.hotspot_count} hotspots, "
            f"seed {self.seed}, "
            f"step {self.t} of {self.model.config['horizon_steps']}>"
        )

    def reset(self, seed: int) -> None:
        """Begin the episode of a seed."""
        self._check(lib.jcas_sim_reset(self.handle, seed_of("seed", seed)))

    def step(self, actions: npt.ArrayLike) -> StepOutcome:
        """Take one step. `actions` is [N, 2]: (u_dir, u_pilot) of each UAV, clipped to -1 to 1."""
        pairs = floats("actions", actions, (self.model.uav_count, 2))
        outcome = self._outcome
        status = lib.jcas_sim_step(
            self.handle, pairs.ctypes.data, self._action_len, ctypes.byref(outcome)
        )
        if status:
            self._fail(status)
        return StepOutcome(outcome.reward, outcome.terminated != 0, outcome.truncated != 0)

    def observe(self, out: Floats | None = None) -> Floats:
        """Observe: a row for each UAV, [N, observation length], written into `out` where given."""
        shape = (self.model.uav_count, self.model.observation_len)
        rows = np.empty(shape, np.float32) if out is None else writable("out", out, shape)
        self._check(lib.jcas_sim_observe(self.handle, rows.ctypes.data, rows.size))
        return rows

    def observe_global(self, out: Floats | None = None) -> Floats:
        """Observe the global state, [global length], for a centralised critic."""
        row = (
            np.empty(self.model.global_len, np.float32)
            if out is None
            else writable("out", out, (self.model.global_len,))
        )
        self._check(lib.jcas_sim_observe_global(self.handle, row.ctypes.data, row.size))
        return row

    # Quantities of the state.

    def episode(self) -> _abi.jcas_episode:
        """Time, phase and the fleet's ledgers, as a record of the C interface."""
        episode = _abi.jcas_episode(struct_size=ctypes.sizeof(_abi.jcas_episode))
        self._check(lib.jcas_sim_get_episode(self.handle, ctypes.byref(episode)))
        return episode

    @property
    def t(self) -> int:
        """Steps since the reset."""
        return int(self.episode().t)

    @property
    def seed(self) -> int:
        """Seed of the episode."""
        return int(self.episode().seed)

    @property
    def terminated(self) -> bool:
        """Whether the episode ended because every hotspot is confirmed and informed."""
        return self.episode().terminated != 0

    @property
    def truncated(self) -> bool:
        """Whether the episode ended at its horizon."""
        return self.episode().truncated != 0

    @property
    def mean_throughput(self) -> float:
        """Mean normalised throughput over all UAVs in the last step."""
        return float(self.episode().mean_throughput)

    def uavs(self) -> npt.NDArray[np.void]:
        """Every quantity of every UAV, as a structured array with the fields of the C interface."""
        uavs = np.empty(self.model.uav_count, UAV)
        self._check(
            lib.jcas_sim_get_uavs(self.handle, uavs.ctypes.data_as(_UAV), uavs.size, UAV.itemsize)
        )
        return uavs

    def hotspots(self) -> npt.NDArray[np.void]:
        """All quantities of the hotspots: a structured array with the C interface's fields."""
        hotspots = np.empty(self.model.hotspot_count, HOTSPOT)
        self._check(
            lib.jcas_sim_get_hotspots(
                self.handle, hotspots.ctypes.data_as(_HOTSPOT), hotspots.size, HOTSPOT.itemsize
            )
        )
        return hotspots

    def cells(self) -> npt.NDArray[np.uint32]:
        """Cells of the UAVs, [N, 2]; y grows upwards."""
        return _cells(self.uavs())

    def batteries_uj(self) -> npt.NDArray[np.uint64]:
        """Charges of the batteries in microjoules, [N]."""
        return self.uavs()["battery_uj"].copy()

    def soc(self) -> npt.NDArray[np.float64]:
        """States of charge, 0 to 1, [N]."""
        return self.uavs()["battery_uj"] / self.model.battery_capacity_uj

    def pilot_densities(self) -> npt.NDArray[np.float64]:
        """Pilot densities, [N]."""
        return self.uavs()["pilot_density"].copy()

    def hotspot_cells(self) -> npt.NDArray[np.uint32]:
        """Cells of the hotspots, [n, 2]."""
        return _cells(self.hotspots())

    def confirmed(self) -> npt.NDArray[np.bool_]:
        """Which hotspots are confirmed, [n]."""
        return self.hotspots()["confirmed"] != 0

    def informed(self) -> npt.NDArray[np.bool_]:
        """Which hotspots every UAV knows, [n]."""
        return self.hotspots()["informed"] != 0

    def links(self) -> npt.NDArray[np.bool_]:
        """Radio links between UAVs, symmetric, [N, N]."""
        return self._flags(lib.jcas_sim_get_links, (self.model.uav_count, self.model.uav_count))

    def knowledge(self) -> npt.NDArray[np.bool_]:
        """Which UAV knows which hotspot, [N, n]."""
        return self._flags(
            lib.jcas_sim_get_knowledge, (self.model.uav_count, self.model.hotspot_count)
        )

    def visited(self) -> npt.NDArray[np.bool_]:
        """Cells that any UAV has been in, [H, W]."""
        record = self.model.config.record
        return self._flags(lib.jcas_sim_get_visited, (record.grid_height, record.grid_width))

    def search_maps(self) -> npt.NDArray[np.bool_]:
        """Cells that each UAV knows to be searched, [N, H, W]; N is 0 without search maps."""
        config = self.model.config
        uavs = self.model.uav_count if config["search_maps"] == "shared" else 0
        return self._flags(
            lib.jcas_sim_get_search_maps, (uavs, config["grid_height"], config["grid_width"])
        )

    def false_alarms(self) -> npt.NDArray[np.bool_]:
        """Cells without a hotspot in which each UAV saw one in the last step, [N, H, W].

        N is 0 without false alarms.
        """
        record = self.model.config.record
        uavs = self.model.uav_count if record.false_alarm_per_cell > 0 else 0
        shape = (uavs, record.grid_height, record.grid_width)
        return self._flags(lib.jcas_sim_get_false_alarms, shape)

    def false_confirmations(self) -> npt.NDArray[np.bool_]:
        """Cells without a hotspot that a quorum has confirmed, [H, W].

        H is 0 without false alarms.
        """
        record = self.model.config.record
        rows = record.grid_height if record.false_alarm_per_cell > 0 else 0
        return self._flags(lib.jcas_sim_get_false_confirmations, (rows, record.grid_width))

    def reports(self) -> npt.NDArray[np.uint8]:
        """Level at which each UAV knows a report of each cell, or 0, [N, H, W].

        Level l stands for l sightings of a hotspot, true or false, by one UAV. N is 0 without
        reports.
        """
        record = self.model.config.record
        uavs = self.model.uav_count if record.report_levels > 0 else 0
        levels = np.empty((uavs, record.grid_height, record.grid_width), np.uint8)
        self._check(lib.jcas_sim_get_reports(self.handle, levels.ctypes.data, levels.size))
        return levels

    def reward_components(self) -> dict[str, float]:
        """Give the components of the last reward by name; their sum, in order, is the reward."""
        return dict(zip(REWARD_NAMES, self.reward_component_array().tolist(), strict=True))

    def reward_component_array(self) -> npt.NDArray[np.float64]:
        """Return the components of the last reward, [12], in the order of `REWARD_NAMES`."""
        values = np.empty(len(REWARD_NAMES))
        self._check(lib.jcas_sim_get_rewards(self.handle, values.ctypes.data, values.size))
        return values

    def uav_rewards(self) -> npt.NDArray[np.float64]:
        """Give the reward of each UAV in the last step, [N]; their mean is the team's."""
        rewards = np.empty(self.model.uav_count)
        self._check(lib.jcas_sim_uav_rewards(self.handle, rewards.ctypes.data, rewards.size))
        return rewards

    def uav_reward_components(self) -> npt.NDArray[np.float64]:
        """Return each UAV's reward components, [N, 12], in the order of `REWARD_NAMES`."""
        components = np.empty((self.model.uav_count, len(REWARD_NAMES)))
        self._check(
            lib.jcas_sim_uav_reward_components(self.handle, components.ctypes.data, components.size)
        )
        return components

    def metrics(self) -> dict[str, Any]:
        """Metrics of the episode so far."""
        metrics = _abi.jcas_metrics(struct_size=ctypes.sizeof(_abi.jcas_metrics))
        self._check(lib.jcas_sim_get_metrics(self.handle, ctypes.byref(metrics)))
        values = {
            name: getattr(metrics, name) for name, *_ in metrics._fields_ if name != "struct_size"
        }
        return {
            **values,
            "terminated": metrics.terminated != 0,
            "truncated": metrics.truncated != 0,
        }

    # Snapshots.

    def state_hash(self) -> int:
        """Fingerprint of the state: equal for equal states, on every platform."""
        value = ctypes.c_uint64()
        self._check(lib.jcas_sim_hash(self.handle, ctypes.byref(value)))
        return value.value

    def save(self) -> bytes:
        """Save the state as bytes that mean the same on every platform."""
        snapshot = ctypes.create_string_buffer(self.model.snapshot_size)
        self._check(lib.jcas_sim_save(self.handle, snapshot, len(snapshot)))
        return snapshot.raw

    def load(self, snapshot: bytes) -> None:
        """Load a saved state of an equal configuration. Other bytes change nothing and raise."""
        saved = snapshot_of("snapshot", snapshot)
        self._check(lib.jcas_sim_load(self.handle, saved, len(saved)))

    def fork(self) -> Sim:
        """Return an independent copy with the same state."""
        twin = Sim(self.model)
        self._check(lib.jcas_sim_fork(self.handle, twin.handle))
        return twin

    def scene(self, trail: tuple[npt.NDArray[np.uint32], ...] = ()) -> Scene:
        """The scene of this moment, for a picture."""
        config, uavs, hotspots = self.model.config, self.uavs(), self.hotspots()
        episode, metrics = self.episode(), self.metrics()
        searching = config["search_maps"] == "shared"
        ended = "success" if episode.terminated else "horizon reached" if episode.truncated else ""
        return Scene(
            grid_width=config["grid_width"],
            grid_height=config["grid_height"],
            t=episode.t,
            horizon_steps=config["horizon_steps"],
            cells=_cells(uavs),
            soc=uavs["battery_uj"] / self.model.battery_capacity_uj,
            pilot_density=uavs["pilot_density"],
            pilot_density_min=config["pilot_density_min"],
            pilot_density_max=config["pilot_density_max"],
            grounded=uavs["grounded"] != 0,
            returning=uavs["returning"] != 0,
            links=self.links(),
            depots=np.array(self.model.depots()),
            hotspots=_cells(hotspots),
            confirmed=hotspots["confirmed"] != 0,
            informed=hotspots["informed"] != 0,
            share_knowing=self.knowledge().mean(axis=0),
            searched=np.any(self.search_maps(), axis=0, out=self.visited())
            if searching
            else self.visited(),
            searched_by="searched cells" if searching else "visited cells",
            sensing_range=np.where(
                uavs["grounded"] != 0,
                0,
                [self.model.sensing_range(float(pilot)) for pilot in uavs["pilot_density"]],
            ),
            outcome=ended,
            readings=(
                ("Return", f"{metrics['return_sum']:.2f}"),
                ("Throughput", f"{episode.mean_throughput:.2f}"),
                ("Energy spent", f"{metrics['energy_kwh']:.3f} kWh"),
                ("CO2", f"{1000 * metrics['co2_kg']:.1f} g"),
            ),
            trail=trail,
        )

    def _flags(self, read: Any, shape: tuple[int, ...]) -> npt.NDArray[np.bool_]:
        flags = np.empty(shape, np.bool_)
        self._check(read(self.handle, flags.ctypes.data, flags.size))
        return flags

    def _check(self, status: int) -> None:
        if status:
            self._fail(status)

    def _fail(self, status: int) -> None:
        fail_saying(status, partial(lib.jcas_sim_message, self.handle))


_UAV = ctypes.POINTER(_abi.jcas_uav)
_HOTSPOT = ctypes.POINTER(_abi.jcas_hotspot)


def _free(handle: ctypes.c_void_p, model: Model) -> None:
    """Free a simulation; that `model` is an argument keeps it alive until then."""
    lib.jcas_sim_free(handle)


def _restore(model: Model, snapshot: bytes) -> Sim:
    sim = Sim(model)
    sim.load(snapshot)
    return sim


def _cells(records: npt.NDArray[np.void]) -> npt.NDArray[np.uint32]:
    return np.stack([records["x"], records["y"]], axis=1)
