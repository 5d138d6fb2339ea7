//! The team reward R_t and the reward R_i of each UAV, term by term.

use super::{Specification, World, fraction, potential::Potentials};
use jcas_core::InformPayment;

const KWH_PER_MICROJOULE: f64 = 1.0 / 3.6e12;
const KG_PER_NANOGRAM: f64 = 1e-12;

/// The twelve terms, in the order in which they are added.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[allow(missing_docs)]
pub struct Rewards {
    pub detect: f64,
    pub inform: f64,
    pub complete: f64,
    pub coverage: f64,
    pub energy: f64,
    pub carbon: f64,
    pub revisit: f64,
    pub truncation: f64,
    pub throughput: f64,
    pub spread: f64,
    pub shaping_goal: f64,
    pub shaping_charge: f64,
}

impl Rewards {
    /// Returns the terms in the order of the reward.
    pub fn terms(&self) -> [f64; 12] {
        [
            self.detect,
            self.inform,
            self.complete,
            self.coverage,
            self.energy,
            self.carbon,
            self.revisit,
            self.truncation,
            self.throughput,
            self.spread,
            self.shaping_goal,
            self.shaping_charge,
        ]
    }

    /// Returns the team reward R_t, the sum of the terms.
    pub fn sum(&self) -> f64 {
        self.terms().iter().sum()
    }
}

/// Quantities of a step that the world after the step does not hold.
#[derive(Clone, Debug, Default)]
pub struct StepFacts {
    /// Whether each UAV was the first ever in its cell. Of several UAVs in one step, the one with
    /// the lowest index counts.
    pub first_visits: Vec<bool>,
    /// Whether each UAV moved into a cell visited before this step.
    pub revisits: Vec<bool>,
    /// Energy spent by each UAV, in microjoules.
    pub spent_uj: Vec<u64>,
    /// Charging billed for each UAV, in microjoules.
    pub billed_uj: Vec<u64>,
    /// Carbon billed to the fleet, in nanograms.
    pub carbon_ng: u64,
}

impl Specification {
    pub(super) fn reward(
        &self,
        world: &World,
        facts: &StepFacts,
        before: Potentials,
        after: Potentials,
    ) -> Rewards {
        let c = &self.config;
        let now = Some(world.t);
        let detected = world.confirmed_at.iter().filter(|&&at| at == now).count();
        let informed = match c.inform_payment {
            InformPayment::Once => world.informed_at.iter().filter(|&&at| at == now).count(),
            InformPayment::EveryStep => world.informed_at.iter().flatten().count(),
        };
        let cells = (self.width() * self.height()) as f64;
        let first_visits = facts.first_visits.iter().filter(|&&first| first).count();
        let revisits = facts.revisits.iter().filter(|&&again| again).count();
        let spent_uj: u64 = facts.spent_uj.iter().sum();
        let at_horizon = world.t == c.horizon_steps;
        let gamma = c.shaping_discount;
        Rewards {
            detect: c.reward_detect * detected as f64
                + c.reward_false_confirmation * f64::from(world.newly_false),
            inform: c.reward_inform * informed as f64,
            complete: if world.terminated {
                c.reward_complete
            } else {
                0.0
            },
            coverage: c.reward_coverage * first_visits as f64 / cells,
            energy: -c.penalty_energy_per_kwh * spent_uj as f64 * KWH_PER_MICROJOULE,
            carbon: -c.penalty_carbon_per_kg * facts.carbon_ng as f64 * KG_PER_NANOGRAM,
            revisit: -c.penalty_revisit * revisits as f64,
            truncation: if at_horizon {
                -c.penalty_truncation
            } else {
                0.0
            },
            throughput: c.reward_throughput * world.mean_throughput,
            spread: c.reward_spread * self.knowledge_spread(world),
            shaping_goal: gamma * after.goal - before.goal,
            shaping_charge: gamma * after.charge - before.charge,
        }
    }

    /// Returns the terms of R_i. A term that the team's reward sums over UAVs is the UAV's part
    /// times N. A term that is a mean over UAVs is the UAV's own value. The others are the team's.
    pub(super) fn uav_reward(
        &self,
        world: &World,
        facts: &StepFacts,
        i: usize,
        before: Potentials,
        after: Potentials,
    ) -> Rewards {
        let c = &self.config;
        let uavs = self.uavs() as f64;
        let cells = (self.width() * self.height()) as f64;
        let billed: u64 = facts.billed_uj.iter().sum();
        let carbon_share = fraction(facts.billed_uj[i] as f64, billed as f64);
        let own_kwh = facts.spent_uj[i] as f64 * KWH_PER_MICROJOULE;
        let own_kg = facts.carbon_ng as f64 * KG_PER_NANOGRAM * carbon_share;
        let one_if = |happened: bool| if happened { 1.0 } else { 0.0 };
        let gamma = c.shaping_discount;
        Rewards {
            coverage: uavs * c.reward_coverage * one_if(facts.first_visits[i]) / cells,
            energy: -uavs * c.penalty_energy_per_kwh * own_kwh,
            carbon: -uavs * c.penalty_carbon_per_kg * own_kg,
            revisit: -uavs * c.penalty_revisit * one_if(facts.revisits[i]),
            throughput: c.reward_throughput * world.throughput[i],
            shaping_goal: gamma * after.goal - before.goal,
            shaping_charge: gamma * after.charge - before.charge,
            ..world.rewards
        }
    }

    /// Returns the mean over the confirmed hotspots of the fraction of UAVs that know each.
    fn knowledge_spread(&self, world: &World) -> f64 {
        let mut sum = 0.0;
        let mut confirmed = 0;
        for j in 0..self.hotspots() {
            if world.confirmed_at[j].is_some() {
                confirmed += 1;
                sum += self.knowing_share(world, j);
            }
        }
        if confirmed == 0 {
            0.0
        } else {
            sum / f64::from(confirmed)
        }
    }

    /// Returns the fraction of the UAVs that know hotspot j.
    pub(super) fn knowing_share(&self, world: &World, j: usize) -> f64 {
        let knowing = world.knows.iter().filter(|row| row[j]).count();
        knowing as f64 / self.uavs() as f64
    }
}
