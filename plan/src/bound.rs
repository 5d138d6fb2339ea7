//! A lower bound: a time that no fixed plan can beat.
//!
//! Two things hold a fleet back.
//!
//! *Reach*: after s steps no UAV is more than s cells from its start. A step confirms a hotspot at
//! most as often as if every UAV were in the best cell of its reach.
//!
//! *Coverage*: let h(p) be the lesser of p/θ and -κ ln(1 - p). The chance Q of at least θ positives
//! is at most Σ h(p_i) over the UAVs. A step therefore confirms at most the sum, over the UAVs, of
//! the largest Σ_c w_c h(p_c) over the cells of the reach.
//!
//! Proof of Q ≤ Σ h(p_i). Let A be the UAVs with h(p) = p/θ. A Bernoulli variable is stochastically
//! at most a Poisson variable of mean -ln(1 - p). The positives of the others are thus at most a
//! Poisson variable, whose mean Λ is the sum of theirs. Given a positives in A, the quorum is
//! reached with probability at most φ_(θ-a)(Λ), where φ_k is the chance of at least k. The slope κ
//! is the least number with φ_(θ-a)(Λ) ≤ a/θ + κ Λ for all a < θ and all Λ. The mean over a is the
//! claim.
//!
//! Both bound the share of hotspots confirmed after t steps, hence F(t), the chance that all are.
//! The mean over sets of distinct cells is at most the power of the mean (Maclaurin). A product of
//! means is at most the power of their mean. A cell that holds a hotspot with a probability of its
//! own counts as a hotspot. Where it holds none, that one is confirmed at once. The expected time
//! is the sum of 1 - F(t).

use alloc::vec;
use alloc::vec::Vec;

use jcas_core::Cell;
use jcas_policy::geometry::one_more;

use crate::odds::Odds;
use crate::problem::{Problem, power};
use crate::targets::Placement;

/// The quorum above which h(p) = p/θ.
const QUORUM_MAX: usize = 32;
/// The grid over Λ on which κ is worked out; between two points the next one bounds φ.
const INTENSITY_STEP: f64 = 0.002;
/// The remaining probability below which no further step is evaluated.
const NEGLIGIBLE: f64 = 1e-9;

/// Returns a lower bound on the expected steps of every fixed plan of the problem, from its
/// beginning.
#[must_use]
pub fn bound(problem: &Problem<'_>) -> f64 {
    bound_while(problem, &mut |_| true)
}

/// Returns a lower bound as [`bound`] does. `go_on` receives the products of each step, and may end
/// the computation, which gives a lower bound too.
pub(crate) fn bound_while(problem: &Problem<'_>, go_on: &mut dyn FnMut(usize) -> bool) -> f64 {
    let odds = &problem.odds;
    let config = problem.model.config();
    let farthest = (config.grid_width + config.grid_height) as usize;
    let starts = &problem.situation.cells;
    let sites = odds.sites();
    let priors = priors(problem);
    let spread = covered(problem, &priors, farthest);

    // Best chance of detection of each site, by distance from each start.
    let nearest: Vec<(Vec<usize>, Vec<f64>)> = distinct(starts)
        .into_iter()
        .map(|start| {
            let members = (0..starts.len()).filter(|&uav| starts[uav] == start);
            (members.collect(), best_within(problem, start, farthest))
        })
        .collect();
    let mut missed = vec![1.0; sites.len()];
    let mut coverage = vec![0.0; priors.len()];
    let quorum = config.quorum as usize;
    let mut exactly = vec![0.0; quorum];
    let (mut expected, mut done) = (0.0, 0.0);
    let products = sites.len() * (starts.len() + priors.len());
    for step in 1..=problem.steps_left {
        if !go_on(products) {
            break;
        }
        expected += 1.0 - done;
        let reach = (step as usize).min(farthest);
        for (site, missed) in missed.iter_mut().enumerate() {
            exactly.fill(0.0);
            exactly[0] = 1.0;
            for (members, best) in &nearest {
                let p = best[reach * sites.len() + site];
                for _ in members {
                    one_more(&mut exactly, p);
                }
            }
            *missed *= exactly.iter().sum::<f64>();
        }
        let mut product = 1.0;
        let mut joint = 1.0;
        for (index, (prior, coverage)) in priors.iter().zip(&mut coverage).enumerate() {
            *coverage += spread[index][reach];
            let mut reached = 0.0;
            for (weight, missed) in prior.weights.iter().zip(&missed) {
                reached += weight * (1.0 - missed);
            }
            let found = prior.empty + reached.min(*coverage);
            let chance = power(found.min(1.0), prior.count);
            if index + 1 < priors.len() {
                product *= chance;
            } else {
                joint = chance;
            }
        }
        done = f64::min(product, joint);
        if 1.0 - done < NEGLIGIBLE {
            break;
        }
    }
    expected
}

/// Weights over the sites and a number of hotspots.
struct Prior {
    count: u32,
    weights: Vec<f64>,
    /// What the weights leave of 1.
    empty: f64,
}

/// The groups, and last all groups as one, with the mean of their weights.
fn priors(problem: &Problem<'_>) -> Vec<Prior> {
    let sites = problem.odds.sites().len();
    let mut priors: Vec<Prior> = problem
        .draws
        .iter()
        .map(|draw| {
            let mut weights = vec![0.0; sites];
            weights[draw.sites.clone()].copy_from_slice(&draw.weights);
            let mut empty = 0.0;
            if draw.placement == Placement::EachCell {
                for weight in &mut weights {
                    *weight /= f64::from(draw.count);
                }
                empty = 1.0 - weights.iter().sum::<f64>();
            }
            Prior {
                count: draw.count,
                weights,
                empty,
            }
        })
        .collect();
    let count: u32 = priors.iter().map(|prior| prior.count).sum();
    let mut joint = Prior {
        count,
        weights: vec![0.0; sites],
        empty: 0.0,
    };
    for prior in &priors {
        let share = f64::from(prior.count) / f64::from(count);
        for (mean, weight) in joint.weights.iter_mut().zip(&prior.weights) {
            *mean += weight * share;
        }
        joint.empty += prior.empty * share;
    }
    priors.push(joint);
    priors
}

fn distinct(cells: &[Cell]) -> Vec<Cell> {
    let mut found: Vec<Cell> = Vec::new();
    for &cell in cells {
        if !found.contains(&cell) {
            found.push(cell);
        }
    }
    found
}

/// Returns the best chance of a detection at any pilot density.
fn best_detection(odds: &Odds, uav: Cell, hotspot: Cell) -> f64 {
    let levels = 0..=odds.highest();
    levels.fold(0.0, |best, level| {
        f64::max(best, odds.detection(level, uav, hotspot))
    })
}

fn cells(problem: &Problem<'_>) -> impl Iterator<Item = Cell> {
    let config = problem.model.config();
    let width = config.grid_width;
    (0..config.grid_height).flat_map(move |y| (0..width).map(move |x| Cell { x, y }))
}

/// Returns, for each distance and site, the best chance of a detection from a cell within the
/// distance of a start.
fn best_within(problem: &Problem<'_>, start: Cell, farthest: usize) -> Vec<f64> {
    let sites = problem.odds.sites();
    let mut best = vec![0.0; (farthest + 1) * sites.len()];
    for cell in cells(problem) {
        let row = start.manhattan(cell) as usize * sites.len();
        for (best, &site) in best[row..row + sites.len()].iter_mut().zip(sites) {
            *best = f64::max(*best, best_detection(&problem.odds, cell, site));
        }
    }
    let count = sites.len();
    for slot in count..best.len() {
        best[slot] = f64::max(best[slot], best[slot - count]);
    }
    best
}

/// Returns, for each prior and distance, the sum over the UAVs of the largest Σ_c w_c h(p_c). It is
/// taken over the cells within the distance of their start.
fn covered(problem: &Problem<'_>, priors: &[Prior], farthest: usize) -> Vec<Vec<f64>> {
    let quorum = problem.model.config().quorum as usize;
    let slope = slope(quorum);
    let share = |p: f64| {
        let markov = p / quorum as f64;
        if p < 1.0 {
            f64::min(markov, -slope * libm::log(1.0 - p))
        } else {
            markov
        }
    };
    let sites = problem.odds.sites();
    let mut sums = vec![Vec::new(); priors.len()];
    for cell in cells(problem) {
        let shares: Vec<f64> = sites
            .iter()
            .map(|&site| share(best_detection(&problem.odds, cell, site)))
            .collect();
        for (prior, sums) in priors.iter().zip(&mut sums) {
            let terms = prior.weights.iter().zip(&shares);
            sums.push(terms.map(|(weight, share)| weight * share).sum::<f64>());
        }
    }
    sums.iter()
        .map(|sums| {
            let mut covered = vec![0.0; farthest + 1];
            for &start in &problem.situation.cells {
                let mut best = vec![0.0; farthest + 1];
                for (cell, &sum) in cells(problem).zip(sums) {
                    let distance = start.manhattan(cell) as usize;
                    best[distance] = f64::max(best[distance], sum);
                }
                let mut most = 0.0;
                for (covered, best) in covered.iter_mut().zip(best) {
                    most = f64::max(most, best);
                    *covered += most;
                }
            }
            covered
        })
        .collect()
}

/// Returns κ: the least number with φ_(θ-a)(Λ) ≤ a/θ + κ Λ for all a < θ and all Λ. It is infinite
/// if only h(p) = p/θ applies.
fn slope(quorum: usize) -> f64 {
    if !(2..=QUORUM_MAX).contains(&quorum) {
        return f64::INFINITY;
    }
    // From Λ = 4 θ on, 1/Λ is below what Λ = θ gives.
    let points = (4.0 * quorum as f64 / INTENSITY_STEP) as usize;
    let mut slope = 0.0;
    for missing in 1..=quorum {
        let positives = (quorum - missing) as f64 / quorum as f64;
        for point in 1..points {
            let next = at_least(missing, (point + 1) as f64 * INTENSITY_STEP);
            let needed = (next - positives) / (point as f64 * INTENSITY_STEP);
            slope = f64::max(slope, needed);
        }
    }
    slope
}

/// Returns φ_k(Λ): the chance that a Poisson variable of mean Λ is at least k.
fn at_least(count: usize, mean: f64) -> f64 {
    let mut exactly = libm::exp(-mean);
    let mut below = 0.0;
    for k in 0..count {
        below += exactly;
        exactly *= mean / (k + 1) as f64;
    }
    1.0 - below
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Random mixtures of chances, near 0 and near 1 alike.
    #[test]
    fn no_fleet_confirms_more_than_its_shares() {
        let mut draws = crate::draws::Draws::new(1);
        for quorum in [2usize, 3, 5] {
            let slope = slope(quorum);
            for _ in 0..20_000 {
                let uavs = 1 + draws.below(12);
                let mut exactly = vec![0.0; quorum];
                exactly[0] = 1.0;
                let mut shares = 0.0;
                for _ in 0..uavs {
                    let p = match draws.below(3) {
                        0 => draws.unit() * 0.3,
                        1 => 1.0 - draws.unit() * 0.01,
                        _ => draws.unit() * 0.999,
                    };
                    shares += f64::min(p / quorum as f64, -slope * libm::log(1.0 - p));
                    for k in (1..quorum).rev() {
                        exactly[k] = exactly[k] * (1.0 - p) + exactly[k - 1] * p;
                    }
                    exactly[0] *= 1.0 - p;
                }
                let confirmed = 1.0 - exactly.iter().sum::<f64>();
                assert!(confirmed <= shares + 1e-12, "{confirmed} {shares}");
            }
        }
    }

    #[test]
    fn the_slope_is_that_of_the_tangent() {
        let tangent = (1..4000).fold(0.0, |most, point| {
            let mean = f64::from(point) * 0.005;
            f64::max(most, at_least(3, mean) / mean)
        });
        assert!((slope(3) - tangent).abs() < 1e-3, "{} {tangent}", slope(3));
    }
}
