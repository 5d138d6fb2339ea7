//! Summary of an episode.

use crate::rules::energy::Settled;
use crate::state::{StateMut, StateRef};
use crate::words::units::{MICROJOULES_PER_KWH, kilograms};

/// Summary of an episode, so far or at its end.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Metrics {
    /// Number of steps taken.
    pub steps: u32,
    /// True if all UAVs know all hotspots and each is confirmed, which is success.
    pub terminated: bool,
    /// True if the episode was truncated at the horizon.
    pub truncated: bool,
    /// Number of confirmed hotspots.
    pub confirmed: u32,
    /// Number of hotspots that all UAVs know.
    pub informed: u32,
    /// Number of moves between cells, over all UAVs.
    pub moves: u64,
    /// Undiscounted return.
    pub return_sum: f64,
    /// Energy spent by the fleet, kWh.
    pub energy_kwh: f64,
    /// Energy accepted from chargers, kWh.
    pub accepted_kwh: f64,
    /// Energy that UAVs requested and their batteries lacked, kWh.
    pub shortfall_kwh: f64,
    /// Grid energy billed, kWh.
    pub grid_kwh: f64,
    /// Carbon emitted, kg.
    pub co2_kg: f64,
    /// Mean over the steps of the fleet's normalised throughput η̄(t); 0 before the first step.
    pub throughput_mean: f64,
    /// Mean over steps and UAVs of the pilot density; 0 before the first step.
    pub pilot_density_mean: f64,
    /// Number of cells without a hotspot that a quorum confirmed.
    pub false_confirmations: u32,
}

/// Adds a step to the sums from which the summary follows.
#[inline(always)]
pub(crate) fn add_step(state: &mut StateMut<'_>, settled: &Settled) {
    let pilot = settled.pilot / state.layout.uavs as f64;
    let header = &mut state.header;
    header.set_moves(header.moves() + settled.moves);
    header.set_pilot_sum(header.pilot_sum() + pilot);
    header.set_throughput_sum(header.throughput_sum() + header.mean_throughput());
}

impl StateRef<'_> {
    /// Summary of the episode so far.
    #[must_use]
    pub fn metrics(&self) -> Metrics {
        let header = &self.header;
        let kwh = |ledger: &[u64]| {
            let mut sum = 0u64;
            for entry in ledger {
                sum += entry;
            }
            sum as f64 / MICROJOULES_PER_KWH
        };
        let steps = header.t();
        let per_step = |sum: f64| {
            if steps == 0 {
                0.0
            } else {
                sum / f64::from(steps)
            }
        };
        Metrics {
            steps,
            terminated: self.terminated(),
            truncated: self.truncated(),
            confirmed: self.confirmed_count() as u32,
            informed: self.informed_count() as u32,
            moves: header.moves(),
            return_sum: header.return_sum(),
            energy_kwh: kwh(self.spent),
            accepted_kwh: kwh(self.accepted),
            shortfall_kwh: kwh(self.shortfall),
            grid_kwh: header.grid_uj() as f64 / MICROJOULES_PER_KWH,
            co2_kg: kilograms(header.co2_ng()),
            throughput_mean: per_step(header.throughput_sum()),
            pilot_density_mean: per_step(header.pilot_sum()),
            false_confirmations: self.false_confirmation_count() as u32,
        }
    }
}
