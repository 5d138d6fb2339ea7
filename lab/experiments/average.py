"""Averages the weights of two policies of one network, and writes a policy without evaluations.

A training with `--steps 0` then evaluates the mean and writes its card. Needs numpy and
safetensors.

    python lab/experiments/average.py out/before out/after --out out/mean
    cargo lab train --steps 0 --from out/mean --out out/policy
"""

import argparse
import json
from pathlib import Path

import numpy as np
from safetensors import safe_open
from safetensors.numpy import load_file, save_file

CARD, WEIGHTS = "policy.json", "policy.safetensors"


def main():
    """Writes the mean of the weights."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("policies", type=Path, nargs=2, help="folders of the two policies")
    parser.add_argument("--out", type=Path, required=True, help="folder of the mean")
    options = parser.parse_args()
    first, second = (load_file(folder / WEIGHTS) for folder in options.policies)
    shapes = [{name: array.shape for name, array in one.items()} for one in (first, second)]
    if shapes[0] != shapes[1]:
        raise SystemExit(f"{options.policies[1]}: its network is not that of {options.policies[0]}")
    mean = {
        name: ((array.astype(np.float32) + second[name].astype(np.float32)) / 2).astype(array.dtype)
        for name, array in first.items()
    }
    with safe_open(options.policies[1] / WEIGHTS, "numpy") as file:
        notes = file.metadata()
    card = json.loads((options.policies[1] / CARD).read_text())
    options.out.mkdir(parents=True, exist_ok=True)
    save_file(mean, options.out / WEIGHTS, notes)
    (options.out / CARD).write_text(json.dumps({**card, "evaluations": []}, indent=2) + "\n")


if __name__ == "__main__":
    main()
