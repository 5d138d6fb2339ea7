//! How the learning rate falls over a run.

use serde::{Deserialize, Serialize};

/// Shape of the fall.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Schedule {
    /// Stays at its start.
    Constant,
    /// Falls evenly to zero.
    Linear,
}

impl Schedule {
    /// Factor on the initial rate when `progress` in [0, 1] of the run is done.
    pub fn factor(self, progress: f64) -> f64 {
        let progress = progress.clamp(0.0, 1.0);
        match self {
            Schedule::Constant => 1.0,
            Schedule::Linear => 1.0 - progress,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_schedule_starts_at_one_and_the_falling_ones_end_at_zero() {
        for schedule in [Schedule::Constant, Schedule::Linear] {
            assert_eq!(schedule.factor(0.0), 1.0);
        }
        assert_eq!(Schedule::Constant.factor(1.0), 1.0);
        assert_eq!(Schedule::Linear.factor(0.25), 0.75);
        assert_eq!(Schedule::Linear.factor(2.0), 0.0);
    }
}
