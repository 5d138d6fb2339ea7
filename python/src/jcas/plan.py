"""Plans: trajectories of a fleet for the least expected time, and a lower bound on that time."""

from __future__ import annotations

import ctypes
import weakref
from collections.abc import Callable
from typing import Any

import numpy as np
import numpy.typing as npt

from . import _abi
from ._library import check, check_with_message, lib, read_text
from .arguments import SEED_MAX, seed_of, shown, whole
from .errors import ArgumentError, PlanError, SnapshotError
from .model import Model, check_model

Progress = Callable[[int, float], object]
"""Hears of the moves tried so far and the expected steps of the best plan so far. The annealing
ends early if it returns `False`."""

_TELL = ctypes.CFUNCTYPE(ctypes.c_int32, ctypes.c_uint64, ctypes.c_double, ctypes.c_void_p)


class Plan:
    """The cell and the pilot density of each UAV in each step: made by `search` or `tour`.

    `jcas.Policy.follow` flies it without feedback; the plan itself makes the fleet meet. A plan
    depends on the configuration, the seed and the number of moves only. It never changes; any
    number of threads may use it.
    """

    def __init__(self, model: Model, handle: ctypes.c_void_p) -> None:
        self.model = model
        """The model that it was made for."""
        self.handle = handle
        weakref.finalize(self, lib.jcas_plan_free, handle)
        info = _abi.jcas_plan_info(struct_size=ctypes.sizeof(_abi.jcas_plan_info))
        check(lib.jcas_plan_get_info(handle, ctypes.byref(info)))
        self.expected_steps: float = info.expected_steps
        """Expected steps until the mission ends; without success it counts with its horizon."""
        self.expected_confirmed_steps: float = info.expected_confirmed_steps
        """Expected steps until every hotspot is confirmed."""
        self.success: float = info.success
        """Probability that the mission ends before the horizon."""
        self.start_steps: float = info.start_steps
        """Expected steps of the trajectories that the annealing began with."""
        self.bound_steps: float = info.bound_steps
        """No plan without feedback takes fewer expected steps."""
        self.seed: int = info.seed
        """Seed of the annealing."""
        self.iterations: int = info.iterations
        """Moves that the annealing tried."""
        self.stopped = bool(info.stopped)
        """Whether it ended before the requested number of moves."""
        uavs, steps = int(info.uav_count), int(info.step_count)
        cells = np.empty((uavs, steps + 1, 2), np.uint32)
        places = cells.ctypes.data_as(ctypes.POINTER(_abi.jcas_cell))
        check(lib.jcas_plan_get_cells(handle, places, uavs * (steps + 1)))
        densities = np.empty((uavs, steps), np.float64)
        check(lib.jcas_plan_get_pilot_densities(handle, densities.ctypes.data, densities.size))
        cells.flags.writeable = densities.flags.writeable = False
        self.cells: npt.NDArray[np.uint32] = cells
        """[N, steps + 1, 2]: each UAV's (x, y) before the first step, then after each."""
        self.pilot_densities: npt.NDArray[np.float64] = densities
        """[N, steps]: the share of pilots that each UAV sends in each step."""

    @classmethod
    def search(
        cls,
        model: Model,
        *,
        iterations: int = 400_000,
        seed: int = 1,
        progress: Progress | None = None,
    ) -> Plan:
        """Plan a mission whose hotspots are hidden, anywhere but in the depots.

        A second is enough for some 200 000 moves of ten UAVs.

        Args:
            model: what to plan for.
            iterations: moves that the annealing tries.
            seed: of the moves.
            progress: hears of the progress.

        Raises:
            ArgumentError: an argument is not acceptable, or the fleet or the grid is too large.
            JcasError: the system has no memory for the plan.

        """
        fitting = check_model(model)

        def begin(*rest: Any) -> int:
            return int(lib.jcas_plan_search(fitting.handle, *rest))

        return cls(fitting, _anneal(begin, iterations, seed, progress))

    @classmethod
    def tour(
        cls,
        model: Model,
        hotspots: npt.ArrayLike,
        *,
        iterations: int = 100_000,
        seed: int = 1,
        progress: Progress | None = None,
    ) -> Plan:
        """Plan a mission whose hotspots lie in known cells.

        The plan decides which UAVs visit them, in which order, how many together and for how long.
        `jcas.Sim.hotspot_cells` gives the cells of a mission.

        Args:
            model: what to plan for.
            hotspots: cells, [n, 2].
            iterations: moves to try.
            seed: of the moves.
            progress: as for `search`.

        Raises:
            ArgumentError: an argument is not acceptable, a cell lies off the grid, or the fleet or
                the grid is too large.
            JcasError: the system has no memory for the plan.

        """
        fitting = check_model(model)
        cells = _cells_of(hotspots, fitting.hotspot_count)
        places = cells.ctypes.data_as(ctypes.POINTER(_abi.jcas_cell))

        def begin(*rest: Any) -> int:
            return int(lib.jcas_plan_tour(fitting.handle, places, len(cells), *rest))

        return cls(fitting, _anneal(begin, iterations, seed, progress))

    @classmethod
    def from_json(cls, text: str | bytes, model: Model) -> Plan:
        """Read a plan from its text, as `to_json` or `jcas plan` wrote it.

        Args:
            text: the content of the file.
            model: of the configuration that the plan was made for.

        Raises:
            PlanError: the text is no plan, or one of another configuration.
            ArgumentError: an argument is not acceptable.

        """
        fitting = check_model(model)
        if not isinstance(text, str | bytes):
            raise ArgumentError(f"text = {shown(text)}: must be the text of a plan")
        content = text.encode() if isinstance(text, str) else text
        handle = ctypes.c_void_p()
        try:
            check_with_message(
                lambda message, capacity: lib.jcas_plan_from_json(
                    fitting.handle, content, len(content), ctypes.byref(handle), message, capacity
                )
            )
        except SnapshotError as error:
            raise PlanError(str(error), error.status) from None
        return cls(fitting, handle)

    def to_json(self) -> str:
        """Write the plan and its configuration as text, which `jcas plan` reads."""
        return read_text(
            lambda text, capacity, length: lib.jcas_plan_to_json(
                self.handle, text, capacity, length
            )
        )

    def __reduce__(self) -> tuple[object, tuple[str, Model]]:
        return (Plan.from_json, (self.to_json(), self.model))

    def __copy__(self) -> Plan:
        return self

    def __deepcopy__(self, memo: object) -> Plan:
        return self

    def __repr__(self) -> str:
        return (
            f"<jcas.Plan: {self.model.uav_count} UAVs, {self.model.hotspot_count} hotspots, "
            f"{self.expected_steps:.2f} steps expected, at least {self.bound_steps:.2f}>"
        )


def _anneal(
    begin: Callable[..., int], iterations: int, seed: int, progress: Progress | None
) -> ctypes.c_void_p:
    """Run an annealing. What `progress` raises ends it, and so does Ctrl-C."""
    raised: list[BaseException] = []

    def tell(tried: int, best_steps: float, _: object) -> int:
        try:
            return int(progress is not None and progress(tried, best_steps) is False)
        except BaseException as error:  # no exception crosses the library
            raised.append(error)
            return 1

    told = _TELL(tell)
    settings = _abi.jcas_plan_settings(
        struct_size=ctypes.sizeof(_abi.jcas_plan_settings),
        iterations=whole("iterations", iterations, 0, SEED_MAX),
        seed=seed_of("seed", seed),
        progress=ctypes.cast(told, ctypes.c_void_p),
    )
    handle = ctypes.c_void_p()
    check_with_message(
        lambda message, capacity: begin(
            ctypes.byref(settings), ctypes.byref(handle), message, capacity
        )
    )
    if raised:
        lib.jcas_plan_free(handle)
        raise raised[0]
    return handle


def _cells_of(cells: npt.ArrayLike, count: int) -> npt.NDArray[np.uint32]:
    """Return `count` cells as an array for the library."""
    array = np.asarray(cells)
    if array.dtype.kind not in "iu" or array.shape != (count, 2):
        raise ArgumentError(
            f"hotspots is {array.dtype} of shape {array.shape}: must be whole numbers of shape "
            f"({count}, 2)"
        )
    if np.any((array < 0) | (array >= 2**32)):
        raise ArgumentError(f"hotspots = {shown(cells)}: must be cells of the grid")
    return np.require(array, np.uint32, ("C_CONTIGUOUS", "ALIGNED"))
