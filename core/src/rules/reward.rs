//! The reward of a step: the components of the team, and those of each UAV.

use crate::lanes::{self, Block, Lanes, at_width};
use crate::model::Model;
use crate::state::StateMut;
use crate::state::scratch::UavStepScratch;
use crate::words::word::canonical_bits;

use super::carbon;

pub use crate::constants::reward::{
    COMPONENTS, NAMES, OWN, OWN_COMPONENTS, RewardConstants, Rewards, total,
};
pub use crate::state::scratch::StepTotals;

impl RewardConstants {
    /// Computes the components of R_t, in the order of [`NAMES`].
    #[inline(always)]
    #[must_use]
    pub fn components(&self, step: &StepTotals) -> Rewards {
        let paid = if self.inform_once {
            step.newly_informed
        } else {
            step.informed
        };
        [
            self.detect * step.newly_confirmed as f64
                + self.false_confirmation * step.newly_false as f64,
            self.inform * paid as f64,
            if step.complete { self.complete } else { 0.0 },
            self.coverage(step.new_cells as f64),
            self.energy(step.spent_uj as f64),
            self.carbon(step.co2_ng),
            self.revisit(step.revisits as f64),
            if step.at_horizon {
                -self.truncation
            } else {
                0.0
            },
            self.throughput(step.mean_throughput),
            self.spread * step.knowledge_spread,
            self.shaping(step.goal_potential_before, step.goal_potential_after),
            self.shaping(step.charge_potential_before, step.charge_potential_after),
        ]
    }
}

/// Charging energy billed to the fleet in a step, and the carbon that it emitted.
#[derive(Clone, Copy)]
pub(crate) struct Billed {
    pub(crate) co2_ng: u64,
    pub(crate) billed_uj: u64,
}

/// Computes and stores the own components of each UAV's reward.
#[inline(always)]
pub(crate) fn credit(
    model: &Model<'_>,
    state: &mut StateMut<'_>,
    per_uav: &UavStepScratch<'_>,
    billed: Billed,
) {
    at_width!(model, credit_in_blocks(model, state, per_uav, billed));
}

#[inline(always)]
fn credit_in_blocks<const W: usize>(
    model: &Model<'_>,
    state: &mut StateMut<'_>,
    per_uav: &UavStepScratch<'_>,
    billed: Billed,
) {
    for block in lanes::blocks::<W>(model.uav_count()) {
        let own = own_in(model, state, per_uav, billed, block);
        let rows = state.own_rewards[block.first * crate::constants::reward::OWN_KEPT..]
            .chunks_exact_mut(crate::constants::reward::OWN_KEPT);
        for (lane, row) in block.lanes().zip(rows) {
            for (value, lanes) in row.iter_mut().zip(&own) {
                *value = lanes[lane];
            }
        }
    }
}

/// Computes the components in [`OWN`] of each UAV of a block, as bits of f64.
///
/// A quantity that the team sums over N UAVs counts N times for the UAV. One that the team averages
/// counts once. So the mean over the fleet is the team's component.
#[inline(always)]
fn own_in<const W: usize>(
    model: &Model<'_>,
    state: &StateMut<'_>,
    per_uav: &UavStepScratch<'_>,
    fleet: Billed,
    block: Block<W>,
) -> [Lanes<u64, W>; OWN_COMPONENTS] {
    let (plan, uavs) = (model.reward(), model.uav_count() as u64);
    let (new_cell, revisited) = (block.load(per_uav.new_cells), block.load(per_uav.revisits));
    let (spent_uj, billed_uj) = (block.load(per_uav.spent_uj), block.load(per_uav.billed_uj));
    let mean = block.load(state.throughput);
    let mut rows = [[0; W]; OWN_COMPONENTS];
    let [coverage, energy, carbon, revisit, throughput, goal, charge] = &mut rows;
    // The compiler vectorises these loops one by one, but not a single loop for all components.
    for lane in 0..W {
        let new_cells = f64::from(new_cell[lane] as u32) * uavs as f64;
        coverage[lane] = canonical_bits(plan.coverage(new_cells));
        energy[lane] = canonical_bits(plan.energy((uavs * spent_uj[lane]) as f64));
        let revisits = f64::from(revisited[lane] as u32) * uavs as f64;
        revisit[lane] = canonical_bits(plan.revisit(revisits));
        throughput[lane] = canonical_bits(plan.throughput(f64::from_bits(mean[lane])));
    }
    for lane in 0..W {
        let share_ng = carbon::share_ng(fleet.co2_ng, billed_uj[lane], fleet.billed_uj);
        carbon[lane] = canonical_bits(plan.carbon(uavs as f64 * share_ng));
    }
    *goal = gained(
        plan,
        &block.load(per_uav.goal_before),
        &block.load(state.goal_potential),
    );
    *charge = gained(
        plan,
        &block.load(per_uav.charge_before),
        &block.load(state.charge_potential),
    );
    rows
}

/// Shaping terms from the potentials before and after a step, all as bits of f64.
#[inline(always)]
fn gained<const W: usize>(
    plan: &RewardConstants,
    before: &Lanes<u64, W>,
    after: &Lanes<u64, W>,
) -> Lanes<u64, W> {
    let mut gained = [0; W];
    for lane in 0..W {
        let (before, after) = (f64::from_bits(before[lane]), f64::from_bits(after[lane]));
        gained[lane] = canonical_bits(plan.shaping(before, after));
    }
    gained
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::config::{Config, Preset};

    #[test]
    fn mission_pays_informing_once_and_paper_at_every_step() {
        let step = StepTotals {
            newly_informed: 1,
            informed: 3,
            ..StepTotals::default()
        };
        let inform = |preset| RewardConstants::new(&Config::preset(preset)).components(&step)[1];
        assert_eq!(inform(Preset::Mission), 4.0);
        assert_eq!(inform(Preset::Paper), 12.0);
    }

    #[test]
    fn weights_are_the_papers() {
        let step = StepTotals {
            newly_confirmed: 2,
            complete: true,
            at_horizon: true,
            new_cells: 72,
            revisits: 3,
            spent_uj: 3_600_000_000_000,
            co2_ng: 2_000_000_000_000.0,
            mean_throughput: 2.0,
            knowledge_spread: 0.5,
            goal_potential_before: -1.0,
            goal_potential_after: -0.5,
            ..StepTotals::default()
        };
        let rewards = RewardConstants::new(&Config::default()).components(&step);
        let expected = [
            14.0, 0.0, 10.0, 0.25, -0.2, -0.2, -0.03, -0.4, 1.0, 0.05, 0.525, 0.0,
        ];
        for (index, (got, want)) in rewards.iter().zip(expected).enumerate() {
            assert!(
                (got - want).abs() < 1e-12,
                "{}: {got} is not {want}",
                NAMES[index]
            );
        }
    }

    #[test]
    fn own_components_are_where_own_says() {
        let plan = RewardConstants::new(&Config::default());
        let idle = plan.components(&StepTotals::default());
        let busy = plan.components(&StepTotals {
            new_cells: 1,
            revisits: 1,
            spent_uj: 1,
            co2_ng: 1.0,
            mean_throughput: 1.0,
            goal_potential_before: -1.0,
            charge_potential_before: 0.1,
            ..StepTotals::default()
        });
        for index in 0..COMPONENTS {
            let differs = idle[index] != busy[index];
            assert_eq!(differs, OWN.contains(&index), "{}", NAMES[index]);
        }
    }
}
