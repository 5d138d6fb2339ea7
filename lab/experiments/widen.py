"""Gives a checkpoint of a set network to one that reads more, so that its training goes on.

Weights of inputs and layers that the old network lacks are zero. The new network thus computes
what the old one did. `--like` is a run of the new network, for example one of `--steps 0`.
Needs numpy and safetensors.

    python lab/experiments/widen.py --checkpoint out/second --like out/like --out out/wide
    cargo lab train --from out/wide --out out/third
"""

import argparse
from pathlib import Path

import numpy as np
from safetensors import safe_open
from safetensors.numpy import load_file, save_file

CHECKPOINT, POLICY = "checkpoint.safetensors", "policy.safetensors"
# The order of an actor's arrays in a checkpoint; the layers of the trunk follow.
ORDER = [
    *("neighbour.0.weight", "neighbour.0.bias", "neighbour.1.weight", "neighbour.1.bias"),
    *("hotspot.0.weight", "hotspot.0.bias", "hotspot.own", "hotspot.1.weight", "hotspot.1.bias"),
    *("hotspot.relation", "hotspot.2.weight", "hotspot.2.bias", "hotspot.others"),
    *("score.weight", "score.bias"),
]


def shapes(run):
    """Returns the shapes of an actor's arrays by name, in the order of a checkpoint."""
    present = {name: array.shape for name, array in load_file(run / POLICY).items()}
    depth = sum(name.startswith("trunk.") for name in present) // 2
    trunk = [f"trunk.{layer}.{part}" for layer in range(depth) for part in ("weight", "bias")]
    order = [name for name in ORDER + trunk if name in present]
    if len(order) < len(present):
        raise SystemExit(f"{run}: arrays of no set network: {sorted(set(present) - set(order))}")
    return {name: present[name] for name in order}


def widen(flat, old, new):
    """Returns the numbers of a flat vector in the places of the new arrays."""
    blocks, first = {}, 0
    for name, (rows, columns) in old.items():
        blocks[name] = flat[first : first + rows * columns].reshape(rows, columns)
        first += rows * columns
    if first != len(flat):
        raise SystemExit(f"the checkpoint has {len(flat)} weights, its policy {first}")
    wide = []
    for name, (rows, columns) in new.items():
        block = blocks.get(name, np.zeros((0, columns), np.float32))
        if len(block) > rows or block.shape[1] != columns:
            raise SystemExit(f"{name}: {block.shape} does not fit into {(rows, columns)}")
        wide += [block.ravel(), np.zeros((rows - len(block)) * columns, np.float32)]
    return np.concatenate(wide)


def main():
    """Writes the checkpoint of the new network."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--checkpoint", type=Path, required=True, help="run to go on from")
    parser.add_argument("--like", type=Path, required=True, help="run of the new network")
    parser.add_argument("--out", type=Path, required=True, help="folder of the new checkpoint")
    options = parser.parse_args()
    old, new = shapes(options.checkpoint), shapes(options.like)
    arrays = load_file(options.checkpoint / CHECKPOINT)
    with safe_open(options.checkpoint / CHECKPOINT, "numpy") as file:
        notes = file.metadata()
    for name in ("actor.parameters", "actor.mean", "actor.square"):
        arrays[name] = widen(arrays[name], old, new)
    options.out.mkdir(parents=True, exist_ok=True)
    save_file(arrays, options.out / CHECKPOINT, notes)


if __name__ == "__main__":
    main()
