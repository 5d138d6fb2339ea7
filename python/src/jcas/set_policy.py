"""Networks over sets of hotspots and UAVs, evaluated by NumPy: one set of weights flies any fleet.

The equations are those of `jcas train`: every hotspot and neighbour passes through shared layers; neighbours are
pooled by a sum, hotspots by attention, after a round in which each hotspot knows of the others.
"""

from __future__ import annotations

import copy
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from .arguments import Floats, numbers_of
from .config import Config
from .errors import PolicyError
from .heads import HEAD_OUTPUTS, Head, act
from .model import Model

OWN, OWN_FIRST = 11, 5
"""Fields of an observation about the UAV itself, and how many of them come before the hotspots."""
HOTSPOT_FIELDS, SLOT_FIELDS = 4, 3
HEADS = 4
CROWD = 8.0
"""Sums over a set are divided by this, as in training."""
HOTSPOT_FEATURES = HOTSPOT_FIELDS + 5
_OFF = np.float32(1e6)
"""Longer than any tour."""
TOUR_STOPS, TOUR_REACH, TOUR_MARGIN = 16, 5, 2
"""Most hotspots of a tour after the first; from how many cells longer than the shortest on it is worth nothing; and how
many cells longer all but one count."""


@dataclass(frozen=True)
class Sizes:
    """What an observation's length does not tell: how many UAVs, hotspots and neighbour slots, on which grid."""

    uavs: int
    hotspots: int
    slots: int
    cells: tuple[float, float]
    added: int
    """Fields of search map, directions and tag, which the configuration adds."""
    tagged: bool

    @classmethod
    def of(cls, model: Model) -> Sizes:
        """Read the sizes of a model."""
        config = model.config
        cells = float(config["grid_width"] - 1), float(config["grid_height"] - 1)
        always = OWN + HOTSPOT_FIELDS * model.hotspot_count + SLOT_FIELDS * model.neighbour_slots
        return cls(
            model.uav_count,
            model.hotspot_count,
            model.neighbour_slots,
            cells,
            added=model.observation_len - always,
            tagged=config["uav_tag"] != "off",
        )

    @property
    def observation_len(self) -> int:
        """Length of an observation."""
        return OWN + HOTSPOT_FIELDS * self.hotspots + SLOT_FIELDS * self.slots + self.added


class SetPolicy:
    """An actor over sets, bound to the sizes of one model; :meth:`for_model` binds it to those of another.

    One that reads tags numbers the UAVs itself where a mission shows none: rows are then those of whole fleets.

    Args:
        arrays: weights and biases by name, as `policy.safetensors` holds them.
        head: `gaussian` or `hybrid`, see :class:`~jcas.MlpPolicy`.
        config: the configuration that the policy was trained on.
        constant_pilot: a pilot command that is held whatever the outputs say.
        mode: how it is meant to be flown, `deterministic`, `sampled` or, which only :class:`jcas.Policy` can,
            `stratified`; :meth:`act` does as it is told.
        fleet_size: the network's last own field is the number of UAVs, which no observation shows.
        tours: its last field of a hotspot rates it as the beginning of a tour of all that are unconfirmed.

    """

    def __init__(
        self,
        arrays: Mapping[str, Floats],
        head: Head,
        config: Config,
        constant_pilot: float | None = None,
        *,
        mode: str = "deterministic",
        fleet_size: bool = False,
        tours: bool = False,
    ) -> None:
        self.head = head
        self.config = config
        self.constant_pilot = constant_pilot
        self.mode = mode
        self._arrays = {name: np.asarray(array, np.float32) for name, array in arrays.items()}
        self._depth = sum(name.startswith("trunk.") and name.endswith(".weight") for name in arrays)
        self.sizes = Sizes.of(Model(config))
        self._fleet_size = fleet_size
        self._tours = tours
        self._added = self._check_arrays()

    @property
    def observation_len(self) -> int:
        """Length of the observations that the policy reads."""
        return self.sizes.observation_len

    def for_model(self, model: Model) -> SetPolicy:
        """Return the policy that flies a model of any size; one whose observations are made otherwise is refused."""
        bound = copy.copy(self)
        bound.sizes = Sizes.of(model)
        if bound.sizes.added != self._added and not bound._numbers:
            raise PolicyError(
                f"the policy reads {self._added} fields of search map, directions and tag, observations of this "
                f"configuration have {bound.sizes.added} (map_window_radius, map_directions, uav_tag)"
            )
        return bound

    @property
    def _numbers(self) -> bool:
        return not self.sizes.tagged and self.sizes.added + 1 == self._added

    def act(
        self, observations: Floats, *, deterministic: bool = True, rng: np.random.Generator | None = None
    ) -> Floats:
        """Choose actions: [..., observation length] to [..., 2], as :meth:`jcas.MlpPolicy.act`."""
        return act(self.head, self.outputs(observations), deterministic, rng, self.constant_pilot)

    def outputs(self, observations: Floats) -> Floats:
        """Evaluate the network: [..., observation length] to [..., outputs]."""
        given = numbers_of("observations", observations)
        if given.shape[-1:] != (self.observation_len,):
            raise PolicyError(
                f"observations have shape {given.shape}: must end in {self.observation_len}; for another model use "
                "for_model(model)"
            )
        rows = given.reshape(-1, self.observation_len)
        n, k = self.sizes.hotspots, self.sizes.slots
        hotspots_end = OWN_FIRST + HOTSPOT_FIELDS * n
        slots_end = hotspots_end + SLOT_FIELDS * k
        own = np.concatenate([rows[:, :OWN_FIRST], rows[:, slots_end:], self._unseen(len(rows))], axis=1)
        hotspots = rows[:, OWN_FIRST:hotspots_end].reshape(-1, n, HOTSPOT_FIELDS)
        slots = rows[:, hotspots_end:slots_end].reshape(-1, k, SLOT_FIELDS)

        neighbours = self._neighbours(slots)
        context = np.concatenate([own, neighbours], axis=1) @ self._arrays["hotspot.own"]
        embedded = _relu(self._linear("hotspot.0", self._features(hotspots, slots)) + context[:, None])
        embedded = _relu(self._linear("hotspot.1", embedded))
        others = embedded.sum(axis=1) / CROWD @ self._arrays["hotspot.others"]
        embedded = _relu(self._linear("hotspot.2", embedded) + others[:, None])
        scores = self._linear("score", embedded)
        weights = np.exp(scores - scores.max(axis=1, keepdims=True))
        weights /= weights.sum(axis=1, keepdims=True)
        attended = np.einsum("rnh,rnw->rhw", weights, embedded).reshape(len(rows), -1)

        hidden = np.concatenate([attended, neighbours, own], axis=1)
        for layer in range(self._depth - 1):
            hidden = _relu(self._linear(f"trunk.{layer}", hidden))
        outputs = self._linear(f"trunk.{self._depth - 1}", hidden)
        return np.asarray(outputs.reshape(*given.shape[:-1], -1), np.float32)

    def _unseen(self, rows: int) -> Floats:
        """What no observation shows: each UAV's tag where missions have none, and how many UAVs there are."""
        uavs, columns = self.sizes.uavs, []
        if self._numbers:
            if rows % uavs:
                raise PolicyError(f"{rows} observations: must be those of whole fleets of {uavs} UAVs, in their order")
            columns.append(np.tile(np.arange(uavs) * (1 / max(uavs - 1, 1)), rows // uavs))
        if self._fleet_size:
            columns.append(np.full(rows, uavs / CROWD))
        return np.array(columns, np.float32).reshape(len(columns), rows).T

    def _neighbours(self, slots: Floats) -> Floats:
        present = slots[..., :1]
        embedded = slots @ self._arrays["neighbour.0.weight"] + present * self._arrays["neighbour.0.bias"]
        embedded = _relu(self._linear("neighbour.1", _relu(embedded)))
        return np.asarray((embedded * present).sum(axis=1) / CROWD, np.float32)

    def _features(self, hotspots: Floats, slots: Floats) -> Floats:
        """Fields of the hotspots, and what a sum over pairs would cost a layer to learn."""
        across, along = self.sizes.cells
        x, y = hotspots[..., 0], hotspots[..., 1]
        far = np.abs(x) * np.float32(across) + np.abs(y) * np.float32(along)
        apart = np.abs(x[:, :, None] - slots[:, None, :, 1]) * np.float32(across)
        apart += np.abs(y[:, :, None] - slots[:, None, :, 2]) * np.float32(along)
        present = slots[:, None, :, 0]
        worked_out = [
            far / np.float32(2 * across or 1),
            _nearness(far, 1),
            _nearness(far, 4),
            (present * _nearness(apart, 1)).sum(axis=2) / CROWD,
            (present * _nearness(apart, 4)).sum(axis=2) / CROWD,
        ]
        if self._tours:
            worked_out.append(self._tour_ratings(hotspots, far))
        return np.concatenate([hotspots, np.stack(worked_out, axis=-1)], axis=-1)

    def _tour_ratings(self, hotspots: Floats, far: Floats) -> Floats:
        """How near the tour that begins with each hotspot, and goes on to the nearest, comes to the shortest."""
        rows, n = far.shape
        x, y = hotspots[..., 0], hotspots[..., 1]
        apart = np.abs(x[:, :, None] - x[:, None]) * np.float32(self.sizes.cells[0])
        apart += np.abs(y[:, :, None] - y[:, None]) * np.float32(self.sizes.cells[1])
        apart = np.rint(apart)
        rank = np.argsort(np.lexsort((y, x)))
        is_open = hotspots[..., 2] == 0
        # One tour for each first hotspot: rows × first × hotspot.
        left = is_open[:, None, :] & ~np.eye(n, dtype=bool)
        at = np.broadcast_to(np.arange(n), (rows, n))
        length = np.rint(far)
        row, first = np.ogrid[:rows, :n]
        for _ in range(min(TOUR_STOPS, n - 1)):
            ways = np.where(left, apart[row, at], _OFF)
            at = _least(ways, rank[:, None])
            way = ways[row, first, at]
            length += np.where(way < _OFF, way, 0)
            left[row, first, at] = False
        length = np.where(is_open, length, _OFF)
        behind = length - length.min(axis=1, keepdims=True) + TOUR_MARGIN
        behind[np.arange(rows), _least(length, rank)] = 0
        return np.asarray(np.where(is_open, _nearness(behind, TOUR_REACH), 0), np.float32)

    def _linear(self, name: str, inputs: Floats) -> Floats:
        return np.asarray(inputs @ self._arrays[f"{name}.weight"] + self._arrays[f"{name}.bias"], np.float32)

    def _check_arrays(self) -> int:
        """Refuse arrays that are no such network; else say how many fields the configuration has to add."""
        widths = {"neighbour.0.weight": SLOT_FIELDS, "hotspot.0.weight": HOTSPOT_FEATURES + self._tours}
        try:
            for name, width in widths.items():
                if self._arrays[name].shape[0] != width:
                    raise PolicyError(f"{name} has shape {self._arrays[name].shape}: must have {width} rows")
            hotspot, uav = self._arrays["hotspot.1.weight"].shape[1], self._arrays["neighbour.1.weight"].shape[1]
            own = self._arrays["hotspot.own"].shape[0] - uav
            first, last = self._arrays["trunk.0.weight"], self._arrays[f"trunk.{self._depth - 1}.weight"]
        except KeyError as error:
            raise PolicyError(f"there is no array {error}") from error
        added = own - OWN - self._fleet_size
        if added < 0:
            raise PolicyError(f"hotspot.own has {own + uav} rows: must have {OWN + self._fleet_size + uav} or more")
        if first.shape[0] != HEADS * hotspot + uav + own or last.shape[1] != HEAD_OUTPUTS[self.head]:
            raise PolicyError(
                f"trunk of {first.shape[0]} inputs and {last.shape[1]} outputs: must have "
                f"{HEADS * hotspot + uav + own} and, for a {self.head} head, {HEAD_OUTPUTS[self.head]}"
            )
        return added


def _relu(values: Floats) -> Floats:
    return np.maximum(values, 0)


def _least(values: Floats, rank: np.ndarray[Any, np.dtype[np.intp]]) -> np.ndarray[Any, np.dtype[np.intp]]:
    """Where the last axis is least; of several places the one of the lowest rank."""
    least = values == values.min(axis=-1, keepdims=True)
    return np.asarray(np.where(least, rank, rank.shape[-1]).argmin(axis=-1))


def _nearness(distance: Floats, reach: float) -> Floats:
    """1 at distance 0, falling evenly to 0 at `reach` cells."""
    return np.maximum(1 - distance / np.float32(reach), 0)
