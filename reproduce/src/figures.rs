//! The pictures of a reproduction, as SVG, PNG and one HTML report.

use super::claims;
use super::flights::POLICIES;
use super::plan::{PAPER_ITERATIONS, Scale};
use super::table::{Quantity, Row, Table, mean};
use jcas_evaluate::figures::report::Report;
use jcas_evaluate::figures::{Axis, Draw, Figure, FigureError, Point, Series};
use jcas_train::error::TrainError;
use jcas_train::policy::files::CARD;
use jcas_train::run::METRICS;
use std::path::Path;

/// Training of one cell with the paper's settings.
#[derive(Clone, Debug, PartialEq)]
pub struct Curve {
    /// UAVs.
    pub uavs: u32,
    /// Hotspots.
    pub hotspots: u32,
    /// Training seed.
    pub seed: u64,
    /// Mean return of the missions that ended in each iteration (NaN where none did).
    pub returns: Vec<f64>,
    /// Wall time of the training.
    pub training_s: f64,
}

impl Curve {
    /// Wall time of the paper's number of iterations at this run's pace.
    pub fn whole_training_s(&self) -> f64 {
        self.training_s * PAPER_ITERATIONS as f64 / self.returns.len().max(1) as f64
    }
}

/// The training curves of the adaptive runs with the paper's settings, as far as they are trained.
pub fn curves(scale: &Scale, out: &Path) -> Result<Vec<Curve>, TrainError> {
    let mut curves = Vec::new();
    for &(uavs, hotspots) in &scale.paper_cells {
        for &seed in &scale.seeds {
            let folder = out
                .join(POLICIES)
                .join(format!("ppo-{uavs}x{hotspots}-adaptive-s{seed}"));
            if !folder.join(CARD).exists() {
                continue;
            }
            let (returns, wall_s) = iterations(&folder.join(METRICS))?;
            curves.push(Curve {
                uavs,
                hotspots,
                seed,
                returns,
                training_s: wall_s.iter().sum(),
            });
        }
    }
    Ok(curves)
}

/// Mean return and wall time of each iteration. A run that was stopped and continued has them all here.
fn iterations(path: &Path) -> Result<(Vec<f64>, Vec<f64>), TrainError> {
    #[derive(serde::Deserialize)]
    struct Line {
        return_mean: Option<f64>,
        wall_s: f64,
    }
    let mut reader = csv::Reader::from_path(path).map_err(TrainError::format(path))?;
    let lines = reader.deserialize::<Line>().map(|line| {
        let line = line.map_err(TrainError::format(path))?;
        Ok((line.return_mean.unwrap_or(f64::NAN), line.wall_s))
    });
    lines.collect()
}

/// Who is compared in the figures over fleets and hotspots: name, condition.
const COMPARED: [(&str, &str, &str); 7] = [
    ("learned, adaptive pilot", "learned", "adaptive"),
    ("learned, constant pilot 0.3", "learned", "constant"),
    ("teams", "teams", "adaptive"),
    ("swarm", "swarm", "adaptive"),
    ("greedy", "greedy", "adaptive"),
    ("sweep", "sweep", "adaptive"),
    ("random", "random", "adaptive"),
];

/// Name of the file, title, unit, quantity.
const QUANTITIES: [(&str, &str, &str, Quantity); 4] = [
    ("success", "success rate", "", Quantity::Success),
    ("mission_time", "mission time", "steps", Quantity::Steps),
    ("energy", "energy spent", "kWh", Quantity::Energy),
    (
        "throughput",
        "normalised throughput",
        "",
        Quantity::Throughput,
    ),
];

fn grid_rows<'a>(table: &'a Table, policy: &str, pilot: &str) -> Vec<&'a Row> {
    table.select(|row| {
        row.experiment == "grid"
            && row.preset == "mission"
            && row.policy == policy
            && row.pilot == pilot
    })
}

fn points(rows: &[&Row], xs: &[u32], quantity: Quantity, x_of: impl Fn(&Row) -> u32) -> Vec<Point> {
    xs.iter()
        .filter_map(|&x| {
            let at: Vec<&Row> = rows.iter().copied().filter(|row| x_of(row) == x).collect();
            let estimate = mean(&at, quantity)?;
            Some(Point::interval(
                f64::from(x),
                estimate.value,
                estimate.low,
                estimate.high,
            ))
        })
        .collect()
}

fn note(scale: &Scale) -> String {
    format!(
        "{} missions a cell, {} training seed(s); intervals: mean of the 95 % intervals of the cells.",
        scale.episodes,
        scale.seeds.len()
    )
}

/// A quantity over the fleet size, averaged over the numbers of hotspots.
fn over_fleets(scale: &Scale, table: &Table, index: usize) -> Figure {
    let (_, title, unit, quantity) = QUANTITIES[index];
    let mut figure = Figure::new(
        format!("{} over fleet size, mean over hotspots", capital(title)),
        Axis::new("UAVs", ""),
        Axis::new(title, unit),
    )
    .note(note(scale));
    for (name, policy, pilot) in COMPARED {
        let rows = grid_rows(table, policy, pilot);
        figure = figure.with(Series::line(
            name,
            points(&rows, &scale.fleets, quantity, |r| r.uavs),
        ));
    }
    if quantity == Quantity::Success {
        let published = vec![Point::new(10.0, 0.73), Point::new(15.0, 0.97)];
        figure = figure.with(Series::points("the paper", published));
    }
    figure
}

/// Adaptive against constant pilot over the number of hotspots, at one fleet size.
fn over_hotspots(scale: &Scale, table: &Table, index: usize, uavs: u32) -> Figure {
    let (_, title, unit, quantity) = QUANTITIES[index];
    let mut figure = Figure::new(
        format!("{} over hotspots at N = {uavs}", capital(title)),
        Axis::new("hotspots", ""),
        Axis::new(title, unit),
    )
    .note(note(scale));
    let compared = [
        ("learned, adaptive pilot", "learned", "adaptive"),
        ("learned, constant pilot 0.3", "learned", "constant"),
        ("teams, adaptive", "teams", "adaptive"),
        ("teams, constant 0.3", "teams", "max"),
    ];
    for (name, policy, pilot) in compared {
        let rows: Vec<&Row> = grid_rows(table, policy, pilot)
            .into_iter()
            .filter(|row| row.uavs == uavs)
            .collect();
        let points = points(&rows, &scale.hotspots, quantity, |r| r.hotspots);
        figure = figure.with(Series::line(name, points));
    }
    figure
}

fn training_returns(scale: &Scale, curves: &[Curve]) -> Figure {
    let uavs = scale
        .paper_cells
        .iter()
        .map(|cell| cell.0)
        .find(|&n| n == 10);
    let uavs = uavs.unwrap_or(scale.paper_cells[0].0);
    let mut figure = Figure::new(
        format!("Return over training iterations, the paper's settings, N = {uavs}"),
        Axis::new("iteration of 4096 environment steps", ""),
        Axis::new("mean episode return", ""),
    )
    .note(format!(
        "Band: least to greatest of {} training seed(s).",
        scale.seeds.len()
    ));
    for &hotspots in &scale.hotspots {
        let runs: Vec<&Curve> = curves
            .iter()
            .filter(|c| (c.uavs, c.hotspots) == (uavs, hotspots))
            .collect();
        if runs.is_empty() {
            continue;
        }
        let length = runs.iter().map(|run| run.returns.len()).min().unwrap_or(0);
        let points = (0..length)
            .map(|k| {
                let values: Vec<f64> = runs.iter().map(|run| run.returns[k]).collect();
                let mean = values.iter().sum::<f64>() / values.len() as f64;
                let low = values.iter().copied().fold(f64::INFINITY, f64::min);
                let high = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
                Point::interval(k as f64 + 1.0, mean, low, high)
            })
            .filter(|point| point.y.is_finite())
            .collect();
        figure = figure.with(Series::band(format!("n = {hotspots}"), points));
    }
    figure
}

fn training_times(scale: &Scale, curves: &[Curve]) -> Figure {
    let measured = scale
        .fleets
        .iter()
        .filter_map(|&uavs| {
            let times: Vec<f64> = curves
                .iter()
                .filter(|curve| curve.uavs == uavs)
                .map(Curve::whole_training_s)
                .collect();
            let mean = times.iter().sum::<f64>() / times.len() as f64;
            (!times.is_empty()).then(|| Point::new(f64::from(uavs), mean))
        })
        .collect();
    let paper = [(5.0, 402.0), (10.0, 598.0), (15.0, 1253.0), (20.0, 1751.0)];
    Figure::new(
        "Training time of one cell with the paper's settings",
        Axis::new("UAVs", ""),
        Axis::new("wall time", "s"),
    )
    .note(
        "62 iterations at the pace measured here; the paper: eight processes of a Xeon Gold 6444Y.",
    )
    .with(Series::line("this machine", measured))
    .with(Series::line(
        "the paper",
        paper.map(|(x, y)| Point::new(x, y)).to_vec(),
    ))
}

fn trade_off(scale: &Scale, table: &Table) -> Figure {
    let (uavs, hotspots) = scale.hard_cell();
    let place = |rows: &[&Row]| -> Option<Point> {
        let success = mean(rows, Quantity::Success)?;
        let throughput = mean(rows, Quantity::Throughput)?;
        Some(
            Point::interval(throughput.value, success.value, success.low, success.high)
                .x_interval(throughput.low, throughput.high),
        )
    };
    let mut figure = Figure::new(
        format!("Success against throughput, N = {uavs}, n = {hotspots}"),
        Axis::new("normalised throughput", ""),
        Axis::new("success rate", ""),
    )
    .note("Lines: the same motions with the pilot density held at the value beside each point.");
    for policy in ["learned", "teams"] {
        let held: Vec<(Point, String)> = scale
            .densities
            .iter()
            .filter_map(|&density| {
                let rows = table.select(|row| {
                    row.experiment == "density" && row.policy == policy && row.x == density
                });
                Some((place(&rows)?, format!("{density:.2}")))
            })
            .collect();
        let points = held.iter().map(|(point, _)| *point).collect();
        let labels = held.iter().map(|(_, label)| label.clone());
        let name = format!("{policy}, held pilot density");
        figure = figure.with(Series::line(name, points).labels(labels));
    }
    for (name, policy, pilot) in COMPARED.iter().take(4) {
        let rows: Vec<&Row> = grid_rows(table, policy, pilot)
            .into_iter()
            .filter(|row| (row.uavs, row.hotspots) == (uavs, hotspots))
            .collect();
        figure = figure.with(Series::points(*name, place(&rows).into_iter().collect()));
    }
    figure
}

fn batteries(scale: &Scale, table: &Table, quantity: Quantity, title: &str, unit: &str) -> Figure {
    let mut figure = Figure::new(
        format!("{} over renewable share, small batteries", capital(title)),
        Axis::new("renewable share of the charge", ""),
        Axis::new(title, unit),
    )
    .note("N = 10, n = 5, batteries of 0.03 kWh: about 25 moves to a charge.");
    for policy in ["learned", "teams"] {
        let points = scale
            .renewable_shares
            .iter()
            .filter_map(|&share| {
                let rows = table.select(|row| {
                    row.experiment == "battery" && row.policy == policy && row.x == share
                });
                let estimate = mean(&rows, quantity)?;
                Some(Point::interval(
                    share,
                    estimate.value,
                    estimate.low,
                    estimate.high,
                ))
            })
            .collect();
        figure = figure.with(Series::line(policy, points));
    }
    figure
}

fn approach(scale: &Scale, out: &Path) -> Result<Figure, TrainError> {
    #[derive(serde::Deserialize)]
    struct Line {
        distance_cells: f64,
        pilot_density_mean: f64,
    }
    let (uavs, hotspots) = scale.hard_cell();
    let mut figure = Figure::new(
        format!("Pilot density over distance to the nearest unconfirmed hotspot, N = {uavs}, n = {hotspots}"),
        Axis::new("Manhattan distance", "cells"),
        Axis::new("mean pilot density", "").span(0.0, 0.3),
    )
    .note("The learned policy, deterministic.");
    for &seed in &scale.seeds {
        let path = out.join(format!("approach-s{seed}.csv"));
        if !path.exists() {
            continue;
        }
        let mut reader = csv::Reader::from_path(&path).map_err(TrainError::format(&path))?;
        let points = reader
            .deserialize::<Line>()
            .map(|line| {
                let line = line.map_err(TrainError::format(&path))?;
                Ok(Point::new(line.distance_cells, line.pilot_density_mean))
            })
            .collect::<Result<_, TrainError>>()?;
        figure = figure.with(Series::line(format!("seed {seed}"), points));
    }
    Ok(figure)
}

fn capital(text: &str) -> String {
    let mut text = text.to_owned();
    text[..1].make_ascii_uppercase();
    text
}

/// Draws everything and writes the report.
pub fn write_all(
    scale: &Scale,
    table: &Table,
    curves: &[Curve],
    out: &Path,
) -> Result<(), TrainError> {
    let mut report = Report::new(
        "The paper's results, measured here",
        &format!(
            "A {} reproduction on this machine: {} missions a cell, {} training seed(s).",
            scale.name,
            scale.episodes,
            scale.seeds.len()
        ),
    );
    report.section("Claims");
    report.text("What the paper says, what was measured here, and whether it holds.");
    report.table(&claims::report_table(scale, table, curves));

    let mut gallery = Gallery {
        report: &mut report,
        out,
    };
    gallery.section("Training with the paper's settings");
    gallery.add("training_returns", &training_returns(scale, curves), "")?;
    gallery.add("training_time", &training_times(scale, curves), "")?;
    gallery.section("Fleet size");
    for (index, quantity) in QUANTITIES.iter().enumerate() {
        let name = format!("{}_over_uavs", quantity.0);
        gallery.add(&name, &over_fleets(scale, table, index), "")?;
    }
    gallery.section("Adaptive against constant pilot density");
    for uavs in [10, 15] {
        for index in [0, 3] {
            let name = format!("{}_over_hotspots_n{uavs}", QUANTITIES[index].0);
            gallery.add(&name, &over_hotspots(scale, table, index, uavs), "")?;
        }
    }
    gallery.section("Sensing against communication");
    gallery.add("trade_off", &trade_off(scale, table), "")?;
    gallery.add("approach", &approach(scale, out)?, "")?;
    gallery.section("Carbon and charging");
    let co2 = batteries(scale, table, Quantity::Co2, "carbon emitted", "kg");
    gallery.add("battery_co2", &co2, "")?;
    let success = batteries(scale, table, Quantity::Success, "success rate", "");
    gallery.add("battery_success", &success, "")?;
    gallery.section("Every cell against the best baseline");
    report.table(&claims::bar_table(scale, table));
    if !scale.variations.is_empty() {
        report.section("What the paper's training hangs on");
        report.table(&claims::variation_table(scale, table));
    }
    let path = out.join("report.html");
    report.write(&path).map_err(|error| drawn(&path)(error))
}

fn drawn(path: &Path) -> impl FnOnce(FigureError) -> TrainError {
    TrainError::format(path)
}

struct Gallery<'a> {
    report: &'a mut Report,
    out: &'a Path,
}

impl Gallery<'_> {
    fn section(&mut self, heading: &str) {
        self.report.section(heading);
    }

    /// A figure in the report and in files of its own.
    fn add(&mut self, name: &str, figure: &Figure, caption: &str) -> Result<(), TrainError> {
        let svg = self.out.join(format!("{name}.svg"));
        let text = figure.svg().map_err(drawn(&svg))?;
        jcas_train::store::write_whole(&svg, text.as_bytes())?;
        let png = self.out.join(format!("{name}.png"));
        jcas_train::store::write_whole(&png, &figure.png().map_err(drawn(&png))?)?;
        self.report.figure(figure, caption).map_err(drawn(&svg))?;
        Ok(())
    }
}
