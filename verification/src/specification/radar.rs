//! The radar equations.

use super::{Position, SPEED_OF_LIGHT_M_PER_S, Specification};
use jcas_core::config::DetectionPoint;
use jcas_core::{Config, DetectionCurve, PilotGain};
use std::f64::consts::PI;

/// SNR^sens in dB at range R, before communication load.
pub fn sensing_snr_db(c: &Config, range_m: f64) -> f64 {
    let lambda = SPEED_OF_LIGHT_M_PER_S / c.carrier_frequency_hz;
    let transmitted_w = watts(c.transmit_power_dbm);
    let gains = ratio(c.transmit_gain_dbi) * ratio(c.receive_gain_dbi);
    let cross_section_m2 = ratio(c.radar_cross_section_dbsm);
    let four_pi_cubed = (4.0 * PI) * (4.0 * PI) * (4.0 * PI);
    let range_4 = range_m * range_m * range_m * range_m;
    let received_w =
        transmitted_w * gains * lambda * lambda * cross_section_m2 / (four_pi_cubed * range_4);
    let noise_w = watts(c.sensing_noise_dbm);
    10.0 * libm::log10(received_w / noise_w) + c.processing_gain_db
        - range_resolution_penalty_db(c, range_m)
}

/// Δ_res(R) = 10·log10(1 + δ/R).
fn range_resolution_penalty_db(c: &Config, range_m: f64) -> f64 {
    let natural = SPEED_OF_LIGHT_M_PER_S / (2.0 * c.bandwidth_hz);
    let resolution = c.range_resolution_m.unwrap_or(natural);
    10.0 * libm::log10(1.0 + resolution / range_m)
}

/// γ_det: given, or the SNR at the sensing range, or Albersheim's equation for one pulse.
pub fn detection_threshold_db(c: &Config) -> f64 {
    if let Some(threshold) = c.detection_threshold_db {
        return threshold;
    }
    if let Some(range_m) = c.sensing_range_m {
        return sensing_snr_db(c, range_m);
    }
    let pulses: f64 = 1.0;
    let a = libm::log(0.62 / c.false_alarm_probability);
    let b = libm::log(c.detection_probability / (1.0 - c.detection_probability));
    -5.0 * libm::log10(pulses)
        + (6.2 + 4.54 / libm::sqrt(pulses + 0.44)) * libm::log10(a + 0.12 * a * b + 1.7 * b)
}

/// What the range alone gives: the logit of P_d by a table, otherwise SNR^sens in dB.
pub fn by_range(c: &Config, range_m: f64) -> f64 {
    match c.detection_curve {
        DetectionCurve::Table => table_logit(c.detection_table.as_slice(), range_m),
        _ => sensing_snr_db(c, range_m),
    }
}

/// The logit of a table's P_d, linear between points and held beyond the ends.
fn table_logit(table: &[DetectionPoint], range_m: f64) -> f64 {
    let (first, last) = (table[0], table[table.len() - 1]);
    let logit = |p: f64| libm::log(p / (1.0 - p));
    let held = range_m.max(first.range_m).min(last.range_m);
    let inside = |pair: &&[DetectionPoint]| held <= pair[1].range_m;
    match table.windows(2).find(inside) {
        None => logit(first.probability),
        Some(pair) => {
            let t = (held - pair[0].range_m) / (pair[1].range_m - pair[0].range_m);
            (1.0 - t) * logit(pair[0].probability) + t * logit(pair[1].probability)
        }
    }
}

impl Specification {
    /// p_ij, the probability that a UAV with this pilot density detects in one step.
    pub fn detection_probability(&self, uav: Position, hotspot: Position, pilot: f64) -> f64 {
        self.probability_at(self.by_range.between(uav, hotspot), pilot)
    }

    /// The probability of detection by what the range gives and a pilot density.
    pub(super) fn probability_at(&self, by_range: f64, pilot: f64) -> f64 {
        let c = &self.config;
        let load = 1.0 - pilot;
        let gain_db = match c.pilot_gain {
            PilotGain::None => 0.0,
            PilotGain::Coherent => 10.0 * libm::log10(pilot / c.pilot_density_max),
        };
        let snr_db = by_range + gain_db - c.comm_load_penalty_db * load;
        match c.detection_curve {
            DetectionCurve::Logistic => {
                let margin = snr_db - self.detection_threshold_db;
                1.0 / (1.0 + libm::exp(-c.logistic_slope_per_db * margin))
            }
            DetectionCurve::Swerling1 => {
                libm::pow(c.false_alarm_probability, 1.0 / (1.0 + ratio(snr_db)))
            }
            DetectionCurve::Table => {
                let lost_db = c.comm_load_penalty_db * (load - (1.0 - c.pilot_density_max));
                let logit = by_range + c.logistic_slope_per_db * (gain_db - lost_db);
                1.0 / (1.0 + libm::exp(-logit))
            }
        }
    }
}

fn ratio(db: f64) -> f64 {
    libm::pow(10.0, db / 10.0)
}

fn watts(dbm: f64) -> f64 {
    ratio(dbm) / 1000.0
}
