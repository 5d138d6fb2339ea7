//! Stratified sampling: UAVs in one cell take different parts of their distribution of motions.
//!
//! UAVs of a cell observe nearly the same, so their distributions are alike. With independent
//! draws, five of ten may go where seven should. Here they take quantiles φ⁻¹ apart, in the order
//! of their index. Multiples of the golden ratio, turned around the unit circle, lie evenly on it
//! for any count (V. T. Sós, 1958). The first quantile follows from the phase seed, the step and
//! the first UAV of the cell. Over the steps, each UAV thus takes every part as often as with
//! independent draws. Besides its own observation, a UAV has to know which UAVs share its cell.
//!
//! Stratified actions are deterministic given the phase seeds, so a bad seed is bad in every
//! episode. A policy file may therefore carry chosen seeds, one for each phase.

use jcas_core::StateRef;

use crate::head::Draw;

/// φ⁻¹ = (√5 - 1)/2.
const TURN: f64 = 0.618_033_988_749_895;

/// Number of phases of an episode: steps 0 and 1, 2 and 3, 4 to 7, 8 to 15, and all later ones.
pub const PHASES: usize = 5;

/// The phase seeds of one fleet: the seed of the first quantile in each phase.
pub type Starts = [u16; PHASES];

/// The maximum number of fleet sizes with phase seeds of their own.
pub const FLEETS_MAX: usize = 8;

/// The phase seeds of fleets, by the number of their UAVs. All are 0 where the file states none.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct FleetStarts {
    /// Entries in ascending order of fleet size.
    fleets: [(u32, Starts); FLEETS_MAX],
    len: usize,
}

impl FleetStarts {
    /// Takes pairs of a number of UAVs and its phase seeds, in strictly ascending order of UAVs.
    /// Returns `None` for another order, or for more than [`FLEETS_MAX`] pairs.
    #[must_use]
    pub fn new(fleets: impl IntoIterator<Item = (u32, Starts)>) -> Option<Self> {
        let mut all = Self::default();
        for fleet in fleets {
            if all.fleets().last().is_some_and(|last| last.0 >= fleet.0) {
                return None;
            }
            *all.fleets.get_mut(all.len)? = fleet;
            all.len += 1;
        }
        Some(all)
    }

    /// The numbers of UAVs, each with its phase seeds, in ascending order.
    #[must_use]
    pub fn fleets(&self) -> &[(u32, Starts)] {
        &self.fleets[..self.len]
    }

    /// The phase seeds for `uavs` UAVs: those of the largest listed fleet that is not larger. For a
    /// fleet smaller than all listed ones, they are those of the smallest.
    #[must_use]
    pub fn of(&self, uavs: u32) -> Starts {
        let fleets = self.fleets();
        let not_larger = fleets.iter().rev().find(|fleet| fleet.0 <= uavs);
        let fleet = not_larger.or(fleets.first());
        fleet.map_or([0; PHASES], |fleet| fleet.1)
    }
}

fn phase(t: u32) -> usize {
    let bits = (u32::BITS - (t / 2).leading_zeros()) as usize;
    if bits < PHASES { bits } else { PHASES - 1 }
}

/// The quantile `turns` golden-ratio turns after `start`, in [0, 1).
#[must_use]
pub fn turned(start: f64, turns: usize) -> f64 {
    let far = start + TURN * turns as f64;
    far - libm::floor(far)
}

/// The quantile of a UAV's motion in its distribution, in [0, 1).
pub(crate) fn quantile(state: &StateRef<'_>, uav: usize, starts: Starts) -> f64 {
    let cell = state.cell(uav);
    let mut before = (0..uav).filter(|&other| state.cell(other) == cell);
    let first = before.next();
    let begin = Draw {
        seed: u64::from(starts[phase(state.t())]),
        t: state.t(),
        uav: first.unwrap_or(uav) as u32,
    };
    turned(begin.unit(), first.map_or(0, |_| 1 + before.count()))
}

#[cfg(test)]
mod tests {
    extern crate std;

    use super::*;
    use jcas_core::{Config, Model, Sim};
    use std::vec::Vec;

    #[test]
    fn phases_double() {
        let phases = [0, 1, 2, 3, 4, 7, 8, 15, 16, u32::MAX].map(phase);
        assert_eq!(phases, [0, 0, 1, 1, 2, 2, 3, 3, 4, 4]);
    }

    #[test]
    fn a_fleet_begins_as_the_largest_that_is_not_larger() {
        let starts = FleetStarts::new([(5, [3; 5]), (10, [0; 5]), (20, [7; 5])]).unwrap();
        let of = [1, 5, 9, 10, 19, 20, 500].map(|uavs| starts.of(uavs)[4]);
        assert_eq!(of, [3, 3, 3, 0, 0, 7, 7]);
        assert_eq!(FleetStarts::default().of(5), [0; 5]);
        assert_eq!(FleetStarts::new([(5, [3; 5]), (5, [0; 5])]), None);
        assert_eq!(FleetStarts::new((0..9).map(|uavs| (uavs, [0; 5]))), None);
    }

    #[test]
    fn a_start_counts_in_its_phase_alone() {
        let (plain, other) = (quantiles(5, [0; 5]), quantiles(5, [0, 0, 1, 0, 0]));
        for t in 0..90 {
            assert_eq!(plain[t] == other[t], !(4..8).contains(&t), "{t}");
        }
    }

    /// Returns the quantiles of nine UAVs over the first steps of an episode without movement.
    fn quantiles(seed: u64, starts: Starts) -> Vec<Vec<f64>> {
        let model = Model::new(Config {
            uav_count: 9,
            ..Config::default()
        })
        .unwrap();
        let mut sim = Sim::new(&model);
        sim.reset(seed);
        let stay = [1.0, 1.0].repeat(9);
        let of_step = |_| {
            let quantiles = (0..9)
                .map(|uav| quantile(&sim.state(), uav, starts))
                .collect();
            sim.step(&stay).unwrap();
            quantiles
        };
        (0..90).map(of_step).collect()
    }

    // All nine begin on the depot. Nine multiples of φ⁻¹ lie on a circle of length 1. Neighbours
    // are then φ⁻⁴, φ⁻⁵ or φ⁻⁶ apart: 0.146, 0.090, 0.056.
    #[test]
    fn uavs_of_a_cell_take_quantiles_that_lie_evenly() {
        for mut step in quantiles(5, [0; 5]) {
            step.sort_by(f64::total_cmp);
            let around = step[0] + 1.0;
            step.push(around);
            for pair in step.windows(2) {
                let gap = pair[1] - pair[0];
                let known = [4, 5, 6].map(|power| TURN.powi(power));
                assert!(known.iter().any(|known| (gap - known).abs() < 1e-12));
            }
        }
    }

    // The standard deviation of a mean of 90 uniform numbers is 0.03.
    #[test]
    fn each_uav_takes_every_part_and_no_seed_says_which() {
        let steps = quantiles(5, [0; 5]);
        for uav in 0..9 {
            let sum: f64 = steps.iter().map(|quantiles| quantiles[uav]).sum();
            assert!((sum / steps.len() as f64 - 0.5).abs() < 0.1);
        }
        assert_eq!(steps, quantiles(6, [0; 5]));
    }
}
