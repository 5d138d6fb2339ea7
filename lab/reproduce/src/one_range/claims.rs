//! The sentences of the paper that the rows at one range judge.

use super::{Range, pairs, within_rates};
use crate::fit::{PAPER, Published};
use crate::scan::PPO;
use crate::statistics::{CONFIDENCE, Measured, Spread, combination};
use crate::text::told;
use crate::verdict::{Effect, Region, Verdict, verdict};
use jcas_episode::statistics::Estimate;

/// Largest difference of pilot densities that the paper calls fluctuating.
const FLUCTUATION: f64 = 0.05;

/// Most intervals that are listed one by one.
const LISTED_MAX: usize = 5;

/// A claim of the paper beside what was measured.
pub(super) struct Claim {
    text: &'static str,
    effects: Vec<Effect>,
    region: Region,
    /// Whether every cell that the claim is about has been flown.
    complete: bool,
}

impl Range<'_> {
    pub(super) fn claims(&self, fleets: &[u32], hotspots: &[u32]) -> Vec<Claim> {
        let success = |cell| self.success(cell, PPO);
        let [
            Published {
                uavs: ten,
                rate: low,
                ..
            },
            Published {
                uavs: fifteen,
                rate: high,
                ..
            },
        ] = PAPER;
        let mean = self.mean(ten, hotspots, success);
        let mut claims = vec![Claim {
            text: "0.73 with 10 UAVs, on average over the target densities \
                (within what another training may give)",
            effects: mean.iter().map(|(mean, _)| Effect::Plain(*mean)).collect(),
            region: Region::AnotherTraining(low),
            complete: mean.is_some_and(|(_, complete)| complete),
        }];
        let (effects, complete) = effects_of(pairs(&[fifteen], hotspots), &|cell| {
            success(cell).map(Effect::Plain)
        });
        claims.push(Claim {
            text: "0.97 with 15 UAVs, for each number of hotspots (the same)",
            effects,
            region: Region::AnotherTraining(high),
            complete,
        });
        let throughput = |&uavs: &u32| self.mean(uavs, hotspots, |cell| self.throughput(cell, PPO));
        let means: Vec<_> = fleets.iter().filter_map(throughput).collect();
        claims.push(Claim {
            text: "normalised throughput above 1, for each fleet",
            complete: means.len() == fleets.len() && means.iter().all(|(_, complete)| *complete),
            effects: means
                .into_iter()
                .map(|(mean, _)| Effect::Plain(mean))
                .collect(),
            region: Region::Above(1.0),
        });
        claims.extend(self.sublinear(fleets, hotspots));
        claims.extend(self.constant(&[ten, fifteen], hotspots));
        claims
    }

    /// The energy of the largest fleet over that of the smallest, in units of their sizes.
    fn sublinear(&self, fleets: &[u32], hotspots: &[u32]) -> Option<Claim> {
        let (&least, &most) = (fleets.first()?, fleets.last()?);
        let of = |uavs| self.mean(uavs, hotspots, |cell| self.energy(cell));
        let ((small, all_small), (large, all_large)) = (of(least)?, of(most)?);
        let mut grown = combination([(1.0, large.ln()), (-1.0, small.ln())]);
        grown.value -= (f64::from(most) / f64::from(least)).ln();
        Some(Claim {
            text: "energy grows slower than the fleet (energy over N, largest over smallest fleet)",
            effects: vec![Effect::LogRatio(grown)],
            region: Region::Below(1.0),
            complete: least < most && all_small && all_large,
        })
    }

    fn constant(&self, fleets: &[u32; 2], hotspots: &[u32]) -> Vec<Claim> {
        let gaps = |uavs: u32| effects_of(pairs(&[uavs], hotspots), &|cell| self.gap(cell));
        let (at_ten, all_at_ten) = gaps(fleets[0]);
        let (at_fifteen, all_at_fifteen) = gaps(fleets[1]);
        let greatest = at_fifteen.iter().filter_map(|effect| match effect {
            Effect::Plain(measured) => Some(*measured),
            _ => None,
        });
        let greatest: Vec<Measured> = greatest.collect();
        let ratio = |&uavs: &u32| self.mean(uavs, hotspots, |cell| self.throughput_ratio(cell));
        let ratios: Vec<_> = fleets.iter().filter_map(ratio).collect();
        vec![
            Claim {
                text: "with 10 UAVs, adaptive and constant pilot within about 5 points",
                effects: at_ten,
                region: Region::Between(-FLUCTUATION, FLUCTUATION),
                complete: all_at_ten,
            },
            Claim {
                text: "with 15 UAVs, adapting improves success for some number of hotspots",
                effects: if greatest.is_empty() {
                    Vec::new()
                } else {
                    vec![Effect::Greatest(greatest)]
                },
                region: Region::Above(0.0),
                complete: all_at_fifteen,
            },
            Claim {
                text: "a constant pilot density lowers the throughput, for each of both fleets",
                complete: ratios.len() == fleets.len()
                    && ratios.iter().all(|(_, complete)| *complete),
                effects: ratios
                    .into_iter()
                    .map(|(mean, _)| Effect::LogRatio(mean))
                    .collect(),
                region: Region::Below(1.0),
            },
        ]
    }
}

impl Claim {
    /// A claim whose cells have been flown in part can be refuted, and does not hold yet.
    pub(super) fn verdict(&self, spread: Option<Spread>) -> Verdict {
        let found = verdict(&self.effects, self.region.ends(spread));
        match found {
            Verdict::Fails => Verdict::Fails,
            _ if !self.complete => Verdict::NotJudged,
            other => other,
        }
    }

    pub(super) fn row(&self, verdict: Verdict) -> [String; 3] {
        let is_rate = matches!(self.region, Region::AnotherTraining(_));
        let intervals = self.effects.iter().map(|effect| {
            let e = effect.interval(CONFIDENCE);
            if is_rate { within_rates(e) } else { e }
        });
        let mut intervals: Vec<Estimate> = intervals.collect();
        if intervals.len() > LISTED_MAX {
            intervals.sort_by(|a, b| a.value.total_cmp(&b.value));
            let ends = [intervals.first(), intervals.last()];
            let [least, greatest] = ends.map(|e| e.map_or(String::new(), |e| told(e, 2)));
            let cells = intervals.len();
            let here = format!("{least} to {greatest}, in {cells} cells");
            return [self.text.to_owned(), here, verdict.text().to_owned()];
        }
        let here: Vec<String> = intervals.iter().map(|e| told(e, 2)).collect();
        [
            self.text.to_owned(),
            here.join(", "),
            verdict.text().to_owned(),
        ]
    }
}

/// What the verdicts come to together, in a sentence.
pub(super) fn together(verdicts: &[Verdict]) -> String {
    let count = |of: Verdict| verdicts.iter().filter(|&&verdict| verdict == of).count();
    let (holds, fails) = (count(Verdict::Holds), count(Verdict::Fails));
    let open = verdicts.len() - holds - fails;
    let whole = if fails > 0 {
        "The range is therefore not compatible with all of them together."
    } else if open > 0 {
        "None refutes the range, and not all of them are shown."
    } else {
        "The range is compatible with all of them together."
    };
    let [hold, fail, are] = [
        counted(holds, "holds", "hold"),
        counted(fails, "fails", "fail"),
        counted(open, "is open", "are open"),
    ];
    format!(
        "Of {} sentences {hold}, {fail}, and {are}. {whole}",
        verdicts.len()
    )
}

/// A number with its verb.
fn counted(count: usize, one: &str, several: &str) -> String {
    format!("{count} {}", if count == 1 { one } else { several })
}

/// The effects of the cells that have been flown, and whether these are all.
fn effects_of(
    cells: Vec<(u32, u32)>,
    of: &dyn Fn((u32, u32)) -> Option<Effect>,
) -> (Vec<Effect>, bool) {
    let effects: Vec<Effect> = cells.iter().filter_map(|&cell| of(cell)).collect();
    let complete = effects.len() == cells.len();
    (effects, complete)
}

#[cfg(test)]
mod tests {
    use super::super::CONSTANT;
    use super::*;
    use crate::scan::testing::row;
    use crate::scan::{Flown, Scan, ScanRow};

    fn at(flown: Flown, (uavs, hotspots): (u32, u32), success: f64) -> ScanRow {
        ScanRow {
            hotspots,
            ..row(flown, 162.5, uavs, 0, success)
        }
    }

    fn verdicts(rows: Vec<ScanRow>) -> Vec<(&'static str, Verdict)> {
        let scan = Scan {
            rows,
            ..Scan::default()
        };
        let range = Range {
            scan: &scan,
            metres: 162.5,
            success: None,
            energy: None,
            throughput: None,
        };
        let (fleets, hotspots) = range.sizes();
        let claims = range.claims(&fleets, &hotspots);
        let judged = claims.iter().map(|claim| (claim.text, claim.verdict(None)));
        judged.collect()
    }

    fn of(verdicts: &[(&str, Verdict)], start: &str) -> Verdict {
        let found = verdicts.iter().find(|(text, _)| text.starts_with(start));
        found.expect("a claim that begins so").1
    }

    // 0.71 and 0.75 of 1000 missions have the mean 0.73; 0.5 lies outside Wilson's interval of 97
    // of 100, [0.915, 0.990].
    #[test]
    fn a_missing_cell_leaves_a_claim_open_and_a_wrong_one_refutes_it() {
        let mut rows = vec![
            at(PPO, (10, 5), 0.71),
            at(PPO, (10, 7), 0.75),
            at(PPO, (15, 5), 0.97),
        ];
        let found = verdicts(rows.clone());
        assert_eq!(of(&found, "0.73"), Verdict::Holds);
        assert_eq!(of(&found, "0.97"), Verdict::NotJudged);
        assert_eq!(of(&found, "a constant"), Verdict::NotJudged);
        rows.push(at(PPO, (15, 7), 0.5));
        assert_eq!(of(&verdicts(rows), "0.97"), Verdict::Fails);
    }

    #[test]
    fn the_constant_density_is_compared_cell_by_cell() {
        let cells = [(10, 5), (10, 7), (15, 5), (15, 7)];
        let mut rows: Vec<ScanRow> = cells.map(|cell| at(PPO, cell, 0.9)).to_vec();
        rows.extend(cells.map(|cell| ScanRow {
            throughput: 1.0,
            throughput_low: 0.99,
            throughput_high: 1.01,
            ..at(CONSTANT, cell, 0.7)
        }));
        let found = verdicts(rows);
        assert_eq!(of(&found, "a constant"), Verdict::Holds);
        assert_eq!(of(&found, "with 10"), Verdict::Fails);
        assert_eq!(of(&found, "with 15"), Verdict::Holds);
        assert_eq!(of(&found, "normalised"), Verdict::Holds);
    }

    // 0.4 kWh with ten as with fifteen UAVs: 2/3 of the energy for each.
    #[test]
    fn energy_is_compared_for_each_uav() {
        let rows = vec![at(PPO, (10, 5), 0.9), at(PPO, (15, 5), 0.9)];
        assert_eq!(of(&verdicts(rows), "energy"), Verdict::Holds);
    }

    #[test]
    fn verdicts_are_counted_together() {
        let text = together(&[Verdict::Holds, Verdict::NotJudged]);
        assert!(text.contains("None refutes the range"), "{text}");
        let text = together(&[Verdict::Holds, Verdict::Fails]);
        assert!(text.contains("not compatible with all"), "{text}");
    }
}
