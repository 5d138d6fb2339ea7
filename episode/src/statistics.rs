//! Statistics of many episodes: means with 95 % intervals.

use jcas_core::Metrics;
use jcas_core::rng::{self, Purpose};
use serde::ser::{Serialize, SerializeMap, Serializer};
use statrs::distribution::{ContinuousCDF, Normal};
use statrs::statistics::{Data, OrderStatistics};

/// Number of resamples of a bootstrap interval.
const RESAMPLES: u32 = 2_000;
/// Seed of the resampling; it is fixed, so that the same episodes always have the same intervals.
const BOOTSTRAP_SEED: u64 = 0x6a63_6173_2d63_6931;
/// The quantity that reports for people leave out where it is 0, as without false alarms.
pub const FALSE_CONFIRMATIONS: &str = "false_confirmations_mean";
/// Fraction of the distribution on either side of an interval.
const TAIL: f64 = 0.025;

/// A value and its 95 % interval.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Estimate {
    /// The value.
    pub value: f64,
    /// Lower end.
    pub low: f64,
    /// Upper end.
    pub high: f64,
}

/// Returns the Wilson score interval of a proportion.
///
/// E. B. Wilson, "Probable inference, the law of succession, and statistical inference", JASA 22,
/// 1927. Unlike the textbook interval it stays within 0 to 1 and does not vanish where all or none
/// succeed.
#[must_use]
pub fn wilson(successes: u64, trials: u64) -> Estimate {
    if trials == 0 {
        return Estimate {
            value: 0.0,
            low: 0.0,
            high: 1.0,
        };
    }
    let z = Normal::standard().inverse_cdf(1.0 - TAIL);
    let n = trials as f64;
    let p = successes as f64 / n;
    let centre = (p + z * z / (2.0 * n)) / (1.0 + z * z / n);
    let half = z / (1.0 + z * z / n) * (p * (1.0 - p) / n + z * z / (4.0 * n * n)).sqrt();
    // At the ends the interval touches 0 or 1 exactly, which rounding would miss.
    Estimate {
        value: p,
        low: if successes == 0 { 0.0 } else { centre - half },
        high: if successes == trials {
            1.0
        } else {
            centre + half
        },
    }
}

/// Returns the means of several quantities of the same episodes, each with its bootstrap percentile
/// interval.
///
/// All quantities share the resamples, which depend only on the number of episodes.
#[must_use]
pub fn bootstrap_means<const K: usize>(episodes: &[[f64; K]]) -> [Estimate; K] {
    let count = episodes.len();
    if count == 0 {
        return [Estimate::default(); K];
    }
    let mut means: [Vec<f64>; K] = std::array::from_fn(|_| Vec::with_capacity(RESAMPLES as usize));
    for resample in 0..RESAMPLES {
        let mut sums = [0.0; K];
        let mut words = [0u32; 4];
        for draw in 0..count {
            if draw % 4 == 0 {
                words = rng::block(
                    BOOTSTRAP_SEED,
                    resample,
                    0,
                    (draw / 4) as u32,
                    Purpose::Policy,
                );
            }
            let pick = (u64::from(words[draw % 4]) * count as u64) >> 32;
            for (sum, value) in sums.iter_mut().zip(episodes[pick as usize]) {
                *sum += value;
            }
        }
        for (mean, sum) in means.iter_mut().zip(sums) {
            mean.push(sum / count as f64);
        }
    }
    std::array::from_fn(|k| {
        let mut resampled = Data::new(means[k].as_mut_slice());
        Estimate {
            value: episodes.iter().map(|episode| episode[k]).sum::<f64>() / count as f64,
            low: resampled.quantile(TAIL),
            high: resampled.quantile(1.0 - TAIL),
        }
    })
}

/// Returns the time of each episode in steps. A failed episode counts its horizon, so that a policy
/// cannot look fast by failing the long episodes.
#[must_use]
pub fn mission_steps(episodes: &[Metrics], horizon_steps: u32) -> Vec<u32> {
    let steps = |metrics: &Metrics| {
        if metrics.terminated {
            metrics.steps
        } else {
            horizon_steps
        }
    };
    episodes.iter().map(steps).collect()
}

/// Returns the least value that at least this share of the values does not exceed; none of none.
#[must_use]
pub fn quantile(values: &[u32], share: f64) -> Option<u32> {
    let mut sorted = values.to_vec();
    sorted.sort_unstable();
    let rank = (share * values.len() as f64).ceil() as usize;
    sorted.get(rank.saturating_sub(1)).copied()
}

/// Returns the mean of a - b over pairs of episodes with common seeds, with the bootstrap interval
/// of the pairs. What both policies owe to an episode cancels.
#[must_use]
pub fn paired_difference(a: &[u32], b: &[u32]) -> Estimate {
    let pairs = a.iter().zip(b);
    let differences: Vec<[f64; 1]> = pairs
        .map(|(&a, &b)| [f64::from(a) - f64::from(b)])
        .collect();
    bootstrap_means(&differences)[0]
}

/// Statistics of a set of episodes.
///
/// Serialises flat: each quantity under its name in [`Summary::quantities`], its interval's ends
/// under that name with `_low` and `_high`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Summary {
    /// Number of episodes.
    pub episodes: u64,
    /// Fraction of episodes in which every UAV knows every hotspot within the horizon.
    pub success_rate: Estimate,
    /// Mission time in steps; see [`mission_steps`].
    pub mission_steps: Estimate,
    /// Energy that the whole fleet spent in an episode.
    pub energy_kwh: Estimate,
    /// CO2 of the energy that the fleet drew from the grid in an episode.
    pub co2_kg: Estimate,
    /// Normalised throughput, averaged over UAVs and steps.
    pub throughput: Estimate,
    /// Number of confirmed hotspots.
    pub confirmed: Estimate,
    /// Number of cells without a hotspot that a quorum confirmed; 0 without false alarms.
    pub false_confirmations: Estimate,
    /// Pilot density, averaged over UAVs and steps.
    pub pilot_density: Estimate,
    /// Undiscounted team reward of an episode.
    pub episode_return: Estimate,
}

/// A quantity of a [`Summary`]: its name in JSON and CSV, its unit, its value.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Quantity {
    /// Name in JSON and CSV.
    pub name: &'static str,
    /// Readable name.
    pub title: &'static str,
    /// Unit; empty for a pure number.
    pub unit: &'static str,
    /// Value and interval.
    pub estimate: Estimate,
}

impl Summary {
    /// Returns the statistics of episodes with the given horizon.
    #[must_use]
    pub fn of(episodes: &[Metrics], horizon_steps: u32) -> Self {
        let successes = episodes.iter().filter(|metrics| metrics.terminated).count();
        let rows: Vec<[f64; 8]> = episodes
            .iter()
            .zip(mission_steps(episodes, horizon_steps))
            .map(|(metrics, steps)| {
                [
                    f64::from(steps),
                    metrics.energy_kwh,
                    metrics.co2_kg,
                    metrics.throughput_mean,
                    f64::from(metrics.confirmed),
                    f64::from(metrics.false_confirmations),
                    metrics.pilot_density_mean,
                    metrics.return_sum,
                ]
            })
            .collect();
        let [
            mission_steps,
            energy_kwh,
            co2_kg,
            throughput,
            confirmed,
            false_confirmations,
            pilot_density,
            episode_return,
        ] = bootstrap_means(&rows);
        Self {
            episodes: episodes.len() as u64,
            success_rate: wilson(successes as u64, episodes.len() as u64),
            mission_steps,
            energy_kwh,
            co2_kg,
            throughput,
            confirmed,
            false_confirmations,
            pilot_density,
            episode_return,
        }
    }

    /// Every quantity, in the order of reports.
    #[must_use]
    pub fn quantities(&self) -> [Quantity; 9] {
        let quantity = |name, title, unit, estimate| Quantity {
            name,
            title,
            unit,
            estimate,
        };
        [
            quantity("success_rate", "success rate", "", self.success_rate),
            quantity(
                "mission_steps_mean",
                "mission time",
                "steps",
                self.mission_steps,
            ),
            quantity("energy_kwh_mean", "energy spent", "kWh", self.energy_kwh),
            quantity("co2_kg_mean", "CO2", "kg", self.co2_kg),
            quantity("throughput_mean", "throughput", "", self.throughput),
            quantity("confirmed_mean", "hotspots confirmed", "", self.confirmed),
            quantity(
                FALSE_CONFIRMATIONS,
                "falsely confirmed",
                "",
                self.false_confirmations,
            ),
            quantity(
                "pilot_density_mean",
                "pilot density",
                "",
                self.pilot_density,
            ),
            quantity("return_mean", "return", "", self.episode_return),
        ]
    }
}

impl Serialize for Summary {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(None)?;
        map.serialize_entry("episodes", &self.episodes)?;
        for quantity in self.quantities() {
            map.serialize_entry(quantity.name, &quantity.estimate.value)?;
            map.serialize_entry(&format!("{}_low", quantity.name), &quantity.estimate.low)?;
            map.serialize_entry(&format!("{}_high", quantity.name), &quantity.estimate.high)?;
        }
        map.end()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// R: `quantile(x, share, type = 1)`.
    #[test]
    fn quantiles_equal_published_ones() {
        let values = [7, 3, 10, 1, 9, 2, 8, 4, 6, 5];
        for (share, expected) in [(0.0, 1), (0.5, 5), (0.51, 6), (0.9, 9), (1.0, 10)] {
            assert_eq!(quantile(&values, share), Some(expected), "{share}");
        }
        assert_eq!(quantile(&[], 0.5), None);
    }

    /// Two policies that differ by one step in every episode differ by one step without noise, and
    /// a failed episode counts its horizon.
    #[test]
    fn pairs_cancel_what_missions_have_in_common() {
        let episode = |steps, terminated| Metrics {
            steps,
            terminated,
            ..Metrics::default()
        };
        let slow = [episode(11, true), episode(41, true), episode(3, false)];
        let slow = mission_steps(&slow, 100);
        assert_eq!(slow, [11, 41, 100]);
        let one = paired_difference(&slow, &[10, 40, 99]);
        assert_eq!((one.value, one.low, one.high), (1.0, 1.0, 1.0));
        let both = paired_difference(&[1, 2], &[2, 1]);
        assert_eq!((both.value, both.low, both.high), (0.0, -1.0, 1.0));
    }

    /// R: `prop.test(x, n, correct = FALSE)$conf.int`.
    #[test]
    fn wilson_intervals_equal_published_ones() {
        for (successes, trials, low, high) in [
            (0, 10, 0.0, 0.277_532_799_862_889_3),
            (5, 10, 0.236_593_090_512_564_06, 0.763_406_909_487_436),
            (10, 10, 0.722_467_200_137_110_7, 1.0),
        ] {
            let got = wilson(successes, trials);
            assert!((got.low - low).abs() < 1e-9, "{got:?}");
            assert!((got.high - high).abs() < 1e-9, "{got:?}");
        }
    }

    #[test]
    fn bootstrap_intervals_are_near_those_of_the_central_limit() {
        let episodes: Vec<[f64; 1]> = (0..400).map(|k| [f64::from(k % 20)]).collect();
        let [got] = bootstrap_means(&episodes);
        let half = 1.96 * (399.0f64 / 12.0 / 400.0).sqrt();
        assert!((got.value - 9.5).abs() < 1e-12);
        assert!((got.low - (9.5 - half)).abs() < 0.1, "{got:?}");
        assert!((got.high - (9.5 + half)).abs() < 0.1, "{got:?}");
        assert_eq!(bootstrap_means(&episodes), [got]);
    }
}
