"""Scripts and the planner in the cells of the scan of `inform_once.py`.

Each row of the table is one policy in one cell, with the columns of that scan. The script can be
stopped at any time, and it goes on where the table ends.

    python lab/experiments/inform_once_baselines.py --jcas target/release/jcas
"""

import argparse

from inform_once import READINGS, TABLE, finished, run

BASELINES = TABLE.with_name("inform_once_baselines.csv")


def cells():
    """Yields the scan's cells for the planner, then the readings at 150 m for the returns."""
    for range_m in (125, 137.5, 150, 162.5, 175, 187.5, 200, 212.5, 225):
        for uavs in (10, 15):
            for policy, pilot in (("teams", "max"), ("plan", "planned"), ("replan", "planned")):
                yield ("once", range_m, uavs, 5, pilot, 0, policy)
    for reading in READINGS:
        for policy, pilot in (("teams", "max"), ("random", "mid")):
            yield (reading, 150, 10, 5, pilot, 0, policy)


def main():
    """Flies every cell that the table lacks."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--jcas", required=True, help="path of the command jcas")
    options = parser.parse_args()
    for cell in cells():
        if tuple(map(str, cell)) not in finished(BASELINES):
            run(options, cell, BASELINES)


if __name__ == "__main__":
    main()
