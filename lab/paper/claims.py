"""The paper's sentences about its results, each with our number and a verdict."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import pandas as pd
from scipy import stats

from . import tables
from .conditions import GRID, LETTER
from .likelihood import HOTSPOTS, Agreement, test
from .tables import mean_interval, pooled_spread, select

FLEETS = (5, 10, 15, 20)
DENSITIES = tables.RESULTS / "pilot_over_distance.csv"
Interval = tuple[float, float, float]


@dataclass(frozen=True)
class Sentence:
    """A sentence of the paper, and what was measured here."""

    paper: str
    here: str
    verdict: str
    trainings: str


def judge(interval: Interval, low: float, high: float) -> str:
    """Whether an interval lies in the region of a sentence, outside it, or across its border."""
    _, bottom, top = interval
    if low <= bottom and top <= high:
        return "holds"
    return "fails" if top < low or bottom > high else "open"


def worst(verdicts: list[str]) -> str:
    """The verdict on a sentence about several numbers."""
    return next((verdict for verdict in ("fails", "open") if verdict in verdicts), "holds")


def words(interval: Interval, digits: int = 2) -> str:
    """An interval as text."""
    mean, low, high = interval
    return f"{mean:.{digits}f} [{low:.{digits}f}, {high:.{digits}f}]"


class Evidence:
    """The measures that the sentences need, of one table of runs."""

    def __init__(self, runs: pd.DataFrame) -> None:
        self.runs = runs
        self.grid = select(runs, **GRID)
        self.adaptive = select(self.grid, pilot="adaptive")
        self.agreement: Agreement = test(self.adaptive)

    def mean(self, quantity: str, uavs: int, pilot: str = "adaptive") -> Interval:
        """The mean over n with N UAVs."""
        rows = select(self.grid, uavs=uavs, pilot=pilot)
        return mean_interval(rows, quantity, pooled_spread(self.runs, quantity))

    def cell(self, quantity: str, uavs: int, hotspots: int, pilot: str = "adaptive") -> Interval:
        """The value of one cell, with symmetric bounds."""
        rows = select(self.grid, uavs=uavs, hotspots=hotspots, pilot=pilot)
        return mean_interval(rows, quantity, pooled_spread(self.runs, quantity))

    def gap(self, uavs: int, hotspots: int | None = None) -> Interval:
        """Success with adaptive less that with constant pilots, in points of 100."""
        if hotspots is None:
            pair = [self.mean("success", uavs, pilot) for pilot in ("adaptive", "0.3")]
        else:
            pair = [self.cell("success", uavs, hotspots, p) for p in ("adaptive", "0.3")]
        return difference(pair[0], pair[1], 100.0)

    def gap_slope(self) -> Interval:
        """The slope of that gap over n, in points a hotspot, mean of N = 10 and 15."""
        lever = np.array(HOTSPOTS) - np.mean(HOTSPOTS)
        lever /= (lever**2).sum()
        gaps = [self.gap(uavs, n) for uavs in (10, 15) for n in HOTSPOTS]
        weights = np.tile(lever, 2) / 2
        mean = sum(w * gap[0] for w, gap in zip(weights, gaps, strict=True))
        squares = sum((w * (gap[2] - gap[0])) ** 2 for w, gap in zip(weights, gaps, strict=True))
        return mean, mean - math.sqrt(squares), mean + math.sqrt(squares)

    def ratio(self, over: Interval, under: Interval) -> Interval:
        """The ratio of two means, with the interval of independent relative errors."""
        value = over[0] / under[0]
        relative = math.hypot((over[2] - over[0]) / over[0], (under[2] - under[0]) / under[0])
        return value, value * math.exp(-relative), value * math.exp(relative)


def difference(over: Interval, under: Interval, unit: float = 1.0) -> Interval:
    """The difference of two independent means."""
    value = unit * (over[0] - under[0])
    half = unit * math.hypot(over[2] - over[0], under[2] - under[0])
    return value, value - half, value + half


def late_change(courses: pd.DataFrame) -> tuple[int, int]:
    """How many trainings change after iteration 40 by less than an iteration scatters, of all."""
    steady, count = 0, 0
    for _, course in courses.groupby(["uavs", "hotspots", "seed"]):
        late = course[course["iteration"] >= 40].dropna(subset="return_mean")
        fit = stats.linregress(late["iteration"], late["return_mean"])
        scatter = float(
            (late["return_mean"] - fit.intercept - fit.slope * late["iteration"]).std(ddof=2)
        )
        change = fit.slope * (late["iteration"].max() - late["iteration"].min())
        steady += abs(change) < scatter
        count += 1
    return steady, count


def pilot_near_hotspots(densities: pd.DataFrame) -> Interval:
    """Pilot density within a cell of an unconfirmed hotspot less that farther away."""
    gaps = []
    for _, rows in densities.groupby("seed"):
        parts = []
        for part in (rows[rows.distance_cells <= 1], rows[rows.distance_cells > 1]):
            parts.append(float(np.average(part.pilot_density_mean, weights=part.uav_steps)))
        gaps.append(parts[0] - parts[1])
    return tables.over_seeds(pd.Series(gaps))


def training_seconds(courses: pd.DataFrame) -> dict[int, float]:
    """The geometric mean over trainings of the seconds of 61 iterations, by N."""
    totals = courses.groupby(["uavs", "hotspots", "seed"])["wall_s"].sum() * 61 / 62
    return {n: float(np.exp(np.log(part).mean())) for n, part in totals.groupby("uavs")}


def of_rates(evidence: Evidence) -> list[Sentence]:
    """The sentences on success rates, judged together by the fixed test."""
    agreement = evidence.agreement
    verdict = f"{'fails' if agreement.rejected else 'open'} (p = {agreement.p_value:.1g})"
    each = ", ".join(f"{evidence.cell('success', 15, n)[0]:.2f}" for n in HOTSPOTS)
    return [
        Sentence(
            "success 0.73 at N = 10, mean over n",
            words(evidence.mean("success", 10)),
            verdict,
            "15",
        ),
        Sentence("success 0.97 at N = 15 for each n", each, "the same test", "15"),
    ]


def of_fleets(evidence: Evidence) -> list[Sentence]:
    """The sentences on time, energy and throughput over the number of UAVs."""
    steps = [evidence.mean("steps", uavs) for uavs in FLEETS]
    first, last = difference(steps[0], steps[1]), difference(steps[2], steps[3])
    energy = [evidence.mean("energy_kwh", uavs) for uavs in FLEETS]
    growth = evidence.ratio(energy[3], energy[0])
    throughput = [evidence.mean("throughput", uavs) for uavs in FLEETS]
    flat = words(difference(first, last), 0)
    return [
        Sentence(
            "mission time falls sharply, then saturates",
            ", ".join(f"{value[0]:.0f}" for value in steps)
            + f" steps; the first fall exceeds the last by {flat}",
            judge(difference(first, last), 0.0, math.inf),
            "60",
        ),
        Sentence(
            "energy grows less than N (times 4)",
            f"times {words(growth)}",
            judge(growth, 0.0, 4.0),
            "60",
        ),
        Sentence(
            "throughput above 1, for each N",
            ", ".join(f"{value[0]:.2f}" for value in throughput),
            worst([judge(value, 1.0, math.inf) for value in throughput]),
            "60",
        ),
    ]


def of_pilots(evidence: Evidence) -> list[Sentence]:
    """The sentences on adaptive against constant pilot density."""
    larger = [evidence.gap(uavs) for uavs in (15, 20)]
    at_10 = [evidence.gap(10, n) for n in HOTSPOTS]
    ratios = [
        evidence.ratio(evidence.mean("throughput", n, "0.3"), evidence.mean("throughput", n))
        for n in (10, 15)
    ]
    slope = evidence.gap_slope()
    return [
        Sentence(
            "adapting gains about 10 points with larger fleets",
            f"{words(larger[0], 0)} (N = 15), {words(larger[1], 0)} (N = 20)",
            worst([judge(gap, 5.0, 15.0) for gap in larger]),
            "60",
        ),
        Sentence(
            "within about 5 points at N = 10",
            ", ".join(f"{gap[0]:.0f}" for gap in at_10) + " points over n",
            worst([judge(gap, -5.0, 5.0) for gap in at_10]),
            "30",
        ),
        Sentence(
            "adapting is worth less with more targets",
            f"{words(slope, 1)} points a hotspot",
            judge(slope, -math.inf, 0.0),
            "60",
        ),
        Sentence(
            "constant pilots lower throughput, N = 10 and 15",
            ", ".join(f"times {words(ratio)}" for ratio in ratios),
            worst([judge(ratio, 0.0, 1.0) for ratio in ratios]),
            "60",
        ),
    ]


def of_learning(evidence: Evidence) -> list[Sentence]:
    """The sentences on learning."""
    sentences = []
    for pay, metres, label in (("every_step", 150.0, "letter"), ("once", 162.5, "paid once")):
        cell = {"inform_payment": pay, "sensing_range_m": metres, "uavs": 10, "hotspots": 5}
        cell |= {"motion_map": "udlrs", "changes": "", "mode": "sampled", "pilot": "adaptive"}
        trained = select(evidence.runs, policy="ppo", **cell)
        start = {**cell, "inform_payment": "once", "mode": "fixed"}
        untrained = select(evidence.runs, policy="untrained", **start)
        interval = mean_interval(trained, "success", pooled_spread(evidence.runs, "success"))
        if untrained.empty:
            here, verdict = f"{words(interval)}; untrained: not run", "not judged"
        else:
            base = float(untrained["success"].mean())
            here, verdict = f"{words(interval)}; untrained {base:.2f}", judge(interval, base, 1.0)
        sentences.append(
            Sentence(
                f"PPO reliably learns ({label}, {metres:g} m, N = 10, n = 5)",
                here,
                verdict,
                str(len(trained)),
            )
        )
    courses = select(tables.read(tables.TRAININGS), **LETTER)
    steady, count = late_change(courses)
    share = (steady / count, *tables.wilson(steady / count, count))
    sentences.append(
        Sentence(
            "the return is stable after about 40 iterations (letter)",
            f"in {steady} of {count} trainings",
            judge(share, 0.5, 1.0),
            str(count),
        )
    )
    near = pilot_near_hotspots(pd.read_csv(DENSITIES))
    sentences.append(
        Sentence(
            "dense pilots near hotspots, sparse after (letter)",
            f"{near[0]:+.3f} [{near[1]:.3f}, {near[2]:.3f}]",
            judge(near, 0.0, 1.0),
            "3",
        )
    )
    return sentences


ALL: list[Callable[[Evidence], list[Sentence]]] = [of_rates, of_learning, of_fleets, of_pilots]


def sentences(evidence: Evidence) -> list[Sentence]:
    """Every sentence, in the order of the paper's topics."""
    return [sentence for part in ALL for sentence in part(evidence)]
