//! The chapters on scripts, plans and policies that flew the same missions.

use crate::campaign::{ADAPTIVE, OURS};
use crate::chapter::{Block, Chapter};
use crate::comparison::{COMPARISON, ComparedRow, MISSIONS, PLANNED, SELECTION_SEED};
use crate::readings::FITTED;
use crate::results::Results;
use crate::scope::Scope;
use crate::text::list;
use jcas_core::Preset;
use jcas_episode::card::EVALUATION_SEED;
use jcas_episode::statistics::{Estimate, bootstrap_means, quantile};
use jcas_figures::{Axis, Figure, Point, Series};
use jcas_plan::PlannedKind;

const PLAN: &str = PlannedKind::Plan.name();
const REPLAN: &str = PlannedKind::Replan.name();
/// Success from which a table with three decimals has 1.
const ALWAYS: f64 = 0.9995;

/// The rows of a cell.
struct CellRows<'a> {
    cell: (u32, u32),
    rows: Vec<&'a ComparedRow>,
}

impl<'a> CellRows<'a> {
    fn of(&self, policy: &str) -> Option<&'a ComparedRow> {
        self.rows.iter().copied().find(|row| row.policy == policy)
    }

    fn script(&self) -> Option<&'a ComparedRow> {
        self.rows.iter().copied().find(|row| row.best_script)
    }

    /// A script with an adaptive density, or with its best constant one.
    fn held(&self, script: &str, adaptive: bool) -> Option<&'a ComparedRow> {
        let of = |row: &&ComparedRow| row.policy == script && (row.pilot == ADAPTIVE) == adaptive;
        self.rows.iter().copied().find(of)
    }

    fn head(&self) -> Vec<String> {
        vec![self.cell.0.to_string(), self.cell.1.to_string()]
    }
}

/// The cells of a preset that have been flown, by fleets and numbers of hotspots.
fn places<'a>(results: &'a Results, preset: Preset) -> Vec<CellRows<'a>> {
    let place = |cell| {
        let of =
            |row: &&ComparedRow| row.preset == preset.name() && (row.uavs, row.hotspots) == cell;
        let rows: Vec<&ComparedRow> = results.comparison.iter().filter(of).collect();
        (!rows.is_empty()).then_some(CellRows { cell, rows })
    };
    results
        .scope
        .cells()
        .into_iter()
        .filter_map(place)
        .collect()
}

/// Names of the scripts of a preset.
fn scripts<'a>(places: &[CellRows<'a>]) -> Vec<&'a str> {
    let rows = places.first().map_or(&[][..], |place| &place.rows);
    let names = rows.iter().map(|row| row.policy.as_str());
    let mut names: Vec<&str> = names
        .filter(|name| crate::table::is_baseline(name))
        .collect();
    names.sort_unstable();
    names.dedup();
    names
}

/// A chapter for each preset that has been flown.
pub fn chapters(results: &Results) -> Vec<Chapter> {
    let presets = [Preset::Paper, Preset::Mission, Preset::Search];
    let chapters = presets.map(|preset| chapter(results, preset));
    chapters.into_iter().flatten().collect()
}

fn chapter(results: &Results, preset: Preset) -> Option<Chapter> {
    let places = places(results, preset);
    places.first()?;
    let mut blocks = vec![Block::Text(introduction(results.scope, preset))];
    blocks.extend(times(&places));
    if let Some(differences) = differences(&places) {
        blocks.extend([Block::Text(counts(&places)), differences]);
    }
    blocks.extend(densities(&places));
    if preset == Preset::Search {
        let title = "Mission time over fleet size, preset search";
        let figure = figure(results.scope, &places, title);
        let block = |figure| Block::figure("search_mission_time_over_uavs", title, figure);
        blocks.extend(figure.map(block));
    }
    Some(Chapter {
        heading: format!("Every cell of the preset `{}`", preset.name()),
        blocks,
    })
}

fn introduction(scope: &Scope, preset: Preset) -> String {
    let missions = MISSIONS.min(scope.episodes);
    let planned = PLANNED.min(missions);
    let fitted = match preset {
        Preset::Paper => format!("\n\n{FITTED}"),
        _ => String::new(),
    };
    format!(
        "All policies of a cell fly the same {missions} missions, those of campaign \
            {EVALUATION_SEED}. A policy that plans anew in each mission flies the first {planned} \
            of them. Each script flies with an adaptive pilot density and with its best constant \
            one. That constant and the best script are chosen on {missions} missions of campaign \
            {SELECTION_SEED}. The choice is by success, then by steps, then by energy. \
            [{COMPARISON}](results/{COMPARISON}) has the steps of each mission. `jcas-lab \
            reproduce --only comparison` makes it, and an empty cell is not flown yet.\n\nThe \
            bound is on the mean of every plan without feedback. `replan`, scripts and policies \
            react, so that it does not bind them. Steps are means with half their 95 % interval. \
            Median and 90th percentile follow in brackets, then the success where it is not 1. A \
            mission without success counts with its horizon.{fitted}"
    )
}

/// The mean of the steps with its interval.
fn mean(row: &ComparedRow) -> Estimate {
    let steps: Vec<[f64; 1]> = row
        .steps()
        .into_iter()
        .map(|steps| [f64::from(steps)])
        .collect();
    bootstrap_means(&steps)[0]
}

/// Mean, median and 90th percentile of the steps.
fn steps(row: &ComparedRow) -> String {
    let e = mean(row);
    let at = |share| quantile(&row.steps(), share).unwrap_or(0);
    let half = (e.high - e.low) / 2.0;
    let times = format!("{:.1} ± {half:.1} ({}, {})", e.value, at(0.5), at(0.9));
    if row.success_rate() >= ALWAYS {
        return times;
    }
    format!("{times} {:.2}", row.success_rate())
}

/// A table without the columns that are empty; none where nothing but N and n is left.
fn table(caption: &str, head: Vec<String>, rows: Vec<Vec<String>>) -> Option<Block> {
    let shown = |column: &usize| rows.iter().any(|row| !row[*column].is_empty());
    let columns: Vec<usize> = (0..head.len()).filter(shown).collect();
    let of = |row: &Vec<String>| columns.iter().map(|&column| row[column].clone()).collect();
    (columns.len() > 2).then(|| Block::Table {
        caption: caption.to_owned(),
        head: of(&head),
        rows: rows.iter().map(of).collect(),
    })
}

fn head(titles: impl IntoIterator<Item = String>) -> Vec<String> {
    let cell = ["N", "n"].map(str::to_owned).into_iter();
    cell.chain(titles).collect()
}

/// The steps of all but the scripts that are not the best.
fn times(places: &[CellRows]) -> Option<Block> {
    let titles = ["bound", PLAN, REPLAN, "our policy", "best script", "which"];
    let rows = places.iter().map(|place| {
        let told = |row: Option<&ComparedRow>| row.map_or(String::new(), steps);
        let bound = place.of(PLAN).and_then(|row| row.bound_steps);
        let which = |row: &ComparedRow| format!("{}:{}", row.policy, row.pilot);
        let mut row = place.head();
        row.push(bound.map_or(String::new(), |bound| format!("{bound:.1}")));
        row.extend([PLAN, REPLAN, OURS].map(|name| told(place.of(name))));
        row.push(told(place.script()));
        row.push(place.script().map_or(String::new(), which));
        row
    });
    let caption = "Steps: mean, median and 90th percentile";
    table(caption, head(titles.map(str::to_owned)), rows.collect())
}

/// What is compared in pairs: two names, the row, the difference.
type Pair = (
    &'static str,
    &'static str,
    fn(&CellRows) -> Option<Estimate>,
);

const PAIRS: [Pair; 4] = [
    (REPLAN, PLAN, |place| {
        Some(place.of(REPLAN)?.over(place.of(PLAN)?))
    }),
    ("best script", PLAN, |place| {
        Some(place.script()?.over(place.of(PLAN)?))
    }),
    ("our policy", PLAN, |place| {
        Some(place.of(OURS)?.over(place.of(PLAN)?))
    }),
    ("our policy", "best script", |place| {
        Some(place.of(OURS)?.over(place.script()?))
    }),
];

/// In how many cells one is faster than the other.
fn counts(places: &[CellRows]) -> String {
    let mut text = format!(
        "Differences of pairs on common seeds cancel what the missions have in common. They are \
            made of [{COMPARISON}](results/{COMPARISON}). Their 95 % intervals are of the missions \
            alone:\n\n"
    );
    for (a, b, difference) in PAIRS {
        let all: Vec<Estimate> = places.iter().filter_map(difference).collect();
        if all.is_empty() {
            continue;
        }
        let shorter = all.iter().filter(|e| e.high < 0.0).count();
        let longer = all.iter().filter(|e| e.low > 0.0).count();
        text += &format!(
            "- {} against {b}: fewer steps in {shorter} of {} cells, more in {longer}, undecided \
                in {}.\n",
            crate::text::capital(a),
            all.len(),
            all.len() - shorter - longer
        );
    }
    text
}

fn differences(places: &[CellRows]) -> Option<Block> {
    let quantities = ["energy", "throughput"];
    let ratios = quantities.map(|name| format!("{name}, our policy / best script"));
    let titles = PAIRS.iter().map(|(a, b, _)| format!("{a} − {b}"));
    let ratio = |ours: f64, script: f64| format!("{:.3}", ours / script.max(1e-9));
    let rows = places.iter().map(|place| {
        let told = |e: Estimate| format!("{:+.2} [{:+.2}, {:+.2}]", e.value, e.low, e.high);
        let mut row = place.head();
        for (_, _, difference) in PAIRS {
            row.push(difference(place).map_or(String::new(), told));
        }
        let both = place.of(OURS).zip(place.script());
        row.extend(both.map_or([const { String::new() }; 2], |(ours, script)| {
            [
                ratio(ours.energy_kwh, script.energy_kwh),
                ratio(ours.throughput, script.throughput),
            ]
        }));
        row
    });
    let caption = "Differences in steps, of pairs";
    table(caption, head(titles.chain(ratios)), rows.collect())
}

/// Each script with both pilot densities.
fn densities(places: &[CellRows]) -> Option<Block> {
    let scripts = scripts(places);
    let titles = scripts
        .iter()
        .map(|name| format!("{name}: adaptive; best constant"));
    let told = |row: &ComparedRow| {
        let value = mean(row).value;
        if row.success_rate() >= ALWAYS {
            format!("{value:.1}")
        } else {
            format!("{value:.1} ({:.2})", row.success_rate())
        }
    };
    let rows = places.iter().map(|place| {
        let mut row = place.head();
        for script in &scripts {
            let adaptive = place.held(script, true).map_or(String::new(), told);
            let constant = place.held(script, false).map_or(String::new(), |row| {
                format!("; {} at {}", told(row), row.pilot)
            });
            row.push(adaptive + &constant);
        }
        row
    });
    let caption = "Steps of each script, success in brackets";
    table(caption, head(titles), rows.collect())
}

/// Mean steps over the fleet's size, of the numbers of hotspots that all fleets have flown.
fn figure(scope: &Scope, places: &[CellRows], title: &str) -> Option<Figure> {
    let flown = |&&hotspots: &&u32| {
        let all = |uavs: &u32| places.iter().any(|place| place.cell == (*uavs, hotspots));
        scope.fleets.iter().all(all)
    };
    let common: Vec<u32> = scope.hotspots.iter().filter(flown).copied().collect();
    if common.is_empty() {
        return None;
    }
    let mut figure = Figure::new(
        title,
        Axis::new("UAVs", ""),
        Axis::new("mission time", "steps"),
    )
    .note(format!(
        "{} missions a cell, mean over n = {}; scripts at their best constant pilot density.",
        MISSIONS.min(scope.episodes),
        list(&common)
    ));
    let over_cells = |uavs: u32, of: &dyn Fn(&CellRows) -> Option<f64>| {
        let here = places.iter().filter(|place| place.cell.0 == uavs);
        let here = here.filter(|place| common.contains(&place.cell.1));
        let values: Vec<f64> = here.filter_map(of).collect();
        (values.len() == common.len()).then(|| values.iter().sum::<f64>() / values.len() as f64)
    };
    let line = |name: &str, of: &dyn Fn(&CellRows) -> Option<f64>| {
        let points = scope.fleets.iter().filter_map(|&uavs| {
            let steps = over_cells(uavs, of)?;
            Some(Point::interval(f64::from(uavs), steps, steps, steps))
        });
        Series::line(name, points.collect())
    };
    for script in scripts(places) {
        let of = |place: &CellRows| Some(mean(place.held(script, false)?).value);
        figure = figure.with(line(script, &of));
    }
    let plan = |place: &CellRows| Some(mean(place.of(PLAN)?).value);
    let bound = |place: &CellRows| place.of(PLAN)?.bound_steps;
    let planned = [line(PLAN, &plan), line("bound on plans", &bound)];
    Some(planned.into_iter().fold(figure, Figure::with))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scope::Scope;
    use crate::table::testing;

    fn row(policy: &str, mission_steps: &str) -> ComparedRow {
        ComparedRow {
            preset: "search".to_owned(),
            uavs: 10,
            hotspots: 7,
            policy: policy.to_owned(),
            pilot: ADAPTIVE.to_owned(),
            config_hash: String::new(),
            best_script: policy == "line",
            bound_steps: (policy == PLAN).then_some(4.7),
            episodes: 4,
            successes: 3,
            energy_kwh: 0.1,
            throughput: 1.0,
            mission_steps: mission_steps.to_owned(),
        }
    }

    #[test]
    fn a_difference_counts_where_its_interval_is_on_one_side() {
        let scope = Scope::full(1);
        let results = Results {
            scope: &scope,
            table: testing::table("comparison", &[]),
            comparison: vec![
                row("line", "15 17 16 100"),
                row(PLAN, "11 13 12 96"),
                row(REPLAN, "10 14"),
            ],
            curves: Vec::new(),
            approach: Vec::new(),
            scan: crate::scan::Scan::default(),
            origin: None,
        };
        let chapters = chapters(&results);
        assert_eq!(chapters.len(), 1);
        let text = chapters[0].markdown("");
        for told in [
            "| 10 | 7 | 4.7 | 33.0 ± ",
            "(12, 96) 0.75 | 12.0 ± 2.0 (10, 14) 0.75 | 37.0 ± ",
            "(16, 100) 0.75 | line:adaptive |",
            "- Replan against plan: fewer steps in 0 of 1 cells, more in 0, undecided in 1.",
            "- Best script against plan: fewer steps in 0 of 1 cells, more in 1, undecided in 0.",
            "| 10 | 7 | +0.00 [-1.00, +1.00] | +4.00 [+4.00, +4.00] |",
            "| 10 | 7 | 37.0 (0.75) |",
        ] {
            assert!(text.contains(told), "{told}\n{text}");
        }
        assert!(!text.contains("our policy"), "{text}");
    }
}
