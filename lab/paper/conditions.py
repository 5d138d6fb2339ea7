"""The conditions that the page compares, as selections of rows of the table."""

from __future__ import annotations

from typing import Any

UDLRS = {"motion_map": "udlrs"}
SYMMETRIC = {"motion_map": "symmetric"}
ADAPTIVE = {"policy": "ppo", "pilot": "adaptive", "mode": "sampled"}

# The grid of all N, n and pilot densities that the paper's Figs. 3 to 8 are drawn from.
GRID: dict[str, Any] = {
    "experiment": "inform-once",
    "policy": "ppo",
    "inform_payment": "once",
    "sensing_range_m": 162.5,
    "changes": "",
    "mode": "sampled",
}

# The trainings of the paper's Fig. 2 and Table 3.
LETTER: dict[str, Any] = {"experiment": "every-step-grid", "policy": "ppo", "pilot": "adaptive"}

# The curves of the figure over the sensing range.
SCAN: dict[str, dict[str, Any]] = {
    "teams (script)": {"policy": "teams", "inform_payment": "once"},
    "pure random walk": {"policy": "random", "inform_payment": "once"},
    "untrained, udlrs": {"policy": "untrained", **UDLRS},
    "untrained, symmetric": {"policy": "untrained", **SYMMETRIC},
    "PPO, paid every step, udlrs": {**ADAPTIVE, "inform_payment": "every_step", **UDLRS},
    "PPO, paid once, udlrs": {**ADAPTIVE, "inform_payment": "once", **UDLRS},
    "PPO, paid every step, symmetric": {**ADAPTIVE, "inform_payment": "every_step", **SYMMETRIC},
    "PPO, paid once, symmetric": {**ADAPTIVE, "inform_payment": "once", **SYMMETRIC},
}
