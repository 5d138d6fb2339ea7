//! The header of a state: its scalars, one word each.

use crate::constants::layout::HEADER_WORDS;
use crate::constants::reward::{COMPONENTS, KEPT, Rewards};
use crate::words::word::canonical_bits;

/// Phase of an episode: the part of the step that came last, which decides what may be called next.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u64)]
pub enum Phase {
    /// The state is between two steps, and a step may begin.
    Ready = 1,
    /// The UAVs have acted and moved; sensing comes next.
    Moved = 2,
    /// The UAVs have sensed and learnt; communication comes next.
    Sensed = 3,
    /// Knowledge has spread; the end of the step comes next.
    Communicated = 4,
    /// The episode has terminated: all UAVs know all hotspots, and each is confirmed.
    Terminated = 5,
    /// The episode was truncated at the horizon.
    Truncated = 6,
}

impl Phase {
    const ALL: [Self; 6] = [
        Self::Ready,
        Self::Moved,
        Self::Sensed,
        Self::Communicated,
        Self::Terminated,
        Self::Truncated,
    ];

    /// Whether the episode has ended.
    #[must_use]
    pub const fn is_over(self) -> bool {
        matches!(self, Self::Terminated | Self::Truncated)
    }
}

pub(crate) const CONFIG_HASH: usize = 0;
const SEED: usize = 1;
pub(crate) const T: usize = 2;
pub(crate) const PHASE: usize = 3;
const INTENSITY: usize = 4;
const BILLED_INTENSITY: usize = 5;
const CO2: usize = 6;
const GRID: usize = 7;
const MOVES: usize = 8;
pub(crate) const MEAN_THROUGHPUT: usize = 9;
const THROUGHPUT_SUM: usize = 10;
const PILOT_SUM: usize = 11;
const GOAL_POTENTIAL: usize = 12;
const CHARGE_POTENTIAL: usize = 13;
const RETURN: usize = 14;
const REWARDS: usize = 15;

/// Number of words of the header.
pub const WORDS: usize = HEADER_WORDS;

const _: () = assert!(WORDS == REWARDS + KEPT);

/// A read-only view of the scalars of a state.
#[derive(Clone, Copy, Debug)]
pub struct HeaderRef<'a>(pub(crate) &'a [u64]);

/// A writable view of the scalars of a state.
#[derive(Debug)]
pub struct HeaderMut<'a>(pub(crate) &'a mut [u64]);

macro_rules! scalar {
    ($(
        $(#[$meta:meta])*
        $get:ident, $set:ident, $index:ident, $type:ty, $read:expr, $write:expr;
    )+) => {
        impl HeaderRef<'_> { $(
            $(#[$meta])*
            #[inline]
            #[must_use]
            pub fn $get(&self) -> $type { $read(self.0[$index]) }
        )+ }
        impl HeaderMut<'_> { $(
            $(#[$meta])*
            #[inline]
            #[must_use]
            pub fn $get(&self) -> $type { $read(self.0[$index]) }
            #[inline]
            pub(crate) fn $set(&mut self, value: $type) { self.0[$index] = $write(value); }
        )+ }
    };
}

const fn word(value: u64) -> u64 {
    value
}
const fn narrow(value: u64) -> u32 {
    value as u32
}
const fn widen(value: u32) -> u64 {
    value as u64
}

scalar! {
    /// Hash of the configuration to which the state belongs.
    config_hash, set_config_hash, CONFIG_HASH, u64, word, word;
    /// Seed of the episode.
    seed, set_seed, SEED, u64, word, word;
    /// Number of steps begun since the reset.
    t, set_t, T, u32, narrow, widen;
    /// Carbon intensity with which the coming step will be billed, in mg/kWh.
    intensity_mg_per_kwh, set_intensity, INTENSITY, u64, word, word;
    /// Carbon intensity with which the last step was billed, in mg/kWh.
    billed_intensity_mg_per_kwh, set_billed_intensity, BILLED_INTENSITY, u64, word, word;
    /// Carbon emitted in the episode by the fleet, in nanograms.
    co2_ng, set_co2, CO2, u64, word, word;
    /// Grid energy billed in the episode to the fleet, in microjoules.
    grid_uj, set_grid, GRID, u64, word, word;
    /// Number of moves between cells in the episode, over all UAVs.
    moves, set_moves, MOVES, u64, word, word;
    /// Mean normalised throughput over the fleet, η̄(t), for the present radio graph.
    mean_throughput, set_mean_throughput, MEAN_THROUGHPUT, f64, f64::from_bits, canonical_bits;
    /// Sum of η̄(t) over the steps.
    throughput_sum, set_throughput_sum, THROUGHPUT_SUM, f64, f64::from_bits, canonical_bits;
    /// Sum over the steps of the fleet's mean pilot density.
    pilot_sum, set_pilot_sum, PILOT_SUM, f64, f64::from_bits, canonical_bits;
    /// Fleet mean of the goal potential, for the distance to hotspots.
    goal_potential, set_goal_potential, GOAL_POTENTIAL, f64, f64::from_bits, canonical_bits;
    /// Fleet mean of the potential for carbon-aware charging.
    charge_potential, set_charge_potential, CHARGE_POTENTIAL, f64, f64::from_bits, canonical_bits;
    /// Undiscounted return of the episode.
    return_sum, set_return_sum, RETURN, f64, f64::from_bits, canonical_bits;
}

fn phase_of(word: u64) -> Option<Phase> {
    Phase::ALL.get((word as usize).wrapping_sub(1)).copied()
}

impl HeaderRef<'_> {
    /// How far the step has come; `None` before the first reset.
    #[must_use]
    pub fn phase(&self) -> Option<Phase> {
        phase_of(self.0[PHASE])
    }

    /// Components of the team's last reward.
    #[must_use]
    pub fn rewards(&self) -> Rewards {
        let mut rewards = [0.0; COMPONENTS];
        for index in 0..KEPT {
            rewards[index] = f64::from_bits(self.0[REWARDS + index]);
        }
        rewards
    }
}

impl HeaderMut<'_> {
    /// A read-only view of the same scalars.
    #[must_use]
    pub fn as_ref(&self) -> HeaderRef<'_> {
        HeaderRef(self.0)
    }

    /// How far the step has come; `None` before the first reset.
    #[must_use]
    pub fn phase(&self) -> Option<Phase> {
        phase_of(self.0[PHASE])
    }

    pub(crate) fn set_phase(&mut self, phase: Phase) {
        self.0[PHASE] = phase as u64;
    }

    pub(crate) fn set_rewards(&mut self, rewards: &Rewards) {
        for index in 0..KEPT {
            self.0[REWARDS + index] = canonical_bits(rewards[index]);
        }
    }
}
