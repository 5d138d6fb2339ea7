//! The expected time of a plan, exactly.
//!
//! Detections are independent. Let m_c(t) be the chance that a hotspot in cell c is unconfirmed
//! after t steps. It is a product over the steps: of the chance that fewer than θ UAVs detect it.
//! Hotspots are independent given their cells. The chance F(t) that all are confirmed is a product
//! over the groups. A group of n hotspots with weights w_c has the factor (Σ w_c (1 - m_c(t)))^n.
//! For n distinct and equally likely cells it is the mean of Π (1 - m_c(t)) over all sets of n.
//! Where each cell holds a hotspot with a probability w_c of its own it is Π (1 - w_c m_c(t)).
//!
//! The episode ends at the first step after the last confirmation in which the planned fleet is one
//! radio component: consensus then informs everybody. Let c(t) be the last such step up to t. The
//! episode has ended by step t with probability F(c(t)). Its expected time is Σ (1 - F(c(t))).

use alloc::vec;
use alloc::vec::Vec;

use jcas_core::Cell;
use jcas_policy::geometry::one_more;

use crate::gather::connected;
use crate::paths::Paths;
use crate::problem::{Hidden, Problem, power};
use crate::targets::Placement;

/// The remaining probability below which no further step is evaluated.
const NEGLIGIBLE: f64 = 1e-12;

/// The probability that a plan that has run out ends the episode later.
const RUN_OUT: f64 = 1e-3;

/// The expected time of a plan, counted from the step that it begins at.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Expectation {
    /// Expected steps until the end of the episode. An episode without success counts with all
    /// steps left.
    pub steps: f64,
    /// Expected steps until every hotspot is confirmed, counted likewise.
    pub confirmed_steps: f64,
    /// Probability that the episode ends before the horizon.
    pub success: f64,
}

/// Returns the expected time of a plan, computed step by step and cell by cell.
#[must_use]
pub fn expect(problem: &Problem<'_>, paths: &Paths) -> Expectation {
    expect_while(problem, paths, &mut |_| true).unwrap_or_default()
}

/// Returns the expected time of a plan. `go_on` receives the products of each step, and may end the
/// computation, which then has no result.
pub(crate) fn expect_while(
    problem: &Problem<'_>,
    paths: &Paths,
    go_on: &mut dyn FnMut(usize) -> bool,
) -> Option<Expectation> {
    expect_traced(problem, paths, go_on, &mut |_| {})
}

/// Returns the step of the plan by which the episode has ended, if it ends by the plan at all. It
/// may have not with the probability [`RUN_OUT`]; a plan says nothing of the time after.
pub(crate) fn runs_out(problem: &Problem<'_>, paths: &Paths) -> u32 {
    let mut ended = Vec::new();
    expect_traced(problem, paths, &mut |_| true, &mut |now| ended.push(now));
    let success = ended.last().copied().unwrap_or(0.0);
    let out = ended.iter().position(|&ended| ended >= success - RUN_OUT);
    out.map_or(problem.steps_left, |step| step as u32 + 1)
}

/// `trace` receives the probability that the episode has ended, after each step.
fn expect_traced(
    problem: &Problem<'_>,
    paths: &Paths,
    go_on: &mut dyn FnMut(usize) -> bool,
    trace: &mut dyn FnMut(f64),
) -> Option<Expectation> {
    let sites = problem.odds.sites();
    let mut missed = vec![1.0; sites.len()];
    let mut factor = vec![1.0; sites.len()];
    let mut confirmed = all_confirmed(&problem.draws, &missed);
    let mut meets = false;
    let mut ended = 0.0;
    let mut expected = Expectation::default();
    for step in 1..=problem.steps_left {
        if 1.0 - ended < NEGLIGIBLE {
            break;
        }
        let detections = if step as usize <= paths.steps() {
            paths.uav_count() * sites.len()
        } else {
            0
        };
        if !go_on(detections + problem.products()) {
            return None;
        }
        expected.steps += 1.0 - ended;
        expected.confirmed_steps += 1.0 - confirmed;
        if step as usize <= paths.steps() {
            for (factor, &site) in factor.iter_mut().zip(sites) {
                *factor = below_quorum(problem, paths, step as usize, site);
            }
            meets = are_one(problem, paths, step as usize);
        }
        for (missed, factor) in missed.iter_mut().zip(&factor) {
            *missed *= factor;
        }
        confirmed = all_confirmed(&problem.draws, &missed);
        if meets {
            ended = confirmed;
        }
        trace(ended);
    }
    expected.success = ended;
    Some(expected)
}

/// Returns the first step of a plan by which all hotspots are confirmed with some probability; the
/// last step if there is none.
pub(crate) fn confirmed_by(problem: &Problem<'_>, paths: &Paths, probability: f64) -> usize {
    let sites = problem.odds.sites();
    let mut missed = vec![1.0; sites.len()];
    for step in 0..paths.steps() {
        if all_confirmed(&problem.draws, &missed) >= probability {
            return step;
        }
        for (missed, &site) in missed.iter_mut().zip(sites) {
            *missed *= below_quorum(problem, paths, step + 1, site);
        }
    }
    paths.steps()
}

/// Returns whether the fleet is one radio component in every step of the plan.
pub(crate) fn stay_one(problem: &Problem<'_>, paths: &Paths) -> bool {
    (1..=paths.steps()).all(|step| are_one(problem, paths, step))
}

/// Returns whether the fleet is one radio component in a step of the plan.
fn are_one(problem: &Problem<'_>, paths: &Paths, step: usize) -> bool {
    let cells: Vec<Cell> = (0..paths.uav_count())
        .map(|uav| problem.odds.cell(paths.cell(uav, step)))
        .collect();
    connected(&problem.odds, &cells, |uav| paths.level(uav, step))
}

/// Returns the chance that fewer than θ UAVs detect a hotspot in a cell in a step.
fn below_quorum(problem: &Problem<'_>, paths: &Paths, step: usize, hotspot: Cell) -> f64 {
    let odds = &problem.odds;
    let chances = (0..paths.uav_count()).map(|uav| {
        let cell = odds.cell(paths.cell(uav, step));
        odds.detection(paths.level(uav, step), cell, hotspot)
    });
    fewer_than(problem.model.config().quorum as usize, chances)
}

/// Returns the chance that fewer than a number of independent events happen.
pub(crate) fn fewer_than(count: usize, chances: impl Iterator<Item = f64>) -> f64 {
    let mut exactly = vec![0.0; count];
    exactly[0] = 1.0;
    for p in chances {
        one_more(&mut exactly, p);
    }
    exactly.iter().sum()
}

/// Returns the hazard -ln(1 - q) of an observation. Its sum over the steps gives the chance of
/// a miss.
///
/// q is the chance that a quorum of some UAVs detects a hotspot, each with probability p.
pub(crate) fn hazard(quorum: usize, uavs: usize, p: f64) -> f64 {
    -libm::log(fewer_than(quorum, core::iter::repeat_n(p, uavs)).max(1e-12))
}

/// Returns F: the probability that every hotspot is confirmed.
fn all_confirmed(draws: &[Hidden], missed: &[f64]) -> f64 {
    draws
        .iter()
        .map(|draw| {
            let missed = &missed[draw.sites.clone()][..draw.cells];
            let terms = draw.weights.iter().zip(missed);
            match draw.placement {
                Placement::Distinct => over_distinct_cells(missed, draw.count as usize),
                Placement::Drawn => {
                    let found = terms.map(|(weight, missed)| weight * (1.0 - missed));
                    power(found.sum(), draw.count)
                }
                Placement::EachCell => terms
                    .map(|(weight, missed)| 1.0 - weight * missed)
                    .product(),
            }
        })
        .product()
}

/// Returns the mean, over all sets of `count` cells, of the product of 1 - m_c.
///
/// Cell j is in the share k/j of the sets of k among the first j cells. The mean over these sets
/// follows from the means over sets among the first j - 1.
fn over_distinct_cells(missed: &[f64], count: usize) -> f64 {
    let mut mean = vec![0.0; count + 1];
    mean[0] = 1.0;
    for (index, missed) in missed.iter().enumerate() {
        let cells = (index + 1) as f64;
        for k in (1..=count.min(index + 1)).rev() {
            let share = k as f64 / cells;
            mean[k] = mean[k] * (1.0 - share) + mean[k - 1] * (1.0 - missed) * share;
        }
    }
    mean[count]
}

#[cfg(test)]
mod tests {
    use super::over_distinct_cells;

    #[test]
    fn distinct_cells_equal_the_mean_over_all_sets() {
        let missed = [0.9, 0.1, 0.5, 0.3, 0.7, 0.0];
        for count in 1usize..=6 {
            let (mut sum, mut sets) = (0.0, 0.0);
            for set in 0u32..1 << 6 {
                if set.count_ones() as usize == count {
                    let cells = (0..6).filter(|cell| set >> cell & 1 == 1);
                    sum += cells.map(|cell| 1.0 - missed[cell]).product::<f64>();
                    sets += 1.0;
                }
            }
            let got = over_distinct_cells(&missed, count);
            assert!((got - sum / sets).abs() < 1e-12, "{count}: {got}");
        }
    }
}
