//! The results of a reproduction, one row for each campaign of missions.

mod query;
mod row;

pub use query::{Query, in_common, mean, numbers_of_hotspots};
pub use row::{Key, Quantity, Row};

use jcas_episode::statistics::Summary;
use jcas_train::error::TrainError;
use jcas_train::store::{csv_bytes, write_whole};
use std::collections::HashSet;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

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
