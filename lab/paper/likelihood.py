"""The test of agreement with the paper's success rates, fixed before the grid was run.

The paper reports a mean success rate of 0.73 over n with ten UAVs, and of 0.97 for each n with
fifteen UAVs. Each of its rates is of one training and 100 episodes. The model:

- A training with N UAVs and n hotspots has the success rate p, logit p = m(N, n) + tau z. Here z
  is standard normal and independent between trainings.
- The successes in M episodes of that training are binomial (M, p).
- The paper's mean is rounded to two digits, so that of 500 episodes 363 to 367 succeeded.
- "approximately 97 %" is 96, 97 or 98 of 100 episodes.

H0: the paper's trainings have our m and tau. H1: they have means of their own, while tau is common.
The means are one on the logit scale for N = 10 and one for each n with N = 15. The statistic
is twice the log of the likelihood ratio, which is compared with chi squared of six degrees of
freedom. H0 is rejected at p < 0.05. A condition is tested only if each of its ten cells has a
training.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache

import numpy as np
import pandas as pd
from numpy.typing import NDArray
from scipy import optimize, stats
from scipy.special import expit, gammaln, logit, logsumexp

from . import tables

HOTSPOTS = (3, 5, 7, 9, 11)
PAPER_EPISODES = 100
MEAN_10 = range(363, 368)
EACH_15 = range(96, 99)
NODES, WEIGHTS = np.polynomial.hermite_e.hermegauss(48)
LOG_WEIGHTS = np.log(WEIGHTS / WEIGHTS.sum())

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Agreement:
    """The outcome of the test for one condition."""

    statistic: float
    p_value: float
    tau: float
    predicted_10: float
    predicted_15: tuple[float, ...]

    @property
    def rejected(self) -> bool:
        """Whether the paper's rates and ours disagree at 5 %."""
        return self.p_value < 0.05


def log_marginal(successes: Array, episodes: int, mean: float, tau: float) -> Array:
    """The log probability of each number of successes of a training, over its z."""
    rates = np.clip(expit(mean + tau * NODES), 1e-12, 1 - 1e-12)
    k = np.atleast_1d(successes)[:, None]
    ways = gammaln(episodes + 1.0) - gammaln(k + 1.0) - gammaln(episodes - k + 1.0)
    terms = ways + k * np.log(rates) + (episodes - k) * np.log1p(-rates)
    return np.asarray(logsumexp(terms + LOG_WEIGHTS, axis=1))


def log_paper_10(means: Array, tau: float) -> float:
    """The log probability of the paper's mean with ten UAVs."""
    total = np.ones(1)
    for mean in means:
        one = np.exp(log_marginal(np.arange(PAPER_EPISODES + 1.0), PAPER_EPISODES, mean, tau))
        total = np.convolve(total, one)
    return float(np.log(max(total[MEAN_10.start : MEAN_10.stop].sum(), 1e-300)))


def log_paper_15(mean: float, tau: float) -> float:
    """The log probability of one of the paper's rates with fifteen UAVs."""
    return float(logsumexp(log_marginal(np.array(EACH_15, float), PAPER_EPISODES, mean, tau)))


@cache
def largest_of_paper() -> tuple[Array, Array]:
    """A grid of log tau, and on it the largest log probability of the paper's rates under H1."""
    grid = np.linspace(np.log(0.05), np.log(4.0), 30)
    values = []
    for tau in np.exp(grid):
        ten = largest(lambda mean, tau=tau: log_paper_10(np.full(5, mean), tau))
        fifteen = largest(lambda mean, tau=tau: log_paper_15(mean, tau))
        values.append(ten + len(HOTSPOTS) * fifteen)
    return grid, np.array(values)


def largest(of: Callable[[float], float]) -> float:
    """The largest value of a function of a mean on the logit scale."""
    found = optimize.minimize_scalar(lambda mean: -of(mean), bounds=(-3.0, 9.0), method="bounded")
    return -float(found.fun)


def cells_of(table: pd.DataFrame) -> list[tuple[Array, int]]:
    """Our numbers of successes and of episodes, for N = 10 and then 15, by n."""
    cells = []
    for uavs in (10, 15):
        for hotspots in HOTSPOTS:
            rows = tables.select(table, uavs=uavs, hotspots=hotspots)
            if rows.empty:
                raise ValueError(f"N = {uavs}, n = {hotspots}: no training, which the test needs")
            episodes = int(rows["episodes"].iloc[0])
            cells.append(((rows["success"] * episodes).round().to_numpy(), episodes))
    return cells


def test(table: pd.DataFrame) -> Agreement:
    """Tests one condition; the table has its trainings with ten and fifteen UAVs."""
    cells = cells_of(table)
    grid, values = largest_of_paper()

    def ours(means: Array, tau: float) -> float:
        pairs = zip(cells, means, strict=True)
        return sum(float(log_marginal(k, m, mean, tau).sum()) for (k, m), mean in pairs)

    def apart(parameters: Array) -> float:
        means, log_tau = parameters[:10], parameters[10]
        return ours(means, float(np.exp(log_tau))) + float(np.interp(log_tau, grid, values))

    def together(parameters: Array) -> float:
        means, tau = parameters[:10], float(np.exp(parameters[10]))
        fifteen = sum(log_paper_15(mean, tau) for mean in means[5:])
        return ours(means, tau) + log_paper_10(means[:5], tau) + fifteen

    start = [logit((k.mean() + 0.5) / (m + 1.0)) for k, m in cells]
    bounds = [(-9.0, 9.0)] * 10 + [(grid[0], grid[-1])]
    free = maximise(apart, np.array([*start, np.log(0.5)]), bounds)
    common = maximise(together, free.x, bounds)
    statistic = max(0.0, 2.0 * float(common.fun - free.fun))
    tau = float(np.exp(free.x[10]))
    rates = [float(np.exp(LOG_WEIGHTS) @ expit(mean + tau * NODES)) for mean in free.x[:10]]
    return Agreement(
        statistic=statistic,
        p_value=float(stats.chi2.sf(statistic, 1 + len(HOTSPOTS))),
        tau=tau,
        predicted_10=float(np.mean(rates[:5])),
        predicted_15=tuple(rates[5:]),
    )


def maximise(
    of: Callable[[Array], float], start: Array, bounds: list[tuple[float, float]]
) -> optimize.OptimizeResult:
    """The maximum of a log likelihood near a start; `fun` is its negative."""
    return optimize.minimize(
        lambda parameters: -of(parameters), start, method="L-BFGS-B", bounds=bounds
    )
