//! Study of adaptive pilot density: against every constant in four presets, then over maps of
//! regimes.

use crate::campaign::{CampaignSpec, OURS, Who};
use crate::chapter::{Block, Chapter};
use crate::pilot_comparison::{PilotComparison, scripted};
use crate::readings::FITTED;
use crate::regimes;
use crate::scope::{CONSTANT_PILOT, Scope};
use crate::table::{Quantity, Row, Table};
use crate::text::capital;
use jcas_core::{Config, Preset};
use jcas_figures::{Axis, Figure, Panels, Point, Series};
use jcas_policy::BaselineKind;

/// Name of the study in the table of results.
const EXPERIMENT: &str = "pilot";

/// A mission and a script that flies it.
struct Case {
    title: &'static str,
    preset: Preset,
    kind: BaselineKind,
    hotspots: u32,
}

const CASES: [Case; 4] = [
    Case {
        title: "`line` in `search`",
        preset: Preset::Search,
        kind: BaselineKind::Line,
        hotspots: 7,
    },
    Case {
        title: "`greedy` in `paper`",
        preset: Preset::Paper,
        kind: BaselineKind::Greedy,
        hotspots: 7,
    },
    Case {
        title: "`swarm` in `paper`",
        preset: Preset::Paper,
        kind: BaselineKind::Swarm,
        hotspots: 7,
    },
    Case {
        title: "`swarm` in `mission`",
        preset: Preset::Mission,
        kind: BaselineKind::Swarm,
        hotspots: 11,
    },
];

/// The cases at every fleet with fine densities, then the maps of regimes with coarse ones.
pub(crate) fn flights(scope: &Scope) -> Vec<CampaignSpec> {
    let (fine, _) = &scope.pilot_densities;
    let mut flights = Vec::new();
    for case in &CASES {
        for &uavs in &scope.fleets {
            let config = scope.mission(case.preset, (uavs, case.hotspots));
            flights.extend(scripted(EXPERIMENT, case.preset, config, case.kind, fine));
            let held = fine.iter().map(|&rho| (rho, Some(rho)));
            flights.extend(
                [(0.0, None)]
                    .into_iter()
                    .chain(held)
                    .map(|(x, held)| CampaignSpec {
                        experiment: (EXPERIMENT.to_owned(), x),
                        preset: case.preset,
                        config,
                        who: Who::Ours { base: config, held },
                    }),
            );
        }
    }
    flights.extend(regimes::flights(scope));
    flights
}

/// Heads of the table of cases.
const HEAD: [&str; 8] = [
    "script and preset",
    "N",
    "adaptive: success, steps",
    "against",
    "success (points)",
    "mission time",
    "energy",
    "throughput",
];

fn row(title: &str, worth: &PilotComparison, name: &str, constant: &Row) -> [String; 8] {
    let percent = |quantity| format!("{:+.1} %", worth.above(constant, quantity));
    let points = 100.0 * (worth.adaptive.success_rate - constant.success_rate);
    [
        title.to_owned(),
        worth.adaptive.uavs.to_string(),
        format!(
            "{:.3}, {:.1}",
            worth.adaptive.success_rate, worth.adaptive.mission_steps
        ),
        format!("{name} {:.2}", constant.x),
        format!("{points:+.1}"),
        percent(Quantity::Steps),
        percent(Quantity::Energy),
        percent(Quantity::Throughput),
    ]
}

/// The policies of a case: its script, then ours if it has one.
fn flyers(case: &Case) -> [(String, &'static str); 2] {
    [
        (case.title.to_owned(), case.kind.name()),
        (format!("ours in `{}`", case.preset.name()), OURS),
    ]
}

fn cases(scope: &Scope, table: &Table) -> Vec<(String, Vec<PilotComparison>)> {
    let mut found: Vec<(String, Vec<PilotComparison>)> = Vec::new();
    for case in &CASES {
        for (title, policy) in flyers(case) {
            let worths: Vec<PilotComparison> = scope
                .fleets
                .iter()
                .filter_map(|&uavs| {
                    PilotComparison::of(table, EXPERIMENT, case.preset, policy, Some(uavs))
                })
                .collect();
            if !worths.is_empty() && found.iter().all(|(other, _)| *other != title) {
                found.push((title, worths));
            }
        }
    }
    found
}

/// The chapter as far as the table has it; none without a row.
pub fn chapter(scope: &Scope, table: &Table) -> Option<Chapter> {
    let cases = cases(scope, table);
    if cases.is_empty() {
        return None;
    }
    let mut rows = Vec::new();
    for (title, worths) in &cases {
        for worth in worths {
            rows.push(row(title, worth, "best constant", worth.best()));
            if let Some(papers) = worth.papers() {
                rows.push(row(title, worth, "constant", papers));
            }
        }
    }
    let mut blocks = vec![
        Block::Text(reason(scope)),
        Block::Text(format!("{}\n\n{FITTED}", verdict(&cases))),
        Block::table("Adaptive against constant pilot density", HEAD, rows),
    ];
    for (quantity, name) in [
        (Quantity::Steps, "pilot_mission_time"),
        (Quantity::Energy, "pilot_energy"),
        (Quantity::Throughput, "pilot_throughput"),
    ] {
        let figure = panels(scope, &cases, quantity);
        blocks.push(Block::figure(name, &figure.title.clone(), figure));
    }
    blocks.extend(regimes::blocks(scope, table));
    Some(Chapter {
        heading: "What adapting the pilot density is worth".to_owned(),
        blocks,
    })
}

/// Why a pilot density can matter at all, from the equations.
fn reason(scope: &Scope) -> String {
    let config = scope.mission(Preset::Paper, (10, 5));
    let (low, high) = (config.pilot_density_min, config.pilot_density_max);
    let gain_db = config.comm_load_penalty_db * (high - low);
    let odds = (config.logistic_slope_per_db * gain_db).exp();
    format!(
        "The pilot density acts in two places. A high one leaves less load for the radar to see \
            through. From {low:.2} to {high:.2} the sensing SNR gains α_JCAS · {:.2} = \
            {gain_db:.2} dB at the paper's α_JCAS = {} dB. This multiplies the odds of a detection \
            by {odds:.3}. A low one leaves more for data: links reach {:.1} cells at {high:.2} and \
            {:.1} at {low:.2}. Throughput grows with 1 − ρ, and sensing costs energy in proportion \
            to ρ. So with the paper's numbers there is little to sense better for, and the least \
            density is hard to beat. In the preset `isac` a sparse pilot costs range, and adapting \
            saves up to 16 % of the time (`docs/radar.md`).",
        high - low,
        config.comm_load_penalty_db,
        link_cells(&config, high),
        link_cells(&config, low),
    )
}

/// How far a link reaches when both ends hold a density, in cells.
fn link_cells(config: &Config, density: f64) -> f64 {
    let bits = config.link_throughput_min * config.reference_spectral_efficiency / (1.0 - density);
    let snr_db = 10.0 * (2f64.powf(bits) - 1.0).log10();
    let at_a_metre_db = jcas_core::link::snr_db(config, 1.0);
    10f64.powf((at_a_metre_db - snr_db) / (10.0 * config.path_loss_exponent)) / config.cell_size_m
}

/// What the cases come to, in a sentence each.
fn verdict(cases: &[(String, Vec<PilotComparison>)]) -> String {
    let mut text =
        "Adaptive is full density within a cell of an unconfirmed hotspot (hidden ones: \
        until all are confirmed) and the least elsewhere; of ours, its own. The best constant has \
        the shortest missions and, of those within its interval, the most throughput.\n\n"
            .to_owned();
    for (title, worths) in cases {
        let times: Vec<f64> = worths
            .iter()
            .map(|worth| worth.above(worth.best(), Quantity::Steps))
            .collect();
        let throughputs = worths
            .iter()
            .map(|worth| worth.above(worth.best(), Quantity::Throughput));
        let points = worths.iter().filter_map(|worth| {
            let papers = worth.papers()?;
            Some(100.0 * (worth.adaptive.success_rate - papers.success_rate))
        });
        let clear = worths
            .iter()
            .filter(|worth| worth.tells_apart(worth.best()))
            .count();
        text += &format!(
            "- {}: against the best constant, mission time {} % (intervals apart in {clear} of {} \
                fleets) and throughput {} %. Against the paper's constant {CONSTANT_PILOT}, \
                success {} points.\n",
            capital(title),
            span(times.into_iter()),
            worths.len(),
            span(throughputs),
            span(points),
        );
    }
    text + "\nThe paper has adaptive up to about 10 points ahead of its constant at larger fleets. \
        Fleets that start in one cell stay together under `greedy`, so that it flies as `swarm` \
        does. `line` chooses its formation for the density that it senses with, by an estimate \
        over sixty steps. Jumps between neighbouring densities are such choices. So are constants \
        that beat full density where missions are longer than that."
}

fn span(values: impl Iterator<Item = f64>) -> String {
    let values: Vec<f64> = values.collect();
    let low = values.iter().copied().fold(f64::INFINITY, f64::min);
    let high = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    if values.is_empty() {
        "not run".to_owned()
    } else if format!("{low:+.1}") == format!("{high:+.1}") {
        format!("{low:+.1}")
    } else {
        format!("{low:+.1} to {high:+.1}")
    }
}

/// A quantity over the density that is held, against adaptive, a panel for each case.
fn panels(scope: &Scope, cases: &[(String, Vec<PilotComparison>)], quantity: Quantity) -> Panels {
    let panel = |(title, worths): &(String, Vec<PilotComparison>)| {
        let mut figure = Figure::new(
            title.replace('`', ""),
            Axis::new("pilot density held", ""),
            Axis::new(format!("{} against adaptive", quantity.title()), "%"),
        );
        for worth in worths {
            let adaptive = worth.adaptive.estimate(quantity).value.max(1e-9);
            let percent = |value: f64| 100.0 * (value / adaptive - 1.0);
            let points = worth.held.iter().map(|row| {
                let e = row.estimate(quantity);
                Point::interval(row.x, percent(e.value), percent(e.low), percent(e.high))
            });
            let name = format!("N = {}", worth.adaptive.uavs);
            figure = figure.with(Series::line(name, points.collect()));
        }
        figure.reference(0.0, "")
    };
    Panels {
        title: format!(
            "{} with a held pilot density, against adaptive",
            capital(quantity.title())
        ),
        note: format!(
            "{} missions a point; n = 7, in mission n = 11. Above the line a constant takes more \
                than adaptive does.",
            scope.episodes
        ),
        columns: 2,
        figures: cases.iter().map(panel).collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// By hand: 32.30 dB at one cell (docs/model.md), and 6/0.7 bits need 25.79 dB, 6/0.99 bits
    /// 18.17 dB.
    #[test]
    fn links_reach_as_far_as_their_budget() {
        let config = Config::default();
        for (density, excess_db) in [(0.30, 32.30 - 25.79), (0.01, 32.30 - 18.17)] {
            let cells = 10f64.powf(excess_db / 20.0);
            assert!((link_cells(&config, density) - cells).abs() < 0.01);
        }
    }
}
