"""The table of a sweep on file: a Parquet file that grows with the cells, and a CSV file."""

from __future__ import annotations

import csv
import json
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pyarrow as pa
import pyarrow.parquet as pq

from ..errors import ArgumentError
from ..files import write_whole
from .cell import Row
from .spec import Sweep

PARQUET, CSV = "results.parquet", "results.csv"
FINGERPRINT = b"jcas_sweep"
WRITE_SECONDS_MIN = 1.0
WRITE_SHARE_MAX = 0.2
"""Largest share of the time that goes into writing the growing file."""


class Table:
    """The finished rows of a sweep, in the order of its cells, and the folder that holds them."""

    def __init__(self, folder: Path, sweep: Sweep, *, overwrite: bool = False) -> None:
        """Open the folder and read the rows that an earlier run of the same sweep has written.

        Raises:
            ArgumentError: the folder holds the table of another sweep, or of another build.

        """
        self.sweep = sweep
        self.parquet, self.csv = folder / PARQUET, folder / CSV
        self.rows: dict[int, Row] = {}
        self._wait_until = 0.0
        self._fingerprint = sweep.fingerprint()
        folder.mkdir(parents=True, exist_ok=True)
        if self.parquet.exists() and not overwrite:
            self._read()
        elif self.csv.exists() and not overwrite:
            raise ArgumentError(
                f"{self.csv}: is not of this command; give another --out, or --overwrite"
            )

    def missing(self) -> list[int]:
        """List the cells that are not finished."""
        return [cell.index for cell in self.sweep.cells if cell.index not in self.rows]

    def add(self, index: int, row: Row) -> None:
        """Take a finished cell, and write the file if the last time is long enough ago."""
        self.rows[index] = row
        begun = time.monotonic()
        if begun < self._wait_until:
            return
        self.write()
        ended = time.monotonic()
        self._wait_until = ended + max(WRITE_SECONDS_MIN, (ended - begun) / WRITE_SHARE_MAX)

    def write(self) -> None:
        """Write the finished rows as Parquet."""
        columns = self._columns()
        table = pa.table(columns).replace_schema_metadata({FINGERPRINT: self._fingerprint})
        write_whole(self.parquet, lambda path: pq.write_table(table, path))

    def finish(self) -> None:
        """Write both files."""
        self.write()
        columns = self._columns()

        def write(path: Path) -> None:
            with path.open("w", encoding="utf-8", newline="") as file:
                writer = csv.writer(file, lineterminator="\n")
                writer.writerow(list(columns)[1:])
                writer.writerows(zip(*list(columns.values())[1:], strict=True))

        write_whole(self.csv, write)

    def _columns(self) -> dict[str, list[Any]]:
        order = sorted(self.rows)
        cells = [self.sweep.cells[index] for index in order]
        columns: dict[str, list[Any]] = {"cell": list(order)}
        for place, (name, values) in enumerate(self.sweep.axes.items()):
            kept = _kept(values)
            columns[name] = [kept(cell.values[place]) for cell in cells]
        columns["config_hash"] = [self.sweep.config_hashes[index] for index in order]
        # Seeds go beyond the whole numbers that many readers of Parquet and CSV take.
        columns["seed"] = [str(cell.seed) for cell in cells]
        columns["episodes"] = [cell.episodes for cell in cells]
        for name in self.rows[order[0]] if order else ():
            columns[name] = [self.rows[index][name] for index in order]
        return columns

    def _read(self) -> None:
        advice = "give another --out, or --overwrite to replace it"
        try:
            table = pq.read_table(self.parquet)
        except (pa.ArrowException, OSError) as error:
            raise ArgumentError(f"{self.parquet}: cannot be read: {error}; {advice}") from error
        metadata = table.schema.metadata or {}
        if metadata.get(FINGERPRINT, b"").decode() != self._fingerprint:
            raise ArgumentError(
                f"{self.parquet}: is of another sweep, or another build wrote it; {advice}"
            )
        keys = {"cell", *self.sweep.axes, "config_hash", "seed", "episodes"}
        for record in table.to_pylist():
            row = {name: value for name, value in record.items() if name not in keys}
            self.rows[int(record["cell"])] = row


def _kept(values: list[Any]) -> Callable[[Any], Any]:
    """How an axis stands in the table: numbers stay numbers, mixed kinds become text."""
    if all(isinstance(value, int) and not isinstance(value, bool) for value in values):
        return int
    if all(isinstance(value, int | float) and not isinstance(value, bool) for value in values):
        return float
    return lambda value: value if isinstance(value, str) else json.dumps(value)
