"""What adapting the pilot density and answering reports are worth in the preset `isac`.

Rules, planners and reports fly blocks of missions that all policies and densities share. An
interval is Student's over the blocks, and a difference is taken block by block. The maps fly one
sweep for each field, with the intervals of the command. An interrupted study goes on where it
ended: a finished sweep in the folder of `--runs` is read and not flown again. Trained policies fly
beside the planners if `--learned` names the folder of their runs:

    jcas-lab train --preset isac --train-preset tuned --train-set shaping.detection=60 \\
        --uavs 5,10,15,20 --hotspots 3,7,11 --steps 409600 --seed SEED --half \\
        --name learned --out out/learned/SEED

    python lab/experiments/isac_rules.py --jcas target/release/jcas --runs out/isac \\
        --figure docs/images/isac_rules.webp --jobs 2
"""

import argparse
import csv
import math
import subprocess
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from isac import write

FLEETS = "5,10,15,20"
HOTSPOTS = "3,7,11"
DENSITIES = ("0.01", "0.03", "0.1", "0.2", "0.3", "adaptive", "myopic")
REFERENCE = "0.3"
STEPS = "mission_steps_mean"
ENDS = ("low", "high")
QUANTITIES = {
    "success": "success_rate",
    "steps": STEPS,
    "energy_kwh": "energy_kwh_mean",
    "throughput": "throughput_mean",
    "false_confirmations": "false_confirmations_mean",
}
BLOCKS = 16
# Quantile of Student's distribution with 15 degrees of freedom, 0.975.
STUDENT = 2.131
# In the curve `table` a change of the density by 1 dB moves the logit of P_d by κ. This slope is
# that of `swerling1` at P_d = 0.5, so that κ is the slope times the exponent of the pilot gain.
LOGIT_PER_DB = 0.30
EXPONENTS = (0, 0.25, 0.5, 0.75, 1)
MAPS = {
    "link_throughput_min": ("0.8", "0.9", "1", "1.1", "1.2"),
    "sensing_noise_dbm": ("-133", "-130", "-127.27", "-124", "-121"),
    "quorum": ("1", "2", "3", "4"),
    "false_alarm_per_cell": ("0.0001", "0.001", "0.01", "0.05"),
    "logistic_slope_per_db": tuple(f"{exponent * LOGIT_PER_DB:g}" for exponent in EXPONENTS),
}
LABELS = {
    "link_throughput_min": "least throughput of a link",
    "sensing_noise_dbm": "noise of the radar in dBm",
    "quorum": "quorum θ",
    "false_alarm_per_cell": "false alarms a cell and look",
    "logistic_slope_per_db": "exponent of the pilot gain",
}


def flown(options, name, blocks, episodes, *arguments):
    """Flies the blocks of a sweep and returns the rows of each, in one order."""

    def fly(block):
        out = options.runs / name / str(block)
        command = [options.jcas, "sweep", "--preset", "isac", "--no-figures", "--threads", "1"]
        command += ["--seed", str(block), "--episodes", str(episodes), "--out", out, *arguments]
        if not (out / "results.csv").exists():
            subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
        with open(out / "results.csv", newline="") as file:
            return list(csv.DictReader(file))

    with ThreadPoolExecutor(options.jobs) as pool:
        return list(pool.map(fly, range(1, blocks + 1)))


def interval(values):
    """Returns the mean of the blocks and half of its 95 % interval."""
    count = len(values)
    mean = sum(values) / count
    variance = sum((value - mean) ** 2 for value in values) / (count - 1)
    return mean, STUDENT * (variance / count) ** 0.5


def blockwise(tables, names, quantity):
    """Returns the values of the blocks for each key, the mean over all other columns."""
    values = {}
    for table in tables:
        sums = {}
        for row in table:
            sums.setdefault(tuple(row[name] for name in names), []).append(float(row[quantity]))
        for key, of in sums.items():
            values.setdefault(key, []).append(sum(of) / len(of))
    return values


def described(tables, names, references):
    """Returns a row for each key: quantities, and the steps beside those of other keys.

    `references` has a function from a key to another for each column.
    """
    by_quantity = {of: blockwise(tables, names, name) for of, name in QUANTITIES.items()}
    rows = []
    for key, steps in by_quantity["steps"].items():
        row = dict(zip(names, key, strict=True))
        for of, values in by_quantity.items():
            mean, half = interval(values[key])
            row |= {of: round(mean, 4), f"{of}_half": round(half, 4)}
        for column, reference in references.items():
            beside = by_quantity["steps"][reference(key)]
            mean, half = interval([a - b for a, b in zip(steps, beside, strict=True)])
            row |= {column: round(mean, 4), f"{column}_half": round(half, 4)}
        rows.append(row)
    return rows


def rules(options):
    """Returns a row for each script, density and fleet: the mean over the numbers of hotspots."""
    names = ("policy", "pilot", "uav_count")
    tables = flown(
        options,
        "rules",
        BLOCKS,
        20,
        *("--policy", "line,answer", "--pilot", ",".join(DENSITIES)),
        *("--uavs", FLEETS, "--hotspots", HOTSPOTS),
    )
    references = {
        "beside_max": lambda key: (key[0], REFERENCE, key[2]),
        "beside_line": lambda key: ("line", *key[1:]),
    }
    return described(tables, names, references)


def planners(options):
    """Returns a row for each policy and fleet, the mean over the numbers of hotspots.

    Plans choose their own densities.
    """
    references = {
        "beside_plan": lambda key: ("plan", key[1]),
        "beside_replan": lambda key: ("replan", key[1]),
    }
    return described(planners_flown(options), ("policy", "uav_count"), references)


def planners_flown(options):
    """Flies the planners' blocks."""
    return flown(
        options,
        "planners",
        BLOCKS,
        8,
        *("--policy", "line,answer,plan,replan", "--uavs", FLEETS, "--hotspots", HOTSPOTS),
    )


def learned(options):
    """Returns a row for each trained policy and fleet, and one for all policies of a fleet.

    The planners' blocks stand beside them.
    """
    folders = sorted(path for path in options.learned.iterdir() if path.is_dir())
    flights = [
        flown(
            options,
            f"learned/{folder.name}",
            BLOCKS,
            8,
            *("--policy", folder, "--uavs", FLEETS, "--hotspots", HOTSPOTS),
        )
        for folder in folders
    ]
    planned = planners_flown(options)
    rows = []
    for name, runs in [("all", flights), *((f.name, [r]) for f, r in zip(folders, flights))]:
        tables = [list(block) for block in planned]
        for run in runs:
            for block, table in zip(tables, run, strict=True):
                block += [row | {"policy": "learned"} for row in table]
        references = {
            f"beside_{policy}": lambda key, policy=policy: (policy, key[1])
            for policy in ("line", "plan", "replan")
        }
        described_rows = described(tables, ("policy", "uav_count"), references)
        rows += [{"seed": name} | row for row in described_rows if row["policy"] == "learned"]
    return rows


def reports(options):
    """Returns a row for each policy, fleet and number of report levels."""
    names = ("policy", "uav_count", "report_levels")
    tables = flown(
        options,
        "reports",
        BLOCKS,
        8,
        *("--policy", "answer,replan", "--uavs", FLEETS, "--hotspots", "7"),
        *("--set", "report_slots=0", "--vary", "report_levels=0,2"),
    )
    return described(tables, names, {"beside_none": lambda key: (*key[:2], "0")})


def tabulated(options):
    """Writes the detection curve of `isac` as a table and returns the options that fly it."""
    path = options.runs / "swerling1.csv"
    odds = [["range_m", "p_d"]]
    false_alarm = 1e-6
    # P_d = false_alarm^(1/(1 + snr)) is 0.5 at 150 m.
    snr_at_150_m = math.log(false_alarm) / math.log(0.5) - 1
    for metres in range(10, 641, 10):
        snr = snr_at_150_m * (150 / metres) ** 4
        odds.append([metres, min(false_alarm ** (1 / (1 + snr)), 0.999999)])
    path.parent.mkdir(parents=True, exist_ok=True)
    with open(path, "w", newline="") as file:
        csv.writer(file).writerows(odds)
    return (
        *("--radar-table", path, "--set", "comm_load_penalty_db=0"),
        *("--set", "sensing_footprint_m=150"),
    )


def maps(options):
    """Returns a row for each field, value and density of fifteen UAVs that `answer`."""
    rows = []
    for field, values in MAPS.items():
        extra = tabulated(options) if field == "logistic_slope_per_db" else ()
        (table,) = flown(
            options,
            f"maps/{field}",
            1,
            120,
            *("--policy", "answer", "--pilot", ",".join(DENSITIES[1:]), "--uavs", "15"),
            *("--hotspots", "7", "--vary", f"{field}={','.join(values)}", *extra),
        )
        for cell in table:
            value = float(cell[field])
            if field == "logistic_slope_per_db":
                value = round(value / LOGIT_PER_DB, 4)
            row = {"field": field, "value": value, "pilot": cell["pilot"]}
            for of, name in QUANTITIES.items():
                row |= {of: round(float(cell[name]), 4)}
                row |= {f"{of}_{end}": round(float(cell[f"{name}_{end}"]), 4) for end in ENDS}
            rows.append(row)
    return rows


def draw(path, rows):
    """Draws the steps over each field of the maps, a curve for each density."""
    from matplotlib import pyplot

    figure, axes = pyplot.subplots(1, len(MAPS), figsize=(15, 3.6), layout="constrained")
    for axis, field in zip(axes, MAPS, strict=True):
        for colour, pilot in enumerate(DENSITIES[1:]):
            of = [r for r in rows if (r["field"], r["pilot"]) == (field, pilot)]
            line = "-" if pilot in ("adaptive", "myopic") else ":"
            axis.errorbar(
                [r["value"] for r in of],
                [r["steps"] for r in of],
                [[abs(r[f"steps_{end}"] - r["steps"]) for r in of] for end in ENDS],
                color=f"C{colour}",
                linestyle=line,
                label=pilot,
            )
        axis.set(xlabel=LABELS[field], ylim=(0, 40))
        if field == "false_alarm_per_cell":
            axis.set_xscale("log")
        else:
            axis.locator_params(axis="x", nbins=4)
    axes[0].set_ylabel("steps of a mission")
    axes[-1].legend(title="ρ")
    figure.savefig(path, dpi=110)


def main():
    """Flies the studies, writes their tables and draws the figure."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--jcas", required=True, help="path of the command jcas")
    parser.add_argument("--runs", required=True, type=Path, help="folder of the sweeps")
    parser.add_argument("--figure", type=Path, help="picture to write, with Matplotlib")
    parser.add_argument("--learned", type=Path, help="folder of the runs of trained policies")
    parser.add_argument("--jobs", type=int, default=1, help="blocks that fly at once")
    options = parser.parse_args()
    write("isac_rules.csv", rules(options))
    mapped = maps(options)
    write("isac_maps.csv", mapped)
    if options.figure:
        draw(options.figure, mapped)
    write("isac_planners.csv", planners(options))
    write("isac_reports.csv", reports(options))
    if options.learned:
        write("isac_learned.csv", learned(options))


if __name__ == "__main__":
    main()
