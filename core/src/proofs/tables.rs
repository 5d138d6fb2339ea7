//! P13: what a model tabulates is finite and in range.
//!
//! libm on symbolic input does not finish, so Kani sees `exp` and `log10` through stubs that return
//! any value within a range. That the real functions stay within it is tested in `dense`.

use super::inputs::real_between;
#[cfg(not(kani))]
use super::standin as kani;
use crate::config::Config;
use crate::radio::link::full_throughput;
use crate::radio::radar::{detects, is_below, odds_against, range_odds_against, snr_db};

/// Bounds of `exp` on [-700, 700]; infinite beyond in neither direction that a table asks for.
pub(super) const EXP_MIN: f64 = 1e-305;
pub(super) const EXP_MAX: f64 = 1e305;
/// Bounds of `exp` on [-300, 300], where the odds against detection are clipped to.
pub(super) const ODDS_MIN: f64 = 1e-131;
pub(super) const ODDS_MAX: f64 = 1e131;
/// Bounds of `log10` on [1e-12, 1e18].
pub(super) const LOG10_MAX: f64 = 18.0;
/// Bound of `exp(κ α ρ)` for legal κ, α and ρ.
pub(super) const LOAD_ODDS_MAX: f64 = 1e87;
/// Bounds of `log2(1 + x)` for x in [0, 1e305].
pub(super) const LOG2_MAX: f64 = 1015.0;

/// Legal ranges, from half a cell of a millimetre to across the largest grid.
const RANGE_MIN_M: f64 = 0.0005;
const RANGE_MAX_M: f64 = 1.5e9;

/// The odds against detection at a range are a positive number.
fn odds_are_positive(config: &Config, range_m: f64, threshold_db: f64) {
    let odds = range_odds_against(config, snr_db(config, range_m), threshold_db);
    assert!(odds >= ODDS_MIN && odds <= ODDS_MAX);
}

#[cfg_attr(kani, kani::proof)]
#[cfg_attr(kani, kani::stub(libm::exp, crate::proofs::stubs::any_odds_exp))]
#[cfg_attr(kani, kani::stub(libm::log10, crate::proofs::stubs::any_log10))]
pub fn tabulated_odds_are_positive() {
    let config = Config {
        logistic_slope_per_db: real_between(0.0, 10.0),
        ..Config::default()
    };
    let range_m = real_between(RANGE_MIN_M, RANGE_MAX_M);
    let threshold_db = real_between(-300.0, 300.0);
    kani::cover!(range_m > 1e6, "far");
    kani::cover!(range_m < 1.0, "near");
    odds_are_positive(&config, range_m, threshold_db);
}

/// A waveform's full throughput is a number that is not negative.
fn throughput_is_a_number(config: &Config, range_m: f64) {
    let throughput = full_throughput(config, range_m);
    assert!(throughput >= 0.0 && throughput <= LOG2_MAX);
}

#[cfg_attr(kani, kani::proof)]
#[cfg_attr(kani, kani::stub(libm::exp, crate::proofs::stubs::any_exp))]
#[cfg_attr(kani, kani::stub(libm::log10, crate::proofs::stubs::any_log10))]
#[cfg_attr(kani, kani::stub(libm::log2, crate::proofs::stubs::any_log2))]
pub fn tabulated_throughput_is_a_number() {
    let config = Config::default();
    let range_m = real_between(RANGE_MIN_M, RANGE_MAX_M);
    kani::cover!(range_m > 1e6, "far");
    kani::cover!(range_m < 1.0, "near");
    throughput_is_a_number(&config, range_m);
}

/// Where a draw detects, a lower one does: both are compared with the same real.
fn is_a_threshold(low: u32, high: u32, real: f64) {
    assert!(!is_below(high, real) || is_below(low, real));
}

/// What [`detects`] compares a draw with is 2^32 over 1 and the odds: from 0 to 2^32.
#[cfg_attr(kani, kani::proof)]
pub fn a_lower_draw_detects_too() {
    let real = real_between(0.0, 4_294_967_296.0);
    let (low, high): (u32, u32) = (kani::any(), kani::any());
    kani::assume(low <= high);
    kani::cover!(real == 4_294_967_296.0, "certain");
    kani::cover!(real < 1.0, "as good as never");
    is_a_threshold(low, high, real);
    assert!(detects(high, 0.0));
}

/// A range's odds times a load's are a finite number.
#[cfg_attr(kani, kani::proof)]
#[cfg_attr(kani, kani::solver(cadical))]
pub fn odds_of_a_draw_are_finite() {
    let range_odds = real_between(ODDS_MIN, ODDS_MAX);
    let load_odds = real_between(1.0, LOAD_ODDS_MAX);
    let odds = odds_against(range_odds, load_odds);
    kani::cover!(odds > 1e200, "as good as never");
    kani::cover!(odds < 1e-100, "as good as certain");
    assert!(odds >= 0.0 && odds <= 1e300);
}

#[cfg(not(kani))]
super::standin::twins! {
    tabulated_odds_are_positive: 4000 cases, 2 covers;
    tabulated_throughput_is_a_number: 4000 cases, 2 covers;
    a_lower_draw_detects_too: 2000 cases, 2 covers;
    odds_of_a_draw_are_finite: 2000 cases, 2 covers;
}

/// The real functions on dense grids of what the stubs assume.
#[cfg(test)]
mod dense {
    use super::*;
    use crate::radio::radar::load_odds_against;

    #[test]
    fn exp_stays_within_its_stub() {
        for step in -700_000..=700_000 {
            let value = libm::exp(f64::from(step) / 1000.0);
            assert!(
                (EXP_MIN..=EXP_MAX).contains(&value),
                "exp({step}/1000) = {value}"
            );
            if (-300_000..=300_000).contains(&step) {
                assert!((ODDS_MIN..=ODDS_MAX).contains(&value), "{step}: {value}");
            }
        }
    }

    #[test]
    fn log10_stays_within_its_stub() {
        for step in -12_000..=18_000 {
            let x = libm::pow(10.0, f64::from(step) / 1000.0);
            // The ends of the grid may round to just beside the stub's domain.
            if (1e-12..=1e18).contains(&x) {
                let value = libm::log10(x);
                assert!(
                    (-LOG10_MAX..=LOG10_MAX).contains(&value),
                    "log10({x}) = {value}"
                );
            }
        }
    }

    /// exp(κ α ρ) for every legal product κ α up to 200 and every load.
    #[test]
    fn load_odds_stay_within_their_stub() {
        for product in 0..=200 {
            for load in 0..=100 {
                let odds = load_odds_against(f64::from(product), f64::from(load) / 100.0);
                assert!(
                    (1.0..=LOAD_ODDS_MAX).contains(&odds),
                    "{product} {load}: {odds}"
                );
            }
        }
    }

    #[test]
    fn log2_stays_within_its_stub() {
        for step in 0..=30_500 {
            let x = 1.0 + libm::pow(10.0, f64::from(step) / 100.0);
            let value = libm::log2(x);
            assert!((0.0..=LOG2_MAX).contains(&value), "log2({x}) = {value}");
        }
        assert_eq!(libm::log2(1.0), 0.0);
    }
}
