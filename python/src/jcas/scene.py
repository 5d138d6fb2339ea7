"""The data that a picture of a mission shows."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
import numpy.typing as npt


@dataclass(frozen=True)
class Scene:
    """One moment of an episode. Arrays have an entry for each UAV (N) or each hotspot (n)."""

    grid_width: int
    grid_height: int
    t: int
    horizon_steps: int
    cells: npt.NDArray[np.integer]
    """UAV cells, [N, 2]; y grows upwards."""
    soc: npt.NDArray[np.floating]
    """State of charge, 0 to 1, [N]."""
    pilot_density: npt.NDArray[np.floating]
    pilot_density_min: float
    pilot_density_max: float
    grounded: npt.NDArray[np.bool_]
    returning: npt.NDArray[np.bool_]
    links: npt.NDArray[np.bool_]
    """Radio links between UAVs, symmetric, [N, N]."""
    depots: npt.NDArray[np.integer]
    hotspots: npt.NDArray[np.integer]
    confirmed: npt.NDArray[np.bool_]
    informed: npt.NDArray[np.bool_]
    share_knowing: npt.NDArray[np.floating]
    """Fraction of the fleet that knows each hotspot, [n]."""
    searched: npt.NDArray[np.bool_]
    """Cells that count as searched, [H, W]."""
    sensing_range: npt.NDArray[np.floating]
    """Range in cells at which each radar detects a hotspot with probability 0.1, [N]."""
    searched_by: str = "visited cells"
    """What `searched` shows, for the legend."""
    outcome: str = ""
    """`success`, `horizon reached`, or empty while the mission runs."""
    readings: tuple[tuple[str, str], ...] = ()
    """Further (label, value) lines for the panel."""
    trail: tuple[npt.NDArray[np.integer], ...] = field(default=())
    """UAV cells of the steps before, oldest first."""
