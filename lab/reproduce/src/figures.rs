//! The pictures of a reproduction. A picture is data: which rows it shows, over what, and where it
//! stands. To add one, add a row to [`PICTURES`].

use crate::campaign::OURS;
use crate::curves::Curve;
use crate::fit::PAPER;
use crate::pilot_by_distance::{Approach, DistanceBin};
use crate::results::Results;
use crate::scope::Scope;
use crate::table::{Quantity, Query, Row, Table, in_common, mean, numbers_of_hotspots};
use crate::text::capital;
use jcas_core::Preset;
use jcas_figures::{Axis, Figure, Point, Series};

/// A picture and its place.
pub struct Picture {
    /// Name of its files.
    pub name: &'static str,
    /// Section of the report that it stands in; pictures of one section follow each other.
    pub section: &'static str,
    /// What it shows.
    pub title: &'static str,
    /// Whether the Markdown page shows it.
    pub on_page: bool,
    content: Content,
}

enum Content {
    /// Means of rows of the table.
    Means(Means),
    /// Returns of the paper's training over its iterations.
    Returns,
    /// What a training of the paper's length takes.
    TrainingTimes,
    /// Success against throughput with the pilot density held.
    TradeOff,
    /// Pilot density over the distance to a hotspot.
    Approach,
}

/// Lines of means.
struct Means {
    experiment: &'static str,
    preset: Preset,
    quantity: Quantity,
    over: Over,
    /// Name, policy and pilot rule of each line.
    lines: &'static [(&'static str, &'static str, &'static str)],
    /// Whether the paper's success rates are marked.
    published: bool,
}

/// What runs from left to right.
#[derive(Clone, Copy)]
enum Over {
    /// The fleet's size, mean over the numbers of hotspots.
    Fleets,
    /// The number of hotspots, at a fleet size.
    Hotspots(u32),
    /// What the experiment varies.
    Varied(&'static str),
}

type Lines = &'static [(&'static str, &'static str, &'static str)];

const SCRIPTS: Lines = &[
    ("learned, adaptive pilot", "learned", "adaptive"),
    ("learned, constant pilot 0.3", "learned", "constant"),
    ("teams", "teams", "adaptive"),
    ("swarm", "swarm", "adaptive"),
    ("greedy", "greedy", "adaptive"),
    ("sweep", "sweep", "adaptive"),
    ("random", "random", "adaptive"),
];
const PAPERS: Lines = &[
    ("random walk", "random", "mid"),
    ("the paper's PPO, team credit", "ppo", "adaptive"),
    ("the same, constant pilot 0.3", "ppo", "constant"),
    ("the paper's PPO, credit of UAVs", "ppo-uav", "adaptive"),
    ("our policy", "learned", "adaptive"),
    ("teams, full pilot", "teams", "max"),
];
const PILOTS: Lines = &[
    ("learned, adaptive pilot", "learned", "adaptive"),
    ("learned, constant pilot 0.3", "learned", "constant"),
    ("teams, adaptive", "teams", "adaptive"),
    ("teams, constant 0.3", "teams", "max"),
];
const BATTERIES: Lines = &[
    ("learned", "learned", "adaptive"),
    ("teams", "teams", "adaptive"),
];

const fn grid(preset: Preset, quantity: Quantity, over: Over, lines: Lines) -> Content {
    Content::Means(Means {
        experiment: "grid",
        preset,
        quantity,
        over,
        lines,
        published: matches!(quantity, Quantity::Success) && matches!(over, Over::Fleets),
    })
}

const fn battery(quantity: Quantity) -> Content {
    Content::Means(Means {
        experiment: "battery",
        preset: Preset::Mission,
        quantity,
        over: Over::Varied("renewable share of the charge"),
        lines: BATTERIES,
        published: false,
    })
}

const fn picture(
    section: &'static str,
    name: &'static str,
    title: &'static str,
    on_page: bool,
    content: Content,
) -> Picture {
    Picture {
        name,
        section,
        title,
        on_page,
        content,
    }
}

const PAPER_FLEETS: &str = "Fleet size, preset `paper`";
const TRAINING: &str = "Training with the paper's settings";
const FLEETS: &str = "Fleet size, preset `mission`";
const PILOT: &str = "Adaptive against constant pilot density, preset `mission`";
const TALK: &str = "Sensing against communication, preset `mission`";
const CHARGE: &str = "Carbon and charging, preset `mission`";

/// Every picture outside of the chapters of single studies, in the order of the report.
#[rustfmt::skip]
pub const PICTURES: [Picture; 19] = {
    use Over::{Fleets, Hotspots};
    use Preset::{Mission, Paper};
    use Quantity::{Co2, Energy, Steps, Success, Throughput};
    [
        picture(PAPER_FLEETS, "paper_success_over_uavs", "success over fleet size", true,
            grid(Paper, Success, Fleets, PAPERS)),
        picture(PAPER_FLEETS, "paper_mission_time_over_uavs", "mission time over fleet size", true,
            grid(Paper, Steps, Fleets, PAPERS)),
        picture(PAPER_FLEETS, "paper_energy_over_uavs", "energy over fleet size", true,
            grid(Paper, Energy, Fleets, PAPERS)),
        picture(PAPER_FLEETS, "paper_throughput_over_uavs", "throughput over fleet size", true,
            grid(Paper, Throughput, Fleets, PAPERS)),
        picture(PAPER_FLEETS, "paper_success_over_hotspots_n10",
            "success over hotspots at N = 10", false, grid(Paper, Success, Hotspots(10), PAPERS)),
        picture(TRAINING, "training_returns", "return over training iterations", true,
            Content::Returns),
        picture(TRAINING, "training_time",
            "training time of one cell with the paper's settings", false, Content::TrainingTimes),
        picture(FLEETS, "success_over_uavs", "success over fleet size", true,
            grid(Mission, Success, Fleets, SCRIPTS)),
        picture(FLEETS, "mission_time_over_uavs", "mission time over fleet size", true,
            grid(Mission, Steps, Fleets, SCRIPTS)),
        picture(FLEETS, "energy_over_uavs", "energy over fleet size", true,
            grid(Mission, Energy, Fleets, SCRIPTS)),
        picture(FLEETS, "throughput_over_uavs", "throughput over fleet size", true,
            grid(Mission, Throughput, Fleets, SCRIPTS)),
        picture(PILOT, "success_over_hotspots_n10", "success over hotspots at N = 10", false,
            grid(Mission, Success, Hotspots(10), PILOTS)),
        picture(PILOT, "throughput_over_hotspots_n10", "throughput over hotspots at N = 10", false,
            grid(Mission, Throughput, Hotspots(10), PILOTS)),
        picture(PILOT, "success_over_hotspots_n15", "success over hotspots at N = 15", false,
            grid(Mission, Success, Hotspots(15), PILOTS)),
        picture(PILOT, "throughput_over_hotspots_n15", "throughput over hotspots at N = 15", false,
            grid(Mission, Throughput, Hotspots(15), PILOTS)),
        picture(TALK, "trade_off", "success against throughput", true, Content::TradeOff),
        picture(TALK, "approach",
            "pilot density over distance to the nearest unconfirmed hotspot", true,
            Content::Approach),
        picture(CHARGE, "battery_co2", "carbon over renewable share, small batteries", true,
            battery(Co2)),
        picture(CHARGE, "battery_success", "success over renewable share, small batteries", false,
            battery(Success)),
    ]
};

impl Picture {
    /// Whether there is anything to show: rows of what is learnt or of one of our own experiments.
    pub(crate) fn shows(&self, results: &Results) -> bool {
        let flown = |experiment, preset: Preset| {
            let mut rows = results.table.rows.iter();
            rows.any(|row| row.experiment == experiment && row.preset == preset.name())
        };
        match &self.content {
            Content::Means(means) => flown(means.experiment, means.preset),
            Content::Returns | Content::TrainingTimes => !results.curves.is_empty(),
            Content::TradeOff | Content::Approach => flown("density", Preset::Mission),
        }
    }

    /// The figure.
    pub(crate) fn draw(&self, results: &Results) -> Figure {
        let Results {
            scope,
            table,
            curves,
            approach: approaches,
            ..
        } = results;
        let figure = match &self.content {
            Content::Means(means) => means.figure(scope, table),
            Content::Returns => returns(scope, curves),
            Content::TrainingTimes => training_times(scope, curves),
            Content::TradeOff => trade_off(scope, table),
            Content::Approach => approach(approaches),
        };
        Figure {
            title: format!("{}{}", capital(self.title), self.condition(scope)),
            ..figure
        }
    }

    /// Which mission the picture is of, where its title does not say.
    fn condition(&self, scope: &Scope) -> String {
        match &self.content {
            Content::Means(means) if means.experiment == "grid" => {
                format!(", preset {}", means.preset.name())
            }
            Content::TradeOff | Content::Approach => {
                let (uavs, hotspots) = scope.hard_cell();
                format!(", N = {uavs}, n = {hotspots}")
            }
            Content::Returns => format!(", N = {}", returns_fleet(scope)),
            Content::Means(_) | Content::TrainingTimes => String::new(),
        }
    }
}

impl Means {
    fn figure(&self, scope: &Scope, table: &Table) -> Figure {
        let x_axis = match self.over {
            Over::Fleets => Axis::new("UAVs", ""),
            Over::Hotspots(_) => Axis::new("hotspots", ""),
            Over::Varied(what) => Axis::new(what, ""),
        };
        let y_axis = Axis::new(self.quantity.title(), self.quantity.unit());
        let note = match self.over {
            Over::Varied(_) => {
                "N = 10, n = 5, batteries of 0.03 kWh: about 25 moves to a charge.".to_owned()
            }
            Over::Fleets | Over::Hotspots(_) => {
                let fitted = match self.preset {
                    Preset::Paper => " 150 m was fitted to a random walk.",
                    _ => "",
                };
                format!(
                    "{} missions a cell, mean over training seeds; intervals: mean of the 95 % \
                        intervals of the cells.{fitted}",
                    scope.episodes
                )
            }
        };
        let mut figure = Figure::new("", x_axis, y_axis).note(note);
        for &(name, policy, pilot) in self.lines {
            let (points, hotspots) = self.points(table, (policy, pilot));
            if points.is_empty() {
                continue;
            }
            let name = match self.over {
                Over::Fleets => format!("{name}{}", scope.over(&hotspots)),
                Over::Hotspots(_) | Over::Varied(_) => name.to_owned(),
            };
            figure = figure.with(Series::line(name, points));
        }
        if self.published {
            let marks = PAPER.map(|p| Point::new(f64::from(p.uavs), p.rate));
            figure = figure.with(Series::points("the paper", marks.to_vec()));
        }
        figure
    }

    /// The points of a line, and the numbers of hotspots of their means. Fleets are compared over
    /// the numbers that all of them have.
    fn points(&self, table: &Table, flown: (&str, &str)) -> (Vec<Point>, Vec<u32>) {
        let query = Query::new(self.experiment, self.preset.name(), flown);
        let query = match self.over {
            Over::Hotspots(uavs) => query.uavs(uavs),
            Over::Fleets | Over::Varied(_) => query,
        };
        let x_of = |row: &Row| match self.over {
            Over::Fleets => f64::from(row.uavs),
            Over::Hotspots(_) => f64::from(row.hotspots),
            Over::Varied(_) => row.x,
        };
        let rows = query.rows(table);
        let mut xs: Vec<f64> = rows.iter().map(|row| x_of(row)).collect();
        xs.sort_by(f64::total_cmp);
        xs.dedup();
        let at = |x: &f64| rows.iter().copied().filter(|row| x_of(row) == *x).collect();
        let groups: Vec<Vec<&Row>> = xs.iter().map(at).collect();
        let groups = match self.over {
            Over::Fleets => in_common(groups),
            Over::Hotspots(_) | Over::Varied(_) => groups,
        };
        let point = |(x, at): (f64, &Vec<&Row>)| {
            let estimate = mean(at, self.quantity)?;
            Some(Point::interval(
                x,
                estimate.value,
                estimate.low,
                estimate.high,
            ))
        };
        let points = xs.into_iter().zip(&groups).filter_map(point).collect();
        (points, numbers_of_hotspots(&groups.concat()))
    }
}

/// The fleet whose trainings are shown: N = 10 where it is trained.
fn returns_fleet(scope: &Scope) -> u32 {
    let mut fleets = scope.paper_cells.iter().map(|cell| cell.0);
    let first = fleets.clone().next().unwrap_or(10);
    fleets.find(|&uavs| uavs == 10).unwrap_or(first)
}

fn returns(scope: &Scope, curves: &[Curve]) -> Figure {
    let uavs = returns_fleet(scope);
    let mut figure = Figure::new(
        "",
        Axis::new("iteration of 4096 environment steps", ""),
        Axis::new("mean episode return", ""),
    )
    .note("Band: least to greatest of the training seeds, where there are several.");
    for learner in scope.learners() {
        for &hotspots in &scope.hotspots {
            let of = |curve: &&Curve| {
                (curve.learner, curve.constant) == (learner.name, None)
                    && (curve.uavs, curve.hotspots) == (uavs, hotspots)
            };
            let runs: Vec<&Curve> = curves.iter().filter(of).collect();
            if runs.is_empty() {
                continue;
            }
            let name = format!("{}, n = {hotspots}", learner.title);
            figure = figure.with(Series::band(name, band(&runs)));
        }
    }
    figure
}

fn band(runs: &[&Curve]) -> Vec<Point> {
    let length = runs.iter().map(|run| run.returns.len()).min().unwrap_or(0);
    (0..length)
        .map(|k| {
            let values: Vec<f64> = runs.iter().map(|run| run.returns[k]).collect();
            let mean = values.iter().sum::<f64>() / values.len() as f64;
            let low = values.iter().copied().fold(f64::INFINITY, f64::min);
            let high = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
            Point::interval(k as f64 + 1.0, mean, low, high)
        })
        .filter(|point| point.y.is_finite())
        .collect()
}

fn training_times(scope: &Scope, curves: &[Curve]) -> Figure {
    let shortened = scope.shortened();
    let how = shortened.map_or(String::new(), |shortened| format!(" ({shortened})"));
    let mut figure =
        Figure::new("", Axis::new("UAVs", ""), Axis::new("wall time", "s")).note(format!(
            "62 iterations at the pace measured here{how}; the paper: eight processes of a \
            Xeon Gold 6444Y."
        ));
    for learner in scope.learners() {
        let measured = scope.fleets.iter().filter_map(|&uavs| {
            let of = |curve: &&Curve| curve.learner == learner.name && curve.uavs == uavs;
            let times: Vec<f64> = curves
                .iter()
                .filter(of)
                .map(Curve::whole_training_s)
                .collect();
            let mean = times.iter().sum::<f64>() / times.len() as f64;
            (!times.is_empty()).then(|| Point::new(f64::from(uavs), mean))
        });
        let points: Vec<Point> = measured.collect();
        if !points.is_empty() {
            figure = figure.with(Series::line(format!("{}, here", learner.title), points));
        }
    }
    let paper = [(5.0, 402.0), (10.0, 598.0), (15.0, 1253.0), (20.0, 1751.0)];
    let points = paper.map(|(x, y)| Point::new(x, y));
    figure.with(Series::line("the paper", points.to_vec()))
}

fn trade_off(scope: &Scope, table: &Table) -> Figure {
    let (uavs, hotspots) = scope.hard_cell();
    let place = |query: Query| -> Option<Point> {
        let success = query.mean(table, Quantity::Success)?;
        let throughput = query.mean(table, Quantity::Throughput)?;
        Some(
            Point::interval(throughput.value, success.value, success.low, success.high)
                .x_interval(throughput.low, throughput.high),
        )
    };
    let mut figure = Figure::new(
        "",
        Axis::new(Quantity::Throughput.title(), ""),
        Axis::new(Quantity::Success.title(), ""),
    )
    .note("Lines: the same motions with the pilot density held at the value beside each point.");
    let preset = Preset::Mission.name();
    for policy in ["learned", "teams"] {
        let held = scope.densities.iter().filter_map(|&density| {
            let query = Query::new("density", preset, (policy, "held")).x(density);
            Some((place(query)?, format!("{density:.2}")))
        });
        let (points, labels): (Vec<Point>, Vec<String>) = held.unzip();
        let name = format!("{policy}, held pilot density");
        figure = figure.with(Series::line(name, points).labels(labels));
    }
    for &(name, policy, pilot) in SCRIPTS.iter().take(4) {
        let query = Query::new("grid", preset, (policy, pilot))
            .uavs(uavs)
            .hotspots(hotspots);
        figure = figure.with(Series::points(name, place(query).into_iter().collect()));
    }
    figure
}

fn approach(approaches: &[Approach]) -> Figure {
    let mut figure = Figure::new(
        "",
        Axis::new("Manhattan distance", "cells"),
        Axis::new("mean pilot density", "").span(0.0, 0.3),
    )
    .note("The learned policy, deterministic.");
    for approach in approaches.iter().filter(|one| one.policy == OURS) {
        let point =
            |bin: &DistanceBin| Point::new(f64::from(bin.distance_cells), bin.pilot_density_mean);
        let points = approach.bins.iter().map(point).collect();
        figure = figure.with(Series::line(format!("seed {}", approach.seed), points));
    }
    figure
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pictures_have_names_of_their_own_and_sections_in_one_piece() {
        let mut sections: Vec<&str> = PICTURES.iter().map(|picture| picture.section).collect();
        sections.dedup();
        for (k, section) in sections.iter().enumerate() {
            assert!(!sections[..k].contains(section), "{section}");
        }
        for (k, picture) in PICTURES.iter().enumerate() {
            let before = &PICTURES[..k];
            assert!(before.iter().all(|other| other.name != picture.name));
        }
    }
}
