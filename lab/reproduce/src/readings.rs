//! The first chapter: the paper's two numbers over the sensing range, under each reading of its
//! reward.

use crate::campaign::OURS;
use crate::cell_means::of_trainings;
use crate::chapter::Block;
use crate::fit::{PAPER, Published};
use crate::other_readings;
use crate::results::Results;
use crate::scan::{self, Flown, HOTSPOTS, PLANNERS, PPO, RANDOM, READINGS, Scan, TEAMS};
use crate::statistics::Spread;
use crate::table::{Quantity, Query};
use crate::text::told;
use crate::verdict::one_training;
use jcas_core::Preset;
use jcas_episode::statistics::Estimate;
use jcas_figures::{Axis, Figure, Panels, Point, Series};

/// Stands beside every number of the preset `paper`.
pub const FITTED: &str = "The preset `paper` has a sensing range of 150 m. This range was chosen \
    by fitting a random walk to the paper's two success rates; the paper does not give it.";
/// Sensing range of the preset `paper`.
pub(crate) const FITTED_M: f64 = 150.0;

/// The lines of the figure and the columns of the table: reading, policy, title.
fn lines() -> Vec<Line> {
    let mut lines = vec![(READINGS[1], RANDOM, RANDOM.2.to_owned())];
    lines.extend(READINGS.map(|reading| (reading, PPO, format!("PPO, paid {reading}"))));
    lines.extend(PLANNERS.map(|planner| (READINGS[1], planner, planner.0.to_owned())));
    lines
}

/// Every range of these lines in the scan, rising.
pub(crate) fn ranges(scan: &Scan, lines: &[Line]) -> Vec<f64> {
    let all = lines.iter().flat_map(|line| scan.ranges(line.0, line.1));
    let mut ranges: Vec<f64> = all.collect();
    ranges.sort_by(f64::total_cmp);
    ranges.dedup();
    ranges
}

/// The spread between trainings with the paper's settings, of all results together.
fn spread(results: &Results) -> Option<Spread> {
    of_trainings(&results.table, &results.scan)
}

/// The first blocks of the page; none where the scan has not been run.
pub fn numbers(results: &Results) -> Vec<Block> {
    let scan = &results.scan;
    if scan.rows.is_empty() {
        return Vec::new();
    }
    let spread = spread(results);
    let title = "Success over the sensing range, under three readings of the reward";
    let mut blocks = vec![
        Block::Text(introduction(results, spread)),
        Block::figure("two_numbers", title, figure(results, spread)),
    ];
    for published in PAPER {
        let alone = one_training(published, None);
        let trained = one_training(published, spread);
        blocks.push(Block::Text(format!(
            "N = {}. The paper: {} {} by its missions, {} with the spread between trainings.",
            published.uavs,
            published.rate,
            ends(&alone),
            ends(&trained)
        )));
        let rows = ranges(scan, &lines()).into_iter().map(|range_m| {
            let cell = |(reading, flown, _): Line| {
                let rows = scan.cell(reading, range_m, published.uavs, flown);
                scan::success_interval(&rows, spread).map_or(String::new(), |e| told(&e, 3))
            };
            let chosen = if range_m == FITTED_M { " (fitted)" } else { "" };
            let mut row = vec![format!("{range_m}{chosen}")];
            row.extend(lines().into_iter().map(cell));
            row
        });
        let mut head = vec!["range (m)".to_owned()];
        head.extend(lines().into_iter().map(|line| line.2));
        blocks.push(Block::Table {
            caption: format!("Success at N = {}, n = {HOTSPOTS}", published.uavs),
            head,
            rows: rows.collect(),
        });
    }
    blocks.push(Block::Text(format!(
        "The ranges at which both numbers of the paper are compatible with the measured rates are \
            these. A rate is \
         compatible where the interval of its difference from the paper's number has 0.\n\n{}\n\
         Beyond the edge of a scan others may be. Where several ranges are compatible, the two \
            numbers do not tell which of them the paper used.",
        compatible(scan, &lines(), spread)
    )));
    blocks.extend(other_readings::blocks(scan, spread));
    blocks
}

/// What the results come to, before anything else; none where the scan has not been run.
pub fn finding(results: &Results) -> Option<String> {
    let scan = &results.scan;
    let spread = spread(results);
    let rates = PAPER.map(|at| format!("{} with {} UAVs", at.rate, at.uavs));
    let mut text = format!(
        "How often informing is paid decides how near the paper's PPO comes to its success rates, \
            {}.",
        rates.join(" and ")
    );
    let mut shown = Vec::new();
    for reading in READINGS {
        let (both, tried) = scan::compatible(scan, reading, PPO, spread);
        let (Some(first), Some(last)) = (tried.first(), tried.last()) else {
            continue;
        };
        let at = match both.len() {
            0 => "none".to_owned(),
            _ => format!("{} m,", metres(&both)),
        };
        text += &format!(
            " Paid {reading}, it is compatible with both at {at} of the ranges from {first} to \
                {last} m."
        );
        let inside = |&range_m: &f64| scan::is_inside(scan, reading, range_m, spread);
        shown.extend(both.into_iter().filter(inside));
    }
    text += &match shown.len() {
        0 => " **No range is shown to fit**, which takes the intervals of both rates inside those \
            of the paper."
            .to_owned(),
        _ => format!(
            " At {} m the intervals of both rates lie inside those of the paper.",
            metres(&shown)
        ),
    };
    let trained = scan.by_seeds();
    let fewest = trained.iter().map(Vec::len).min()?;
    let most = trained.iter().map(Vec::len).max()?;
    let cells = beside_random(scan);
    text += &format!(
        " A cell has {fewest} to {most} trainings, which differ{}. A random walk succeeds at least \
            as often as PPO in {} of {} cells.",
        spread.map_or(String::new(), |spread| format!(
            " by a standard deviation of {:.1} points",
            100.0 * spread.deviation
        )),
        cells.iter().filter(|(ppo, random)| random >= ppo).count(),
        cells.len()
    );
    Some(text + &scripts(scan))
}

fn metres(ranges: &[f64]) -> String {
    let ranges: Vec<String> = ranges.iter().map(f64::to_string).collect();
    ranges.join(", ")
}

/// Success of PPO and of a random walk, in each cell of each reading that both have flown.
fn beside_random(scan: &Scan) -> Vec<(f64, f64)> {
    let mut cells = Vec::new();
    for reading in READINGS {
        for range_m in scan.ranges(reading, PPO) {
            for published in PAPER {
                let of = |reading, flown| {
                    let rows = scan.cell(reading, range_m, published.uavs, flown);
                    Some(scan::success(&rows, None)?.value)
                };
                // What is paid does not change how a random walk flies.
                let both = of(reading, PPO).zip(of(READINGS[1], RANDOM));
                cells.extend(both);
            }
        }
    }
    cells
}

/// The least success of the best script and of the planner, in a sentence.
fn scripts(scan: &Scan) -> String {
    let names = [TEAMS.0, PLANNERS[0].0, PLANNERS[1].0];
    let rows = scan.rows.iter();
    let rows = rows.filter(|row| names.contains(&row.policy.as_str()));
    let least = rows.map(|row| row.success).fold(f64::INFINITY, f64::min);
    let names = names.map(|name| format!("`{name}`")).join(", ");
    match least {
        1.0 => format!(" The best script and the planner ({names}) always succeed."),
        _ if least.is_finite() => {
            format!(" The best script and the planner ({names}) succeed in {least:.3} at least.")
        }
        _ => String::new(),
    }
}

fn introduction(results: &Results, spread: Option<Spread>) -> String {
    let noise = spread.map_or(String::new(), |spread| {
        format!(
            " Those of PPO also have the standard deviation between training seeds, {:.1} points. \
                It has {} degrees of freedom, {} of them from this scan. The others are from cells \
                where informing is paid at every step. The same deviation is taken for every \
                success rate, which is too wide near 0 and 1.",
            100.0 * spread.deviation,
            spread.freedom,
            crate::statistics::pooled(&results.scan.by_seeds()).map_or(0.0, |own| own.freedom)
        )
    });
    format!(
        "The paper gives two success rates: {} with {} UAVs and {} with {}. It does not give the \
            threshold of its radar. Its reward can be read in three ways: informing is paid at \
            every step (its letter), once, or once without throughput. Each number below is \
            success at n = {HOTSPOTS}, of {} missions. The intervals are those of the missions \
            (Wilson, 95 %).{noise}\n\n{FITTED} The tables have other ranges beside it.\n\n\
         The tables are [{}](results/{}), made by `lab/experiments/inform_once.py`, and \
         [{}](results/{}), made by `lab/experiments/inform_once_baselines.py`.",
        PAPER[0].rate,
        PAPER[0].uavs,
        PAPER[1].rate,
        PAPER[1].uavs,
        results.scan.rows[0].episodes,
        scan::TABLES[0],
        scan::TABLES[0],
        scan::TABLES[1],
        scan::TABLES[1],
    )
}

fn ends(e: &Estimate) -> String {
    format!("[{:.2}, {:.2}]", e.low, e.high)
}

/// A reading, a policy and the title of both.
pub(crate) type Line = (&'static str, Flown, String);

/// Which ranges have both numbers within intervals, in a sentence for each line.
pub(crate) fn compatible(scan: &Scan, lines: &[Line], spread: Option<Spread>) -> String {
    let mut text = String::new();
    for (reading, flown, title) in lines.iter().cloned() {
        let (_, tried) = scan::compatible(scan, reading, flown, spread);
        let (Some(&first), Some(&last)) = (tried.first(), tried.last()) else {
            continue;
        };
        let sentence = |spread: Option<Spread>| {
            let (both, _) = scan::compatible(scan, reading, flown, spread);
            if both.is_empty() {
                return "at no range".to_owned();
            }
            let edge = if first == last {
                " (the only one with both fleets)"
            } else if both.contains(&first) || both.contains(&last) {
                " (at the edge of the scan)"
            } else {
                ""
            };
            format!("at {} m{edge}", metres(&both))
        };
        let title = crate::text::capital(&title);
        let tried = if first == last {
            format!("{first} m")
        } else {
            format!("{first} to {last} m")
        };
        text += &format!(
            "- {title} ({tried}): {} by the missions alone",
            sentence(None)
        );
        if flown == PPO && spread.is_some() {
            text += &format!(". With the spread between trainings: {}", sentence(spread));
        }
        text += ".\n";
    }
    text
}

fn figure(results: &Results, spread: Option<Spread>) -> Panels {
    let scan = &results.scan;
    let scanned = ranges(scan, &lines());
    let panel = |published: Published| {
        let mut figure = Figure::new(
            format!("N = {}", published.uavs),
            Axis::new("sensing range", "m"),
            Axis::new(Quantity::Success.title(), "").span(0.0, 1.0),
        );
        for (reading, flown, title) in lines() {
            let point = |range_m: f64| {
                let rows = scan.cell(reading, range_m, published.uavs, flown);
                let e = scan::success_interval(&rows, spread)?;
                Some(Point::interval(range_m, e.value, e.low, e.high))
            };
            let ranges = scan.ranges(reading, flown).into_iter();
            figure = figure.with(Series::line(title, ranges.filter_map(point).collect()));
        }
        let query = Query::new("grid", Preset::Paper.name(), (OURS, "adaptive"));
        let ours = query.uavs(published.uavs).hotspots(HOTSPOTS);
        let ours = ours.mean(&results.table, Quantity::Success);
        let ours = ours.map(|e| Point::interval(FITTED_M, e.value, e.low, e.high));
        let paper = one_training(published, None);
        let at = |range_m| Point::interval(range_m, paper.value, paper.low, paper.high);
        let ends = [scanned.first(), scanned.last()];
        let paper = ends.into_iter().flatten().map(|&range_m| at(range_m));
        figure
            .with(Series::points("our policy", ours.into_iter().collect()))
            .with(Series::band("the paper", paper.collect()))
    };
    Panels {
        title: "The paper's two numbers over the sensing range".to_owned(),
        note: format!(
            "n = {HOTSPOTS}; 95 % intervals, for PPO with the spread between trainings. 150 m \
                was fitted to a random walk."
        ),
        columns: PAPER.len(),
        figures: PAPER.map(panel).to_vec(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scan::testing::row;

    #[test]
    fn a_compatible_range_at_the_edge_says_so() {
        let scan = Scan {
            rows: vec![
                row(RANDOM, 150.0, 10, 0, 0.774),
                row(RANDOM, 150.0, 15, 0, 0.961),
                row(RANDOM, 175.0, 10, 0, 0.919),
                row(RANDOM, 175.0, 15, 0, 0.992),
            ],
            ..Scan::default()
        };
        let text = compatible(&scan, &lines(), None);
        assert!(
            text.contains("- A random walk (150 to 175 m): at 150 m (at the edge of the scan) "),
            "{text}"
        );
        assert!(!text.contains("PPO"), "{text}");
    }

    // Trainings that spread by 0.02 leave 0.73 its missions' interval, some [0.63, 0.82]. With the
    // noise of one training, 0.73 itself lies inside, and 0.834 outside.
    #[test]
    fn the_finding_tells_what_is_shown_from_what_is_compatible() {
        let told = |rates: [f64; 4]| {
            let [ten, again, fifteen, second] = rates;
            let scan = Scan {
                rows: vec![
                    row(RANDOM, 175.0, 10, 0, 0.9),
                    row(PPO, 175.0, 10, 0, ten),
                    row(PPO, 175.0, 10, 1, again),
                    row(PPO, 175.0, 15, 0, fifteen),
                    row(PPO, 175.0, 15, 1, second),
                ],
                ..Scan::default()
            };
            let scope = crate::scope::Scope::full(1);
            let results = Results {
                scope: &scope,
                table: crate::table::testing::table("finding", &[]),
                comparison: Vec::new(),
                curves: Vec::new(),
                approach: Vec::new(),
                scan,
                origin: None,
            };
            finding(&results).unwrap()
        };
        let near = told([0.72, 0.74, 0.96, 0.96]);
        assert!(
            near.contains(" At 175 m the intervals of both rates lie inside"),
            "{near}"
        );
        assert!(near.contains("A cell has 2 to 2 trainings"), "{near}");
        assert!(near.contains("as often as PPO in 1 of 1 cells."), "{near}");
        let edge = told([0.80, 0.80, 0.96, 0.94]);
        assert!(edge.contains("compatible with both at 175 m, of"), "{edge}");
        assert!(edge.contains("**No range is shown to fit**"), "{edge}");
        let far = told([0.30, 0.32, 0.96, 0.94]);
        assert!(far.contains("compatible with both at none of"), "{far}");
    }
}
