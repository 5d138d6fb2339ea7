"""One cell of a sweep: a configuration with its policy, and the row that its missions give."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

from .._library import lib
from ..config import Config
from ..evaluation import evaluate
from ..flown import Policy, trained
from ..model import Model

Row = dict[str, float]
"""The quantities of a cell: each value with the ends of its 95 % interval."""


@dataclass(frozen=True)
class Cell:
    """One combination of a sweep's values."""

    index: int
    """Its place in the sweep, from 0; the last axis varies fastest."""
    values: tuple[Any, ...]
    """The value on each axis."""
    policy: str
    """Name of a baseline, or of a trained policy's folder."""
    pilot: str | float
    """Pilot density of a baseline."""
    fields: dict[str, Any]
    """Every field of the configuration."""
    episodes: int
    """Number of missions."""
    seed: int
    """Seed of the missions."""

    def flown_by(self, weights: bytes | None) -> Policy:
        """Make the policy of this cell: the baseline, or the trained one of the given bytes."""
        model = Model(Config(self.fields))
        if weights is None:
            return Policy.baseline(self.policy, model, pilot=self.pilot)
        return trained(model, self.policy, weights, None)


def fly(cell: Cell, weights: bytes | None) -> tuple[Row, str]:
    """Run the missions of a cell; returns its row and the build that ran it."""
    policy = cell.flown_by(weights)
    report = evaluate(
        policy, policy.model, episodes=cell.episodes, seed=cell.seed, policy=cell.policy
    )
    row: Row = {}
    for quantity in report.quantities:
        row[quantity.name] = quantity.value
        row[f"{quantity.name}_low"] = quantity.low
        row[f"{quantity.name}_high"] = quantity.high
    return row, build()


@cache
def build() -> str:
    """Describe what decides the bits of a row: kernel, its library, and NumPy's resampling."""
    digest = hashlib.sha256(Path(str(lib._name)).read_bytes()).hexdigest()
    return f"jcas {lib.jcas_version().decode()}, library {digest[:16]}, numpy {np.__version__}"
