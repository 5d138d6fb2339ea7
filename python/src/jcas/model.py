"""The model: a legal configuration with the tables that are computed before the first step."""

from __future__ import annotations

import ctypes
import weakref
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from gymnasium import spaces
from typing_extensions import Unpack

from . import _abi
from ._fields import Fields
from ._library import check, check_with_message, lib
from .arguments import SEED_MAX, real, seed_of, shown, whole
from .config import Config, ConfigLike
from .errors import ArgumentError
from .signature import shows_fields


@dataclass(frozen=True)
class Radio:
    """Radar and link between two cells, at a pilot density of the sender."""

    sensing_snr_db: float
    detection_probability: float
    comm_snr_db: float
    link_throughput: float


class Model:
    """An immutable model; any number of simulations and batches may share one.

    Args:
        config: see `jcas.Config`.
        **fields: fields that replace those of `config`.

    """

    @shows_fields
    def __init__(self, config: ConfigLike = None, **fields: Unpack[Fields]) -> None:
        self.config = (
            config if isinstance(config, Config) and not fields else Config(config, **fields)
        )
        handle = ctypes.c_void_p()
        check_with_message(
            lambda message, capacity: lib.jcas_model_new(
                ctypes.byref(self.config.record), ctypes.byref(handle), message, capacity
            )
        )
        self.handle = handle
        self._ranges: dict[tuple[float, float], float] = {}
        weakref.finalize(self, lib.jcas_model_free, handle)
        info = _abi.jcas_model_info(struct_size=ctypes.sizeof(_abi.jcas_model_info))
        check(lib.jcas_model_get_info(handle, ctypes.byref(info)))
        self.uav_count: int = info.uav_count
        self.hotspot_count: int = info.hotspot_count
        self.neighbour_slots: int = info.neighbour_slots
        self.observation_len: int = info.observation_len
        self.global_len: int = info.global_len
        self.snapshot_size: int = info.snapshot_size
        self.config_hash: int = info.config_hash
        self.battery_capacity_uj: int = info.battery_capacity_uj
        self.detection_threshold_db: float = info.detection_threshold_db

    def __reduce__(self) -> tuple[type[Model], tuple[Config]]:
        return (Model, (self.config,))

    def __copy__(self) -> Model:
        return self

    def __deepcopy__(self, memo: object) -> Model:
        return self

    def __repr__(self) -> str:
        config = self.config
        return (
            f"<jcas.Model: {self.uav_count} UAVs, {self.hotspot_count} hotspots, "
            f"{config['grid_width']} x {config['grid_height']} cells, "
            f"hash 0x{self.config_hash:016x}>"
        )

    def radio(self, dx: int, dy: int, pilot_density: float) -> Radio:
        """Radar and link over an offset of cells, at a pilot density of the sender."""
        record, radio = (
            self.config.record,
            _abi.jcas_radio(struct_size=ctypes.sizeof(_abi.jcas_radio)),
        )
        across = whole("dx", dx, 1 - record.grid_width, record.grid_width - 1)
        along = whole("dy", dy, 1 - record.grid_height, record.grid_height - 1)
        density = real("pilot_density", pilot_density)
        if not record.pilot_density_min <= density <= record.pilot_density_max:
            raise ArgumentError(
                f"pilot_density = {density!r}: must be a number from {record.pilot_density_min} "
                f"to {record.pilot_density_max}"
            )
        check(
            lib.jcas_model_get_radio(
                self.handle, abs(across), abs(along), density, ctypes.byref(radio)
            )
        )
        return Radio(
            radio.sensing_snr_db,
            radio.detection_probability,
            radio.comm_snr_db,
            radio.link_throughput,
        )

    def sensing_range(self, pilot_density: float, probability: float = 0.1) -> float:
        """Return the range in cells at which a radar detects a hotspot with a given probability.

        The probability is interpolated linearly between the middles of cells. The range is 0 where
        the probability is not reached even in the UAV's own cell.
        """
        chance = real("probability", probability)
        if not 0 < chance <= 1:
            raise ArgumentError(f"probability = {shown(probability)}: must be above 0, at most 1")
        key = round(real("pilot_density", pilot_density), 3), chance
        if key not in self._ranges:
            self._ranges[key] = self._range(pilot_density, chance)
        return self._ranges[key]

    def _range(self, pilot_density: float, probability: float) -> float:
        before = self.radio(0, 0, pilot_density).detection_probability
        if before < probability:
            return 0.0
        for cells in range(1, max(self.config.record.grid_width, 1)):
            after = self.radio(cells, 0, pilot_density).detection_probability
            if after < probability:
                return cells - 1 + (before - probability) / (before - after)
            before = after
        return float(self.config.record.grid_width)

    def depots(self) -> list[tuple[int, int]]:
        """Return the depots in force: those of the configuration, or the one in the middle."""
        record = self.config.record
        if record.depot_count == 0:
            return [(record.grid_width // 2, record.grid_height // 2)]
        return [(cell.x, cell.y) for cell in record.depots[: record.depot_count]]

    def observation_fields(self) -> dict[str, npt.NDArray[np.intp]]:
        """Return the indices of each observation field, by name. Each index occurs once.

        `observations[..., model.observation_fields()["hotspot_dx"]]` has one entry for each
        hotspot. Fields that the configuration leaves out have no places.
        """
        fields = (_abi.jcas_observation_field * _abi.JCAS_OBSERVATION_FIELDS)()
        size = ctypes.sizeof(_abi.jcas_observation_field)
        check(lib.jcas_model_observation_fields(self.handle, fields, len(fields), size))
        return {
            lib.jcas_observation_field_name(index).decode(): field.offset
            + field.stride * np.arange(field.count)
            for index, field in enumerate(fields)
        }

    def observation_space(self, uavs: int | None = None) -> spaces.Box:
        """Return the space of one UAV's observation, or of the rows of `uavs` UAVs."""
        low = np.full(self.observation_len, -1.0, np.float32)
        high = np.ones(self.observation_len, np.float32)
        high[4] = self._throughput_max()
        if uavs is not None:
            low, high = np.tile(low, (uavs, 1)), np.tile(high, (uavs, 1))
        return spaces.Box(low, high, dtype=np.float32)

    def global_space(self) -> spaces.Box:
        """Describe the global state."""
        high = np.ones(self.global_len, np.float32)
        high[4 : 6 * self.uav_count : 6] = self._throughput_max()
        return spaces.Box(np.full(self.global_len, -1.0, np.float32), high, dtype=np.float32)

    def _throughput_max(self) -> np.float32:
        """Bound mean throughput: a neighbour in one's own cell at the lowest pilot density."""
        nearest = self.radio(0, 0, float(self.config["pilot_density_min"])).link_throughput
        return np.nextafter(np.float32(max(nearest, 1.0)), np.float32(np.inf))


def derive_seed(seed: int, index: int) -> int:
    """Derive the seed with the given index from a seed, as the command line does."""
    return int(lib.jcas_derive_seed(seed_of("seed", seed), whole("index", index, 0, SEED_MAX)))


def check_model(model: object) -> Model:
    """Refuse what is no model."""
    if not isinstance(model, Model):
        raise ArgumentError(f"model = {shown(model)}: must be a jcas.Model")
    return model
