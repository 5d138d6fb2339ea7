//! What the results say about a claim: effects with their noise, and words.

use crate::cell_means::{between_seeds, by_hotspots, over_hotspots};
use crate::claims::{Measure, Reading};
use crate::curves::Curve;
use crate::fit::PAPER;
use crate::results::Results;
use crate::statistics::{CONFIDENCE, Measured, Spread, combination, line, mean};
use crate::table::{Quantity, Query};
use crate::verdict::Effect;
use jcas_core::{Config, Preset};
use jcas_episode::statistics::Estimate;
use std::collections::BTreeMap;

/// Iterations of the last third of the paper's training.
const LAST_THIRD: usize = 21;

/// What was measured.
pub(crate) struct Measurement {
    /// Empty where it cannot be judged.
    pub(crate) effects: Vec<Effect>,
    /// The numbers, with intervals.
    pub(crate) words: String,
}

/// The results of one reading.
pub(crate) struct Evidence<'a> {
    results: &'a Results<'a>,
    reading: &'a Reading,
}

/// A value for each number of hotspots.
type Cells = BTreeMap<u32, Measured>;

impl<'a> Evidence<'a> {
    pub(crate) fn new(results: &'a Results<'a>, reading: &'a Reading) -> Self {
        Evidence { results, reading }
    }

    /// The spread between training seeds.
    pub(crate) fn spread(&self, quantity: Quantity) -> Option<Spread> {
        let preset = self.reading.preset.name();
        between_seeds(&self.results.table, preset, self.reading.policy, quantity)
    }

    /// None where nothing of it was run.
    pub(crate) fn measure(&self, measure: Measure) -> Option<Measurement> {
        let mut measured = match measure {
            Measure::At(quantity, uavs) => self.at(quantity, uavs),
            Measure::OfEachHotspots(quantity, uavs) => self.of_each_hotspots(quantity, uavs),
            Measure::LastOverFirst(quantity) => self.last_over_first(quantity),
            Measure::Growth(quantity) => self.growth(quantity),
            Measure::Saturation(quantity) => self.saturation(quantity),
            Measure::PilotGap(uavs) => self.pilot_gap(uavs),
            Measure::GreatestPilotGap(uavs) => self.greatest_pilot_gap(uavs),
            Measure::PilotGapSlope => self.pilot_gap_slope(),
            Measure::PilotRatio(quantity, uavs) => self.pilot_ratio(quantity, uavs),
            Measure::PilotRatioOfEachHotspots(quantity) => self.pilot_ratios(quantity),
            Measure::Approach => return Some(self.approach()),
            Measure::LateChange => return self.late_change(),
            Measure::TimeGrowth => return self.time_growth(),
            Measure::Endurance => return Some(endurance(&Config::preset(Preset::Paper))),
        }?;
        if self.spread(Quantity::Success).is_none() {
            measured.effects.clear();
            measured.words += "; one training, and no spread between trainings is known";
        }
        Some(measured)
    }

    fn cells(&self, quantity: Quantity, pilot: &str, uavs: u32) -> Cells {
        let policy = (self.reading.policy, pilot);
        let query = Query::new("grid", self.reading.preset.name(), policy).uavs(uavs);
        let rows = query.rows(&self.results.table);
        by_hotspots(&rows, quantity, self.spread(quantity))
    }

    /// Every fleet over the numbers of hotspots that all have; none where a fleet has none.
    fn fleets(&self, quantity: Quantity) -> Option<(Vec<Measured>, String)> {
        let fleets = self.results.scope.fleets.iter();
        let cells: Vec<Cells> = fleets
            .map(|&uavs| self.cells(quantity, "adaptive", uavs))
            .collect();
        let cells = in_common(cells)?;
        let over = self.over(&cells[0]);
        Some((cells.iter().map(over_hotspots).collect(), over))
    }

    /// Adaptive and constant at a fleet size, over the numbers of hotspots that both have.
    fn pilots(&self, quantity: Quantity, uavs: u32) -> Option<[Cells; 2]> {
        let both = ["adaptive", "constant"].map(|pilot| self.cells(quantity, pilot, uavs));
        in_common(both.to_vec())?.try_into().ok()
    }

    fn over(&self, cells: &Cells) -> String {
        let numbers: Vec<u32> = cells.keys().copied().collect();
        self.results.scope.over(&numbers)
    }

    fn at(&self, quantity: Quantity, uavs: u32) -> Option<Measurement> {
        let cells = self.cells(quantity, "adaptive", uavs);
        if cells.is_empty() {
            return None;
        }
        let effect = Effect::Plain(over_hotspots(&cells));
        let words = told(&effect, quantity.digits()) + &self.over(&cells);
        let each = |cell: Measured| told(&Effect::Plain(cell), quantity.digits());
        Some(Measurement {
            words: words + &of_several(&cells, each),
            effects: vec![effect],
        })
    }

    fn of_each_hotspots(&self, quantity: Quantity, uavs: u32) -> Option<Measurement> {
        let cells = self.cells(quantity, "adaptive", uavs);
        let parts = cells.iter().map(|(n, &cell)| {
            let effect = Effect::Plain(cell);
            let words = format!("n = {n}: {}", told(&effect, quantity.digits()));
            (effect, words)
        });
        listed(parts)
    }

    /// The values of all fleets, in words.
    fn fleet_values(&self, means: &[Measured], quantity: Quantity) -> String {
        let digits = quantity.digits();
        let fleets = self.results.scope.fleets.iter().zip(means);
        let parts: Vec<String> = fleets
            .map(|(uavs, mean)| format!("N = {uavs}: {:.digits$}", mean.value))
            .collect();
        parts.join(", ")
    }

    fn last_over_first(&self, quantity: Quantity) -> Option<Measurement> {
        let (means, over) = self.fleets(quantity)?;
        let effect = ratio(*means.last()?, *means.first()?);
        Some(Measurement {
            words: format!(
                "{}{over}; ratio {}",
                self.fleet_values(&means, quantity),
                told(&effect, 2)
            ),
            effects: vec![effect],
        })
    }

    fn growth(&self, quantity: Quantity) -> Option<Measurement> {
        let (means, over) = self.fleets(quantity)?;
        let fleets = &self.results.scope.fleets;
        let fleets = f64::from(*fleets.last()?) / f64::from(*fleets.first()?);
        let grown = ratio(*means.last()?, *means.first()?);
        let Effect::LogRatio(logarithm) = grown else {
            return None;
        };
        Some(Measurement {
            words: format!(
                "{}{over}; {} times, N {fleets} times",
                self.fleet_values(&means, quantity),
                told(&grown, 2)
            ),
            effects: vec![Effect::LogRatio(Measured {
                value: logarithm.value - fleets.ln(),
                ..logarithm
            })],
        })
    }

    fn saturation(&self, quantity: Quantity) -> Option<Measurement> {
        let (means, over) = self.fleets(quantity)?;
        if means.len() < 3 {
            return None;
        }
        let first = combination([(1.0, means[0]), (-1.0, means[1])]);
        let second = second_difference(&means);
        let effects = vec![Effect::Plain(first), Effect::Plain(second)];
        let digits = quantity.digits();
        Some(Measurement {
            words: format!(
                "{}{over}; first step down {}, mean second difference {}",
                self.fleet_values(&means, quantity),
                told(&effects[0], digits),
                told(&effects[1], digits)
            ),
            effects,
        })
    }

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

    fn pilot_gap(&self, uavs: u32) -> Option<Measurement> {
        let gaps = self.gaps(uavs)?;
        let effect = Effect::Plain(over_hotspots(&gaps));
        Some(Measurement {
            words: signed(&effect) + " points" + &self.over(&gaps) + &gaps_in_words(&gaps),
            effects: vec![effect],
        })
    }

    fn greatest_pilot_gap(&self, uavs: u32) -> Option<Measurement> {
        let gaps = self.gaps(uavs)?;
        let effect = Effect::Greatest(gaps.values().copied().collect());
        Some(Measurement {
            words: signed(&effect) + " points" + &self.over(&gaps) + &gaps_in_words(&gaps),
            effects: vec![effect],
        })
    }

    fn pilot_gap_slope(&self) -> Option<Measurement> {
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

    fn pilot_ratio(&self, quantity: Quantity, uavs: u32) -> Option<Measurement> {
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

    fn pilot_ratios(&self, quantity: Quantity) -> Option<Measurement> {
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
    fn approach(&self) -> Measurement {
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

    /// Trainings of the reading's policy with the paper's number of iterations or more.
    fn trainings(&self) -> impl Iterator<Item = &Curve> {
        let curves = self.results.curves.iter();
        curves.filter(|curve| curve.learner == self.reading.policy)
    }

    fn late_change(&self) -> Option<Measurement> {
        let adaptive = self.trainings().filter(|curve| curve.constant.is_none());
        let changes: Vec<f64> = adaptive
            .filter_map(|curve| late_change(&curve.returns))
            .collect();
        let mean = mean(&changes)?;
        let effect = Effect::Plain(mean);
        Some(Measurement {
            words: format!(
                "{} of the scatter, mean of {} trainings",
                signed(&effect),
                changes.len()
            ),
            effects: vec![effect],
        })
    }

    fn time_growth(&self) -> Option<Measurement> {
        let of = |uavs: u32| {
            let times = self.trainings().filter(|curve| curve.uavs == uavs);
            let logarithms: Vec<f64> = times.map(|curve| curve.iteration_s.ln()).collect();
            mean(&logarithms)
        };
        let fleets = &self.results.scope.fleets;
        let terms = [(1.0, of(*fleets.last()?)?), (-1.0, of(*fleets.first()?)?)];
        let effect = Effect::LogRatio(combination(terms));
        Some(Measurement {
            words: format!(
                "{} times, beside whatever else the machine did",
                told(&effect, 1)
            ),
            effects: vec![effect],
        })
    }
}

/// The change over the last third of a curve by its line, in the scatter of its values about it.
/// None where the curve is shorter than the paper's trainings.
fn late_change(returns: &[f64]) -> Option<f64> {
    let start = returns.len().checked_sub(LAST_THIRD)?;
    if start < 2 * (LAST_THIRD - 1) || returns[start..].iter().any(|value| !value.is_finite()) {
        return None;
    }
    let line = line(&returns[start..])?;
    (line.scatter > 0.0).then(|| line.slope.value * LAST_THIRD as f64 / line.scatter)
}

/// The mean of the second differences: the last first difference less the first one.
fn second_difference(means: &[Measured]) -> Measured {
    let last = means.len() - 1;
    let mut weights = vec![0.0; means.len()];
    for k in 1..last {
        let share = 1.0 / (last - 1) as f64;
        weights[k - 1] += share;
        weights[k] -= 2.0 * share;
        weights[k + 1] += share;
    }
    combination(weights.into_iter().zip(means.iter().copied()))
}

/// The value of each number of hotspots; nothing where there is one.
fn of_several(cells: &Cells, told: impl Fn(Measured) -> String) -> String {
    let parts = cells
        .iter()
        .map(|(n, &cell)| format!("n = {n}: {}", told(cell)));
    let parts: Vec<String> = parts.collect();
    if parts.len() > 1 {
        format!("; {}", parts.join(", "))
    } else {
        String::new()
    }
}

fn gaps_in_words(gaps: &Cells) -> String {
    of_several(gaps, |gap| signed(&Effect::Plain(gap)))
}

fn ratio(above: Measured, below: Measured) -> Effect {
    Effect::LogRatio(combination([(1.0, above.ln()), (-1.0, below.ln())]))
}

/// Over the numbers of hotspots that all have; none where they have none in common.
fn in_common(groups: Vec<Cells>) -> Option<Vec<Cells>> {
    let shared = |n: &u32| groups.iter().all(|cells| cells.contains_key(n));
    let compared: Vec<Cells> = groups
        .iter()
        .map(|cells| {
            cells
                .iter()
                .filter(|(n, _)| shared(n))
                .map(|(&n, &c)| (n, c))
                .collect()
        })
        .collect();
    compared
        .iter()
        .all(|cells| !cells.is_empty())
        .then_some(compared)
}

/// Several effects with their words; none without any.
fn listed(parts: impl Iterator<Item = (Effect, String)>) -> Option<Measurement> {
    let (effects, words): (Vec<Effect>, Vec<String>) = parts.unzip();
    (!effects.is_empty()).then(|| Measurement {
        effects,
        words: words.join(", "),
    })
}

fn endurance(config: &Config) -> Measurement {
    let step_kwh = config.move_energy_kwh + config.sense_energy_kwh + config.comm_energy_kwh;
    let steps = config.battery_capacity_kwh / step_kwh;
    Measurement {
        effects: vec![Effect::Plain(Measured {
            value: steps,
            error: 0.0,
            freedom: f64::INFINITY,
        })],
        words: format!(
            "{steps:.0} steps of moving, sensing and talking at {step_kwh:.5} kWh, exactly"
        ),
    }
}

/// A value with its interval.
fn told(effect: &Effect, digits: usize) -> String {
    crate::text::told(&effect.interval(CONFIDENCE), digits)
}

/// The same with signs, for differences.
fn signed(effect: &Effect) -> String {
    let Estimate { value, low, high } = effect.interval(CONFIDENCE);
    let digits = if value.abs() < 1.0 { 2 } else { 1 };
    format!("{value:+.digits$} [{low:+.digits$}, {high:+.digits$}]")
}

#[cfg(test)]
mod tests {
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
}
