"""A sweep as jobs of a Slurm cluster, submitted by submitit.

Each job runs an equal share of the cells that are not finished. The same command goes on after a
crash. Without Slurm the jobs run as processes of this machine.

    python submitit_sweep.py sweep.toml --out campaign --jobs 20 --minutes 60 --partition cpu
"""

import argparse
import time
from pathlib import Path

import submitit

from jcas.sweep import Sweep, Table, build, fly

POLL_SECONDS = 0.5


def fly_share(cells, weights):
    """Run some cells, in a job; returns the index, the row and the build of each."""
    return [(cell.index, *fly(cell, weights.get(cell.policy))) for cell in cells]


def submit(options, sweep, indices):
    """Submit the cells in equal shares; returns the jobs."""
    executor = submitit.AutoExecutor(folder=options.out / "log", cluster=options.cluster)
    executor.update_parameters(timeout_min=options.minutes, cpus_per_task=1)
    if options.partition is not None:
        executor.update_parameters(slurm_partition=options.partition)
    shares = [
        [sweep.cells[index] for index in indices[job :: options.jobs]]
        for job in range(options.jobs)
    ]
    with executor.batch():
        return [executor.submit(fly_share, share, sweep.weights) for share in shares if share]


def collect(jobs, table):
    """Take the rows of each job as soon as it ends."""
    waiting = list(jobs)
    while waiting:
        ended = [job for job in waiting if job.done()]
        for job in ended:
            waiting.remove(job)
            for index, row, built in job.result():
                if built != build():
                    raise SystemExit(f"a node has another build: {built}, must be {build()}")
                table.add(index, row)
            print(f"{len(table.rows)} of {len(table.sweep.cells)} cells", flush=True)
        time.sleep(POLL_SECONDS)


def main():
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("spec", type=Path, help="a specification, as of python -m jcas.sweep")
    parser.add_argument("--out", type=Path, required=True, help="a folder that all nodes share")
    parser.add_argument("--jobs", type=int, default=20, help="number of jobs (20)")
    parser.add_argument("--minutes", type=int, default=60, help="time limit of a job (60)")
    parser.add_argument("--partition", help="partition of Slurm")
    parser.add_argument("--cluster", choices=("slurm", "local"), help="found out by default")
    options = parser.parse_args()
    sweep = Sweep.read(options.spec)
    table = Table(options.out, sweep)
    try:
        collect(submit(options, sweep, table.missing()), table)
    finally:
        table.write()
    table.finish()


if __name__ == "__main__":
    main()
