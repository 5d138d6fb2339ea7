"""The page of results, written from the tables through a template."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any

import jinja2
import pandas as pd

from . import experiments, figures, tables
from .claims import FLEETS, Evidence, sentences, training_seconds
from .conditions import LETTER, SCAN
from .run import missing
from .tables import select

PAGE = Path(__file__).parent.parent / "results.md"
TEMPLATE = Path(__file__).parent / "page.md.j2"
PAPER_SECONDS = {5: 402, 10: 598, 15: 1253, 20: 1751}


def of_fleet(runs: pd.DataFrame, wanted: dict[str, Any], metres: float, uavs: int) -> str:
    """The success rate at n = 5 as text, with the number of trainings that were run."""
    rows = select(runs, **wanted, sensing_range_m=metres, uavs=uavs, hotspots=5, changes="")
    if rows.empty:
        return "not run"
    trainings = f" ({len(rows)})" if wanted["policy"] == "ppo" else ""
    return f"{rows['success'].mean():.2f}{trainings}"


def over_hotspots(runs: pd.DataFrame, metres: float, uavs: int) -> str:
    """The success rate of the pure random walk, as a mean over n."""
    rows = select(runs, policy="random", sensing_range_m=metres, uavs=uavs, changes="")
    rates = rows.groupby("hotspots")["success"].mean()
    return f"{rates.mean():.2f}" if len(rates) == len(figures.HOTSPOTS) else "not run"


def rate(runs: pd.DataFrame, **wanted: Any) -> str:
    """The mean success rate of PPO in one cell, with the number of trainings."""
    fixed = {"policy": "ppo", "hotspots": 5, "pilot": "adaptive", "mode": "sampled"}
    fixed |= {"motion_map": "udlrs", "changes": ""}
    rows = select(runs, **{**fixed, **wanted})
    return f"{rows['success'].mean():.2f} ({len(rows)})" if len(rows) else "not run"


def both_modes(runs: pd.DataFrame) -> list[dict[str, Any]]:
    """The conditions of which both ways to evaluate were run, with both success rates."""
    keys = ["policy", "motion_map", "inform_payment", "sensing_range_m", "uavs"]
    rows = select(runs, hotspots=5, pilot="adaptive", changes="")
    rows = rows[rows["mode"].isin(experiments.MODES)]
    wide = rows.pivot_table(index=keys, columns="mode", values="success").reset_index()
    if "deterministic" not in wide:
        return []
    return wide.dropna().to_dict("records")


def context() -> dict[str, Any]:
    """Everything that the template shows."""
    runs = tables.read(tables.RUNS)
    evidence = Evidence(runs)
    seconds = training_seconds(select(tables.read(tables.TRAININGS), **LETTER))
    lists = []
    for name in experiments.names():
        planned = experiments.read(name)
        done = len(planned) - len(missing(planned, runs))
        lists.append({"name": name, "done": done, "planned": len(planned)})
    conditions = [
        {
            "label": label,
            "rates": [of_fleet(runs, wanted, r, n) for r in (150.0, 162.5) for n in (10, 15)],
        }
        for label, wanted in SCAN.items()
    ]
    return {
        "agreement": evidence.agreement,
        "both_modes": both_modes(runs),
        "conditions": conditions,
        "cell": lambda *wanted: evidence.cell("success", *wanted)[0],
        "fleets": FLEETS,
        "lists": lists,
        "mean": evidence.mean,
        "paper_seconds": PAPER_SECONDS,
        "rate": lambda pay, metres, uavs, **more: rate(
            runs, inform_payment=pay, sensing_range_m=float(metres), uavs=uavs, **more
        ),
        "seconds": seconds,
        "sentences": sentences(evidence),
        "sources": sorted(set(runs["sources"])),
        "spread": tables.pooled_spread(runs, "success"),
        "walk": [over_hotspots(runs, r, n) for r in (150.0, 162.5) for n in (10, 15)],
    }


def render() -> str:
    """The page as text."""
    environment = jinja2.Environment(
        undefined=jinja2.StrictUndefined, trim_blocks=True, lstrip_blocks=True, autoescape=False
    )
    template = environment.from_string(TEMPLATE.read_text(encoding="utf-8"))
    return template.render(context()).rstrip() + "\n"


def write() -> None:
    """Writes the figures and the page."""
    figures.write(tables.read(tables.RUNS), tables.RESULTS / "figures")
    part = PAGE.with_suffix(".part")
    part.write_text(render(), encoding="utf-8")
    os.replace(part, PAGE)
