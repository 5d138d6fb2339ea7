"""Planner, scripts and trained policies on thirty configurations that none was made for.

Fleet, hotspots, grid, depot and sensing range of each configuration are drawn from one seed. Each
row of the table is one policy in one configuration. The script can be stopped at any time, and it
goes on where the table ends. Another seed draws other configurations and has a table of its own.

    python lab/experiments/unseen.py --jcas target/release/jcas
    python lab/experiments/unseen.py --jcas target/release/jcas --seed 20261127 --presets paper
"""

import argparse
import csv
import json
import random
import statistics
import subprocess
from pathlib import Path

RESULTS = Path(__file__).parent.parent / "results"
SEED = 20261126
CONFIGURATIONS = 10
EPISODES = 100
REFERENCE = "replan"
# Student's t quantile at 0.975 with CONFIGURATIONS - 1 degrees of freedom.
T_QUANTILE = 2.262
POLICIES = {
    "paper": ("replan", "plan", "teams", "squads", "swarm", "policies/paper"),
    "search": ("replan", "plan", "line", "frontier"),
    "mission": ("replan", "teams", "squads", "swarm", "policies/fleet", "policies/mission"),
}
DRAWN = ("preset", "index", "uavs", "hotspots", "width", "height", "depot", "range_m")
QUANTITIES = ("success_rate", "mission_steps_mean", "energy_kwh_mean")
FIELDS = [*DRAWN, "policy", "episodes"]
FIELDS += [name + end for name in QUANTITIES for end in ("", "_low", "_high")]


def configurations(seed):
    """Returns the configurations of each preset, as the columns of DRAWN."""
    draws = random.Random(seed)
    drawn = []
    for preset in POLICIES:
        for index in range(CONFIGURATIONS):
            width, height = draws.randint(8, 16), draws.randint(8, 16)
            drawn.append(
                {
                    "preset": preset,
                    "index": index,
                    "uavs": draws.randint(3, 24),
                    "hotspots": draws.randint(1, 11),
                    "width": width,
                    "height": height,
                    "depot": f"{draws.randrange(width)},{draws.randrange(height)}",
                    # The radar of `mission` has no range of its own.
                    "range_m": "" if preset == "mission" else round(draws.uniform(112.5, 187.5)),
                }
            )
    return drawn


def flown(options, drawn, policy):
    """Flies one policy in one configuration and returns its row."""
    fields = {
        "grid_width": drawn["width"],
        "grid_height": drawn["height"],
        "depots": f"[[{drawn['depot']}]]",
        "uav_tag": "index" if drawn["preset"] == "paper" else "off",
    }
    if drawn["range_m"]:
        fields["sensing_range_m"] = drawn["range_m"]
    command = [options.jcas, "evaluate", policy, "--preset", drawn["preset"], "--json"]
    command += ["--uavs", str(drawn["uavs"]), "--hotspots", str(drawn["hotspots"])]
    for name, value in fields.items():
        command += ["--set", f"{name}={value}"]
    command += ["--episodes", str(EPISODES), "--threads", str(options.threads)]
    told = json.loads(subprocess.run(command, check=True, capture_output=True).stdout)
    row = {**drawn, "policy": policy, "episodes": EPISODES}
    for name in QUANTITIES:
        for end in ("", "_low", "_high"):
            row[name + end] = round(told[name + end], 5)
    return row


def read(path):
    """Returns the rows of the table so far."""
    if not path.exists():
        return []
    with path.open(newline="") as table:
        return list(csv.DictReader(table))


def write(path, rows):
    """Writes the table to a temporary name and renames it."""
    part = path.with_suffix(".part")
    with part.open("w", newline="") as table:
        writer = csv.DictWriter(table, FIELDS, lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)
    part.replace(path)


def summary(rows, presets):
    """Prints steps as a share of those of `replan`: mean over configurations, and the largest."""
    at = {(row["preset"], row["index"], row["policy"]): row for row in rows}
    print("preset policy | success, least | steps / replan's, 95 % interval, largest")
    for preset in presets:
        for policy in POLICIES[preset]:
            cells = [at[preset, str(index), policy] for index in range(CONFIGURATIONS)]
            best = [at[preset, str(index), REFERENCE] for index in range(CONFIGURATIONS)]
            steps = "mission_steps_mean"
            shares = [float(a[steps]) / float(b[steps]) for a, b in zip(cells, best, strict=True)]
            success = [float(cell["success_rate"]) for cell in cells]
            mean = statistics.mean(shares)
            half = T_QUANTILE * statistics.stdev(shares) / len(shares) ** 0.5
            print(
                f"{preset} {policy} | {statistics.mean(success):.3f} {min(success):.2f}"
                f" | {mean:.2f} ± {half:.2f} {max(shares):.2f}"
            )


def main():
    """Flies every configuration that the table lacks, then prints the summary."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--jcas", required=True, help="path of the command jcas")
    parser.add_argument("--threads", type=int, default=1, help="threads (%(default)s)")
    parser.add_argument("--seed", type=int, default=SEED, help="seed of the draws (%(default)s)")
    parser.add_argument("--presets", nargs="+", choices=POLICIES, default=list(POLICIES))
    options = parser.parse_args()
    path = RESULTS / ("unseen.csv" if options.seed == SEED else f"unseen-{options.seed}.csv")
    rows = read(path)
    finished = {(row["preset"], row["index"], row["policy"]) for row in rows}
    for drawn in configurations(options.seed):
        if drawn["preset"] not in options.presets:
            continue
        for policy in POLICIES[drawn["preset"]]:
            if (drawn["preset"], str(drawn["index"]), policy) not in finished:
                rows.append(flown(options, drawn, policy))
                write(path, rows)
    summary(read(path), options.presets)


if __name__ == "__main__":
    main()
