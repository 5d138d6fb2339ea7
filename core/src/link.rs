//! The radio graph: link budget, normalised throughput, who hears whom.

use libm::{exp, log2, log10};

use crate::bits;
use crate::config::{Cell, Config};
use crate::model::Model;
use crate::radar::LIGHT_M_PER_S;
use crate::scratch::Scratch;
use crate::state::StateMut;

/// Communication SNR at a range: P_t + G_t + G_r - PL - P_n, with the log-distance path loss
/// PL = 20 log10(4π f_c/c) + 10 n log10(R).
#[must_use]
pub fn snr_db(config: &Config, range_m: f64) -> f64 {
    let path_loss_db = 20.0
        * log10(4.0 * core::f64::consts::PI * config.carrier_frequency_hz / LIGHT_M_PER_S)
        + 10.0 * config.path_loss_exponent * log10(range_m);
    config.transmit_power_dbm + config.transmit_gain_dbi + config.receive_gain_dbi
        - path_loss_db
        - config.comm_noise_dbm
}

/// log2(1 + SNR) / reference: the normalised throughput of a waveform that carries only data.
#[must_use]
pub fn full_throughput(config: &Config, range_m: f64) -> f64 {
    let snr = exp(snr_db(config, range_m) * (core::f64::consts::LN_10 / 10.0));
    log2(1.0 + snr) / config.reference_spectral_efficiency
}

/// Up to this many UAVs, looking at every pair beats sorting them into buckets.
const ALL_PAIRS_MAX: usize = 48;

/// Builds the graph from positions and pilot densities.
pub(crate) fn build_graph(model: &Model<'_>, state: &mut StateMut<'_>, scratch: &mut Scratch<'_>) {
    state.links.fill(0);
    if model.uav_count() <= ALL_PAIRS_MAX || model.bucket_count() < 9 {
        link_all_pairs(model, state);
    } else {
        link_by_buckets(model, state, scratch);
    }
    measure_throughput(model, state);
}

/// Whether two UAVs hear each other: η_ij and η_ji both reach η_link.
#[inline]
fn linked(model: &Model<'_>, a: Cell, load_a: f64, b: Cell, load_b: f64) -> bool {
    let least_load = if load_a < load_b { load_a } else { load_b };
    least_load * model.full_throughput(a, b) >= model.link_throughput_min()
}

fn link_all_pairs(model: &Model<'_>, state: &mut StateMut<'_>) {
    let row = model.uav_words();
    for i in 1..model.uav_count() {
        if bits::get(state.grounded, i) {
            continue;
        }
        let (cell, load) = (state.cell(i), 1.0 - state.pilot_density(i));
        for k in 0..i {
            if !bits::get(state.grounded, k)
                && linked(
                    model,
                    cell,
                    load,
                    state.cell(k),
                    1.0 - state.pilot_density(k),
                )
            {
                bits::set(&mut state.links[i * row..], k);
                bits::set(&mut state.links[k * row..], i);
            }
        }
    }
}

/// Sorts the UAVs into square buckets as wide as the longest possible link, so that a UAV's neighbours
/// lie in its own bucket and the eight around it.
fn link_by_buckets(model: &Model<'_>, state: &mut StateMut<'_>, scratch: &mut Scratch<'_>) {
    let uavs = model.uav_count();
    let columns = model.bucket_columns();
    let rows = model.bucket_count() / columns;
    let (starts, members) = scratch.buckets(model);
    starts.fill(0);
    for i in 0..uavs {
        starts[model.bucket(state.cell(i)) + 1] += 1;
    }
    for bucket in 0..starts.len() - 1 {
        starts[bucket + 1] += starts[bucket];
    }
    for i in 0..uavs {
        let bucket = model.bucket(state.cell(i));
        members[starts[bucket] as usize] = i as u64;
        starts[bucket] += 1;
    }
    // Filling moved each start to its end, which is the next bucket's start.
    let span = |bucket: usize| {
        let begin = if bucket == 0 {
            0
        } else {
            starts[bucket - 1] as usize
        };
        begin..starts[bucket] as usize
    };

    let words = model.uav_words();
    for i in 0..uavs {
        if bits::get(state.grounded, i) {
            continue;
        }
        let (cell, load) = (state.cell(i), 1.0 - state.pilot_density(i));
        let bucket = model.bucket(cell);
        let (column, row) = (bucket % columns, bucket / columns);
        for near_row in row.saturating_sub(1)..(row + 2).min(rows) {
            let first = near_row * columns + column.saturating_sub(1);
            let last = near_row * columns + (column + 1).min(columns - 1);
            for slot in span(first).start..span(last).end {
                let k = members[slot] as usize;
                if k < i
                    && !bits::get(state.grounded, k)
                    && linked(
                        model,
                        cell,
                        load,
                        state.cell(k),
                        1.0 - state.pilot_density(k),
                    )
                {
                    bits::set(&mut state.links[i * words..], k);
                    bits::set(&mut state.links[k * words..], i);
                }
            }
        }
    }
}

/// η̄_i: the mean over neighbours, in ascending order, of ρ_comm,i · log2(1 + SNR_ij)/6; 0 without any.
/// η̄(t): the mean over all UAVs.
pub(crate) fn measure_throughput(model: &Model<'_>, state: &mut StateMut<'_>) {
    let words = model.uav_words();
    let mut fleet = 0.0;
    for i in 0..model.uav_count() {
        let cell = state.cell(i);
        let (mut sum, mut degree) = (0.0, 0u32);
        for word in 0..words {
            let mut rest = state.links[i * words + word];
            while rest != 0 {
                let k = word * 64 + rest.trailing_zeros() as usize;
                rest &= rest - 1;
                sum += model.full_throughput(cell, state.cell(k));
                degree += 1;
            }
        }
        let throughput = if degree == 0 {
            0.0
        } else {
            (1.0 - state.pilot_density(i)) * sum / f64::from(degree)
        };
        state.set_throughput(i, throughput);
        fleet += throughput;
    }
    let mean = fleet / model.uav_count() as f64;
    state.header.set_mean_throughput(mean);
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Worked by hand: 20 log10(4π f/c) = 47.71 dB.
    #[test]
    fn hand_worked_link_budget() {
        let config = Config::default();
        assert!((snr_db(&config, 50.0) - 32.30).abs() < 0.005);
        assert!((snr_db(&config, 100.0) - 26.28).abs() < 0.005);
        let snr = 10f64.powf(snr_db(&config, 100.0) / 10.0);
        assert!((full_throughput(&config, 100.0) - (1.0 + snr).log2() / 6.0).abs() < 1e-12);
    }
}
