//! What the results say about a claim: effects with their noise, and words.

use crate::cell_means::{between_seeds, by_hotspots, over_hotspots};
use crate::claims::{Measure, Reading};
use crate::curves::Curve;
use crate::results::Results;
use crate::statistics::{CONFIDENCE, Measured, Spread, combination, line, mean};
use crate::table::{Quantity, Query};
use crate::verdict::Effect;
use jcas_core::{Config, Preset};
use jcas_episode::statistics::Estimate;
use std::collections::BTreeMap;

mod pilot;
#[cfg(test)]
mod tests;

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
