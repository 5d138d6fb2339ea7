//! What the results say about an adaptive pilot density beside a constant one.

use super::{Cells, Evidence, Measurement, in_common, listed, of_several, ratio, signed, told};
use crate::cell_means::over_hotspots;
use crate::fit::PAPER;
use crate::statistics::{Measured, combination};
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

    /// The density of one policy over distances. A mission's mean lies between the least and the
    /// highest density, so that its standard deviation is at most half their difference
    /// (Popoviciu).
    pub(super) fn approach(&self) -> Measurement {
        let unknown = Measurement {
            effects: Vec::new(),
            words: "no density over the distance is kept of it".to_owned(),
        };
        let Some(flight) = self.results.approach.first() else {
            return unknown;
        };
        if self.reading.policy != crate::campaign::OURS {
            return unknown;
        }
        let config = Config::preset(self.reading.preset);
        let most = (config.pilot_density_max - config.pilot_density_min) / 2.0;
        let of = |near: bool| {
            let bins = flight
                .bins
                .iter()
                .filter(|bin| (bin.distance_cells <= 1) == near);
            let steps: f64 = bins.clone().map(|bin| bin.uav_steps as f64).sum();
            let sum: f64 = bins
                .map(|bin| bin.uav_steps as f64 * bin.pilot_density_mean)
                .sum();
            Measured {
                value: sum / steps,
                error: most / (flight.missions as f64).sqrt(),
                freedom: f64::INFINITY,
            }
        };
        let (near, far) = (of(true), of(false));
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

fn gaps_in_words(gaps: &Cells) -> String {
    of_several(gaps, |gap| signed(&Effect::Plain(gap)))
}
