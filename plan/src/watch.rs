//! The caller's wish to end early, asked after about equal shares of work.

use core::ops::ControlFlow;

use crate::anneal::Progress;

/// The work between two questions, in products of the inner loops: some tenths of a second.
const SHARE: u64 = 1 << 27;

/// A progress callback that is asked from time to time, and whether it has ended the planning.
pub(crate) struct Watch<'w> {
    progress: &'w mut dyn FnMut(Progress) -> ControlFlow<()>,
    now: Progress,
    work: u64,
    stopped: bool,
}

impl<'w> Watch<'w> {
    pub(crate) fn new(progress: &'w mut dyn FnMut(Progress) -> ControlFlow<()>) -> Self {
        Self {
            progress,
            now: Progress {
                iterations: 0,
                best_steps: f64::INFINITY,
            },
            work: 0,
            stopped: false,
        }
    }

    /// The number of moves tried so far.
    pub(crate) fn iterations(&self) -> u64 {
        self.now.iterations
    }

    pub(crate) fn stopped(&self) -> bool {
        self.stopped
    }

    /// Notes the expected steps of the best plan so far.
    pub(crate) fn found(&mut self, best_steps: f64) {
        self.now.best_steps = best_steps;
    }

    /// Notes moves of the annealing, and asks.
    pub(crate) fn moved(&mut self, moves: u64) {
        self.now.iterations += moves;
        self.ask();
    }

    /// Notes work, and asks if a share of it is done. Returns whether the planning has ended.
    pub(crate) fn work(&mut self, products: usize) -> bool {
        self.work = self.work.saturating_add(products as u64);
        if self.work >= SHARE {
            self.ask();
        }
        self.stopped
    }

    fn ask(&mut self) {
        self.work = 0;
        self.stopped = self.stopped || (self.progress)(self.now).is_break();
    }
}
