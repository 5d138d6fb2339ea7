"""The figures of the page, as SVG: one over the sensing range, then those of the paper."""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path

import matplotlib as mpl

mpl.use("svg")
import matplotlib.pyplot as plt
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from . import tables
from .conditions import GRID, LETTER, SCAN
from .tables import select

HOTSPOTS = (3, 5, 7, 9, 11)
FLEETS = (5, 10, 15, 20)
MARKS = "os^Dv"
STYLE = {
    "svg.fonttype": "none",
    "svg.hashsalt": "jcas",
    "font.size": 9,
    "axes.grid": True,
    "grid.alpha": 0.3,
    "legend.fontsize": 7,
    "legend.framealpha": 0.7,
}
Draw = Callable[[pd.DataFrame], Figure]


def curve(
    axes: Axes, runs: pd.DataFrame, rows: pd.DataFrame, x: str, quantity: str, **style: object
) -> None:
    """Draws a quantity over a column; trainings have the interval of their spread."""
    if rows.empty:
        return
    spread = tables.pooled_spread(runs, quantity)
    points = []
    for value, cell in rows.groupby(x):
        if set(cell["policy"]) == {"ppo"}:
            points.append((value, *tables.cell_interval(cell, quantity, spread)))
        else:
            mean = float(cell[quantity].mean())
            points.append((value, mean, mean, mean))
    at, mean, low, high = (list(column) for column in zip(*points, strict=True))
    below = [middle - bound for middle, bound in zip(mean, low, strict=True)]
    above = [bound - middle for middle, bound in zip(mean, high, strict=True)]
    axes.errorbar(at, mean, yerr=[below, above], capsize=2, markersize=4, linewidth=1.2, **style)


def over_range(runs: pd.DataFrame) -> Figure:
    """Success over the sensing range, for the paper's two fleets."""
    figure, panels = plt.subplots(1, 2, figsize=(8.4, 3.6), sharey=True, layout="constrained")
    for panel, (uavs, rate) in zip(panels, ((10, 0.73), (15, 0.97)), strict=True):
        here = select(runs, uavs=uavs, hotspots=5, changes="")
        panel.axhspan(rate - 0.005, rate + 0.005, color="0.6", alpha=0.5, label="the paper")
        for number, (label, wanted) in enumerate(SCAN.items()):
            rows = select(here, **wanted)
            curve(
                panel,
                runs,
                rows,
                "sensing_range_m",
                "success",
                label=label,
                color=f"C{number}",
                marker=(MARKS * 2)[number],
                linestyle="--" if "symmetric" in label else "-",
            )
        panel.set(title=f"N = {uavs}, n = 5", xlabel="sensing range (m)", ylim=(-0.02, 1.03))
    panels[0].set_ylabel("success rate")
    handles, labels = panels[1].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside right upper")
    return figure


def returns(runs: pd.DataFrame) -> Figure:
    """The paper's Fig. 2: mean episode return over iterations, by the number of hotspots."""
    figure, axes = plt.subplots(figsize=(5.2, 3.4), layout="constrained")
    course = select(tables.read(tables.TRAININGS), uavs=10, seed=0, **LETTER)
    for hotspots in HOTSPOTS:
        rows = select(course, hotspots=hotspots)
        axes.plot(rows["iteration"], rows["return_mean"], label=f"n = {hotspots}", linewidth=1.2)
    axes.axvline(40, color="0.5", linestyle=":", label="the paper: flat from here")
    axes.set(xlabel="PPO iteration", ylabel="mean episode return", title="N = 10")
    figure.legend(loc="outside right upper")
    return figure


def over_uavs(quantity: str, label: str) -> Draw:
    """One of the paper's Figs. 3 to 6: a quantity over the number of UAVs, by n."""

    def draw(runs: pd.DataFrame) -> Figure:
        figure, axes = plt.subplots(figsize=(5.2, 3.4), layout="constrained")
        grid = select(runs, pilot="adaptive", **GRID)
        for hotspots, mark in zip(HOTSPOTS, MARKS, strict=True):
            rows = select(grid, hotspots=hotspots)
            curve(axes, runs, rows, "uavs", quantity, label=f"n = {hotspots}", marker=mark)
        axes.set(xlabel="number of UAVs", ylabel=label, xticks=FLEETS)
        figure.legend(loc="outside right upper")
        return figure

    return draw


def over_hotspots(quantity: str, label: str, fleets: tuple[int, ...]) -> Draw:
    """One of the paper's Figs. 7 and 8: a quantity over n, for both ways to choose the pilots."""

    def draw(runs: pd.DataFrame) -> Figure:
        figure, axes = plt.subplots(figsize=(5.2, 3.4), layout="constrained")
        for number, uavs in enumerate(fleets):
            for pilot, line in (("adaptive", "-"), ("0.3", "--")):
                rows = select(runs, pilot=pilot, uavs=uavs, **GRID)
                curve(
                    axes,
                    runs,
                    rows,
                    "hotspots",
                    quantity,
                    label=f"N = {uavs}, {pilot}",
                    marker=MARKS[number],
                    color=f"C{number}",
                    linestyle=line,
                )
        axes.set(xlabel="number of hotspots", ylabel=label, xticks=HOTSPOTS)
        figure.legend(loc="outside right upper")
        return figure

    return draw


FIGURES: dict[str, Draw] = {
    "success_over_range": over_range,
    "fig2_returns": returns,
    "fig3_success": over_uavs("success", "success rate"),
    "fig4_mission_time": over_uavs("steps", "steps of an episode"),
    "fig5_energy": over_uavs("energy_kwh", "energy of the fleet (kWh)"),
    "fig6_throughput": over_uavs("throughput", "normalised throughput"),
    "fig7_success_over_hotspots": over_hotspots("success", "success rate", FLEETS),
    "fig8_throughput_over_hotspots": over_hotspots("throughput", "normalised throughput", (10, 15)),
}


def write(runs: pd.DataFrame, folder: Path) -> None:
    """Draws every figure into a folder; the same tables give the same files."""
    folder.mkdir(parents=True, exist_ok=True)
    with mpl.rc_context(STYLE):
        for name, draw in FIGURES.items():
            figure = draw(runs)
            part = folder / f"{name}.part"
            figure.savefig(part, format="svg", metadata={"Date": None})
            os.replace(part, folder / f"{name}.svg")
            plt.close(figure)
