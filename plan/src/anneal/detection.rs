//! The chances that hotspots are missed, with all UAVs but one fixed.

use super::Annealer;
use crate::odds::LANES;
use crate::problem::{Hidden, Problem, power};
use crate::targets::Placement;

impl Annealer<'_, '_> {
    /// Computes B and D of a step.
    pub(super) fn fix_others(&mut self, step: usize) {
        let (odds, stride) = (&self.problem.odds, self.problem.odds.stride());
        let quorum = self.exactly.len();
        let span = step * stride..(step + 1) * stride;
        let below = lanes_mut(&mut self.below[span.clone()]);
        let edge = lanes_mut(&mut self.edge[span]);
        for (chunk, (below, edge)) in below.iter_mut().zip(edge).enumerate() {
            self.exactly.fill([0.0; LANES]);
            self.exactly[0] = [1.0; LANES];
            for uav in 0..self.paths.uav_count() {
                if uav == self.uav {
                    continue;
                }
                let (level, cell) = (self.paths.level(uav, step), self.paths.cell(uav, step));
                let odds = &lanes(odds.row(level, cell, &mut self.scratch))[chunk];
                for k in (1..quorum).rev() {
                    let (fewer, exactly) = self.exactly.split_at_mut(k);
                    for lane in 0..LANES {
                        exactly[0][lane] =
                            exactly[0][lane] * (1.0 - odds[lane]) + fewer[k - 1][lane] * odds[lane];
                    }
                }
                for lane in 0..LANES {
                    self.exactly[0][lane] *= 1.0 - odds[lane];
                }
            }
            *below = [0.0; LANES];
            for exactly in &self.exactly {
                for lane in 0..LANES {
                    below[lane] += exactly[lane];
                }
            }
            *edge = self.exactly[quorum - 1];
        }
    }

    /// Computes the chances of a miss in a step and so far, and F, from B and D.
    pub(super) fn sense(&mut self, step: usize) {
        let stride = self.problem.odds.stride();
        let (level, cell) = (
            self.paths.level(self.uav, step),
            self.paths.cell(self.uav, step),
        );
        let odds = self.problem.odds.row(level, cell, &mut self.scratch);
        let at = step * stride;
        let (below, edge) = (&self.below[at..at + stride], &self.edge[at..at + stride]);
        factors(below, edge, odds, &mut self.missed[at..at + stride]);
        self.accumulate(step);
    }

    /// Computes the chances of a miss in all steps so far, and F, from those in a step.
    pub(super) fn accumulate(&mut self, step: usize) {
        let stride = self.problem.odds.stride();
        let at = step * stride;
        let (before, now) = self.left[at - stride..at + stride].split_at_mut(stride);
        now.copy_from_slice(before);
        self.confirmed[step] = miss(self.problem, now, &self.missed[at..at + stride]);
    }
}

/// Computes F from the weighted chance that each site has been missed so far.
pub(super) fn found(problem: &Problem<'_>, left: &[f64]) -> f64 {
    let mut product = 1.0;
    for draw in &problem.draws {
        product *= all_found(draw, lanes(&left[draw.sites.clone()]));
    }
    product
}

/// Multiplies the chance of a miss of each site by one more factor, and returns F after that.
pub(super) fn miss(problem: &Problem<'_>, left: &mut [f64], factors: &[f64]) -> f64 {
    let mut product = 1.0;
    for draw in &problem.draws {
        let left = lanes_mut(&mut left[draw.sites.clone()]);
        for (left, factors) in left.iter_mut().zip(lanes(&factors[draw.sites.clone()])) {
            for lane in 0..LANES {
                left[lane] *= factors[lane];
            }
        }
        product *= all_found(draw, left);
    }
    product
}

/// Returns the chance that all hotspots of a group are confirmed.
fn all_found(draw: &Hidden, left: &[[f64; LANES]]) -> f64 {
    if draw.placement == Placement::EachCell {
        let mut products = [1.0; LANES];
        for left in left {
            for lane in 0..LANES {
                products[lane] *= 1.0 - left[lane];
            }
        }
        return products.iter().product();
    }
    let mut sums = [0.0; LANES];
    for left in left {
        for lane in 0..LANES {
            sums[lane] += left[lane];
        }
    }
    power(complement(&sums), draw.count)
}

/// Computes B - p D for each site.
pub(super) fn factors(below: &[f64], edge: &[f64], odds: &[f64], factors: &mut [f64]) {
    let others = lanes(below).iter().zip(lanes(edge));
    let chunks = lanes_mut(factors).iter_mut().zip(lanes(odds));
    for ((factors, odds), (below, edge)) in chunks.zip(others) {
        for lane in 0..LANES {
            factors[lane] = below[lane] - odds[lane] * edge[lane];
        }
    }
}

fn lanes(row: &[f64]) -> &[[f64; LANES]] {
    row.as_chunks().0
}

fn lanes_mut(row: &mut [f64]) -> &mut [[f64; LANES]] {
    row.as_chunks_mut().0
}

/// Returns what the lanes leave of 1.
fn complement(sums: &[f64; LANES]) -> f64 {
    let [a, b, c, d, e, f, g, h] = sums;
    let found = 1.0 - (((a + e) + (b + f)) + ((c + g) + (d + h)));
    if found > 0.0 { found } else { 0.0 }
}
