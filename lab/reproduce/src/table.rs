//! The results of a reproduction, one row for each campaign of missions.

use jcas_episode::statistics::{Estimate, Summary};
use jcas_train::error::TrainError;
use jcas_train::store::{csv_bytes, write_whole};
use serde::{Deserialize, Serialize};
use std::collections::{BTreeMap, HashSet};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// Key of a campaign.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Key {
    /// `grid`, `density`, `battery`, `variation`, `range`, `endurance`, or one that begins with
    /// `pilot`.
    pub experiment: String,
    /// `mission`, `paper` or `search`.
    pub preset: String,
    /// UAVs.
    pub uavs: u32,
    /// Hotspots.
    pub hotspots: u32,
    /// Baseline's name, `learned` (our settings), a learner's name (the paper's), a variation's, or
    /// the folder of a policy that was given.
    pub policy: String,
    /// Pilot rule.
    pub pilot: String,
    /// Training seed; of policies that were given, their place among those for the mission; 0 for
    /// baselines.
    pub seed: u64,
    /// What the experiment varies besides: a density, a share; 0 where nothing.
    pub x: f64,
    /// Fingerprint of the configuration that is flown.
    pub config_hash: String,
}

/// A row: a campaign and its results.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[allow(missing_docs)] // the names are those of the summary's quantities and their intervals
pub struct Row {
    pub experiment: String,
    pub preset: String,
    pub uavs: u32,
    pub hotspots: u32,
    pub policy: String,
    pub pilot: String,
    pub seed: u64,
    pub x: f64,
    pub config_hash: String,
    pub episodes: u64,
    pub success_rate: f64,
    pub success_rate_low: f64,
    pub success_rate_high: f64,
    pub mission_steps: f64,
    pub mission_steps_low: f64,
    pub mission_steps_high: f64,
    pub energy_kwh: f64,
    pub energy_kwh_low: f64,
    pub energy_kwh_high: f64,
    pub throughput: f64,
    pub throughput_low: f64,
    pub throughput_high: f64,
    pub co2_kg: f64,
    pub co2_kg_low: f64,
    pub co2_kg_high: f64,
    pub pilot_density: f64,
}

impl Row {
    fn new(key: &Key, summary: &Summary) -> Row {
        let Key {
            experiment,
            preset,
            uavs,
            hotspots,
            policy,
            pilot,
            seed,
            x,
            config_hash,
        } = key.clone();
        let Summary {
            success_rate,
            mission_steps,
            energy_kwh,
            throughput,
            co2_kg,
            ..
        } = *summary;
        Row {
            experiment,
            preset,
            uavs,
            hotspots,
            policy,
            pilot,
            seed,
            x,
            config_hash,
            episodes: summary.episodes,
            success_rate: success_rate.value,
            success_rate_low: success_rate.low,
            success_rate_high: success_rate.high,
            mission_steps: mission_steps.value,
            mission_steps_low: mission_steps.low,
            mission_steps_high: mission_steps.high,
            energy_kwh: energy_kwh.value,
            energy_kwh_low: energy_kwh.low,
            energy_kwh_high: energy_kwh.high,
            throughput: throughput.value,
            throughput_low: throughput.low,
            throughput_high: throughput.high,
            co2_kg: co2_kg.value,
            co2_kg_low: co2_kg.low,
            co2_kg_high: co2_kg.high,
            pilot_density: summary.pilot_density.value,
        }
    }

    /// Whether another row is of the same campaign.
    pub(crate) fn is_again(&self, other: &Row) -> bool {
        self.campaign() == other.campaign()
    }

    fn is_of(&self, key: &Key) -> bool {
        let names = [&key.experiment, &key.preset, &key.policy, &key.pilot];
        self.campaign() == (names, [key.uavs, key.hotspots], key.seed, key.x.to_bits())
    }

    /// The columns that identify a row.
    fn campaign(&self) -> ([&String; 4], [u32; 2], u64, u64) {
        let names = [&self.experiment, &self.preset, &self.policy, &self.pilot];
        (
            names,
            [self.uavs, self.hotspots],
            self.seed,
            self.x.to_bits(),
        )
    }

    /// A quantity with its interval.
    pub fn estimate(&self, quantity: Quantity) -> Estimate {
        let (value, low, high) = match quantity {
            Quantity::Success => (
                self.success_rate,
                self.success_rate_low,
                self.success_rate_high,
            ),
            Quantity::Steps => (
                self.mission_steps,
                self.mission_steps_low,
                self.mission_steps_high,
            ),
            Quantity::Energy => (self.energy_kwh, self.energy_kwh_low, self.energy_kwh_high),
            Quantity::Throughput => (self.throughput, self.throughput_low, self.throughput_high),
            Quantity::Co2 => (self.co2_kg, self.co2_kg_low, self.co2_kg_high),
        };
        Estimate { value, low, high }
    }
}

/// What is compared.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quantity {
    /// Success rate.
    Success,
    /// Mission time.
    Steps,
    /// Energy of the fleet.
    Energy,
    /// Normalised throughput.
    Throughput,
    /// Carbon.
    Co2,
}

impl Quantity {
    /// Its name, for people.
    pub const fn title(self) -> &'static str {
        match self {
            Quantity::Success => "success rate",
            Quantity::Steps => "mission time",
            Quantity::Energy => "energy spent",
            Quantity::Throughput => "normalised throughput",
            Quantity::Co2 => "carbon emitted",
        }
    }

    /// Its unit; empty for a pure number.
    pub const fn unit(self) -> &'static str {
        match self {
            Quantity::Success | Quantity::Throughput => "",
            Quantity::Steps => "steps",
            Quantity::Energy => "kWh",
            Quantity::Co2 => "kg",
        }
    }

    /// Decimals in reports.
    pub const fn digits(self) -> usize {
        match self {
            Quantity::Steps => 1,
            _ => 3,
        }
    }
}

/// The file is written at most this often, and at the end.
const WRITE_INTERVAL: Duration = Duration::from_secs(1);

/// All rows.
#[derive(Clone, Debug)]
pub struct Table {
    path: PathBuf,
    written: Instant,
    /// In the table of a shard, the unit of each row.
    units: Option<Vec<u64>>,
    /// In the order in which they were flown.
    pub rows: Vec<Row>,
}

impl Table {
    /// What is there already.
    pub fn open(path: &Path) -> Result<Table, TrainError> {
        let mut rows: Vec<Row> = Vec::new();
        if path.exists() {
            let mut reader = csv::Reader::from_path(path).map_err(TrainError::format(path))?;
            for row in reader.deserialize() {
                rows.push(row.map_err(TrainError::format(path))?);
            }
        }
        Table::new(path, None, rows)
    }

    /// What is there of a shard already.
    pub(crate) fn open_shard(path: &Path) -> Result<Table, TrainError> {
        let (units, rows) = crate::shard::read(path)?.into_iter().unzip();
        Table::new(path, Some(units), rows)
    }

    fn new(path: &Path, units: Option<Vec<u64>>, rows: Vec<Row>) -> Result<Table, TrainError> {
        let mut campaigns = HashSet::new();
        for (number, row) in (2..).zip(&rows) {
            if !campaigns.insert(row.campaign()) {
                let what = format!(
                    "line {number}: {}, {}, N = {}, n = {} is there twice, it must be there once",
                    row.experiment, row.policy, row.uavs, row.hotspots
                );
                return Err(TrainError::Format(path.to_owned(), what));
            }
        }
        Ok(Table {
            path: path.to_owned(),
            written: Instant::now(),
            units,
            rows,
        })
    }

    /// The campaign, if it has been flown.
    pub fn find(&self, key: &Key) -> Option<&Row> {
        self.rows.iter().find(|row| row.is_of(key))
    }

    /// Adds a campaign of a unit.
    pub(crate) fn add(
        &mut self,
        unit: u64,
        key: &Key,
        summary: &Summary,
    ) -> Result<(), TrainError> {
        if let Some(units) = &mut self.units {
            units.push(unit);
        }
        self.rows.push(Row::new(key, summary));
        if self.written.elapsed() >= WRITE_INTERVAL {
            self.write()?;
        }
        Ok(())
    }

    /// Writes the whole table.
    pub fn write(&mut self) -> Result<(), TrainError> {
        let bytes = match &self.units {
            None => csv_bytes(&self.rows, true, &self.path)?,
            Some(units) => crate::shard::bytes(units, &self.rows, &self.path)?,
        };
        write_whole(&self.path, &bytes)?;
        self.written = Instant::now();
        Ok(())
    }
}

/// A selection of rows; an absent field matches every value.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Query<'a> {
    /// As in [`Key`].
    pub experiment: &'a str,
    /// As in [`Key`].
    pub preset: &'a str,
    /// Baseline or learner.
    pub policy: &'a str,
    /// Pilot rule.
    pub pilot: &'a str,
    /// UAVs.
    pub uavs: Option<u32>,
    /// Hotspots.
    pub hotspots: Option<u32>,
    /// What the experiment varies.
    pub x: Option<f64>,
}

impl<'a> Query<'a> {
    /// Every campaign of an experiment that one policy has flown with one pilot rule.
    pub const fn new(
        experiment: &'a str,
        preset: &'a str,
        (policy, pilot): (&'a str, &'a str),
    ) -> Self {
        Query {
            experiment,
            preset,
            policy,
            pilot,
            uavs: None,
            hotspots: None,
            x: None,
        }
    }

    /// Only at a fleet size.
    #[must_use]
    pub const fn uavs(self, uavs: u32) -> Self {
        Query {
            uavs: Some(uavs),
            ..self
        }
    }

    /// Only at a number of hotspots.
    #[must_use]
    pub const fn hotspots(self, hotspots: u32) -> Self {
        Query {
            hotspots: Some(hotspots),
            ..self
        }
    }

    /// Only at a value of what the experiment varies.
    #[must_use]
    pub const fn x(self, x: f64) -> Self {
        Query { x: Some(x), ..self }
    }

    /// Its rows, in the order in which they were flown.
    pub fn rows<'t>(&self, table: &'t Table) -> Vec<&'t Row> {
        let is = |wanted: Option<u32>, value: u32| wanted.is_none_or(|wanted| wanted == value);
        let wanted = |row: &&Row| {
            row.experiment == self.experiment
                && row.preset == self.preset
                && row.policy == self.policy
                && row.pilot == self.pilot
                && is(self.uavs, row.uavs)
                && is(self.hotspots, row.hotspots)
                && self.x.is_none_or(|x| row.x == x)
        };
        table.rows.iter().filter(wanted).collect()
    }

    /// The mean over its rows; none without rows.
    pub fn mean(&self, table: &Table, quantity: Quantity) -> Option<Estimate> {
        mean(&self.rows(table), quantity)
    }
}

/// The mean over cells of the mean over each cell's seeds, with that of their intervals' ends; none
/// without rows.
pub fn mean(rows: &[&Row], quantity: Quantity) -> Option<Estimate> {
    let mut cells: BTreeMap<_, Vec<Estimate>> = BTreeMap::new();
    for row in rows {
        let cell = (row.uavs, row.hotspots, row.x.to_bits());
        cells.entry(cell).or_default().push(row.estimate(quantity));
    }
    let of_cells: Vec<Estimate> = cells.values().map(|seeds| of_equal(seeds)).collect();
    (!of_cells.is_empty()).then(|| of_equal(&of_cells))
}

/// The mean of estimates that count the same.
fn of_equal(estimates: &[Estimate]) -> Estimate {
    let over =
        |end: fn(&Estimate) -> f64| estimates.iter().map(end).sum::<f64>() / estimates.len() as f64;
    Estimate {
        value: over(|e| e.value),
        low: over(|e| e.low),
        high: over(|e| e.high),
    }
}

/// What of some groups of rows can be compared: the numbers of hotspots that all of those have that
/// have any.
pub fn in_common<'a>(groups: Vec<Vec<&'a Row>>) -> Vec<Vec<&'a Row>> {
    let has = |group: &[&Row], hotspots| {
        group.is_empty() || group.iter().any(|row| row.hotspots == hotspots)
    };
    let compared = |row: &&'a Row| groups.iter().all(|group| has(group, row.hotspots));
    groups
        .iter()
        .map(|rows| rows.iter().copied().filter(compared).collect())
        .collect()
}

/// The numbers of hotspots among rows, rising.
pub fn numbers_of_hotspots(rows: &[&Row]) -> Vec<u32> {
    let numbers: std::collections::BTreeSet<u32> = rows.iter().map(|row| row.hotspots).collect();
    numbers.into_iter().collect()
}

/// Whether a policy of the table is a script, not learnt.
pub fn is_baseline(policy: &str) -> bool {
    jcas_policy::BaselineKind::named(policy).is_ok()
}

#[cfg(test)]
pub(crate) mod testing {
    use super::*;

    /// A table of successes in cells (N, n) with these seeds.
    pub(crate) fn opened(name: &str, rows: &[(u32, u32, u64)]) -> Result<Table, TrainError> {
        let path = std::env::temp_dir().join(format!("jcas-{name}-{}.csv", std::process::id()));
        let quantities = [
            "success_rate",
            "mission_steps",
            "energy_kwh",
            "throughput",
            "co2_kg",
        ];
        let columns = quantities.map(|name| format!("{name},{name}_low,{name}_high,"));
        let mut text = format!(
            "experiment,preset,uavs,hotspots,policy,pilot,seed,x,config_hash,episodes,\
             {}pilot_density\n",
            columns.concat()
        );
        for (uavs, hotspots, seed) in rows {
            let values = "1,1,1,".repeat(quantities.len());
            text += &format!(
                "grid,paper,{uavs},{hotspots},ppo,adaptive,{seed},0.0,0x0,1000,{values}0.2\n"
            );
        }
        std::fs::write(&path, text).unwrap();
        let table = Table::open(&path);
        std::fs::remove_file(&path).unwrap();
        table
    }

    /// The same where every cell is there once for each seed.
    pub(crate) fn table(name: &str, rows: &[(u32, u32, u64)]) -> Table {
        opened(name, rows).unwrap()
    }
}

#[cfg(test)]
mod tests {
    use super::testing::{opened, table};
    use super::*;

    // As where two folders' tables were put together by hand: a mean would count it twice.
    #[test]
    fn a_campaign_that_is_there_twice_is_refused() {
        let seeds = |seeds: [u64; 2]| opened("twice", &seeds.map(|seed| (10, 5, seed)));
        assert_eq!(seeds([0, 1]).unwrap().rows.len(), 2);
        let told = seeds([0, 0]).unwrap_err().to_string();
        assert!(
            told.contains("line 3: grid, ppo, N = 10, n = 5 is there twice"),
            "{told}"
        );
    }

    // Three seeds of one cell beside one of the other: a mean over rows would be 0.75.
    #[test]
    fn a_cell_counts_once_however_many_seeds_it_has() {
        let cells = [(10, 3, 0), (10, 5, 0), (10, 5, 1), (10, 5, 2)];
        let mut table = table("seeds", &cells);
        table.rows[0].success_rate = 0.0;
        let rows: Vec<&Row> = table.rows.iter().collect();
        assert_eq!(mean(&rows, Quantity::Success).unwrap().value, 0.5);
        assert!(mean(&[], Quantity::Success).is_none());
    }

    // A mean over three to eleven hotspots is not to be held against one over five.
    #[test]
    fn fleets_are_compared_over_the_hotspots_that_all_have_flown() {
        let cells = [(5, 5, 0), (10, 3, 0), (10, 5, 0), (10, 7, 0)];
        let table = table("compared", &cells);
        let of = |uavs| {
            let of_fleet = |row: &&Row| row.uavs == uavs;
            table.rows.iter().filter(of_fleet).collect::<Vec<_>>()
        };
        let numbers = |groups: Vec<Vec<&Row>>| -> Vec<Vec<u32>> {
            let groups = in_common(groups);
            groups
                .iter()
                .map(|rows| numbers_of_hotspots(rows))
                .collect()
        };
        assert_eq!(
            numbers(vec![of(5), of(10), of(20)]),
            [vec![5], vec![5], vec![]]
        );
        assert_eq!(numbers(vec![of(10), of(20)]), [vec![3, 5, 7], vec![]]);
    }
}
