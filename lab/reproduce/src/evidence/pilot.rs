//! What the results say about an adaptive pilot density beside a constant one.

use super::{Cells, Evidence, Measurement, in_common, listed, of_several, ratio, signed, told};
use crate::campaign::OURS;
use crate::cell_means::over_hotspots;
use crate::fit::PAPER;
use crate::pilot_by_distance::Approach;
use crate::statistics::{Measured, combination, mean};
use crate::table::Quantity;
use crate::verdict::Effect;
use jcas_core::Config;

impl Evidence<'_> {
    /// The gap for each number of hotspots, in points; none where neither policy ever succeeds,
    /// which says nothing about pilots.
    fn gaps(&self, uavs: u32) -> Option<Cells> {
        let [adaptive, constant] = self.pilots(Quantity::Success, uavs)?;
        let succeed = adaptive.values().chain(constant.values());
        if succeed.map(|cell| cell.value).sum::<f64>() == 0.0 {
            return None;
        }
        let gap = |(n, &cell): (&u32, &Measured)| {
            (*n, combination([(100.0, cell), (-100.0, constant[n])]))
        };
        Some(adaptive.iter().map(gap).collect())
    }

    pub(super) fn pilot_gap(&self, uavs: u32) -> Option<Measurement> {
        let gaps = self.gaps(uavs)?;
        let effect = Effect::Plain(over_hotspots(&gaps));
        Some(Measurement {
            words: signed(&effect) + " points" + &self.over(&gaps) + &gaps_in_words(&gaps),
            effects: vec![effect],
        })
    }

    pub(super) fn greatest_pilot_gap(&self, uavs: u32) -> Option<Measurement> {
        let gaps = self.gaps(uavs)?;
        let effect = Effect::Greatest(gaps.values().copied().collect());
        Some(Measurement {
            words: signed(&effect) + " points" + &self.over(&gaps) + &gaps_in_words(&gaps),
            effects: vec![effect],
        })
    }

    pub(super) fn pilot_gap_slope(&self) -> Option<Measurement> {
        let fleets: Option<Vec<Cells>> = PAPER.iter().map(|at| self.gaps(at.uavs)).collect();
        let fleets = in_common(fleets?)?;
        let numbers: Vec<u32> = fleets[0].keys().copied().collect();
        let centre = numbers.iter().map(|&n| f64::from(n)).sum::<f64>() / numbers.len() as f64;
        let offset = |n: u32| f64::from(n) - centre;
        let width: f64 = numbers.iter().map(|&n| offset(n).powi(2)).sum();
        if numbers.len() < 3 {
            return None;
        }
        let share = 1.0 / fleets.len() as f64;
        let terms = fleets.iter().flatten();
        let slope = combination(terms.map(|(&n, &gap)| (share * offset(n) / width, gap)));
        let effect = Effect::Plain(slope);
        Some(Measurement {
            words: format!("{} points a hotspot", signed(&effect)),
            effects: vec![effect],
        })
    }

    pub(super) fn pilot_ratio(&self, quantity: Quantity, uavs: u32) -> Option<Measurement> {
        let both = self.pilots(quantity, uavs)?;
        let [adaptive, constant] = [&both[0], &both[1]].map(over_hotspots);
        let effect = ratio(constant, adaptive);
        let digits = quantity.digits();
        Some(Measurement {
            words: format!(
                "adaptive {:.digits$}, constant {:.digits$}: ratio {}{}",
                adaptive.value,
                constant.value,
                told(&effect, 2),
                self.over(&both[0])
            ),
            effects: vec![effect],
        })
    }

    pub(super) fn pilot_ratios(&self, quantity: Quantity) -> Option<Measurement> {
        let mut parts = Vec::new();
        for at in PAPER {
            let [adaptive, constant] = self.pilots(quantity, at.uavs)?;
            for (n, &cell) in &adaptive {
                let effect = ratio(constant[n], cell);
                let words = format!("{} × {n}: {}", at.uavs, told(&effect, 2));
                parts.push((effect, words));
            }
        }
        listed(parts.into_iter())
    }

    /// The density within a cell of an unconfirmed hotspot, less that farther away.
    pub(super) fn approach(&self) -> Measurement {
        let flights = self.results.approach.iter();
        let flights = flights.filter(|flight| flight.policy == self.reading.policy);
        let flights: Vec<&Approach> = flights.collect();
        match flights[..] {
            [] => Measurement {
                effects: Vec::new(),
                words: "no density over the distance is kept of it".to_owned(),
            },
            [flight, ..] if self.reading.policy == OURS => self.approach_of_one(flight),
            _ => approach_of_several(&flights),
        }
    }

    /// The densities of one policy, which is judged alone. A mission's mean lies between the least
    /// and the highest density, so that its standard deviation is at most half their difference
    /// (Popoviciu).
    fn approach_of_one(&self, flight: &Approach) -> Measurement {
        let config = Config::preset(self.reading.preset);
        let most = (config.pilot_density_max - config.pilot_density_min) / 2.0;
        let [near, far] = near_and_far(flight).map(|value| Measured {
            value,
            error: most / (flight.missions as f64).sqrt(),
            freedom: f64::INFINITY,
        });
        let effect = Effect::Plain(combination([(1.0, near), (-1.0, far)]));
        Measurement {
            words: format!(
                "{:.3} within a cell, {:.3} farther away: {} more, by the widest interval that {} \
                    missions allow",
                near.value,
                far.value,
                told(&effect, 3),
                flight.missions
            ),
            effects: vec![effect],
        }
    }
}

/// The mean densities within a cell of an unconfirmed hotspot and farther away.
fn near_and_far(flight: &Approach) -> [f64; 2] {
    [true, false].map(|near| {
        let bins = flight.bins.iter();
        let bins = bins.filter(|bin| (bin.distance_cells <= 1) == near);
        let steps: f64 = bins.clone().map(|bin| bin.uav_steps as f64).sum();
        let sum: f64 = bins
            .map(|bin| bin.uav_steps as f64 * bin.pilot_density_mean)
            .sum();
        sum / steps
    })
}

/// The densities of several trainings, with the noise between them. One training is not judged.
fn approach_of_several(flights: &[&Approach]) -> Measurement {
    let pairs: Vec<[f64; 2]> = flights.iter().map(|flight| near_and_far(flight)).collect();
    let mean_of = |side: usize| {
        let sum: f64 = pairs.iter().map(|pair| pair[side]).sum();
        sum / pairs.len() as f64
    };
    let levels = format!(
        "{:.3} within a cell, {:.3} farther away",
        mean_of(0),
        mean_of(1)
    );
    let differences: Vec<f64> = pairs.iter().map(|[near, far]| near - far).collect();
    match mean(&differences).map(Effect::Plain) {
        None => Measurement {
            words: levels + "; one training, and no spread between trainings is known",
            effects: Vec::new(),
        },
        Some(effect) => Measurement {
            words: format!(
                "{levels}: {} more, mean of {} trainings",
                told(&effect, 3),
                pairs.len()
            ),
            effects: vec![effect],
        },
    }
}

fn gaps_in_words(gaps: &Cells) -> String {
    of_several(gaps, |gap| signed(&Effect::Plain(gap)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pilot_by_distance::DistanceBin;

    fn flight(seed: u64, densities: [f64; 3]) -> Approach {
        let bin = |(distance_cells, pilot_density_mean)| DistanceBin {
            distance_cells,
            uav_steps: 10 + 10 * u64::from(distance_cells),
            pilot_density_mean,
        };
        Approach {
            policy: "ppo",
            seed,
            missions: 100,
            bins: (0..).zip(densities).map(bin).collect(),
        }
    }

    #[test]
    fn steps_within_a_cell_stand_against_all_others() {
        let [near, far] = near_and_far(&flight(0, [0.3, 0.24, 0.1]));
        assert!((near - 0.26).abs() < 1e-12, "{near}");
        assert!((far - 0.1).abs() < 1e-12, "{far}");
    }

    // Differences 0.16 and 0.18: a mean of 0.17, whose interval at one degree of freedom is
    // 12.706 * 0.01 wide on each side (scipy.stats.t.ppf(0.975, 1)).
    #[test]
    fn trainings_are_judged_by_what_differs_between_them() {
        let flights = [flight(0, [0.3, 0.24, 0.1]), flight(1, [0.32, 0.26, 0.1])];
        let several = approach_of_several(&flights.each_ref());
        let words = &several.words;
        assert!(
            words.contains("0.270 within a cell, 0.100 farther away"),
            "{words}"
        );
        assert!(
            words.contains("0.170 [0.043, 0.297] more, mean of 2"),
            "{words}"
        );
        let one = approach_of_several(&[&flights[0]]);
        assert!(one.effects.is_empty() && one.words.contains("one training"));
    }
}
