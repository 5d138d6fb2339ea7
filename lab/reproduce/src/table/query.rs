//! Selections of rows, and means over them.

use super::{Quantity, Row, Table};
use jcas_episode::statistics::Estimate;
use std::collections::{BTreeMap, BTreeSet};

/// A selection of rows; an absent field matches every value.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Query<'a> {
    /// As in [`Key`](super::Key).
    pub experiment: &'a str,
    /// As in [`Key`](super::Key).
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
    let numbers: BTreeSet<u32> = rows.iter().map(|row| row.hotspots).collect();
    numbers.into_iter().collect()
}
