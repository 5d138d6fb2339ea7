//! The expected time of the present trajectories and of a proposal.

use super::Annealer;
use super::detection::{factors, miss};

/// Steps that an episode is assumed to last beyond the evaluated ones.
const REST: f64 = 12.0;
/// The chance of the last confirmation in a step below which the step adds nothing to the
/// gathering.
const RARE: f64 = 1e-5;
/// The marker of a G that has not been computed.
pub(super) const UNKNOWN: u32 = u32::MAX - 1;

impl Annealer<'_, '_> {
    /// Computes the expected steps so far from a step on, and the value.
    pub(super) fn account(&mut self, first: usize) {
        for step in first..=self.window {
            let cost = self.cost(step, self.done[step - 1], self.done[step]);
            self.spent[step] = self.spent[step - 1] + cost;
        }
        self.value = self.spent[self.window] + self.rest(self.done[self.window]);
    }

    /// Returns what a step adds to the expected time. That is the step itself, and the gathering of
    /// the episodes with their last confirmation in it.
    fn cost(&mut self, step: usize, before: f64, after: f64) -> f64 {
        let chance = after - before;
        let mut cost = 1.0 - before;
        if chance > RARE {
            if self.gather[step] == UNKNOWN {
                let (cell, level) = (
                    self.paths.cell(self.uav, step),
                    self.paths.level(self.uav, step),
                );
                self.gather[step] = self.gathering(step, cell, level);
            }
            cost += chance * self.wait(step, self.gather[step]);
        }
        cost
    }

    /// Steps of gathering that count.
    fn wait(&self, step: usize, gather: u32) -> f64 {
        f64::from(gather.min(self.problem.steps_left - step as u32))
    }

    /// Returns the remainder after the evaluated steps, as if nothing more were confirmed.
    fn rest(&self, done: f64) -> f64 {
        (1.0 - done) * REST.min(f64::from(self.problem.steps_left) - self.window as f64)
    }

    /// Returns the expected steps with the proposal; `None` if they are more than `most`.
    pub(super) fn judge(&mut self, most: f64) -> Option<f64> {
        let (problem, stride) = (self.problem, self.problem.odds.stride());
        let (first, last) = (self.moved.first, self.moved.last);
        let mut value = self.spent[first - 1];
        let mut row = core::mem::take(&mut self.row);
        row.copy_from_slice(&self.left[(first - 1) * stride..first * stride]);
        let mut before = self.done[first - 1];
        for step in first..=self.window {
            let at = step * stride;
            let done = if step <= last {
                let (level, cell) = (self.moved.levels[step], self.moved.cells[step]);
                let odds = problem.odds.row(level, cell, &mut self.scratch);
                let (below, edge) = (&self.below[at..at + stride], &self.edge[at..at + stride]);
                factors(below, edge, odds, &mut self.factors);
                miss(problem, &mut row, &self.factors)
            } else {
                miss(problem, &mut row, &self.missed[at..at + stride])
            };
            if step <= last {
                // Gathering is the most expensive part. It is computed last, once all else is good
                // enough.
                self.moved.chance[step] = done - before;
                value += 1.0 - before;
            } else {
                value += self.cost(step, before, done);
            }
            before = done;
            if value > most {
                break;
            }
        }
        self.row = row;
        value += self.rest(before);
        for step in first..=last.min(self.window) {
            if value > most {
                return None;
            }
            let chance = self.moved.chance[step];
            self.moved.gather[step] = UNKNOWN;
            if chance > RARE {
                let (level, cell) = (self.moved.levels[step], self.moved.cells[step]);
                let gather = self.gathering(step, cell, level);
                self.moved.gather[step] = gather;
                value += chance * self.wait(step, gather);
            }
        }
        (value <= most).then_some(value)
    }
}
