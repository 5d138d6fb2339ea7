//! Readings of detection and of the start that are near the paper's text, beside the model's own.

use crate::chapter::Block;
use crate::fit::PAPER;
use crate::readings::{Line, compatible, ranges};
use crate::scan::{self, OTHER_READINGS, PPO, RANDOM, READINGS, Scan};
use crate::statistics::Spread;
use crate::text::told;

/// The range at which the readings stand beside the model's own.
const RANGE_M: f64 = 162.5;

/// A table of all readings, and the ranges that fit; none where they have not been flown.
pub(crate) fn blocks(scan: &Scan, spread: Option<Spread>) -> Vec<Block> {
    let flown: Vec<(&'static str, &'static str)> = OTHER_READINGS
        .into_iter()
        .filter(|(reading, _)| scan.rows.iter().any(|row| row.reading == *reading))
        .collect();
    if flown.is_empty() {
        return Vec::new();
    }
    let mut rows = rows(scan, READINGS[1], "the model", &[RANGE_M], spread);
    for &(reading, field) in &flown {
        let ranges = ranges(scan, &lines(&[(reading, field)]));
        let field = format!("`{field}`");
        rows.extend(self::rows(scan, reading, &field, &ranges, spread));
    }
    let of = |policy| PAPER.map(|published| format!("{policy}, N = {}", published.uavs));
    let mut head = vec!["reading".to_owned(), "range (m)".to_owned()];
    for policy in [RANDOM.2, "PPO"] {
        head.extend(of(policy));
    }
    vec![
        Block::Text(INTRODUCTION.to_owned()),
        Block::Table {
            caption: "Success under other readings of detection and start".to_owned(),
            head,
            rows,
        },
        Block::Text(format!(
            "Both numbers of the paper are compatible with these readings at these ranges:\n\n{}",
            compatible(scan, &lines(&flown), spread)
        )),
    ]
}

const INTRODUCTION: &str = "Other readings of detection and of the start are near the paper's \
    text. Each field below changes one of them, with informing paid once \
    ([the model](../docs/model.md#other-readings-of-detection)). With a quorum over the episode a \
    hotspot is confirmed once three UAVs have detected it in any steps. With own detections a UAV \
    knows a hotspot from its own detection on. With random starts each UAV starts in a cell of its \
    own.";

fn lines(flown: &[(&'static str, &'static str)]) -> Vec<Line> {
    let mut lines = Vec::new();
    for &(reading, field) in flown {
        lines.push((reading, RANDOM, format!("`{field}`, a random walk")));
        lines.push((reading, PPO, format!("`{field}`, PPO")));
    }
    lines
}

/// One row for each range: a random walk and PPO, each with both fleets.
fn rows(
    scan: &Scan,
    reading: &str,
    title: &str,
    ranges: &[f64],
    spread: Option<Spread>,
) -> Vec<Vec<String>> {
    let row = |&range_m: &f64| {
        let mut row = vec![title.to_owned(), range_m.to_string()];
        for flown in [RANDOM, PPO] {
            row.extend(PAPER.map(|published| {
                let rows = scan.cell(reading, range_m, published.uavs, flown);
                scan::success_interval(&rows, spread).map_or(String::new(), |e| told(&e, 3))
            }));
        }
        row
    };
    ranges.iter().map(row).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scan::testing::row;

    #[test]
    fn a_reading_stands_beside_the_models_own() {
        let other = |mut row: scan::ScanRow| {
            row.reading = OTHER_READINGS[0].0.to_owned();
            row
        };
        let scan = Scan {
            rows: vec![
                row(RANDOM, RANGE_M, 10, 0, 0.863),
                row(RANDOM, RANGE_M, 15, 0, 0.982),
                other(row(RANDOM, 75.0, 10, 0, 0.702)),
                other(row(RANDOM, 75.0, 15, 0, 0.941)),
            ],
            ..Scan::default()
        };
        let blocks = blocks(&scan, None);
        let [
            Block::Text(_),
            Block::Table { head, rows, .. },
            Block::Text(fits),
        ] = &blocks[..]
        else {
            panic!("a text, a table and a text");
        };
        assert_eq!((head.len(), rows.len()), (6, 2));
        assert!(rows[0][0] == "the model" && rows[0][2].starts_with("0.863"));
        assert!(rows[1][0] == "`quorum_window = episode`" && rows[1][3].starts_with("0.941"));
        assert!(
            fits.contains("a random walk (75 m): at 75 m (the only one"),
            "{fits}"
        );
    }

    #[test]
    fn nothing_is_said_of_readings_that_were_not_flown() {
        let scan = Scan {
            rows: vec![row(RANDOM, RANGE_M, 10, 0, 0.863)],
            ..Scan::default()
        };
        assert!(blocks(&scan, None).is_empty());
    }
}
