//! The chapter on one sensing range for all numbers of the paper, with informing paid once. They
//! are success over fleets and hotspots, energy, throughput and the constant pilot density.

mod claims;

use crate::cell_means::{between_seeds, of_trainings};
use crate::chapter::{Block, Chapter};
use crate::results::Results;
use crate::scan::{self, Flown, PPO, RANDOM, READINGS, Scan, ScanRow, success_interval};
use crate::statistics::{CONFIDENCE, Measured, Spread, combination};
use crate::table::Quantity;
use crate::text::told;
use crate::verdict::{Effect, Verdict};
use claims::together;
use jcas_core::Preset;
use jcas_episode::statistics::Estimate;
use std::collections::BTreeSet;

/// The reading of the scan over fleets and hotspots.
const READING: &str = READINGS[1];
/// The paper's PPO, trained with a constant pilot density.
const CONSTANT: Flown = ("ppo", "0.3", "the paper's PPO, pilot density 0.3");
/// Head of the table of claims.
const HEAD: [&str; 3] = ["the paper", "here", "verdict"];

/// The cells of the scan at one range.
struct Range<'r> {
    scan: &'r Scan,
    metres: f64,
    success: Option<Spread>,
    energy: Option<Spread>,
    throughput: Option<Spread>,
}

/// The chapter. There is none if no range has several numbers of hotspots.
pub fn chapter(results: &Results) -> Option<Chapter> {
    let range = Range::of(results)?;
    let (fleets, hotspots) = range.sizes();
    let mut blocks = vec![
        Block::Text(range.introduction()),
        range.success_table(&fleets, &hotspots),
        range.cost_table(&fleets, &hotspots),
    ];
    blocks.extend(range.constant_table(&fleets, &hotspots));
    let claims = range.claims(&fleets, &hotspots);
    let verdicts: Vec<Verdict> = claims
        .iter()
        .map(|claim| claim.verdict(range.success))
        .collect();
    blocks.push(Block::Text(format!(
        "The paper's sentences are judged by these rows of \
            [inform_once.csv](results/inform_once.csv), with the rule of the chapter on its \
            claims. A sentence of which cells are missing can fail; it is not judged otherwise. {}",
        together(&verdicts)
    )));
    let judged = claims.iter().zip(&verdicts);
    let rows = judged.map(|(claim, verdict)| claim.row(*verdict)).collect();
    blocks.push(Block::table(
        "The paper's sentences at one range",
        HEAD,
        rows,
    ));
    Some(Chapter {
        heading: "One range for all numbers".to_owned(),
        blocks,
    })
}

impl<'r> Range<'r> {
    /// The range at which PPO has flown with most fleets and numbers of hotspots.
    fn of(results: &'r Results) -> Option<Range<'r>> {
        let scan = &results.scan;
        let sizes = |&metres: &f64| cells_at(scan, metres).len();
        let ranges = scan.ranges(READING, PPO);
        let metres = ranges.into_iter().max_by_key(sizes)?;
        let hotspots: BTreeSet<u32> = cells_at(scan, metres).iter().map(|cell| cell.1).collect();
        if hotspots.len() < 2 {
            return None;
        }
        let relative =
            |quantity| between_seeds(&results.table, Preset::Paper.name(), PPO.0, quantity);
        Some(Range {
            scan,
            metres,
            success: of_trainings(&results.table, scan),
            energy: relative(Quantity::Energy),
            throughput: relative(Quantity::Throughput),
        })
    }

    fn sizes(&self) -> (Vec<u32>, Vec<u32>) {
        let cells = cells_at(self.scan, self.metres);
        let fleets: BTreeSet<u32> = cells.iter().map(|cell| cell.0).collect();
        let hotspots: BTreeSet<u32> = cells.iter().map(|cell| cell.1).collect();
        (fleets.into_iter().collect(), hotspots.into_iter().collect())
    }

    fn rows(&self, cell: (u32, u32), flown: Flown) -> Vec<&'r ScanRow> {
        self.scan.at(READING, self.metres, cell, flown)
    }

    fn success(&self, cell: (u32, u32), flown: Flown) -> Option<Measured> {
        scan::success(&self.rows(cell, flown), self.success)
    }

    fn energy(&self, cell: (u32, u32)) -> Option<Measured> {
        let rows = self.rows(cell, PPO);
        scan::measured(&rows, ScanRow::energy_kwh, self.energy, |mean| mean)
    }

    fn throughput(&self, cell: (u32, u32), flown: Flown) -> Option<Measured> {
        let rows = self.rows(cell, flown);
        scan::measured(&rows, ScanRow::throughput, self.throughput, |mean| mean)
    }

    /// The mean over the numbers of hotspots that a fleet has flown, and whether these are all.
    fn mean(
        &self,
        uavs: u32,
        hotspots: &[u32],
        of: impl Fn((u32, u32)) -> Option<Measured>,
    ) -> Option<(Measured, bool)> {
        let flown: Vec<Measured> = hotspots.iter().filter_map(|&n| of((uavs, n))).collect();
        if flown.is_empty() {
            return None;
        }
        let weight = 1.0 / flown.len() as f64;
        let mean = combination(flown.iter().map(|&cell| (weight, cell)));
        Some((mean, flown.len() == hotspots.len()))
    }

    fn introduction(&self) -> String {
        format!(
            "Is one sensing range compatible with the other numbers of the paper, too? At {} m the \
                paper's PPO was trained for each fleet and number of hotspots, with informing paid \
                {READING}. A cell has one training seed where the first table has no more. The \
                intervals have the noise of the missions and the spread between trainings. A cell \
                that has not been run is empty. The rows are those of [{}](results/{}).",
            self.metres,
            scan::TABLES[0],
            scan::TABLES[0],
        )
    }

    fn success_table(&self, fleets: &[u32], hotspots: &[u32]) -> Block {
        let mut head = vec!["N".to_owned(), "policy".to_owned()];
        head.extend(hotspots.iter().map(|n| format!("n = {n}")));
        head.push("mean".to_owned());
        let mut rows = Vec::new();
        for &uavs in fleets {
            for flown in [PPO, RANDOM] {
                let cell = |&n: &u32| {
                    let rows = self.rows((uavs, n), flown);
                    success_interval(&rows, self.success).map_or(String::new(), |e| told(&e, 2))
                };
                let mean = self.mean(uavs, hotspots, |cell| self.success(cell, flown));
                let mut row = vec![uavs.to_string(), flown.2.to_owned()];
                row.extend(hotspots.iter().map(cell));
                row.push(mean.map_or(String::new(), |(mean, complete)| {
                    let e = within_rates(mean.interval(CONFIDENCE));
                    format!(
                        "{}{}",
                        told(&e, 2),
                        if complete { "" } else { " (in part)" }
                    )
                }));
                if row[2..].iter().any(|entry| !entry.is_empty()) {
                    rows.push(row);
                }
            }
        }
        Block::Table {
            caption: format!("Success at {} m", self.metres),
            head,
            rows,
        }
    }

    fn cost_table(&self, fleets: &[u32], hotspots: &[u32]) -> Block {
        let rows = fleets.iter().map(|&uavs| {
            let entry = |of: &dyn Fn((u32, u32)) -> Option<Measured>, digits| {
                let mean = self.mean(uavs, hotspots, of);
                mean.map_or(String::new(), |(mean, _)| {
                    told(&mean.interval(CONFIDENCE), digits)
                })
            };
            let steps = |cell| {
                let rows = self.rows(cell, PPO);
                scan::measured(&rows, ScanRow::steps, None, |mean| mean)
            };
            [
                uavs.to_string(),
                entry(&steps, 1),
                entry(&|cell| self.energy(cell), 3),
                entry(&|cell| self.throughput(cell, PPO), 2),
            ]
        });
        Block::table(
            "Steps, energy and throughput of the paper's PPO, mean over n",
            ["N", "steps (missions alone)", "energy (kWh)", "throughput"],
            rows.collect(),
        )
    }

    /// The cells that were trained with the constant pilot density as well.
    fn constant_table(&self, fleets: &[u32], hotspots: &[u32]) -> Option<Block> {
        let mut rows = Vec::new();
        for cell in pairs(fleets, hotspots) {
            let (Some(gap), Some(ratio)) = (self.gap(cell), self.throughput_ratio(cell)) else {
                continue;
            };
            let of = |flown| {
                let rows = self.rows(cell, flown);
                success_interval(&rows, self.success).map_or(String::new(), |e| told(&e, 2))
            };
            rows.push([
                cell.0.to_string(),
                cell.1.to_string(),
                of(PPO),
                of(CONSTANT),
                told(&gap.interval(CONFIDENCE), 2),
                told(&Effect::LogRatio(ratio).interval(CONFIDENCE), 2),
            ]);
        }
        let head = [
            "N",
            "n",
            "success, adaptive",
            "success, 0.3",
            "adaptive less constant",
            "throughput, constant over adaptive",
        ];
        (!rows.is_empty()).then(|| Block::table("The constant pilot density", head, rows))
    }

    fn gap(&self, cell: (u32, u32)) -> Option<Effect> {
        let (adaptive, constant) = (self.success(cell, PPO)?, self.success(cell, CONSTANT)?);
        Some(Effect::Plain(combination([
            (1.0, adaptive),
            (-1.0, constant),
        ])))
    }

    /// The logarithm of the throughput with the constant density over that with the adaptive one.
    fn throughput_ratio(&self, cell: (u32, u32)) -> Option<Measured> {
        let (adaptive, constant) = (
            self.throughput(cell, PPO)?,
            self.throughput(cell, CONSTANT)?,
        );
        Some(combination([(1.0, constant.ln()), (-1.0, adaptive.ln())]))
    }
}

/// The fleets and numbers of hotspots with which PPO has flown at a range.
fn cells_at(scan: &Scan, metres: f64) -> BTreeSet<(u32, u32)> {
    let rows = scan.rows.iter().filter(|row| {
        (
            row.reading.as_str(),
            row.policy.as_str(),
            row.pilot.as_str(),
        ) == (READING, PPO.0, PPO.1)
            && row.range_m == metres
    });
    rows.map(|row| (row.uavs, row.hotspots)).collect()
}

fn pairs(fleets: &[u32], hotspots: &[u32]) -> Vec<(u32, u32)> {
    let of = |&uavs: &u32| hotspots.iter().map(move |&n| (uavs, n));
    fleets.iter().flat_map(of).collect()
}

fn within_rates(e: Estimate) -> Estimate {
    Estimate {
        low: e.low.max(0.0),
        high: e.high.min(1.0),
        ..e
    }
}
