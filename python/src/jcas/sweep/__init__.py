"""Sweeps on Ray: every combination of listed values, on one machine or on a cluster.

`python -m jcas.sweep SPEC.toml` runs them; docs/campaigns.md shows a specification.
"""

from .cell import Cell, build, fly
from .spec import Sweep
from .table import Table

__all__ = ["Cell", "Sweep", "Table", "build", "fly"]
