//! Study of the effect of a training's seed, over cells with several seeds.

use crate::campaign::{OURS, pilot_name};
use crate::chapter::{Block, Chapter};
use crate::readings::FITTED;
use crate::scope::Scope;
use crate::table::{Quantity, Query, Row, Table};
use jcas_core::Preset;

const HEAD: [&str; 6] = [
    "preset",
    "who",
    "pilot",
    "cells × seeds",
    "success: intervals overlap; greatest difference",
    "steps: intervals overlap; greatest difference",
];

/// The chapter as far as the table has several seeds; none without.
pub fn chapter(scope: &Scope, table: &Table) -> Option<Chapter> {
    let rows: Vec<[String; 6]> = flown(scope)
        .into_iter()
        .filter_map(|(preset, title, policy, pilot)| {
            let query = Query::new("grid", preset.name(), (policy, pilot));
            let of = |(uavs, hotspots)| query.uavs(uavs).hotspots(hotspots).rows(table);
            let seeds = scope.cells().into_iter().map(of);
            let several: Vec<Vec<&Row>> = seeds.filter(|seeds| seeds.len() > 1).collect();
            if several.is_empty() {
                return None;
            }
            Some([
                format!("`{}`", preset.name()),
                title,
                pilot.to_owned(),
                counts(&several),
                Spread::of(&several, Quantity::Success).text(),
                Spread::of(&several, Quantity::Steps).text(),
            ])
        })
        .collect();
    if rows.is_empty() {
        return None;
    }
    Some(Chapter {
        heading: "What a training's seed changes".to_owned(),
        blocks: vec![
            Block::Text(format!("{}\n\n{FITTED}", text(scope))),
            Block::table("Trainings with several seeds", HEAD, rows),
        ],
    })
}

fn text(scope: &Scope) -> String {
    format!(
        "Some cells (N × n) were flown with several seeds of the paper's training, or several \
            policies given as ours, on the same {} missions. In how many do the 95 % intervals of \
            all of them have a value in common, and where are two farthest apart? Such an \
            interval is one of the missions, for the policy at hand. What trainings come to \
            varies besides, and this is how much.",
        scope.episodes
    )
}

/// Policies that may have several training seeds: preset, title, name in the table, pilot rule.
fn flown(scope: &Scope) -> Vec<(Preset, String, &'static str, &'static str)> {
    let pilots = || scope.paper_pilots.iter().map(|&pilot| pilot_name(pilot));
    let mut all = Vec::new();
    for learner in scope.learners() {
        let title = learner.title.to_owned();
        all.extend(pilots().map(|pilot| (Preset::Paper, title.clone(), learner.name, pilot)));
    }
    for preset in [Preset::Paper, Preset::Mission] {
        all.extend(pilots().map(|pilot| (preset, "our policy".to_owned(), OURS, pilot)));
    }
    all
}

/// How many cells there are with how many seeds.
fn counts(cells: &[Vec<&Row>]) -> String {
    let mut numbers: Vec<usize> = cells.iter().map(Vec::len).collect();
    numbers.sort_unstable();
    let runs = numbers.chunk_by(|a, b| a == b);
    let runs: Vec<String> = runs
        .map(|run| format!("{} × {}", run.len(), run[0]))
        .collect();
    runs.join("; ")
}

/// How far seeds are apart.
struct Spread {
    quantity: Quantity,
    /// Cells, and those in which the intervals of all seeds have a value in common.
    cells: usize,
    overlapping: usize,
    /// The greatest difference between two seeds of a cell, with the cell. It is absolute for
    /// success, and relative to the smaller value for other quantities.
    greatest: f64,
    at: (u32, u32),
}

impl Spread {
    fn of(cells: &[Vec<&Row>], quantity: Quantity) -> Spread {
        let mut spread = Spread {
            quantity,
            cells: cells.len(),
            overlapping: 0,
            greatest: -1.0,
            at: (0, 0),
        };
        for seeds in cells {
            let (mut low, mut high) = (f64::NEG_INFINITY, f64::INFINITY);
            let (mut least, mut most) = (f64::INFINITY, f64::NEG_INFINITY);
            for row in seeds {
                let e = row.estimate(quantity);
                (low, high) = (low.max(e.low), high.min(e.high));
                (least, most) = (least.min(e.value), most.max(e.value));
            }
            spread.overlapping += usize::from(low <= high);
            let difference = match quantity {
                Quantity::Success => most - least,
                _ => (most - least) / least.max(f64::MIN_POSITIVE),
            };
            if difference > spread.greatest {
                spread.greatest = difference;
                spread.at = (seeds[0].uavs, seeds[0].hotspots);
            }
        }
        spread
    }

    fn text(&self) -> String {
        let (uavs, hotspots) = self.at;
        let greatest = match self.quantity {
            Quantity::Success => format!("{:.3}", self.greatest),
            _ => format!("{:.1} %", 100.0 * self.greatest),
        };
        format!(
            "in {} of {}; {greatest} ({uavs} × {hotspots})",
            self.overlapping, self.cells
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::table::testing::table;

    #[test]
    fn seeds_are_compared_within_their_cell() {
        let mut table = table("spread", &[(10, 3, 0), (10, 3, 1), (10, 5, 0), (10, 5, 1)]);
        for (row, [value, half]) in
            table
                .rows
                .iter_mut()
                .zip([[0.50, 0.02], [0.53, 0.02], [0.9, 0.03], [1.0, 0.03]])
        {
            row.success_rate = value;
            (row.success_rate_low, row.success_rate_high) = (value - half, value + half);
            row.mission_steps = 100.0 * value;
        }
        let rows: Vec<&Row> = table.rows.iter().collect();
        let cells: Vec<Vec<&Row>> = rows.chunks(2).map(<[_]>::to_vec).collect();
        let success = Spread::of(&cells, Quantity::Success);
        // 0.52 and 0.51 overlap, 0.93 and 0.97 do not.
        assert_eq!((success.cells, success.overlapping), (2, 1));
        assert_eq!(success.text(), "in 1 of 2; 0.100 (10 × 5)");
        // 11.1 % of 90 steps, against 6 % of 50.
        assert!(
            Spread::of(&cells, Quantity::Steps)
                .text()
                .ends_with("; 11.1 % (10 × 5)")
        );
        assert_eq!(counts(&cells), "2 × 2");
    }

    #[test]
    fn one_seed_makes_no_chapter() {
        let scope = Scope::full(1);
        let one = table("one", &[(10, 3, 0), (10, 5, 0)]);
        assert!(chapter(&scope, &one).is_none());
        let two = table("two", &[(10, 3, 0), (10, 5, 0), (10, 5, 1)]);
        let page = chapter(&scope, &two).unwrap().markdown("");
        assert!(
            page.contains(
                "| the paper's PPO, credit of the team | adaptive | 1 × 2 | in 1 of 1; \
                0.000 (10 × 5) |"
            ),
            "{page}"
        );
    }
}
