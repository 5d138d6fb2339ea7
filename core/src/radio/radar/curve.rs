//! Detection curves: the probability of detection over the SNR, with the gain of the pilots.
//!
//! Each probability has two parts. The model tabulates a value for the range, and a step computes
//! a factor for each UAV from its pilot density.

use libm::{exp, log};

use super::{EXPONENT_BOUND, bounded, detection_threshold_db, load_odds_against, odds_against};
use super::{inverse_detects, range_odds_against, snr_db, table};
use crate::config::{Config, DetectionCurve, PilotGain};
use crate::lanes::real;

/// ln(10)/10: a level in decibels times this is the natural logarithm of its ratio.
const PER_DB: f64 = core::f64::consts::LN_10 / 10.0;

/// Least ratio of a pilot density to the highest one; a density of 0 counts as this.
const DENSITY_RATIO_MIN: f64 = 1e-30;

/// Bound of a UAV's exponent of the odds against detection. The odds of every range times the odds
/// at this bound are finite, and no draw detects at them.
const UAV_EXPONENT_BOUND: f64 = 380.0;

/// A detection curve, for the loop over UAVs and hotspots.
pub trait Curve {
    /// The factor of a UAV with a pilot density from 0 to ρ_max.
    fn factor(&self, density: f64) -> f64;

    /// 1/P_d for a range's tabulated value and a UAV's factor; from 1 to infinity.
    fn inverse_probability(&self, tabulated: f64, factor: f64) -> f64;

    /// Whether a 32-bit draw is below the whole part of P_d · 2^32.
    #[inline(always)]
    fn detects(&self, draw: u32, tabulated: f64, factor: f64) -> bool {
        inverse_detects(draw, self.inverse_probability(tabulated, factor))
    }
}

/// The logistic curve without a gain of the pilots, as in the paper. Its tabulated value and its
/// factor are odds against detection.
#[derive(Clone, Copy, Debug)]
pub struct Logistic {
    loss_per_load: f64,
}

impl Curve for Logistic {
    #[inline(always)]
    fn factor(&self, density: f64) -> f64 {
        load_odds_against(self.loss_per_load, 1.0 - density)
    }

    #[inline(always)]
    fn inverse_probability(&self, tabulated: f64, factor: f64) -> f64 {
        1.0 + odds_against(tabulated, factor)
    }

    #[inline(always)]
    fn detects(&self, draw: u32, tabulated: f64, factor: f64) -> bool {
        super::detects(draw, odds_against(tabulated, factor))
    }
}

/// The logistic curve with coherent integration of the pilots.
#[derive(Clone, Copy, Debug)]
pub struct Coherent {
    pub(crate) loss_per_load: f64,
    /// 10 κ/ln 10: the exponent of the odds for each unit of ln(ρ/ρ_max).
    pub(crate) odds_per_log: f64,
    pub(crate) density_max: f64,
}

impl Curve for Coherent {
    /// exp(κ (α (1 - ρ) - 10 log10(ρ/ρ_max))).
    #[inline(always)]
    fn factor(&self, density: f64) -> f64 {
        let ratio = density / self.density_max;
        let ratio = if ratio > DENSITY_RATIO_MIN {
            ratio
        } else {
            DENSITY_RATIO_MIN
        };
        let exponent = self.loss_per_load * (1.0 - density) - self.odds_per_log * log(ratio);
        exp(bounded(exponent, UAV_EXPONENT_BOUND))
    }

    #[inline(always)]
    fn inverse_probability(&self, tabulated: f64, factor: f64) -> f64 {
        1.0 + odds_against(tabulated, factor)
    }
}

/// A Swerling-1 echo behind a square-law detector, in one look: P_d = P_fa^(1/(1 + SNR)). Its
/// tabulated value is an SNR as a ratio, and its factor the part of it that a UAV's pilots leave.
///
/// M. A. Richards, "Fundamentals of Radar Signal Processing", chapter 6.
#[derive(Clone, Copy, Debug)]
pub struct Swerling1 {
    /// -ln P_fa.
    pub(crate) false_alarm_exponent: f64,
    /// α ln(10)/10.
    pub(crate) loss_per_load: f64,
    /// 1/ρ_max with a coherent gain of the pilots, otherwise 0.
    pub(crate) gain_per_density: f64,
    /// 0 with a coherent gain of the pilots, otherwise 1.
    pub(crate) gain_constant: f64,
}

impl Curve for Swerling1 {
    /// 10^(-α (1 - ρ)/10), times ρ/ρ_max with a coherent gain.
    #[inline(always)]
    fn factor(&self, density: f64) -> f64 {
        let loss = real::exp(self.loss_per_load * (1.0 - density));
        (self.gain_constant + density * self.gain_per_density) / loss
    }

    /// P_fa^(-1/(1 + SNR)).
    #[inline(always)]
    fn inverse_probability(&self, tabulated: f64, factor: f64) -> f64 {
        real::exp(self.false_alarm_exponent / (1.0 + tabulated * factor))
    }
}

/// The detection curve of a configuration.
#[derive(Clone, Copy, Debug)]
pub enum AnyCurve {
    /// The paper's, or a table.
    Logistic(Logistic),
    /// The same with coherent integration of the pilots.
    Coherent(Coherent),
    /// The curve of a fluctuating echo.
    Swerling1(Swerling1),
}

impl AnyCurve {
    /// The curve of a legal configuration.
    #[must_use]
    pub fn of(config: &Config) -> Self {
        let coherent = config.pilot_gain == PilotGain::Coherent;
        let density_max = config.pilot_density_max;
        let slope_per_db = config.logistic_slope_per_db;
        let loss_per_load = slope_per_db * config.comm_load_penalty_db;
        match config.detection_curve {
            DetectionCurve::Swerling1 => Self::Swerling1(Swerling1 {
                false_alarm_exponent: -log(config.false_alarm_probability),
                loss_per_load: config.comm_load_penalty_db * PER_DB,
                gain_per_density: if coherent { 1.0 / density_max } else { 0.0 },
                gain_constant: if coherent { 0.0 } else { 1.0 },
            }),
            DetectionCurve::Logistic | DetectionCurve::Table if coherent => {
                Self::Coherent(Coherent {
                    loss_per_load,
                    odds_per_log: slope_per_db / PER_DB,
                    density_max,
                })
            }
            DetectionCurve::Logistic | DetectionCurve::Table => {
                Self::Logistic(Logistic { loss_per_load })
            }
        }
    }

    /// P_d for a range's tabulated value and a pilot density.
    #[must_use]
    pub fn probability(&self, tabulated: f64, density: f64) -> f64 {
        fn of(curve: &impl Curve, tabulated: f64, density: f64) -> f64 {
            1.0 / curve.inverse_probability(tabulated, curve.factor(density))
        }
        match self {
            Self::Logistic(curve) => of(curve, tabulated, density),
            Self::Coherent(curve) => of(curve, tabulated, density),
            Self::Swerling1(curve) => of(curve, tabulated, density),
        }
    }
}

/// The value that a model tabulates for a range: odds against detection, or with `swerling1` the
/// SNR as a ratio. It is positive and finite.
#[must_use]
pub fn tabulated(config: &Config, range_m: f64) -> f64 {
    match config.detection_curve {
        DetectionCurve::Logistic => {
            let threshold_db = detection_threshold_db(config);
            range_odds_against(config, snr_db(config, range_m), threshold_db)
        }
        DetectionCurve::Swerling1 => exp(bounded(snr_db(config, range_m) * PER_DB, EXPONENT_BOUND)),
        DetectionCurve::Table => {
            // The table holds at ρ_max: the load's penalty there is in its values.
            let loss_per_load = config.logistic_slope_per_db * config.comm_load_penalty_db;
            let at_density_max = loss_per_load * (1.0 - config.pilot_density_max);
            let logit = table::logit_at(&config.detection_table, range_m);
            exp(bounded(-logit - at_density_max, EXPONENT_BOUND))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn swerling1() -> Config {
        Config {
            detection_curve: DetectionCurve::Swerling1,
            comm_load_penalty_db: 0.0,
            ..Config::default()
        }
    }

    fn near(a: f64, b: f64, tolerance: f64) {
        assert!((a - b).abs() < tolerance, "{a} is not {b}");
    }

    /// Values of P_fa^(1/(1 + SNR)) at P_fa = 1e-6, worked with another tool.
    #[test]
    fn swerling1_has_the_known_values() {
        let curve = AnyCurve::of(&swerling1());
        let at = |snr_db: f64| curve.probability(libm::pow(10.0, snr_db / 10.0), 0.3);
        near(at(10.0), 0.284_804, 1e-6);
        near(at(13.1), 0.524_631, 1e-6);
        near(at(20.0), 0.872_156, 1e-6);
        near(curve.probability(0.0, 0.3), 1e-6, 1e-18);
    }

    /// 10 log10(0.01/0.30) = -14.77 dB, and 10^(14.77/40) = 2.34.
    #[test]
    fn few_pilots_cost_their_share_of_the_gain_and_of_the_range() {
        let config = Config {
            pilot_gain: PilotGain::Coherent,
            range_resolution_m: Some(0.0),
            ..swerling1()
        };
        let AnyCurve::Swerling1(curve) = AnyCurve::of(&config) else {
            panic!("another curve");
        };
        let loss_db = 10.0 * libm::log10(curve.factor(0.01) / curve.factor(0.30));
        near(loss_db, -14.77, 0.005);
        let far = tabulated(&config, 100.0) * curve.factor(0.30);
        let near_by = tabulated(&config, 100.0 / 2.34) * curve.factor(0.01);
        near(far / near_by, 1.0, 0.005);
        // The logistic curve loses the same number of decibels.
        let config = Config {
            pilot_gain: PilotGain::Coherent,
            comm_load_penalty_db: 0.0,
            ..Config::default()
        };
        let AnyCurve::Coherent(curve) = AnyCurve::of(&config) else {
            panic!("another curve");
        };
        near(curve.factor(0.30), 1.0, 1e-15);
        near(log(curve.factor(0.01)) / 0.25, 14.77, 0.005);
    }

    /// Echoes of complex Gaussian amplitude in complex Gaussian noise: the power of their sum is
    /// exponential, and a square-law detector compares it with a threshold.
    #[test]
    fn a_million_gaussian_echoes_are_detected_as_often() {
        const LOOKS: u32 = 1_000_000;
        let config = Config {
            false_alarm_probability: 1e-3,
            ..swerling1()
        };
        let curve = AnyCurve::of(&config);
        let mut state = 1u64;
        let mut uniform = || {
            state = state.wrapping_add(0x9E37_79B9_7F4A_7C15);
            let mut bits = state;
            bits = (bits ^ (bits >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
            bits = (bits ^ (bits >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
            ((bits ^ (bits >> 31)) >> 11) as f64 / 9_007_199_254_740_992.0
        };
        // Box and Muller: two normal numbers of variance 1/2 are one complex Gaussian of power 1.
        let mut gaussian = || {
            let radius = libm::sqrt(-log(1.0 - uniform()));
            let angle = core::f64::consts::TAU * uniform();
            (radius * libm::cos(angle), radius * libm::sin(angle))
        };
        let threshold = -log(config.false_alarm_probability);
        for snr in [0.0, 1.0, 10.0] {
            let amplitude = libm::sqrt(snr);
            let mut detected = 0;
            for _ in 0..LOOKS {
                let (echo, noise) = (gaussian(), gaussian());
                let (i, q) = (amplitude * echo.0 + noise.0, amplitude * echo.1 + noise.1);
                detected += u32::from(i * i + q * q > threshold);
            }
            let p = curve.probability(snr, 0.3);
            let sigma = libm::sqrt(p * (1.0 - p) / f64::from(LOOKS));
            near(f64::from(detected) / f64::from(LOOKS), p, 3.0 * sigma);
        }
    }

    /// At ρ = 0 there is no pilot: the radar detects noise, or nothing at all.
    #[test]
    fn without_pilots_nothing_is_detected_but_noise() {
        let coherent = |config: Config| Config {
            pilot_gain: PilotGain::Coherent,
            pilot_density_min: 0.0,
            ..config
        };
        let config = coherent(swerling1());
        let blind = AnyCurve::of(&config).probability(tabulated(&config, 25.0), 0.0);
        near(blind, 1e-6, 1e-18);
        let config = coherent(Config::default());
        let curve = AnyCurve::of(&config);
        assert!(curve.probability(tabulated(&config, 25.0), 0.0) < 1e-30);
    }
}
