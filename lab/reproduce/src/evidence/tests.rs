//! Effects of made-up results.

use super::*;
use crate::verdict::{Region, Verdict, verdict};
use jcas_core::rng::{self, Purpose};
use std::f64::consts::TAU;

fn exact(value: f64) -> Measured {
    Measured {
        value,
        error: 1.0,
        freedom: f64::INFINITY,
    }
}

// numpy.diff([94.3, 83.2, 76.5, 69.5], 2) is [4.4, -0.3]. Its mean is (-94.3 + 83.2 + 76.5 …)
// by weights (1, -1, -1, 1)/2, so that unit errors make 1.
#[test]
fn saturation_is_the_mean_of_second_differences() {
    let second = second_difference(&[94.3, 83.2, 76.5, 69.5].map(exact));
    assert!((second.value - 2.05).abs() < 1e-9, "{second:?}");
    assert!((second.error - 1.0).abs() < 1e-9, "{second:?}");
    let three = second_difference(&[9.0, 5.0, 4.0].map(exact));
    assert!((three.value - 3.0).abs() < 1e-9);
    assert!((three.error - 6f64.sqrt()).abs() < 1e-9);
}

// scipy 1.17.1: y = [k + (-1)**(k + 41) for k in range(21)].
// The line is r = stats.linregress(range(21), y).
// The value is r.slope * 21 over the root of the sum of squared residuals over 19.
#[test]
fn a_late_change_is_in_units_of_the_scatter() {
    let noise = |k: usize| if k.is_multiple_of(2) { 1.0 } else { -1.0 };
    let rising: Vec<f64> = (0..62).map(|k| k as f64 + noise(k)).collect();
    let change = late_change(&rising).unwrap();
    assert!((change - 19.997_670_318_860_102).abs() < 1e-9, "{change}");
    assert!(late_change(&rising[..50]).is_none());
}

/// The rule's two error rates for curves that are perfectly flat but for noise.
#[test]
fn flat_trainings_pass_and_hardly_ever_fail() {
    let region = Region::Between(-1.0, 1.0).ends(None);
    let mut told = [0, 0];
    for set in 0..400u32 {
        let curve = |training: u32| {
            let value = |k: u32| {
                let words = rng::block(5, set, training, k, Purpose::Policy);
                let uniform = |word: u32| (f64::from(word) + 0.5) / 4_294_967_296.0;
                (-2.0 * uniform(words[0]).ln()).sqrt() * (TAU * uniform(words[1])).cos()
            };
            late_change(&(0..62).map(value).collect::<Vec<f64>>()).unwrap()
        };
        let changes: Vec<f64> = (0..20).map(curve).collect();
        match verdict(&[Effect::Plain(mean(&changes).unwrap())], region) {
            Verdict::Holds => told[0] += 1,
            Verdict::Fails => told[1] += 1,
            _ => {}
        }
    }
    assert!(told[0] >= 396 && told[1] == 0, "{told:?}");
}

// 0.20 kWh over 8e-4 + 2e-4 + 5e-5 kWh.
#[test]
fn the_battery_lasts_longer_than_the_horizon() {
    let measured = endurance(&Config::preset(Preset::Paper));
    let [Effect::Plain(steps)] = measured.effects[..] else {
        panic!("one number");
    };
    assert!((steps.value - 0.20 / 0.00105).abs() < 1e-9);
}
