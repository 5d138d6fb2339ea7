//! What adapting the pilot density is worth: against every constant in four worlds, then over maps of regimes.

use crate::chapter::{Block, Chapter};
use crate::flight::{ADAPTIVE, Flight, HELD, OURS, Who};
use crate::plan::{CONSTANT_PILOT, Scale};
use crate::table::{Quantity, Query, Row, Table};
use crate::text::capital;
use jcas_core::{Config, Preset};
use jcas_evaluate::figures::{Axis, Figure, HeatTable, Panels, Point, Series};
use jcas_evaluate::policy::{BaselineKind, PilotMode};

/// Name of the study of worlds in the table of results; that of a regime begins with it.
const EXPERIMENT: &str = "pilot";

/// A mission and a script that flies it.
struct World {
    title: &'static str,
    preset: Preset,
    kind: BaselineKind,
    hotspots: u32,
}

const WORLDS: [World; 4] = [
    World {
        title: "`line` in `search`",
        preset: Preset::Search,
        kind: BaselineKind::Line,
        hotspots: 7,
    },
    World {
        title: "`greedy` in `paper`",
        preset: Preset::Paper,
        kind: BaselineKind::Greedy,
        hotspots: 7,
    },
    World {
        title: "`swarm` in `paper`",
        preset: Preset::Paper,
        kind: BaselineKind::Swarm,
        hotspots: 7,
    },
    World {
        title: "`swarm` in `mission`",
        preset: Preset::Mission,
        kind: BaselineKind::Swarm,
        hotspots: 11,
    },
];

/// A field of the configuration and its values.
struct Varied {
    label: &'static str,
    unit: &'static str,
    values: &'static [f64],
    set: fn(&mut Config, f64),
}

impl Varied {
    fn ends_at(&self, value: f64) -> bool {
        [self.values.first(), self.values.last()].contains(&Some(&value))
    }
}

const LOAD: Varied = Varied {
    label: "loss of sensing per load (α_JCAS)",
    unit: "dB",
    values: &[0.0, 1.0, 3.0, 5.0, 10.0, 20.0],
    set: |config, value| config.comm_load_penalty_db = value,
};
const LINK: Varied = Varied {
    label: "throughput that a link needs (η_link)",
    unit: "",
    values: &[0.6, 0.8, 1.0, 1.2, 1.4],
    set: |config, value| config.link_throughput_min = value,
};
const FLEET: Varied = Varied {
    label: "UAVs",
    unit: "",
    values: &[5.0, 10.0, 15.0, 20.0],
    set: |config, value| config.uav_count = value as u32,
};
const RANGE: Varied = Varied {
    label: "sensing range",
    unit: "m",
    values: &[75.0, 100.0, 150.0, 200.0, 250.0],
    set: |config, value| config.sensing_range_m = Some(value),
};

/// Two fields varied together around the mission of `line` in `search` at N = 10, n = 7.
struct Map {
    name: &'static str,
    rows: Varied,
    columns: Varied,
    /// α_JCAS where it is not varied, dB.
    load_db: f64,
}

const MAPS: [Map; 3] = [
    Map {
        name: "pilot_load_link",
        rows: LOAD,
        columns: LINK,
        load_db: 1.0,
    },
    Map {
        name: "pilot_load_fleet",
        rows: LOAD,
        columns: FLEET,
        load_db: 1.0,
    },
    Map {
        name: "pilot_range_fleet",
        rows: RANGE,
        columns: FLEET,
        load_db: 10.0,
    },
];

impl Map {
    fn config(&self, scale: &Scale, row: f64, column: f64) -> Config {
        let mut config = Config {
            comm_load_penalty_db: self.load_db,
            ..scale.mission(Preset::Search, (10, 7))
        };
        (self.rows.set)(&mut config, row);
        (self.columns.set)(&mut config, column);
        config
    }

    fn experiment(&self, row: f64, column: f64) -> String {
        format!("{}:{row}:{column}", self.name)
    }

    fn places(&self) -> impl Iterator<Item = (f64, f64)> {
        let (rows, columns) = (self.rows.values, self.columns.values);
        rows.iter()
            .flat_map(move |&row| columns.iter().map(move |&column| (row, column)))
    }

    fn worth(&self, table: &Table, row: f64, column: f64) -> Option<Worth> {
        let experiment = self.experiment(row, column);
        Worth::of(
            table,
            &experiment,
            Preset::Search,
            BaselineKind::Line.name(),
            None,
        )
    }
}

/// A script's campaigns: adaptive, then each density.
fn scripted(
    experiment: &str,
    preset: Preset,
    config: Config,
    kind: BaselineKind,
    densities: &[f64],
) -> Vec<Flight> {
    let held = densities.iter().map(|&rho| (rho, PilotMode::Held(rho)));
    [(0.0, PilotMode::Adaptive)]
        .into_iter()
        .chain(held)
        .map(|(x, pilot)| Flight {
            experiment: (experiment.to_owned(), x),
            preset,
            config,
            who: Who::Script(kind, pilot),
        })
        .collect()
}

/// The worlds at every fleet with fine densities, then the maps with coarse ones.
pub(crate) fn flights(scale: &Scale) -> Vec<Flight> {
    let (fine, coarse) = &scale.pilot_densities;
    let mut flights = Vec::new();
    for world in &WORLDS {
        for &uavs in &scale.fleets {
            let config = scale.mission(world.preset, (uavs, world.hotspots));
            flights.extend(scripted(EXPERIMENT, world.preset, config, world.kind, fine));
            let held = fine.iter().map(|&rho| (rho, Some(rho)));
            flights.extend(
                [(0.0, None)]
                    .into_iter()
                    .chain(held)
                    .map(|(x, held)| Flight {
                        experiment: (EXPERIMENT.to_owned(), x),
                        preset: world.preset,
                        config,
                        who: Who::Ours { base: config, held },
                    }),
            );
        }
    }
    for map in &MAPS {
        let flown = |&(row, column): &(f64, f64)| {
            !coarse.is_empty()
                && (scale.whole_maps || map.rows.ends_at(row) && map.columns.ends_at(column))
        };
        for (row, column) in map.places().filter(flown) {
            let experiment = map.experiment(row, column);
            let config = map.config(scale, row, column);
            flights.extend(scripted(
                &experiment,
                Preset::Search,
                config,
                BaselineKind::Line,
                coarse,
            ));
        }
    }
    flights
}

/// Adaptive beside each constant, in one mission.
struct Worth {
    adaptive: Row,
    held: Vec<Row>,
}

impl Worth {
    fn of(
        table: &Table,
        experiment: &str,
        preset: Preset,
        policy: &str,
        uavs: Option<u32>,
    ) -> Option<Worth> {
        let rows = |pilot| {
            let query = Query {
                uavs,
                ..Query::new(experiment, preset.name(), (policy, pilot))
            };
            query.rows(table).into_iter().filter(|row| row.seed == 0)
        };
        let mut held: Vec<Row> = rows(HELD).cloned().collect();
        held.sort_by(|a, b| a.x.total_cmp(&b.x));
        Some(Worth {
            adaptive: rows(ADAPTIVE).next()?.clone(),
            held,
        })
        .filter(|worth| !worth.held.is_empty())
    }

    /// The constant with the shortest missions; of those whose intervals reach that, the one that talks most.
    fn best(&self) -> &Row {
        let least = self
            .held
            .iter()
            .min_by(|a, b| a.mission_steps.total_cmp(&b.mission_steps));
        let bound = least.map_or(f64::INFINITY, |row| row.mission_steps_high);
        self.held
            .iter()
            .filter(|row| row.mission_steps <= bound)
            .max_by(|a, b| a.throughput.total_cmp(&b.throughput))
            .expect("the least is one of them")
    }

    /// The constant that the paper compares with.
    fn papers(&self) -> Option<&Row> {
        self.held.iter().find(|row| row.x == CONSTANT_PILOT)
    }

    /// How much a quantity of adaptive is above that of a constant, in percent.
    fn above(&self, constant: &Row, quantity: Quantity) -> f64 {
        let of = |row: &Row| row.estimate(quantity).value;
        100.0 * (of(&self.adaptive) / of(constant).max(1e-9) - 1.0)
    }

    /// Whether the intervals of mission time of adaptive and a constant are apart.
    fn tells_apart(&self, constant: &Row) -> bool {
        let (a, b) = (&self.adaptive, constant);
        a.mission_steps_high < b.mission_steps_low || a.mission_steps_low > b.mission_steps_high
    }
}

/// Heads of the table of worlds.
const HEAD: [&str; 8] = [
    "world",
    "N",
    "adaptive: success, steps",
    "against",
    "success (points)",
    "mission time",
    "energy",
    "throughput",
];

fn row(title: &str, worth: &Worth, name: &str, constant: &Row) -> [String; 8] {
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

/// Who flies a world: its script, then ours where it is flown there.
fn flyers(world: &World) -> [(String, &'static str); 2] {
    [
        (world.title.to_owned(), world.kind.name()),
        (format!("ours in `{}`", world.preset.name()), OURS),
    ]
}

fn worlds(scale: &Scale, table: &Table) -> Vec<(String, Vec<Worth>)> {
    let mut found: Vec<(String, Vec<Worth>)> = Vec::new();
    for world in &WORLDS {
        for (title, policy) in flyers(world) {
            let worths: Vec<Worth> = scale
                .fleets
                .iter()
                .filter_map(|&uavs| Worth::of(table, EXPERIMENT, world.preset, policy, Some(uavs)))
                .collect();
            if !worths.is_empty() && found.iter().all(|(other, _)| *other != title) {
                found.push((title, worths));
            }
        }
    }
    found
}

/// The chapter as far as the table has it; none without a row.
pub fn chapter(scale: &Scale, table: &Table) -> Option<Chapter> {
    let worlds = worlds(scale, table);
    if worlds.is_empty() {
        return None;
    }
    let mut rows = Vec::new();
    for (title, worths) in &worlds {
        for worth in worths {
            rows.push(row(title, worth, "best constant", worth.best()));
            if let Some(papers) = worth.papers() {
                rows.push(row(title, worth, "constant", papers));
            }
        }
    }
    let mut blocks = vec![
        Block::Text(reason(scale)),
        Block::Text(verdict(&worlds)),
        Block::table("Adaptive against constant pilot density", HEAD, rows),
    ];
    for (quantity, name) in [
        (Quantity::Steps, "pilot_mission_time"),
        (Quantity::Energy, "pilot_energy"),
        (Quantity::Throughput, "pilot_throughput"),
    ] {
        let figure = panels(scale, &worlds, quantity);
        blocks.push(Block::figure(name, &figure.title.clone(), figure));
    }
    for map in &MAPS {
        if let Some((text, figure)) = regimes(scale, table, map) {
            blocks.push(Block::Text(text));
            blocks.push(Block::figure(map.name, &figure.title.clone(), figure));
        }
    }
    Some(Chapter {
        heading: "What adapting the pilot density is worth".to_owned(),
        blocks,
    })
}

/// Why a pilot density can matter at all, from the equations.
fn reason(scale: &Scale) -> String {
    let config = scale.mission(Preset::Paper, (10, 5));
    let (low, high) = (config.pilot_density_min, config.pilot_density_max);
    let gain_db = config.comm_load_penalty_db * (high - low);
    let odds = (config.logistic_slope_per_db * gain_db).exp();
    format!(
        "The pilot density acts in two places. A high one leaves less load for the radar to see through: from {low:.2} to \
         {high:.2} the sensing SNR gains α_JCAS · {:.2} = {gain_db:.2} dB at the paper's α_JCAS = {} dB, which \
         multiplies the odds of a detection by {odds:.3}. A low one leaves more for data: links reach {:.1} cells at \
         {high:.2} and {:.1} at {low:.2}, throughput grows with 1 − ρ, and sensing costs energy in proportion to ρ. So \
         with the paper's numbers there is little to sense better for, and the least density is hard to beat.",
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

/// What the worlds come to, in a sentence each.
fn verdict(worlds: &[(String, Vec<Worth>)]) -> String {
    let mut text = "Adaptive is full density within a cell of an unconfirmed hotspot (hidden ones: until all are \
                    confirmed) and the least elsewhere. The best constant has the shortest missions and, of those within \
                    its interval, the most throughput. "
        .to_owned();
    for (title, worths) in worlds {
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
            "{}: mission time {} % against the best constant (intervals apart in {clear} of {} fleets), throughput {} %, \
             success {} points against the paper's constant {CONSTANT_PILOT}. ",
            capital(title),
            span(times.into_iter()),
            worths.len(),
            span(throughputs),
            span(points),
        );
    }
    text + "The paper has adaptive up to about 10 points ahead of its constant at larger fleets. Fleets that start in one \
            cell stay together under `greedy`, so that it flies as `swarm` does. `line` chooses its formation for the \
            density that it senses with, by an estimate over sixty steps: jumps between neighbouring densities, and \
            constants that beat full density where missions are longer than that, are such choices."
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

/// A quantity over the density that is held, against adaptive, a panel for each world.
fn panels(scale: &Scale, worlds: &[(String, Vec<Worth>)], quantity: Quantity) -> Panels {
    let panel = |(title, worths): &(String, Vec<Worth>)| {
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
            "{} missions a point; n = 7, in mission n = 11. Above the line a constant takes more than adaptive does.",
            scale.episodes
        ),
        columns: 2,
        figures: worlds.iter().map(panel).collect(),
    }
}

/// Where adapting pays, over two fields: mission time saved against the best constant of each regime.
fn regimes(scale: &Scale, table: &Table, map: &Map) -> Option<(String, HeatTable)> {
    let worths: Vec<((f64, f64), Worth)> = map
        .places()
        .filter_map(|(row, column)| Some(((row, column), map.worth(table, row, column)?)))
        .collect();
    let saved = |worth: &Worth| -worth.above(worth.best(), Quantity::Steps);
    let most = worths
        .iter()
        .max_by(|a, b| saved(&a.1).total_cmp(&saved(&b.1)))?;
    let least = worths
        .iter()
        .min_by(|a, b| saved(&a.1).total_cmp(&saved(&b.1)))?;
    let clear = worths
        .iter()
        .filter(|(_, worth)| worth.tells_apart(worth.best()) && saved(worth) > 0.0)
        .count();
    let (rows, columns) = (&map.rows, &map.columns);
    let place = |((row, column), worth): &((f64, f64), Worth)| {
        format!(
            "{} {row}{}, {} {column}: {:+.1} % of the best constant's time (ρ = {:.2}, {:.1} steps)",
            rows.label,
            unit(rows.unit),
            columns.label,
            -saved(worth),
            worth.best().x,
            worth.best().mission_steps
        )
    };
    let text = format!(
        "`line` in `search` around N = 10, n = 7{}: adapting shortens the mission beyond the intervals in {clear} of {} \
         regimes. Most: {}. Least: {}.",
        if map.load_db == 1.0 {
            String::new()
        } else {
            format!(", α_JCAS = {} dB", map.load_db)
        },
        worths.len(),
        place(most),
        place(least),
    );
    let cell = |row: f64, column: f64| {
        let at = worths.iter().find(|(place, _)| *place == (row, column))?;
        Some(saved(&at.1))
    };
    let figure = HeatTable {
        title: "Mission time saved by adapting".to_owned(),
        note: format!(
            "Against the best constant; line in search, {} missions a campaign, n = 7; where not varied N = 10, α = {} dB.",
            scale.episodes, map.load_db
        ),
        value: Axis::new("mission time saved", "%"),
        columns: categories(columns),
        rows: categories(rows),
        cells: rows
            .values
            .iter()
            .map(|&row| {
                let columns = columns.values.iter();
                columns.map(|&column| cell(row, column)).collect()
            })
            .collect(),
        decimals: Some(1),
    };
    Some((text, figure))
}

fn unit(unit: &str) -> String {
    if unit.is_empty() {
        String::new()
    } else {
        format!(" {unit}")
    }
}

fn categories(varied: &Varied) -> Axis {
    Axis::new(varied.label, varied.unit).categories(varied.values.iter().map(f64::to_string))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::table::Key;
    use jcas_core::Metrics;
    use jcas_evaluate::statistics::Summary;

    /// One regime in which a constant of 0.1 takes 20 steps and adaptive 15.
    #[test]
    fn a_map_says_what_adapting_saves() {
        let scale = Scale::full(1);
        let mut table = Table::open(&std::env::temp_dir().join("jcas-no-such-table")).unwrap();
        let map = &MAPS[0];
        for (pilot, x, steps) in [(ADAPTIVE, 0.0, 15), (HELD, 0.1, 20), (HELD, 0.3, 25)] {
            let key = Key {
                experiment: map.experiment(5.0, 1.0),
                preset: Preset::Search.name().to_owned(),
                uavs: 10,
                hotspots: 7,
                policy: BaselineKind::Line.name().to_owned(),
                pilot: pilot.to_owned(),
                seed: 0,
                x,
                config_hash: String::new(),
            };
            let mission = Metrics {
                steps,
                terminated: true,
                ..Metrics::default()
            };
            table.add(&key, &Summary::of(&[mission; 10], 100)).unwrap();
        }
        let (text, figure) = regimes(&scale, &table, map).unwrap();
        let saved: Vec<f64> = figure.cells.iter().flatten().copied().flatten().collect();
        assert_eq!(saved.len(), 1);
        assert!((saved[0] - 25.0).abs() < 1e-9);
        assert!(text.contains("in 1 of 1 regimes"), "{text}");
        assert!(
            text.contains("-25.0 % of the best constant's time (ρ = 0.10, 20.0 steps)"),
            "{text}"
        );
    }

    /// By hand: 32.30 dB at one cell (docs/model.md), and 6/0.7 bits need 25.79 dB, 6/0.99 bits 18.17 dB.
    #[test]
    fn links_reach_as_far_as_their_budget() {
        let config = Config::default();
        for (density, excess_db) in [(0.30, 32.30 - 25.79), (0.01, 32.30 - 18.17)] {
            let cells = 10f64.powf(excess_db / 20.0);
            assert!((link_cells(&config, density) - cells).abs() < 0.01);
        }
    }

    #[test]
    fn regimes_have_names_and_missions_of_their_own() {
        let scale = Scale::full(1);
        let mut seen = Vec::new();
        for map in &MAPS {
            for (row, column) in map.places() {
                let config = map.config(&scale, row, column);
                jcas_core::Model::new(config).unwrap();
                let experiment = map.experiment(row, column);
                assert!(!seen.contains(&experiment), "{experiment}");
                seen.push(experiment);
            }
        }
        let base = MAPS[0].config(&scale, 1.0, 1.0);
        assert_eq!(base, scale.mission(Preset::Search, (10, 7)));
    }
}
