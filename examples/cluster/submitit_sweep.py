"""A sweep as jobs of a Slurm cluster, submitted by submitit.

Each job runs one shard that is not on file. The same command goes on after a crash. Without Slurm
the jobs run as processes of this machine.

    python submitit_sweep.py --out campaign --shards 20 --minutes 60 -- --uavs 5,10 --episodes 300
"""

import argparse
from pathlib import Path

import submitit

from jcas.sweep import keep, merge, missing, run_shard


def main():
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--out", type=Path, required=True, help="a folder for the tables")
    parser.add_argument("--shards", type=int, default=20, help="number of jobs (20)")
    parser.add_argument("--minutes", type=int, default=60, help="time limit of a job (60)")
    parser.add_argument("--partition", help="partition of Slurm")
    parser.add_argument("--cluster", choices=("slurm", "local"), help="found out by default")
    parser.add_argument("options", nargs="*", help="options of jcas sweep, after --")
    given = parser.parse_args()
    executor = submitit.AutoExecutor(folder=given.out / "log", cluster=given.cluster)
    executor.update_parameters(timeout_min=given.minutes, cpus_per_task=1)
    if given.partition is not None:
        executor.update_parameters(slurm_partition=given.partition)
    with executor.batch():
        jobs = [
            executor.submit(run_shard, given.options, number, given.shards)
            for number in missing(given.out, given.shards)
        ]
    for job in submitit.helpers.as_completed(jobs):
        keep(given.out, job.result())
    print(merge(given.out, given.shards), end="")


if __name__ == "__main__":
    main()
