"""The course of the trainings at 150 m with ten UAVs, one for each reading.

    python lab/experiments/inform_once_trainings.py --runs out/inform_once
"""

import argparse
import csv
from pathlib import Path

from inform_once import READINGS, TABLE

TRAININGS = TABLE.with_name("inform_once_trainings.csv")
CELL = {"range_m": 150, "uavs": 10, "hotspots": 5}
COLUMNS = ("iteration", "return_mean", "success_rate")


def main():
    """Writes the table anew from the metrics of the runs."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--runs", required=True, help="folder of the trainings")
    options = parser.parse_args()
    with TRAININGS.open("w", newline="") as table:
        writer = csv.DictWriter(table, ["reading", *CELL, *COLUMNS], lineterminator="\n")
        writer.writeheader()
        for reading in READINGS:
            words = reading.replace(",", "").replace(" ", "_")
            folder = Path(options.runs) / f"{words}-150m-10x5-adaptive-s0"
            with (folder / "metrics.csv").open(newline="") as metrics:
                for line in csv.DictReader(metrics):
                    of_line = {name: line[name] for name in COLUMNS}
                    writer.writerow({"reading": reading} | CELL | of_line)


if __name__ == "__main__":
    main()
