//! Means over cells with both kinds of noise: that of the missions, and that between trainings.
//!
//! A cell's value comes from 1000 missions of one or several trainings. The missions' interval says
//! nothing about another training, so the standard deviation between training seeds enters as
//! well. It is pooled over all cells that have several seeds. For success it is in absolute terms,
//! for other quantities in parts of the cell's mean.

use crate::campaign::OURS;
use crate::scan::Scan;
use crate::statistics::{Measured, Spread, combination, error_of, pooled};
use crate::table::{Quantity, Row, Table};
use jcas_core::Preset;
use std::collections::BTreeMap;

/// Returns the spread between the training seeds of a policy.
///
/// Where the policy has one seed a cell, it is that of the paper's PPO. None where that has one
/// seed a cell as well.
pub fn between_seeds(
    table: &Table,
    preset: &str,
    policy: &str,
    quantity: Quantity,
) -> Option<Spread> {
    let own = of_policy(table, preset, policy, quantity);
    own.or_else(|| of_policy(table, Preset::Paper.name(), "ppo", quantity))
}

/// Returns the spread of success between trainings with the paper's settings, pooled over the cells
/// of both tables.
pub fn of_trainings(table: &Table, scan: &Scan) -> Option<Spread> {
    let mut groups = by_seeds(table, Preset::Paper.name(), "ppo", Quantity::Success);
    groups.extend(scan.by_seeds());
    pooled(&groups)
}

fn of_policy(table: &Table, preset: &str, policy: &str, quantity: Quantity) -> Option<Spread> {
    pooled(&by_seeds(table, preset, policy, quantity))
}

/// The values of each cell, one a training seed.
fn by_seeds(table: &Table, preset: &str, policy: &str, quantity: Quantity) -> Vec<Vec<f64>> {
    let mut cells: BTreeMap<_, Vec<f64>> = BTreeMap::new();
    for row in &table.rows {
        if row.experiment == "grid" && row.preset == preset && row.policy == policy {
            let cell = (row.uavs, row.hotspots, &row.pilot);
            let value = row.estimate(quantity).value;
            cells.entry(cell).or_default().push(value);
        }
    }
    let relative = |values: Vec<f64>| {
        let mean = values.iter().sum::<f64>() / values.len() as f64;
        let unit = if is_absolute(quantity) { 1.0 } else { mean };
        values.iter().map(|value| value / unit).collect()
    };
    cells.into_values().map(relative).collect()
}

const fn is_absolute(quantity: Quantity) -> bool {
    matches!(quantity, Quantity::Success)
}

/// Returns the mean of each number of hotspots among rows of one fleet and one policy. Seeds share
/// their missions, so the missions' noise does not shrink with the number of seeds.
pub fn by_hotspots(
    rows: &[&Row],
    quantity: Quantity,
    spread: Option<Spread>,
) -> BTreeMap<u32, Measured> {
    let mut cells: BTreeMap<u32, Vec<&Row>> = BTreeMap::new();
    for row in rows {
        cells.entry(row.hotspots).or_default().push(row);
    }
    let mean = |seeds: Vec<&Row>| {
        let count = seeds.len() as f64;
        let estimates = seeds.iter().map(|row| row.estimate(quantity));
        let value = estimates.clone().map(|e| e.value).sum::<f64>() / count;
        let missions = estimates.map(|e| error_of(&e)).sum::<f64>() / count;
        let unit = if is_absolute(quantity) { 1.0 } else { value };
        let trainings = spread.map_or(0.0, |spread| spread.deviation * unit / count.sqrt());
        Measured {
            value,
            error: missions.hypot(trainings),
            freedom: spread.map_or(f64::INFINITY, |spread| spread.freedom),
        }
    };
    cells.into_iter().map(|(n, rows)| (n, mean(rows))).collect()
}

/// Returns the mean over the numbers of hotspots.
pub fn over_hotspots(cells: &BTreeMap<u32, Measured>) -> Measured {
    let weight = 1.0 / cells.len() as f64;
    combination(cells.values().map(|&cell| (weight, cell)))
}

/// Returns what the results know of the spread between seeds, in a sentence each.
pub fn told(table: &Table) -> String {
    let policies = [
        (Preset::Paper, "ppo", "the paper's PPO"),
        (Preset::Paper, OURS, "our policy in `paper`"),
        (Preset::Mission, OURS, "our policy in `mission`"),
    ];
    let mut text = String::new();
    for (preset, policy, title) in policies {
        let of = |quantity| of_policy(table, preset.name(), policy, quantity);
        let [Some(success), Some(steps), Some(energy), Some(throughput)] = [
            Quantity::Success,
            Quantity::Steps,
            Quantity::Energy,
            Quantity::Throughput,
        ]
        .map(of) else {
            continue;
        };
        text += &format!(
            "For {title} it has {} degrees of freedom and is {:.2} points of success. It is {:.1} \
                % of the steps, {:.1} % of the energy and {:.1} % of the throughput. ",
            success.freedom,
            100.0 * success.deviation,
            100.0 * steps.deviation,
            100.0 * energy.deviation,
            100.0 * throughput.deviation,
        );
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::table::testing::table;

    fn success(name: &str, values: &[(u32, u64, f64)]) -> Table {
        let cells: Vec<(u32, u32, u64)> = values.iter().map(|v| (v.0, 5, v.1)).collect();
        let mut table = table(name, &cells);
        for (row, value) in table.rows.iter_mut().zip(values) {
            row.success_rate = value.2;
            (row.success_rate_low, row.success_rate_high) = (value.2 - 0.0196, value.2 + 0.0196);
        }
        table
    }

    // numpy.std([0.3, 0.4, 0.5], ddof=1) = 0.1; a cell with one seed tells nothing.
    #[test]
    fn seeds_spread_within_their_cell() {
        let several = [(10, 0, 0.3), (10, 1, 0.4), (10, 2, 0.5), (15, 0, 0.9)];
        let table = success("several", &several);
        let spread = between_seeds(&table, "paper", "ppo", Quantity::Success).unwrap();
        assert!((spread.deviation - 0.1).abs() < 1e-12, "{spread:?}");
        assert_eq!(spread.freedom, 2.0);
        assert_eq!(
            between_seeds(&table, "paper", "ppo-uav", Quantity::Success),
            Some(spread)
        );
        let one = success("one-each", &[(10, 0, 0.3), (15, 0, 0.9)]);
        assert_eq!(between_seeds(&one, "paper", "ppo", Quantity::Success), None);
    }

    // Missions leave 0.0196/1.96 = 0.01; four seeds of 0.0751 leave 0.0751/2.
    #[test]
    fn both_noises_are_in_a_cells_error() {
        let four = [(10, 0, 0.3), (10, 1, 0.4), (10, 2, 0.5), (10, 3, 0.4)];
        let table = success("four", &four);
        let rows: Vec<&Row> = table.rows.iter().collect();
        let spread = Spread {
            deviation: 0.0751,
            freedom: 7.0,
        };
        let cells = by_hotspots(&rows, Quantity::Success, Some(spread));
        let cell = over_hotspots(&cells);
        assert!((cell.value - 0.4).abs() < 1e-12);
        let expected = (0.01f64.powi(2) + 0.03755f64.powi(2)).sqrt();
        assert!((cell.error - expected).abs() < 1e-5, "{cell:?}");
        assert_eq!(cell.freedom, 7.0);
    }
}
