//! The scan of the sensing range: the paper's PPO under each reading of its reward, a random walk,
//! scripts and the planner. `lab/experiments` makes its tables.

use crate::fit::{PAPER, Published};
use crate::statistics::{CONFIDENCE, Measured, Spread, combination, error_of};
use crate::verdict::{Effect, Region, Verdict, one_training, verdict};
use jcas_episode::statistics::Estimate;
use jcas_train::error::TrainError;
use serde::Deserialize;
use serde::de::DeserializeOwned;
use std::collections::BTreeMap;
use std::path::Path;

/// Names of the tables: trainings and a random walk; scripts and the planner.
pub const TABLES: [&str; 2] = ["inform_once.csv", "inform_once_baselines.csv"];

/// Name of the table of its trainings' course.
pub const TRAININGS: &str = "inform_once_trainings.csv";

/// The readings of the paper's reward, in the order of its letter.
pub const READINGS: [&str; 3] = ["every step", "once", "once, no throughput"];

/// Other readings of detection and of the start, with informing paid once: name and field.
pub const OTHER_READINGS: [(&str, &str); 3] = [
    ("once, quorum over the episode", "quorum_window = episode"),
    ("once, own detections", "learned_detections = all"),
    ("once, random starts", "start_cells = random"),
];

/// Number of hotspots of the scan over ranges.
pub const HOTSPOTS: u32 = 5;

/// A policy of the scan: name, pilot rule, title.
pub type Flown = (&'static str, &'static str, &'static str);

/// The paper's PPO.
pub const PPO: Flown = ("ppo", "adaptive", "the paper's PPO");
/// A random walk.
pub const RANDOM: Flown = ("random", "mid", "a random walk");
/// The best script.
pub const TEAMS: Flown = ("teams", "max", "the best script, `teams`");
/// The planner.
pub const PLANNERS: [Flown; 2] = [
    ("plan", "planned", "the planner, `plan`"),
    ("replan", "planned", "the planner, `replan`"),
];

/// One policy in one cell.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[allow(missing_docs)] // the names are those of the columns
pub struct ScanRow {
    pub reading: String,
    pub range_m: f64,
    pub uavs: u32,
    pub hotspots: u32,
    pub pilot: String,
    pub seed: u64,
    pub policy: String,
    pub episodes: u64,
    pub success: f64,
    pub success_low: f64,
    pub success_high: f64,
    pub steps: f64,
    pub steps_low: f64,
    pub steps_high: f64,
    pub energy_kwh: f64,
    pub energy_kwh_low: f64,
    pub energy_kwh_high: f64,
    pub throughput: f64,
    pub throughput_low: f64,
    pub throughput_high: f64,
    #[serde(rename = "return")]
    pub episode_return: f64,
    pub return_low: f64,
    pub return_high: f64,
}

/// Declares the quantities of a row with the ends of the intervals of its missions.
macro_rules! estimates {
    ($( $(#[$meta:meta])+ $quantity:ident, $low:ident, $high:ident; )+) => {
        impl ScanRow { $(
            $(#[$meta])+
            pub fn $quantity(&self) -> Estimate {
                let (value, low, high) = (self.$quantity, self.$low, self.$high);
                Estimate { value, low, high }
            }
        )+ }
    };
}

estimates! {
    /// Share of missions that succeeded.
    success, success_low, success_high;
    /// The undiscounted return.
    episode_return, return_low, return_high;
    /// Steps.
    steps, steps_low, steps_high;
    /// Energy of the fleet in a mission in kWh.
    energy_kwh, energy_kwh_low, energy_kwh_high;
    /// Normalised throughput.
    throughput, throughput_low, throughput_high;
}

/// One iteration of one training.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[allow(missing_docs)] // the names are those of the columns
pub struct ScanIteration {
    pub reading: String,
    pub range_m: f64,
    pub uavs: u32,
    pub hotspots: u32,
    pub iteration: u32,
    pub return_mean: Option<f64>,
    pub success_rate: Option<f64>,
}

/// What the scan has come to so far.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Scan {
    /// In the order of the tables.
    pub rows: Vec<ScanRow>,
    /// The course of some of its trainings.
    pub trainings: Vec<ScanIteration>,
}

impl Scan {
    /// Reads the tables that a folder has.
    pub fn open(out: &Path) -> Result<Scan, TrainError> {
        let mut rows = Vec::new();
        for name in TABLES {
            rows.extend(lines(&out.join(name))?);
        }
        Ok(Scan {
            rows,
            trainings: lines(&out.join(TRAININGS))?,
        })
    }

    /// The rows of a policy in one cell, one a training seed. A random walk and the scripts fly the
    /// same under every reading, which changes what is paid alone.
    pub fn cell(&self, reading: &str, range_m: f64, uavs: u32, flown: Flown) -> Vec<&ScanRow> {
        self.at(reading, range_m, (uavs, HOTSPOTS), flown)
    }

    /// As [`Scan::cell`], for a number of UAVs and one of hotspots.
    pub fn at(
        &self,
        reading: &str,
        range_m: f64,
        (uavs, hotspots): (u32, u32),
        flown: Flown,
    ) -> Vec<&ScanRow> {
        let mut seeds: Vec<u64> = Vec::new();
        let mut first_of_seed = |row: &&ScanRow| {
            let new = !seeds.contains(&row.seed);
            seeds.push(row.seed);
            new
        };
        let of = |row: &&ScanRow| {
            (row.reading.as_str(), row.range_m, row.uavs, row.hotspots)
                == (reading, range_m, uavs, hotspots)
                && (row.policy.as_str(), row.pilot.as_str()) == (flown.0, flown.1)
        };
        let rows = self.rows.iter().filter(of);
        rows.filter(|row| first_of_seed(row)).collect()
    }

    /// The ranges at which a policy has flown under a reading, rising.
    pub fn ranges(&self, reading: &str, flown: Flown) -> Vec<f64> {
        let of = |row: &&ScanRow| (row.reading.as_str(), row.policy.as_str()) == (reading, flown.0);
        let mut ranges: Vec<f64> = self.rows.iter().filter(of).map(|row| row.range_m).collect();
        ranges.sort_by(f64::total_cmp);
        ranges.dedup();
        ranges
    }

    /// The success of PPO in each cell of the readings of the reward, one value a training seed.
    pub fn by_seeds(&self) -> Vec<Vec<f64>> {
        let mut cells: BTreeMap<_, Vec<f64>> = BTreeMap::new();
        let of = |row: &&ScanRow| row.policy == PPO.0 && READINGS.contains(&row.reading.as_str());
        for row in self.rows.iter().filter(of) {
            let range = row.range_m.to_bits();
            let cell = (&row.reading, range, row.uavs, row.hotspots, &row.pilot);
            cells.entry(cell).or_default().push(row.success);
        }
        cells.into_values().collect()
    }
}

/// The lines of a table; none where it is not there.
pub(crate) fn lines<T: DeserializeOwned>(path: &Path) -> Result<Vec<T>, TrainError> {
    if !path.exists() {
        return Ok(Vec::new());
    }
    let mut reader = csv::Reader::from_path(path).map_err(TrainError::format(path))?;
    let lines = reader.deserialize();
    lines
        .map(|line| line.map_err(TrainError::format(path)))
        .collect()
}

/// Success of a cell with the noise of its missions and, where it is trained, of its trainings.
pub fn success(rows: &[&ScanRow], spread: Option<Spread>) -> Option<Measured> {
    measured(rows, ScanRow::success, spread, |_| 1.0)
}

/// A quantity of a cell with the noise of its missions and, where it is trained, of its trainings.
/// The spread between trainings is in units of `unit` of the cell's mean.
pub fn measured(
    rows: &[&ScanRow],
    quantity: impl Fn(&ScanRow) -> Estimate,
    spread: Option<Spread>,
    unit: impl Fn(f64) -> f64,
) -> Option<Measured> {
    let count = rows.len() as f64;
    let first = rows.first()?;
    let trained = spread.filter(|_| first.policy == PPO.0);
    let estimates = rows.iter().map(|row| quantity(row));
    let missions = estimates.clone().map(|e| error_of(&e)).sum::<f64>() / count;
    let value = estimates.map(|e| e.value).sum::<f64>() / count;
    let trainings = trained.map_or(0.0, |spread| spread.deviation * unit(value) / count.sqrt());
    Some(Measured {
        value,
        error: missions.hypot(trainings),
        freedom: trained.map_or(f64::INFINITY, |spread| spread.freedom),
    })
}

/// The interval of a success rate, which ends at 0 and 1. Missions alone keep Wilson's interval.
pub fn success_interval(rows: &[&ScanRow], spread: Option<Spread>) -> Option<Estimate> {
    let e = success(rows, spread)?.interval(CONFIDENCE);
    match rows {
        [row] if row.policy != PPO.0 => Some(row.success()),
        _ => Some(Estimate {
            low: e.low.max(0.0),
            high: e.high.min(1.0),
            ..e
        }),
    }
}

/// Whether a range is compatible with a success rate of the paper: the interval of the difference
/// has 0. The paper's rate has the noise of its missions and, for a policy that is trained, of one
/// training.
pub fn is_compatible(
    rows: &[&ScanRow],
    published: Published,
    spread: Option<Spread>,
) -> Option<bool> {
    let measured = success(rows, spread)?;
    let trained = spread.filter(|_| rows[0].policy == PPO.0);
    let paper = one_training(published, trained);
    // The end of the paper's interval that faces the measured rate gives its standard error.
    let half = if measured.value < paper.value {
        paper.value - paper.low
    } else {
        paper.high - paper.value
    };
    let factor = crate::statistics::t_factor(measured.freedom, CONFIDENCE);
    let paper = Measured {
        value: paper.value,
        error: half / factor,
        freedom: measured.freedom,
    };
    let difference = Effect::Plain(combination([(1.0, measured), (-1.0, paper)]));
    let apart = verdict(&[difference], (0.0, 0.0)) == Verdict::Fails;
    Some(!apart)
}

/// Whether the intervals of both rates of PPO lie inside those that another training of the paper
/// may have given.
pub fn is_inside(scan: &Scan, reading: &str, range_m: f64, spread: Option<Spread>) -> bool {
    PAPER.iter().all(|published| {
        let rows = scan.cell(reading, range_m, published.uavs, PPO);
        let effects: Vec<Effect> = success(&rows, spread)
            .map(Effect::Plain)
            .into_iter()
            .collect();
        let ends = Region::AnotherTraining(published.rate).ends(spread);
        verdict(&effects, ends) == Verdict::Holds
    })
}

/// The ranges at which both rates of the paper are compatible with a policy, and those that were
/// flown with both fleets.
pub fn compatible(
    scan: &Scan,
    reading: &str,
    flown: Flown,
    spread: Option<Spread>,
) -> (Vec<f64>, Vec<f64>) {
    let (mut both, mut tried) = (Vec::new(), Vec::new());
    for range_m in scan.ranges(reading, flown) {
        let of = |published: Published| {
            let rows = scan.cell(reading, range_m, published.uavs, flown);
            is_compatible(&rows, published, spread)
        };
        let [Some(first), Some(second)] = PAPER.map(of) else {
            continue;
        };
        tried.push(range_m);
        if first && second {
            both.push(range_m);
        }
    }
    (both, tried)
}

#[cfg(test)]
pub(crate) mod testing {
    use super::*;

    /// A row of the reading "once" at n = 5.
    pub(crate) fn row(policy: Flown, range_m: f64, uavs: u32, seed: u64, success: f64) -> ScanRow {
        let e = jcas_episode::statistics::wilson((success * 1000.0).round() as u64, 1000);
        ScanRow {
            reading: "once".to_owned(),
            range_m,
            uavs,
            hotspots: HOTSPOTS,
            pilot: policy.1.to_owned(),
            seed,
            policy: policy.0.to_owned(),
            episodes: 1000,
            success,
            success_low: e.low,
            success_high: e.high,
            steps: 40.0,
            steps_low: 39.0,
            steps_high: 41.0,
            energy_kwh: 0.4,
            energy_kwh_low: 0.39,
            energy_kwh_high: 0.41,
            throughput: 1.2,
            throughput_low: 1.19,
            throughput_high: 1.21,
            episode_return: 100.0,
            return_low: 99.0,
            return_high: 101.0,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::testing::row;
    use super::*;

    // Two proportions, 0.774 of 1000 and 0.73 of 100: proportions_ztest of statsmodels gives
    // p = 0.32. By the same, 0.919 beside 0.73 has p < 1e-8.
    #[test]
    fn a_random_walk_has_the_noise_of_missions_alone() {
        let at = |uavs, success: f64, published| {
            let row = row(RANDOM, 150.0, uavs, 0, success);
            is_compatible(&[&row], published, None)
        };
        assert_eq!(at(10, 0.774, PAPER[0]), Some(true));
        assert_eq!(at(10, 0.919, PAPER[0]), Some(false));
        assert_eq!(at(15, 0.961, PAPER[1]), Some(true));
        assert_eq!(is_compatible(&[], PAPER[0], None), None);
    }

    #[test]
    fn trainings_that_spread_make_a_range_compatible() {
        let row = row(PPO, 175.0, 10, 0, 0.834);
        // 0.834 is 0.104 above: more than the missions of both allow (0.07), less than two
        // trainings that spread by 0.06 do (0.18).
        assert_eq!(is_compatible(&[&row], PAPER[0], None), Some(false));
        let spread = Some(Spread {
            deviation: 0.06,
            freedom: 16.0,
        });
        assert_eq!(is_compatible(&[&row], PAPER[0], spread), Some(true));
    }

    #[test]
    fn a_range_counts_where_both_fleets_have_flown() {
        let scan = Scan {
            rows: vec![
                row(RANDOM, 150.0, 10, 0, 0.774),
                row(RANDOM, 150.0, 15, 0, 0.961),
                row(RANDOM, 175.0, 10, 0, 0.919),
                row(RANDOM, 175.0, 15, 0, 0.992),
                row(RANDOM, 200.0, 10, 0, 0.979),
            ],
            ..Scan::default()
        };
        let (both, tried) = compatible(&scan, "once", RANDOM, None);
        assert_eq!(both, [150.0]);
        assert_eq!(tried, [150.0, 175.0]);
    }

    #[test]
    fn seeds_of_a_cell_stand_together() {
        let scan = Scan {
            rows: vec![
                row(PPO, 175.0, 10, 0, 0.8),
                row(PPO, 175.0, 10, 1, 0.9),
                row(PPO, 150.0, 10, 0, 0.1),
            ],
            ..Scan::default()
        };
        assert_eq!(scan.by_seeds(), [vec![0.1], vec![0.8, 0.9]]);
        assert_eq!(scan.cell("once", 175.0, 10, PPO).len(), 2);
    }
}
