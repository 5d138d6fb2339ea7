//! P13: what a detection curve computes for a UAV is finite and in range.
//!
//! As for the tables, Kani sees `exp` and `log` through stubs that return any value within a range.
//! The tests of `dense` show that the real functions stay within it.

use super::inputs::real_between;
#[cfg(not(kani))]
use super::standin as kani;
use super::tables::{ODDS_MAX, ODDS_MIN};
use crate::config::{Config, DetectionCurve, DetectionTable};
use crate::radio::radar::curve::{Coherent, Curve, Swerling1, tabulated};

/// Bounds of `exp` on [-380, 380], where a UAV's exponent is clipped to.
pub(super) const UAV_ODDS_MIN: f64 = 1e-166;
pub(super) const UAV_ODDS_MAX: f64 = 1e166;
/// Bound of `log` on [1e-30, 1e4].
pub(super) const LOG_MAX: f64 = 70.0;
/// Bounds of `log` on [5e-324, 1].
pub(super) const LOG_PROBABILITY_MIN: f64 = -745.0;
/// Largest -ln P_fa, rounded up, and a bound of its exponential.
pub(super) const FALSE_ALARM_EXPONENT_MAX: f64 = 27.7;
pub(super) const INVERSE_PROBABILITY_MAX: f64 = 1.1e12;

/// The odds against detection with coherent pilots are a positive number.
#[cfg_attr(kani, kani::proof)]
#[cfg_attr(kani, kani::stub(libm::exp, crate::proofs::stubs::any_uav_exp))]
#[cfg_attr(kani, kani::stub(libm::log, crate::proofs::stubs::any_log))]
pub fn odds_with_coherent_pilots_are_finite() {
    let curve = Coherent {
        loss_per_load: real_between(0.0, 200.0),
        odds_per_log: 1.0857,
        density_max: 0.3,
    };
    let factor = curve.factor(real_between(0.0, 0.3));
    let inverse = curve.inverse_probability(real_between(ODDS_MIN, ODDS_MAX), factor);
    kani::cover!(factor > 1e100, "as good as no pilots");
    kani::cover!(factor < 2.0, "all pilots");
    assert!(factor >= UAV_ODDS_MIN && factor <= UAV_ODDS_MAX);
    assert!(inverse >= 1.0 && inverse <= 1e300);
}

/// The probability of detection of a Swerling-1 echo lies between P_fa and 1.
#[cfg_attr(kani, kani::proof)]
#[cfg_attr(
    kani,
    kani::stub(crate::lanes::real::exp, crate::proofs::stubs::any_real_exp)
)]
pub fn swerling1_gives_a_probability() {
    let curve = Swerling1 {
        false_alarm_exponent: real_between(2.3, FALSE_ALARM_EXPONENT_MAX),
        loss_per_load: real_between(0.0, 4.7),
        gain_per_density: 1.0 / 0.3,
        gain_constant: 0.0,
    };
    let factor = curve.factor(real_between(0.0, 0.3));
    let inverse = curve.inverse_probability(real_between(ODDS_MIN, ODDS_MAX), factor);
    kani::cover!(factor == 0.0, "no pilots");
    kani::cover!(factor > 0.5, "most pilots");
    assert!(factor >= 0.0 && factor <= 1.1);
    assert!(inverse >= 1.0 && inverse <= INVERSE_PROBABILITY_MAX);
}

/// The odds against detection that a table gives are a positive number.
#[cfg_attr(kani, kani::proof)]
#[cfg_attr(kani, kani::stub(libm::exp, crate::proofs::stubs::any_odds_exp))]
#[cfg_attr(kani, kani::stub(libm::log, crate::proofs::stubs::any_log_probability))]
pub fn a_table_gives_positive_odds() {
    let probability = real_between(5e-324, 1.0 - f64::EPSILON / 2.0);
    let point = (real_between(0.0, 1e6), probability).into();
    let config = Config {
        detection_curve: DetectionCurve::Table,
        detection_table: DetectionTable::from_slice(&[point]).unwrap_or(DetectionTable::EMPTY),
        comm_load_penalty_db: real_between(0.0, 20.0),
        ..Config::default()
    };
    let odds = tabulated(&config, real_between(0.0, 1.5e9));
    kani::cover!(probability < 1e-300, "as good as never");
    kani::cover!(probability > 0.5, "likely");
    assert!(odds >= ODDS_MIN && odds <= ODDS_MAX);
}

#[cfg(not(kani))]
super::standin::twins! {
    odds_with_coherent_pilots_are_finite: 4000 cases, 2 covers;
    swerling1_gives_a_probability: 4000 cases, 2 covers;
    a_table_gives_positive_odds: 4000 cases, 2 covers;
}

/// The real functions on dense grids of what the stubs assume.
#[cfg(test)]
mod dense {
    use super::*;
    use crate::lanes::real;

    #[test]
    fn exp_stays_within_its_stubs() {
        for step in -380_000..=380_000 {
            let value = libm::exp(f64::from(step) / 1000.0);
            assert!((UAV_ODDS_MIN..=UAV_ODDS_MAX).contains(&value), "{step}");
        }
        for step in 0..=27_700 {
            let value = real::exp(f64::from(step) / 1000.0);
            assert!((1.0..=INVERSE_PROBABILITY_MAX).contains(&value), "{step}");
        }
    }

    #[test]
    fn log_stays_within_its_stub() {
        for step in -30_000..=4_000 {
            let value = libm::log(libm::pow(10.0, f64::from(step) / 1000.0));
            assert!((-LOG_MAX..=LOG_MAX).contains(&value), "{step}: {value}");
        }
    }

    #[test]
    fn log_of_a_probability_stays_within_its_stub() {
        let least = f64::from_bits(1);
        for value in (0..=323_000)
            .map(|step| libm::pow(10.0, f64::from(-step) / 1000.0))
            .chain([least])
        {
            let log = libm::log(value);
            assert!((LOG_PROBABILITY_MIN..=0.0).contains(&log), "{value}: {log}");
        }
    }
}
