//! What the page needs of a trace, read and checked: the page's code then trusts every length and index.

use serde::{Deserialize, Serialize};
use std::fmt;

/// The version of the trace format that this page understands.
const FORMAT_VERSION: u32 = 1;

/// Why a trace could not be made into a page.
#[derive(Debug)]
pub enum ReplayError {
    /// A line is not the JSON that a trace has there.
    Json {
        /// Counted from 1.
        line: usize,
        /// What the JSON reader says.
        source: serde_json::Error,
    },
    /// A line holds a value that is not allowed there.
    Value {
        /// Counted from 1.
        line: usize,
        /// The name of the field.
        field: &'static str,
        /// What stands there.
        value: String,
        /// What may stand there.
        allowed: String,
    },
    /// The text stops before the trace does.
    Incomplete {
        /// How many steps there are.
        steps: usize,
    },
}

impl fmt::Display for ReplayError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Json { line, source } => write!(f, "trace line {line}: {source}"),
            Self::Value {
                line,
                field,
                value,
                allowed,
            } => write!(
                f,
                "trace line {line}: {field} is {value}, but must be {allowed}"
            ),
            Self::Incomplete { steps } => write!(
                f,
                "the trace has no end line after its {steps} steps: it was not written to its end"
            ),
        }
    }
}

impl std::error::Error for ReplayError {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        match self {
            Self::Json { source, .. } => Some(source),
            _ => None,
        }
    }
}

/// The episode as the page gets it.
#[derive(Serialize)]
pub(super) struct Episode {
    header: Header,
    steps: Vec<Step>,
    end: End,
}

type Cell = [u32; 2];

#[derive(Deserialize, Serialize)]
struct Header {
    format: String,
    format_version: u32,
    core_version: String,
    config: Config,
    config_hash: String,
    seed: String,
    policy: String,
    pilot: String,
    hotspots: Vec<Cell>,
    depots: Vec<Cell>,
    initial: Initial,
}

#[derive(Deserialize, Serialize)]
struct Config {
    grid_width: u32,
    grid_height: u32,
    cell_size_m: f64,
    uav_count: usize,
    hotspot_count: usize,
    quorum: u32,
    step_duration_s: f64,
    battery_capacity_kwh: f64,
    rtb_threshold_kwh: f64,
    pilot_density_min: f64,
    pilot_density_max: f64,
}

#[derive(Deserialize, Serialize)]
struct Initial {
    positions: Vec<Cell>,
    battery_uj: Vec<u64>,
}

#[derive(Deserialize, Serialize)]
struct Step {
    t: usize,
    positions: Vec<Cell>,
    pilot_density: Vec<f64>,
    battery_uj: Vec<u64>,
    grounded: Vec<usize>,
    returning: Vec<usize>,
    links: Vec<[usize; 2]>,
    knowledge: Vec<Vec<usize>>,
    confirmed: Vec<usize>,
    informed: Vec<usize>,
    carbon_intensity_mg_per_kwh: u64,
    co2_ng: u64,
    throughput: f64,
    reward: serde_json::Map<String, serde_json::Value>,
}

#[derive(Deserialize, Serialize)]
struct End {
    steps: usize,
    terminated: bool,
    truncated: bool,
}

/// Only the field that tells the lines apart.
#[derive(Deserialize)]
struct Kind {
    kind: String,
}

impl Episode {
    pub(super) fn read(text: &str) -> Result<Self, ReplayError> {
        let mut lines = (1..).zip(text.lines());
        let (_, first) = lines.next().unwrap_or((1, ""));
        let header: Header = line_of_kind(1, first, "header")?;
        header.check()?;

        let mut steps: Vec<Step> = Vec::new();
        for (line, text) in lines {
            if kind(line, text)? == "end" {
                let end: End = json(line, text)?;
                let found = steps.len();
                check(line, "steps", end.steps == found, end.steps, || {
                    format!("{found}, the number of step lines")
                })?;
                return Ok(Self { header, steps, end });
            }
            let step: Step = line_of_kind(line, text, "step")?;
            step.check(line, steps.len() + 1, &header.config)?;
            steps.push(step);
        }
        Err(ReplayError::Incomplete { steps: steps.len() })
    }

    pub(super) fn to_json(&self) -> String {
        serde_json::to_string(self).expect("plain numbers, strings and lists are JSON")
    }

    /// What the browser's tab shows.
    pub(super) fn title(&self) -> String {
        let Header {
            policy,
            pilot,
            seed,
            config,
            ..
        } = &self.header;
        let steps = self.end.steps;
        let result = if self.end.terminated {
            format!("complete in {steps} steps")
        } else {
            format!("not complete after {steps} steps")
        };
        format!(
            "{policy}, pilot {pilot}, N = {}, n = {}, seed {seed}: {result} (jcas replay)",
            config.uav_count, config.hotspot_count
        )
    }
}

impl Header {
    fn check(&self) -> Result<(), ReplayError> {
        let config = &self.config;
        check(
            1,
            "format",
            self.format == "jcas-trace",
            &self.format,
            || "jcas-trace".into(),
        )?;
        check(
            1,
            "format_version",
            self.format_version == FORMAT_VERSION,
            self.format_version,
            || FORMAT_VERSION.to_string(),
        )?;
        let seed_digits = self.seed.strip_prefix("0x").unwrap_or("");
        check(
            1,
            "seed",
            u64::from_str_radix(seed_digits, 16).is_ok(),
            &self.seed,
            || "0x and hexadecimal digits of 64 bits".into(),
        )?;
        let capacity_kwh = config.battery_capacity_kwh;
        check(
            1,
            "battery_capacity_kwh",
            capacity_kwh > 0.0,
            capacity_kwh,
            || "more than 0".into(),
        )?;
        let uavs = config.uav_count;
        check(1, "uav_count", uavs > 0, uavs, || "at least 1".into())?;
        check_length(1, "hotspots", self.hotspots.len(), config.hotspot_count)?;
        check_length(1, "positions", self.initial.positions.len(), uavs)?;
        check_length(1, "battery_uj", self.initial.battery_uj.len(), uavs)?;
        config.check_cells(1, "hotspots", &self.hotspots)?;
        config.check_cells(1, "depots", &self.depots)?;
        config.check_cells(1, "positions", &self.initial.positions)
    }
}

impl Config {
    fn check_cells(
        &self,
        line: usize,
        field: &'static str,
        cells: &[Cell],
    ) -> Result<(), ReplayError> {
        let (width, height) = (self.grid_width, self.grid_height);
        match cells.iter().find(|[x, y]| *x >= width || *y >= height) {
            None => Ok(()),
            Some(cell) => check(line, field, false, format!("{cell:?}"), || {
                format!("cells of the {width} x {height} grid")
            }),
        }
    }
}

impl Step {
    fn check(&self, line: usize, t: usize, config: &Config) -> Result<(), ReplayError> {
        let (uavs, hotspots) = (config.uav_count, config.hotspot_count);
        check(line, "t", self.t == t, self.t, || t.to_string())?;
        check_length(line, "positions", self.positions.len(), uavs)?;
        check_length(line, "pilot_density", self.pilot_density.len(), uavs)?;
        check_length(line, "battery_uj", self.battery_uj.len(), uavs)?;
        check_length(line, "knowledge", self.knowledge.len(), uavs)?;
        config.check_cells(line, "positions", &self.positions)?;
        check_ids(line, "grounded", &self.grounded, uavs)?;
        check_ids(line, "returning", &self.returning, uavs)?;
        check_ids(line, "links", self.links.as_flattened(), uavs)?;
        for known in &self.knowledge {
            check_ids(line, "knowledge", known, hotspots)?;
        }
        check_ids(line, "confirmed", &self.confirmed, hotspots)?;
        check_ids(line, "informed", &self.informed, hotspots)?;
        for (_, value) in &self.reward {
            check(line, "reward", value.is_number(), value, || {
                "a number for each component".into()
            })?;
        }
        Ok(())
    }
}

fn kind(line: usize, text: &str) -> Result<String, ReplayError> {
    Ok(json::<Kind>(line, text)?.kind)
}

fn line_of_kind<'a, T: Deserialize<'a>>(
    line: usize,
    text: &'a str,
    wanted: &'static str,
) -> Result<T, ReplayError> {
    let found = kind(line, text)?;
    check(line, "kind", found == wanted, &found, || wanted.into())?;
    json(line, text)
}

fn json<'a, T: Deserialize<'a>>(line: usize, text: &'a str) -> Result<T, ReplayError> {
    serde_json::from_str(text).map_err(|source| ReplayError::Json { line, source })
}

fn check_length(
    line: usize,
    field: &'static str,
    found: usize,
    wanted: usize,
) -> Result<(), ReplayError> {
    check(
        line,
        field,
        found == wanted,
        format!("a list of {found}"),
        || format!("a list of {wanted}"),
    )
}

fn check_ids(
    line: usize,
    field: &'static str,
    ids: &[usize],
    count: usize,
) -> Result<(), ReplayError> {
    match ids.iter().find(|id| **id >= count) {
        None => Ok(()),
        Some(id) => check(line, field, false, format!("a list with {id}"), || {
            format!("numbers below {count}")
        }),
    }
}

fn check(
    line: usize,
    field: &'static str,
    holds: bool,
    value: impl fmt::Display,
    allowed: impl FnOnce() -> String,
) -> Result<(), ReplayError> {
    if holds {
        return Ok(());
    }
    Err(ReplayError::Value {
        line,
        field,
        value: value.to_string(),
        allowed: allowed(),
    })
}
