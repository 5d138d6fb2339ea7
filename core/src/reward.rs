//! The reward: a fixed vector of named components whose sum, left to right, is R_t for the team, and R_i
//! for one UAV. The mean of R_i over the fleet is R_t.

use crate::config::{Config, InformPayment};
use crate::lanes::{Lanes, WIDTH};
use crate::word::stored;

/// How many components there are.
pub const COMPONENTS: usize = 12;

/// The ten terms of the paper's reward and the two shaping terms.
pub type Rewards = [f64; COMPONENTS];

/// Their names, in order.
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

/// How many components are a UAV's own; the others are the team's.
pub const OWN_COMPONENTS: usize = 7;

/// The components that are a UAV's own: coverage, energy, carbon, revisit, throughput and both shaping terms.
pub const OWN: [usize; OWN_COMPONENTS] = [3, 4, 5, 6, 8, 10, 11];

/// How many components of the team's last reward a state keeps. A proof's state keeps the first: no call
/// reads any of them, and one line writes, another judges each.
pub(crate) const KEPT: usize = if cfg!(kani) { 1 } else { COMPONENTS };

/// How many of its own components a state keeps for each UAV; as [`KEPT`].
pub(crate) const OWN_KEPT: usize = if cfg!(kani) { 1 } else { OWN_COMPONENTS };

/// The weights of a configuration.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RewardPlan {
    detect: f64,
    inform: f64,
    inform_once: bool,
    complete: f64,
    coverage_per_cell: f64,
    energy_per_uj: f64,
    carbon_per_ng: f64,
    revisit: f64,
    truncation: f64,
    throughput: f64,
    spread: f64,
    discount: f64,
}

/// What happened in a step, as far as the reward is concerned: to the team, or as one UAV is credited with it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Happenings {
    /// Hotspots confirmed in this step.
    pub newly_confirmed: u64,
    /// Hotspots informed in this step.
    pub newly_informed: u64,
    /// Hotspots informed in this step or before.
    pub informed: u64,
    /// Every hotspot is informed.
    pub complete: bool,
    /// This is step T_max.
    pub at_horizon: bool,
    /// Cells visited for the first time.
    pub new_cells: u64,
    /// UAVs that moved into a cell visited before this step.
    pub revisits: u64,
    /// Energy spent by the fleet.
    pub spent_uj: u64,
    /// Carbon emitted; a UAV's share of it need not be whole.
    pub co2_ng: f64,
    /// η̄(t).
    pub mean_throughput: f64,
    /// Mean over confirmed hotspots of the fraction of UAVs that know them.
    pub knowledge_spread: f64,
    /// Φ of the distance to hotspots, before the step.
    pub goal_potential_before: f64,
    /// The same after it; 0 in a terminal state.
    pub goal_potential_after: f64,
    /// Φ of carbon-aware charging, before the step.
    pub charge_potential_before: f64,
    /// The same after it; 0 in a terminal state.
    pub charge_potential_after: f64,
}

/// What one UAV did in a step, as far as its own reward is concerned.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Deeds {
    /// It was the first, by index, of those that came to a cell never visited before.
    pub new_cell: bool,
    /// It moved into a cell visited before this step.
    pub revisit: bool,
    /// Energy that it spent.
    pub spent_uj: u64,
    /// Its share of the carbon emitted.
    pub co2_ng: f64,
    /// η̄_i.
    pub throughput: f64,
    /// Its Φ of the distance to hotspots, before the step.
    pub goal_potential_before: f64,
    /// The same after it; 0 in a terminal state.
    pub goal_potential_after: f64,
    /// Its Φ of carbon-aware charging, before the step.
    pub charge_potential_before: f64,
    /// The same after it; 0 in a terminal state.
    pub charge_potential_after: f64,
}

/// [`Deeds`] of a block of UAVs as the state holds them: reals as bits, 1 for yes.
pub(crate) struct BlockDeeds {
    pub(crate) new_cell: Lanes<u64>,
    pub(crate) revisit: Lanes<u64>,
    pub(crate) spent_uj: Lanes<u64>,
    pub(crate) billed_uj: Lanes<u64>,
    pub(crate) throughput: Lanes<u64>,
    pub(crate) goal_potential_before: Lanes<u64>,
    pub(crate) goal_potential_after: Lanes<u64>,
    pub(crate) charge_potential_before: Lanes<u64>,
    pub(crate) charge_potential_after: Lanes<u64>,
}

impl Happenings {
    /// The team's happenings as a UAV of a fleet of `uavs` is credited with them: what the team counts as a
    /// sum over UAVs is `uavs` times the UAV's own, what it counts as a mean is the UAV's own, and the rest
    /// is shared. So the mean over the fleet is the team's.
    #[inline(always)]
    #[must_use]
    pub fn credited(&self, uavs: u64, own: &Deeds) -> Self {
        Self {
            new_cells: if own.new_cell { uavs } else { 0 },
            revisits: if own.revisit { uavs } else { 0 },
            spent_uj: uavs * own.spent_uj,
            co2_ng: uavs as f64 * own.co2_ng,
            mean_throughput: own.throughput,
            goal_potential_before: own.goal_potential_before,
            goal_potential_after: own.goal_potential_after,
            charge_potential_before: own.charge_potential_before,
            charge_potential_after: own.charge_potential_after,
            ..*self
        }
    }
}

impl RewardPlan {
    /// Brings each weight to the unit in which its quantity is counted.
    #[must_use]
    pub fn new(config: &Config) -> Self {
        Self {
            detect: config.reward_detect,
            inform: config.reward_inform,
            inform_once: config.inform_payment == InformPayment::Once,
            complete: config.reward_complete,
            coverage_per_cell: config.reward_coverage / config.cell_count() as f64,
            energy_per_uj: config.penalty_energy_per_kwh / crate::energy::MICROJOULES_PER_KWH,
            carbon_per_ng: config.penalty_carbon_per_kg / 1e12,
            revisit: config.penalty_revisit,
            truncation: config.penalty_truncation,
            throughput: config.reward_throughput,
            spread: config.reward_spread,
            discount: config.shaping_discount,
        }
    }

    /// Every component of R_t, or of R_i for what a UAV is credited with, in the order of [`NAMES`].
    #[inline(always)]
    #[must_use]
    pub fn components(&self, step: &Happenings) -> Rewards {
        let paid = if self.inform_once {
            step.newly_informed
        } else {
            step.informed
        };
        [
            self.detect * step.newly_confirmed as f64,
            self.inform * paid as f64,
            if step.complete { self.complete } else { 0.0 },
            self.coverage_per_cell * step.new_cells as f64,
            -(self.energy_per_uj * step.spent_uj as f64),
            -(self.carbon_per_ng * step.co2_ng),
            -(self.revisit * step.revisits as f64),
            if step.at_horizon {
                -self.truncation
            } else {
                0.0
            },
            self.throughput * step.mean_throughput,
            self.spread * step.knowledge_spread,
            self.discount * step.goal_potential_after - step.goal_potential_before,
            self.discount * step.charge_potential_after - step.charge_potential_before,
        ]
    }
}

impl RewardPlan {
    /// The components in [`OWN`] of each UAV of a block, as bits: those of [`Self::components`] for what
    /// [`Happenings::credited`] credits it with. `fleet` is the fleet's carbon and what it was billed for.
    #[inline(always)]
    pub(crate) fn own_in_lanes(
        &self,
        uavs: u64,
        (co2_ng, billed_uj): (u64, u64),
        own: &BlockDeeds,
    ) -> [Lanes<u64>; OWN_COMPONENTS] {
        let (fleet, whole_ng) = (uavs as f64, co2_ng as f64);
        let billed_fleet = if billed_uj == 0 {
            1.0
        } else {
            billed_uj as f64
        };
        let mut rows = [[0; WIDTH]; OWN_COMPONENTS];
        let [coverage, energy, carbon, revisit, throughput, goal, charge] = &mut rows;
        for lane in 0..WIDTH {
            let new_cells = f64::from(own.new_cell[lane] as u32) * fleet;
            coverage[lane] = stored(self.coverage_per_cell * new_cells);
            let spent_uj = (uavs * own.spent_uj[lane]) as f64;
            energy[lane] = stored(-(self.energy_per_uj * spent_uj));
            let revisits = f64::from(own.revisit[lane] as u32) * fleet;
            revisit[lane] = stored(-(self.revisit * revisits));
            throughput[lane] = stored(self.throughput * f64::from_bits(own.throughput[lane]));
        }
        for lane in 0..WIDTH {
            let share = whole_ng * (own.billed_uj[lane] as f64 / billed_fleet);
            let share = if share > whole_ng { whole_ng } else { share };
            carbon[lane] = stored(-(self.carbon_per_ng * (fleet * share)));
        }
        for lane in 0..WIDTH {
            let gained = |after: &Lanes<u64>, before: &Lanes<u64>| {
                stored(self.discount * f64::from_bits(after[lane]) - f64::from_bits(before[lane]))
            };
            goal[lane] = gained(&own.goal_potential_after, &own.goal_potential_before);
            charge[lane] = gained(&own.charge_potential_after, &own.charge_potential_before);
        }
        rows
    }
}

/// R_t or R_i: the components summed left to right.
#[inline(always)]
#[must_use]
pub fn total(rewards: &Rewards) -> f64 {
    let mut sum = 0.0;
    for component in rewards {
        sum += component;
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::config::Preset;

    #[test]
    fn mission_pays_informing_once_and_paper_at_every_step() {
        let step = Happenings {
            newly_informed: 1,
            informed: 3,
            ..Happenings::default()
        };
        let inform = |preset| RewardPlan::new(&Config::preset(preset)).components(&step)[1];
        assert_eq!(inform(Preset::Mission), 4.0);
        assert_eq!(inform(Preset::Paper), 12.0);
    }

    #[test]
    fn weights_are_the_papers() {
        let step = Happenings {
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
            ..Happenings::default()
        };
        let rewards = RewardPlan::new(&Config::default()).components(&step);
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
    fn own_components_of_a_block_are_those_of_each_uav() {
        let plan = RewardPlan::new(&Config::default());
        for round in 0..1000u64 {
            let word = |purpose: u64, lane: usize| {
                crate::rng::derive_seed(round, purpose * WIDTH as u64 + lane as u64)
            };
            let real = |purpose, lane, scale: f64| {
                (crate::rng::unit(word(purpose, lane)) * scale).to_bits()
            };
            let lanes = |purpose, make: &dyn Fn(u64, usize) -> u64| {
                core::array::from_fn(|lane| make(purpose, lane))
            };
            let own = BlockDeeds {
                new_cell: lanes(0, &|purpose, lane| word(purpose, lane) & 1),
                revisit: lanes(1, &|purpose, lane| word(purpose, lane) & 1),
                spent_uj: lanes(2, &|purpose, lane| word(purpose, lane) >> 22),
                billed_uj: lanes(3, &|purpose, lane| {
                    word(purpose, lane) >> 30 << (word(9, lane) % 3)
                }),
                throughput: lanes(4, &|purpose, lane| real(purpose, lane, 2.0)),
                goal_potential_before: lanes(5, &|purpose, lane| real(purpose, lane, -3.0)),
                goal_potential_after: lanes(6, &|purpose, lane| real(purpose, lane, -3.0)),
                charge_potential_before: lanes(7, &|purpose, lane| real(purpose, lane, 0.1)),
                charge_potential_after: lanes(8, &|purpose, lane| real(purpose, lane, 0.1)),
            };
            let billed_uj: u64 = own.billed_uj.iter().sum();
            let billed_uj = if round % 10 == 0 { 0 } else { billed_uj };
            let co2_ng = word(10, 0) >> 20;
            let rows = plan.own_in_lanes(15, (co2_ng, billed_uj), &own);
            for lane in 0..WIDTH {
                let billed = if billed_uj == 0 {
                    0
                } else {
                    own.billed_uj[lane]
                };
                if billed != own.billed_uj[lane] {
                    continue;
                }
                let deeds = Deeds {
                    new_cell: own.new_cell[lane] != 0,
                    revisit: own.revisit[lane] != 0,
                    spent_uj: own.spent_uj[lane],
                    co2_ng: crate::carbon::share_ng(co2_ng, billed, billed_uj),
                    throughput: f64::from_bits(own.throughput[lane]),
                    goal_potential_before: f64::from_bits(own.goal_potential_before[lane]),
                    goal_potential_after: f64::from_bits(own.goal_potential_after[lane]),
                    charge_potential_before: f64::from_bits(own.charge_potential_before[lane]),
                    charge_potential_after: f64::from_bits(own.charge_potential_after[lane]),
                };
                let all = plan.components(&Happenings::default().credited(15, &deeds));
                for (row, index) in rows.iter().zip(OWN) {
                    assert_eq!(row[lane], stored(all[index]), "{}", NAMES[index]);
                }
            }
        }
    }

    #[test]
    fn own_components_are_those_that_differ_between_uavs() {
        let fleet = Happenings {
            newly_confirmed: 1,
            newly_informed: 1,
            informed: 1,
            complete: true,
            at_horizon: true,
            knowledge_spread: 1.0,
            ..Happenings::default()
        };
        let busy = Deeds {
            new_cell: true,
            revisit: true,
            spent_uj: 1,
            co2_ng: 1.0,
            throughput: 1.0,
            goal_potential_before: -1.0,
            charge_potential_before: 0.1,
            ..Deeds::default()
        };
        let plan = RewardPlan::new(&Config::default());
        let idle = plan.components(&fleet.credited(10, &Deeds::default()));
        let busy = plan.components(&fleet.credited(10, &busy));
        for index in 0..COMPONENTS {
            let differs = idle[index] != busy[index];
            assert_eq!(differs, OWN.contains(&index), "{}", NAMES[index]);
        }
    }
}
