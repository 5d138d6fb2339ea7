"""Run every combination of the listed values, on this machine or on a Ray cluster.

The rows go into DIR/results.parquet as they come, and into DIR/results.csv at the end. After
Ctrl-C, a crash or a lost machine the same command goes on with the cells that are missing.
"""

from __future__ import annotations

import argparse
import json
import signal
import sys
import time
from pathlib import Path

from ..errors import JcasError, MissingDependencyError

try:
    import pyarrow  # noqa: F401
    import ray  # noqa: F401
except ImportError as error:
    raise MissingDependencyError("Ray", "jcas.sweep", "sweep") from error

from .runners import in_process, on_ray
from .spec import Sweep
from .table import Table

FAILED, WRONG_INPUT, INTERRUPTED = 1, 2, 130
"""Exit statuses: a cell failed; the specification or the folder is not usable; Ctrl-C."""

EXAMPLES = """\
examples:
  python -m jcas.sweep sweep.toml --out campaign
  python -m jcas.sweep sweep.toml --out campaign --address auto
  python -m jcas.sweep sweep.toml --out campaign --address ray://head:10001

a specification:
  config = "paper"                      # a preset, or a TOML or JSON file; may be left out
  episodes = 300                        # missions in each cell
  seed = 1
  [fields]                              # for every cell
  sensing_range_m = 150.0
  [axes]                                # every combination is a cell
  policy = ["teams", "policies/paper"]  # baselines and folders of trained policies
  pilot = ["adaptive"]
  uav_count = [5, 10]
  hotspot_count = [3, 7, 11]

exit status: 0 done, 1 a cell failed, 2 wrong input, 130 stopped by Ctrl-C
"""


def main(arguments: list[str] | None = None) -> int:
    """Run the command; returns the exit status."""
    options = _parser().parse_args(arguments)
    signal.signal(signal.SIGTERM, signal.default_int_handler)
    try:
        sweep = Sweep.read(options.spec)
        table = Table(options.out, sweep, overwrite=options.overwrite)
        return _run(sweep, table, options)
    except (JcasError, OSError) as error:
        print(f"error: {error}", file=sys.stderr)
        return WRONG_INPUT
    except KeyboardInterrupt:
        print("stopped; the same command goes on", file=sys.stderr)
        return INTERRUPTED


def _run(sweep: Sweep, table: Table, options: argparse.Namespace) -> int:
    missing, failed = table.missing(), {}
    progress = _Progress(len(sweep.cells), len(table.rows))
    if options.serial:
        outcomes = in_process(sweep, missing)
    else:
        outcomes = on_ray(sweep, missing, options.address)
    try:
        for outcome in outcomes:
            if outcome.row is None:
                failed[outcome.index] = outcome.error
            else:
                table.add(outcome.index, outcome.row)
            progress.show(len(table.rows), len(failed))
    finally:
        outcomes.close()
        table.write()
        progress.end()
    if failed:
        for index, error in sorted(failed.items()):
            values = dict(zip(sweep.axes, sweep.cells[index].values, strict=True))
            print(f"error: cell {index} {json.dumps(values)}: {error}", file=sys.stderr)
    else:
        table.finish()
    written = [str(table.parquet)] + ([] if failed else [str(table.csv)])
    if options.json:
        report = {"cells": len(sweep.cells), "failed": sorted(failed), "written": written}
        print(json.dumps(report))
    else:
        print("\n".join(f"wrote {path}" for path in written))
    return FAILED if failed else 0


class _Progress:
    """A line on the terminal: finished cells and the time left."""

    def __init__(self, cells: int, finished: int) -> None:
        self.cells, self.at_start, self.begun = cells, finished, time.monotonic()
        self.shown = sys.stderr.isatty()

    def show(self, finished: int, failed: int) -> None:
        if not self.shown:
            return
        ended = finished + failed
        spent = time.monotonic() - self.begun
        left = spent * (self.cells - ended) / max(1, ended - self.at_start)
        text = f"\r{ended} of {self.cells} cells, {left:.0f} s left"
        print(text + (f", {failed} failed" if failed else ""), end="\x1b[K", file=sys.stderr)

    def end(self) -> None:
        if self.shown:
            print(file=sys.stderr)


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="python -m jcas.sweep",
        description=__doc__,
        epilog=EXAMPLES,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("spec", type=Path, help="the specification, a TOML file")
    parser.add_argument(
        "--out", type=Path, default=Path("out"), metavar="DIR", help="folder (%(default)s)"
    )
    place = parser.add_mutually_exclusive_group()
    place.add_argument(
        "--address",
        default="local",
        help="a Ray cluster: host:port, ray://host:port or auto; "
        "by default Ray begins on this machine",
    )
    place.add_argument("--serial", action="store_true", help="run in this process, without Ray")
    parser.add_argument(
        "--overwrite", action="store_true", help="replace the results of another sweep"
    )
    parser.add_argument("--json", action="store_true", help="print JSON")
    return parser


if __name__ == "__main__":
    sys.exit(main())
