"""The paper's PPO over the sensing range, with informing paid once.

Each row of the table is one policy in one cell: a random walk, or PPO with the paper's settings.
The script can be stopped at any time. It goes on where the table ends, and an unfinished training
resumes from its checkpoint. With `--jobs` several cells run at once, each on one thread.

    python lab/experiments/inform_once.py --jcas target/release/jcas \\
        --lab lab/target/release/jcas-lab --runs out/inform_once --jobs 2
"""

import argparse
import csv
import json
import subprocess
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from threading import Lock

TABLE = Path(__file__).parent.parent / "results" / "inform_once.csv"
TABLE_LOCK = Lock()
EPISODES = 1000
KEY = ("reading", "range_m", "uavs", "hotspots", "pilot", "seed", "policy")
QUANTITIES = {
    "success": "success_rate",
    "steps": "mission_steps_mean",
    "energy_kwh": "energy_kwh_mean",
    "throughput": "throughput_mean",
    "return": "return_mean",
}
FIELDS = [*KEY, "episodes"]
FIELDS += [name + end for name in QUANTITIES for end in ("", "_low", "_high")]
FIELDS += ["train_seconds"]

# What each reading of the paper's text changes of the preset `paper`.
READINGS = {
    "every step": ["inform_payment=every_step"],
    "once": ["inform_payment=once"],
    "once, no throughput": ["inform_payment=once", "reward_throughput=0"],
    "once, quorum over the episode": ["inform_payment=once", "quorum_window=episode"],
    "once, own detections": ["inform_payment=once", "learned_detections=all"],
    "once, random starts": ["inform_payment=once", "start_cells=random"],
}
OVER_THE_EPISODE = "once, quorum over the episode"


def cells():
    """Yields the cells in the order of their worth; some come up again."""
    for range_m in (175, 150, 162.5, 187.5, 200, 137.5, 125, 212.5, 225):
        for uavs in (10, 15):
            yield ("once", range_m, uavs, 5, "mid", 0, "random")
            yield ("once", range_m, uavs, 5, "adaptive", 0, "ppo")
    for range_m in (150, 175):
        for uavs in (10, 15):
            for reading in ("every step", "once, no throughput"):
                yield (reading, range_m, uavs, 5, "adaptive", 0, "ppo")
    for seed in (1, 2):
        for range_m in (175, 162.5, 187.5):
            for uavs in (10, 15):
                yield ("once", range_m, uavs, 5, "adaptive", seed, "ppo")
    for uavs in (10, 15, 5, 20):
        for hotspots in (3, 5, 7, 9, 11):
            yield ("once", 162.5, uavs, hotspots, "adaptive", 0, "ppo")
        yield ("once", 162.5, uavs, 5, "0.3", 0, "ppo")
        for hotspots in (3, 5, 7, 9, 11):
            yield ("once", 162.5, uavs, hotspots, "mid", 0, "random")
    for fleets in ((10, 15), (5, 20)):
        for pilot in ("adaptive", "0.3"):
            for seed in (0, 1, 2):
                for uavs in fleets:
                    for hotspots in (3, 5, 7, 9, 11):
                        yield ("once", 162.5, uavs, hotspots, pilot, seed, "ppo")
    yield from other_readings()


def other_readings():
    """Yields the cells of the readings of detection and start, at the range that fits `once`.

    A quorum over the episode needs a shorter range, so it is scanned as well.
    """
    readings = [*READINGS][3:]
    for range_m in (75, 62.5, 87.5, 50, 100):
        for uavs in (10, 15):
            yield (OVER_THE_EPISODE, range_m, uavs, 5, "mid", 0, "random")
    for seed in (0, 1, 2):
        for reading in readings:
            for uavs in (10, 15):
                if seed == 0:
                    yield (reading, 162.5, uavs, 5, "mid", 0, "random")
                yield (reading, 162.5, uavs, 5, "adaptive", seed, "ppo")
        for range_m in (75, 100, 87.5):
            for uavs in (10, 15):
                yield (OVER_THE_EPISODE, range_m, uavs, 5, "adaptive", seed, "ppo")


def finished(path):
    """Returns the keys of the rows that a table holds."""
    if not path.exists():
        return set()
    with path.open(newline="") as table:
        return {tuple(row[name] for name in KEY) for row in csv.DictReader(table)}


def run(options, cell, path):
    """Trains where the policy is PPO, evaluates, and appends one row to a table."""
    reading, range_m, uavs, hotspots, pilot, seed, policy = cell
    config = ["--preset", "paper", "--uavs", str(uavs), "--hotspots", str(hotspots)]
    for change in [*READINGS[reading], f"sensing_range_m={range_m}"]:
        config += ["--set", change]
    seconds = ""
    if policy == "ppo":
        words = reading.replace(",", "").replace(" ", "_")
        folder = f"{options.runs}/{words}-{range_m}m-{uavs}x{hotspots}-{pilot}-s{seed}"
        train = [options.lab, "train", "--train-preset", "paper", *config, "--seed", str(seed)]
        train += ["--threads", "1", "--out", folder, "--resume"]
        if pilot != "adaptive":
            train += ["--train-set", f"constant_pilot={pilot}"]
        begun = time.monotonic()
        subprocess.run(train, check=True)
        seconds = round(time.monotonic() - begun)
        fly = [folder, "--mode", "sampled"]
    elif pilot == "planned":
        fly = [policy]
    else:
        fly = [policy, "--pilot", pilot]
    evaluate = [options.jcas, "evaluate", *fly, *config, "--episodes", str(EPISODES), "--json"]
    report = json.loads(subprocess.run(evaluate, check=True, capture_output=True).stdout)
    row = dict(zip(KEY, cell, strict=True)) | {"episodes": EPISODES, "train_seconds": seconds}
    for name, field in QUANTITIES.items():
        for end in ("", "_low", "_high"):
            row[name + end] = report[field + end]
    with TABLE_LOCK:
        new = not path.exists()
        with path.open("a", newline="") as table:
            writer = csv.DictWriter(table, FIELDS, lineterminator="\n")
            if new:
                writer.writeheader()
            writer.writerow(row)


def main():
    """Runs every cell that the table lacks."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--jcas", required=True, help="path of the command jcas")
    parser.add_argument("--lab", required=True, help="path of the command jcas-lab")
    parser.add_argument("--runs", required=True, help="folder of the trainings")
    parser.add_argument("--jobs", type=int, default=1, help="cells that run at once")
    options = parser.parse_args()
    present = finished(TABLE)
    missing = [cell for cell in dict.fromkeys(cells()) if tuple(map(str, cell)) not in present]
    with ThreadPoolExecutor(options.jobs) as pool:
        for _ in pool.map(lambda cell: run(options, cell, TABLE), missing):
            pass


if __name__ == "__main__":
    main()
