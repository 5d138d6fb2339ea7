"""The worth of the pilot density and of the quorum in the preset `isac`.

Two sweeps of the policy `line` fly the pilot densities beside those of the preset `search`. A third
sweep flies the quorum beside the rate of false alarms with several policies, where each false
confirmation costs 7. An interrupted sweep goes on where it ended.

    python lab/experiments/isac.py --jcas target/release/jcas --runs out/isac \\
        --figure docs/images/isac.webp
"""

import argparse
import csv
import itertools
import subprocess
from pathlib import Path

RESULTS = Path(__file__).parent.parent / "results"
DENSITIES = ("0.01", "0.03", "0.1", "0.2", "0.3", "adaptive")
FLEETS = ("5", "10", "15", "20")
HOTSPOTS = ("3", "7", "11")
RATES = ("0.0001", "0.001", "0.01", "0.05")
COST = 7
STEPS = "mission_steps_mean"
QUANTITIES = ("success_rate", STEPS, f"{STEPS}_low", f"{STEPS}_high", "energy_kwh_mean")
LINE = ["--policy", "line", "--pilot", ",".join(DENSITIES), "--hotspots", ",".join(HOTSPOTS)]
SWEEPS = {
    "isac": [*LINE, "--episodes", "300"],
    "search": [*LINE, "--episodes", "300"],
    "quorum": [
        *("--policy", "line,answer,replan", "--uavs", "10,20", "--hotspots", "7"),
        *("--vary", "quorum=1,2,3,4", "--vary", f"false_alarm_per_cell={','.join(RATES)}"),
        *("--set", f"reward_false_confirmation={-COST}", "--episodes", "32"),
    ],
}


def swept(options, name):
    """Flies a sweep and returns its rows."""
    out = options.runs / name
    preset = "search" if name == "search" else "isac"
    command = [options.jcas, "sweep", "--preset", preset, "--no-figures", *SWEEPS[name]]
    subprocess.run([*command, "--out", out], check=True)
    with open(out / "results.csv", newline="") as file:
        return list(csv.DictReader(file))


def densities(options):
    """Returns a row for each preset, density and fleet: the mean over the numbers of hotspots.

    The missions of all cells share their seeds, so that the ends of intervals are averaged too.
    """
    rows = []
    for preset in ("isac", "search"):
        flown = swept(options, preset)
        for uavs in FLEETS:
            for density in DENSITIES:
                cells = [r for r in flown if (r["uav_count"], r["pilot"]) == (uavs, density)]
                row = {"preset": preset, "uavs": uavs, "pilot": density}
                for name in QUANTITIES:
                    row[name] = round(sum(float(cell[name]) for cell in cells) / len(cells), 4)
                rows.append(row)
    return rows


def quorums(options):
    """Returns a row for each policy, fleet, rate of false alarms and quorum."""
    names = {
        "policy": "policy",
        "uavs": "uav_count",
        "false_alarm_per_cell": "false_alarm_per_cell",
        "quorum": "quorum",
    }
    means = ("success_rate", STEPS, "false_confirmations_mean", "return_mean")
    rows = []
    for flown in swept(options, "quorum"):
        row = {name: flown[column] for name, column in names.items()}
        for quantity in means:
            row[quantity] = round(float(flown[quantity]), 4)
        for end in ("low", "high"):
            row[f"return_mean_{end}"] = round(float(flown[f"return_mean_{end}"]), 4)
        rows.append(row)
    return rows


def write(name, rows):
    """Writes a table into the folder of results."""
    with open(RESULTS / name, "w", newline="") as file:
        columns = list(dict.fromkeys(itertools.chain.from_iterable(rows)))
        writer = csv.DictWriter(file, columns, lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)


def draw(path, by_density, by_quorum):
    """Draws the mission time over the pilot density, and the return over the quorum."""
    from matplotlib import pyplot

    figure, (left, right) = pyplot.subplots(1, 2, figsize=(10, 4), layout="constrained")
    for colour, preset in (("C0", "isac"), ("C1", "search")):
        rows = [r for r in by_density if (r["preset"], r["uavs"]) == (preset, "15")]
        held = [r for r in rows if r["pilot"] != "adaptive"]
        error = [[abs(r[f"{STEPS}_{end}"] - r[STEPS]) for r in held] for end in ("low", "high")]
        x = [float(r["pilot"]) for r in held]
        left.errorbar(x, [r[STEPS] for r in held], error, marker="o", color=colour, label=preset)
        (adaptive,) = (r[STEPS] for r in rows if r["pilot"] == "adaptive")
        left.axhline(adaptive, color=colour, linestyle="--", label=f"{preset}, adaptive")
    left.set(xlabel="pilot density ρ", ylabel="steps of a mission", xscale="log", ylim=0)
    left.set_title("15 UAVs")
    for rate in RATES:
        at = ("line", "10", float(rate))
        of = [(r["policy"], r["uavs"], float(r["false_alarm_per_cell"])) for r in by_quorum]
        rows = [row for row, key in zip(by_quorum, of, strict=True) if key == at]
        ends = ("return_mean_low", "return_mean_high")
        low, high = ([abs(r[end] - r["return_mean"]) for r in rows] for end in ends)
        x = [int(r["quorum"]) for r in rows]
        right.errorbar(x, [r["return_mean"] for r in rows], [low, high], marker="o", label=rate)
    right.set(xlabel="quorum θ", ylabel="return of a mission", xticks=range(1, 5), ylim=(80, 150))
    right.set_title("10 UAVs, false alarms a cell and look")
    left.legend()
    right.legend()
    figure.savefig(path, dpi=120)


def main():
    """Flies both sweeps, writes both tables and draws the figure."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--jcas", required=True, help="path of the command jcas")
    parser.add_argument("--runs", required=True, type=Path, help="folder of the sweeps")
    parser.add_argument("--figure", type=Path, help="picture to write, with Matplotlib")
    options = parser.parse_args()
    by_density, by_quorum = densities(options), quorums(options)
    write("isac_density.csv", by_density)
    write("isac_quorum.csv", by_quorum)
    if options.figure:
        draw(options.figure, by_density, by_quorum)


if __name__ == "__main__":
    main()
