//! The components of a reward, and their weights.
//!
//! The sum of the components, left to right, is R_t for the team and R_i for one UAV. The mean of
//! R_i over the fleet is R_t.

use crate::config::{Config, InformPayment};
use crate::words::units::MICROJOULES_PER_KWH;

/// Number of components of a reward.
pub const COMPONENTS: usize = 12;

/// Components of a reward: the ten terms of the paper's reward and the two shaping terms.
pub type Rewards = [f64; COMPONENTS];

/// Names of the components, in order.
pub const NAMES: [&str; COMPONENTS] = [
    "detect",
    "inform",
    "complete",
    "coverage",
    "energy",
    "carbon",
    "revisit",
    "truncation",
    "throughput",
    "spread",
    "shaping_goal",
    "shaping_charge",
];

/// Number of components that are a UAV's own; the others are the team's.
pub const OWN_COMPONENTS: usize = 7;

/// Indices of the components that are a UAV's own: coverage, energy, carbon, revisit, throughput
/// and both shaping terms.
pub const OWN: [usize; OWN_COMPONENTS] = [3, 4, 5, 6, 8, 10, 11];

/// Number of components of the team's last reward that a state stores.
///
/// Under Kani only one component is stored, to keep the state small; no call reads these words.
pub(crate) const KEPT: usize = if cfg!(kani) { 1 } else { COMPONENTS };

/// Number of own components that a state stores for each UAV; under Kani one, as for [`KEPT`].
pub(crate) const OWN_KEPT: usize = if cfg!(kani) { 1 } else { OWN_COMPONENTS };

/// Weights of the reward, each for the unit in which its quantity is counted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RewardConstants {
    pub(crate) detect: f64,
    pub(crate) false_confirmation: f64,
    pub(crate) inform: f64,
    pub(crate) inform_once: bool,
    pub(crate) complete: f64,
    pub(crate) coverage_per_cell: f64,
    pub(crate) energy_per_uj: f64,
    pub(crate) carbon_per_ng: f64,
    pub(crate) revisit: f64,
    pub(crate) truncation: f64,
    pub(crate) throughput: f64,
    pub(crate) spread: f64,
    pub(crate) discount: f64,
}

impl RewardConstants {
    /// Converts each weight to the unit in which its quantity is counted.
    #[must_use]
    pub fn new(config: &Config) -> Self {
        Self {
            detect: config.reward_detect,
            false_confirmation: config.reward_false_confirmation,
            inform: config.reward_inform,
            inform_once: config.inform_payment == InformPayment::Once,
            complete: config.reward_complete,
            coverage_per_cell: config.reward_coverage / config.cell_count() as f64,
            energy_per_uj: config.penalty_energy_per_kwh / MICROJOULES_PER_KWH,
            carbon_per_ng: config.penalty_carbon_per_kg / 1e12,
            revisit: config.penalty_revisit,
            truncation: config.penalty_truncation,
            throughput: config.reward_throughput,
            spread: config.reward_spread,
            discount: config.shaping_discount,
        }
    }

    // The own terms, which apply to the fleet's totals as well as to one UAV's.

    #[inline(always)]
    pub(crate) fn coverage(&self, new_cells: f64) -> f64 {
        self.coverage_per_cell * new_cells
    }

    #[inline(always)]
    pub(crate) fn energy(&self, spent_uj: f64) -> f64 {
        -(self.energy_per_uj * spent_uj)
    }

    #[inline(always)]
    pub(crate) fn carbon(&self, co2_ng: f64) -> f64 {
        -(self.carbon_per_ng * co2_ng)
    }

    #[inline(always)]
    pub(crate) fn revisit(&self, revisits: f64) -> f64 {
        -(self.revisit * revisits)
    }

    #[inline(always)]
    pub(crate) fn throughput(&self, mean: f64) -> f64 {
        self.throughput * mean
    }

    #[inline(always)]
    pub(crate) fn shaping(&self, before: f64, after: f64) -> f64 {
        self.discount * after - before
    }
}

/// The reward R_t or R_i: the sum of the components, left to right.
#[inline(always)]
#[must_use]
pub fn total(rewards: &Rewards) -> f64 {
    let mut sum = 0.0;
    for component in rewards {
        sum += component;
    }
    sum
}
