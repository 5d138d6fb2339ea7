"""A sweep of the command in shards, on this machine or on a Ray cluster.

    python -m jcas.sweep --out campaign --shards 40 -- --uavs 5,10,15 --hotspots 3,7 --episodes 300
    python -m jcas.sweep --out campaign --shards 40 --address auto -- --uavs 5,10,15

What follows `--` are options of `jcas sweep`. Each shard is one call of `jcas sweep --shard`, and
`jcas merge` joins them into DIR/results.csv. After Ctrl-C, a crash or a lost machine the same
command goes on with the shards that are missing. The command `jcas`, the same build on each node,
is found on the path or named in JCAS_COMMAND.
"""

from __future__ import annotations

import argparse
import os
import shutil
import signal
import subprocess
import sys
import tempfile
from collections.abc import Iterator, Sequence
from functools import partial
from pathlib import Path
from typing import Any

from .arguments import whole
from .errors import JcasError, MissingDependencyError
from .files import write_whole

Files = dict[str, bytes]
"""The manifest and the table of a shard, by name."""

WRONG_INPUT, INTERRUPTED = 2, 130
RETRIES = 5
"""Times that a shard starts again after its worker or its node was lost."""
SHARDS_MAX = 10**6


def jcas(*arguments: object) -> str:
    """Run the command and return what it prints; its error is raised as it stands."""
    command = os.environ.get("JCAS_COMMAND") or shutil.which("jcas")
    if command is None:
        raise JcasError("there is no command jcas: put it on the path, or name it in JCAS_COMMAND")
    done = subprocess.run([command, *map(str, arguments)], capture_output=True, text=True)
    if done.returncode:
        raise JcasError(done.stderr.strip().removeprefix("error: "))
    return done.stdout


def run_shard(options: Sequence[str], number: int, shards: int) -> Files:
    """Run a shard of a sweep on one processor and return its files."""
    with tempfile.TemporaryDirectory() as folder:
        shard = ("--shard", f"{number}/{shards}", "--threads", 1)
        jcas("sweep", *options, "--out", folder, *shard)
        return {name: (Path(folder) / name).read_bytes() for name in names(number, shards)}


def names(number: int, shards: int) -> tuple[str, str]:
    """Name the files of a shard: its table first, so that a manifest is never alone."""
    return f"shard-{number}-of-{shards}.csv", f"shard-{number}-of-{shards}.json"


def missing(out: Path, shards: int) -> list[int]:
    """List the shards that a folder does not hold."""
    numbers = range(1, shards + 1)
    return [n for n in numbers if not all((out / name).is_file() for name in names(n, shards))]


def keep(out: Path, files: Files) -> None:
    """Write the files of a shard that has run."""
    for name, content in files.items():
        write_whole(out / name, partial(Path.write_bytes, data=content))


def merge(out: Path, shards: int) -> str:
    """Join all shards into `results.csv`; returns what the command says."""
    manifests = [out / names(number, shards)[1] for number in range(1, shards + 1)]
    return jcas("merge", out / "results.csv", *manifests, "--overwrite")


def on_ray(
    options: Sequence[str], numbers: list[int], shards: int, address: str
) -> Iterator[Files]:
    """Run shards as tasks of a Ray cluster, in the order in which they end."""
    try:
        import ray
    except ImportError as error:
        raise MissingDependencyError("Ray", "a sweep on a cluster", "sweep") from error
    local: dict[str, Any] = {"include_dashboard": False} if address == "local" else {}
    ray.init(address=address, logging_level="warning", log_to_driver=False, **local)
    try:
        task = ray.remote(num_cpus=1, max_retries=RETRIES)(run_shard)
        waiting = [task.remote(options, number, shards) for number in numbers]
        while waiting:
            ended, waiting = ray.wait(waiting)
            try:
                yield ray.get(ended[0])
            except ray.exceptions.RayTaskError as error:
                raise JcasError(str(error.cause)) from None
    finally:
        ray.shutdown()


def main(arguments: list[str] | None = None) -> int:
    """Run the command; returns the exit status."""
    parser = argparse.ArgumentParser(
        prog="python -m jcas.sweep",
        description=__doc__,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("--out", type=Path, default=Path("out"), metavar="DIR", help="(out)")
    parser.add_argument("--shards", type=int, default=20, help="(%(default)s)")
    place = parser.add_mutually_exclusive_group()
    place.add_argument("--address", default="local", help="a Ray cluster: host:port or auto")
    place.add_argument("--serial", action="store_true", help="in this process, without Ray")
    parser.add_argument("--overwrite", action="store_true", help="run every shard again")
    parser.add_argument("options", nargs="*", help="options of jcas sweep, after --")
    given = parser.parse_args(arguments)
    signal.signal(signal.SIGTERM, signal.default_int_handler)
    try:
        shards = whole("--shards", given.shards, 1, SHARDS_MAX)
        given.out.mkdir(parents=True, exist_ok=True)
        numbers = list(range(1, shards + 1)) if given.overwrite else missing(given.out, shards)
        here = (run_shard(given.options, number, shards) for number in numbers)
        runs = here if given.serial else on_ray(given.options, numbers, shards, given.address)
        for done, files in enumerate(runs, shards - len(numbers) + 1):
            keep(given.out, files)
            print(f"{done} of {shards} shards", flush=True)
        print(merge(given.out, shards), end="")
    except (JcasError, OSError) as error:
        print(f"error: {error}", file=sys.stderr)
        return WRONG_INPUT
    except KeyboardInterrupt:
        print("stopped; the same command goes on", file=sys.stderr)
        return INTERRUPTED
    return 0


if __name__ == "__main__":
    sys.exit(main())
