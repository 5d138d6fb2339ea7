//! The monostatic OFDM radar: SNR, detection margin, detection probability.

pub mod curve;
pub mod table;

use libm::{exp, log, log10};

use crate::config::Config;
use crate::lanes::real;

/// Speed of light in vacuum.
pub const LIGHT_M_PER_S: f64 = 299_792_458.0;

/// Bound of the tabulated exponent. Beyond it the probability equals 0 or 1 at the resolution of a
/// draw.
const EXPONENT_BOUND: f64 = 300.0;

/// Number of values of a draw.
const DRAWS: f64 = 4_294_967_296.0;

/// Distance in metres between the centres of two cells, at least R_min.
#[must_use]
pub fn range_m(config: &Config, dx: u32, dy: u32) -> f64 {
    let squares = u64::from(dx) * u64::from(dx) + u64::from(dy) * u64::from(dy);
    let range = config.cell_size_m * libm::sqrt(squares as f64);
    let least = config.range_min_m.unwrap_or(config.cell_size_m / 2.0);
    if range > least { range } else { least }
}

/// 10 log10(P_r/P_n) + G_proc - Δ_res: the sensing SNR before the communication load is taken off.
///
/// P_r = P_t G_t G_r λ² σ / ((4π)³ R⁴), written in decibels.
#[must_use]
pub fn snr_db(config: &Config, range_m: f64) -> f64 {
    let wavelength_m = LIGHT_M_PER_S / config.carrier_frequency_hz;
    let received_dbm = config.transmit_power_dbm
        + config.transmit_gain_dbi
        + config.receive_gain_dbi
        + 20.0 * log10(wavelength_m)
        + config.radar_cross_section_dbsm
        - 30.0 * log10(4.0 * core::f64::consts::PI)
        - 40.0 * log10(range_m);
    received_dbm - config.sensing_noise_dbm + config.processing_gain_db
        - resolution_penalty_db(config, range_m)
}

/// Δ_res(R) = 10 log10(1 + δ/R).
#[must_use]
pub fn resolution_penalty_db(config: &Config, range_m: f64) -> f64 {
    let resolution_m = config
        .range_resolution_m
        .unwrap_or(LIGHT_M_PER_S / (2.0 * config.bandwidth_hz));
    10.0 * log10(1.0 + resolution_m / range_m)
}

/// The detection threshold γ_det in dB.
///
/// It is the configured value, or the SNR at the configured sensing range. Without both, it is the
/// SNR at which one pulse reaches P_d at P_fa, by Albersheim's equation.
///
/// W. J. Albersheim, "A closed-form approximation to Robertson's detection characteristics",
/// Proc. IEEE 69(7), 1981, for one non-coherently integrated sample.
#[must_use]
pub fn detection_threshold_db(config: &Config) -> f64 {
    if let Some(threshold_db) = config.detection_threshold_db {
        return threshold_db;
    }
    if let Some(range_m) = config.sensing_range_m {
        return snr_db(config, range_m);
    }
    let p_d = config.detection_probability;
    let a = log(0.62 / config.false_alarm_probability);
    let b = log(p_d / (1.0 - p_d));
    (6.2 + 4.54 / libm::sqrt(1.44)) * log10(a + 0.12 * a * b + 1.7 * b)
}

/// The range's factor of the odds against detection, exp(-κ (SNR - γ_det)).
///
/// The odds against detection are exp(-κ m) with m = SNR - α ρ_comm - γ_det. They are the product
/// of this tabulated factor and the UAV's factor exp(κ α ρ_comm). So a pair needs no transcendental
/// function.
#[must_use]
pub fn range_odds_against(config: &Config, snr_db: f64, threshold_db: f64) -> f64 {
    let exponent = -config.logistic_slope_per_db * (snr_db - threshold_db);
    exp(bounded(exponent, EXPONENT_BOUND))
}

/// The value, or the nearer end of [-bound, bound].
const fn bounded(value: f64, bound: f64) -> f64 {
    if value > bound {
        bound
    } else if value < -bound {
        -bound
    } else {
        value
    }
}

/// The UAV's factor of the odds against detection, exp(κ α ρ_comm), for κ α from 0 to 700 and a
/// load from 0 to 1.
#[inline(always)]
#[must_use]
pub fn load_odds_against(loss_per_load: f64, comm_load: f64) -> f64 {
    real::exp(loss_per_load * comm_load)
}

/// The odds against a detection: a range's factor times a UAV's.
#[inline(always)]
#[must_use]
pub fn odds_against(range_odds: f64, load_odds: f64) -> f64 {
    range_odds * load_odds
}

/// Whether a 32-bit draw is below the whole part of p · 2^32, with p = 1 / (1 + odds against). A
/// whole number is below the whole part of a real if the next whole number is not above the real.
// Proof: proofs/tables.rs, a_lower_draw_detects_too
#[inline(always)]
#[must_use]
pub fn detects(draw: u32, odds_against: f64) -> bool {
    inverse_detects(draw, 1.0 + odds_against)
}

/// The same for 1/p, from 1 to infinity.
#[inline(always)]
fn inverse_detects(draw: u32, inverse_probability: f64) -> bool {
    is_below(draw, DRAWS / inverse_probability)
}

/// Whether a draw is below the whole part of a real: the next whole number is not above it.
#[inline(always)]
pub(crate) fn is_below(draw: u32, real: f64) -> bool {
    f64::from(draw) + 1.0 <= real
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::config::Preset;

    fn near(a: f64, b: f64, tolerance: f64) {
        assert!((a - b).abs() < tolerance, "{a} is not {b}");
    }

    /// Worked by hand from the radar equation: λ = 0.0516883548...; see docs/model.md.
    #[test]
    fn hand_worked_sensing_snr() {
        let config = Config {
            range_resolution_m: Some(0.0),
            ..Config::default()
        };
        near(snr_db(&config, 25.0), 7.37, 0.005);
        near(snr_db(&config, 50.0), -4.67, 0.005);
        near(snr_db(&config, 100.0), -16.71, 0.005);
        // The linear form of the paper, term by term.
        let lambda: f64 = 299_792_458.0 / 5.8e9;
        let watts = 0.1 * 10f64.powf(0.2) * 10f64.powf(0.2) * lambda * lambda
            / ((4.0 * core::f64::consts::PI).powi(3) * 50f64.powi(4));
        near(
            snr_db(&config, 50.0),
            10.0 * (watts / 1e-12).log10() + 8.0,
            1e-9,
        );
    }

    #[test]
    fn threshold_and_penalty() {
        near(detection_threshold_db(&Config::default()), 13.1, 0.05);
        near(
            resolution_penalty_db(&Config::default(), 25.0),
            0.252_7,
            1e-3,
        );
        let given = Config {
            detection_threshold_db: Some(-3.5),
            ..Config::default()
        };
        assert_eq!(detection_threshold_db(&given), -3.5);
    }

    /// Worked by hand: 7.37 dB at 25 m (above) less 40 log10(150/25) = 31.13 dB is -23.75 dB at 150
    /// m. The range resolution takes off another 10 log10(1 + 1.499/150) = 0.043 dB.
    #[test]
    fn a_sensing_range_is_a_threshold_unless_one_is_given() {
        let ranged = Config {
            sensing_range_m: Some(150.0),
            ..Config::default()
        };
        near(detection_threshold_db(&ranged), -23.80, 0.01);
        let coarse = Config {
            range_resolution_m: Some(0.0),
            ..ranged
        };
        near(detection_threshold_db(&coarse), 7.37 - 31.126, 0.006);
        let given = Config {
            detection_threshold_db: Some(-3.5),
            ..ranged
        };
        assert_eq!(detection_threshold_db(&given), -3.5);
        for preset in [Preset::Paper, Preset::Search] {
            assert_eq!(
                detection_threshold_db(&Config::preset(preset)),
                detection_threshold_db(&ranged)
            );
        }
    }

    /// p · 2^32 as a whole number.
    fn detection_threshold(odds_against: f64) -> u64 {
        (DRAWS / (1.0 + odds_against)) as u64
    }

    #[test]
    fn a_draw_detects_where_it_is_below_the_threshold() {
        for step in 0..400_000u64 {
            let bits = step.wrapping_mul(0x9E37_79B9_7F4A_7C15);
            // Odds of every magnitude, and draws around the threshold.
            let odds = libm::exp2((bits >> 44) as f64 / 8192.0 - 64.0);
            let threshold = detection_threshold(odds);
            for draw in [
                bits as u32,
                threshold.wrapping_sub(2) as u32,
                threshold.wrapping_sub(1) as u32,
                threshold as u32,
                threshold.wrapping_add(1) as u32,
            ] {
                let below = u64::from(draw) < threshold;
                assert_eq!(detects(draw, odds), below, "{draw} {odds:e}");
            }
        }
        for odds in [0.0, 1.0, 1e131, f64::MAX] {
            for draw in [0, 1, u32::MAX - 1, u32::MAX] {
                assert_eq!(
                    detects(draw, odds),
                    u64::from(draw) < detection_threshold(odds)
                );
            }
        }
    }

    #[test]
    fn thresholds_span_the_draws() {
        assert_eq!(detection_threshold(0.0), 1 << 32);
        assert_eq!(detection_threshold(1.0), 1 << 31);
        assert_eq!(detection_threshold(f64::MAX), 0);
    }
}
