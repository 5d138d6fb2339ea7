//! The expected time of the present trajectories and of a proposal.

use super::Annealer;
use super::detection::{factors, miss};

/// Steps that an episode is assumed to last beyond the evaluated ones.
const REST: f64 = 12.0;

impl Annealer<'_, '_> {
    /// Computes the chance that the episode has ended by a step, and the expected steps so far.
    pub(super) fn account(&mut self, step: usize) {
        let before = self.ended[step - 1];
        self.spent[step] = self.spent[step - 1] + 1.0 - before;
        self.ended[step] = if self.meets[step] {
            self.confirmed[step]
        } else {
            before
        };
    }

    /// Returns the remainder after the evaluated steps, as if the episode did not end there.
    pub(super) fn rest(&self, ended: f64) -> f64 {
        (1.0 - ended) * REST.min(f64::from(self.problem.steps_left) - self.window as f64)
    }

    /// Returns whether the expected steps with the proposal are at most `most`.
    pub(super) fn judge(&mut self, most: f64) -> bool {
        let (problem, stride) = (self.problem, self.problem.odds.stride());
        let (first, last) = (self.moved.first, self.moved.last);
        let mut value = self.spent[first - 1];
        let mut ended = self.ended[first - 1];
        let mut row = core::mem::take(&mut self.row);
        row.copy_from_slice(&self.left[(first - 1) * stride..first * stride]);
        for step in first..=self.window {
            value += 1.0 - ended;
            if value > most {
                break;
            }
            let at = step * stride;
            let (confirmed, meets) = if step <= last {
                let (level, cell) = (self.moved.levels[step], self.moved.cells[step]);
                let odds = problem.odds.row(level, cell, &mut self.scratch);
                let (below, edge) = (&self.below[at..at + stride], &self.edge[at..at + stride]);
                factors(below, edge, odds, &mut self.factors);
                let meets = self.joins_all(step, cell, level);
                self.moved.meets[step] = meets;
                if problem.together && self.meets[step] && !meets {
                    value = f64::INFINITY;
                    break;
                }
                (miss(problem, &mut row, &self.factors), meets)
            } else {
                let missed = &self.missed[at..at + stride];
                (miss(problem, &mut row, missed), self.meets[step])
            };
            if meets {
                ended = confirmed;
            }
        }
        self.row = row;
        value + self.rest(ended) <= most
    }
}
