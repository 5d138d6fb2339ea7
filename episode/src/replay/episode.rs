//! The data that the page gets from a trace. Every index is checked here, so that the page's code
//! can rely on it.

use std::borrow::Cow;

use jcas_core::{Cell, Config, Model};
use serde::Serialize;

use crate::trace::{End, Header, Hex, Host, Rewards, Step, Trace, TraceError};

/// The episode in the form that the page reads.
#[derive(Serialize)]
pub(super) struct Episode<'a> {
    /// The state that the first step found: a host's own start replaces the drawn one.
    header: Cow<'a, Header>,
    steps: Vec<Frame<'a>>,
    end: &'a End,
    /// Whether a host simulator changed the state, so that no command flies the episode.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    hosted: bool,
    /// The radius of the cells in which a UAV may raise a false alarm, in cells.
    #[serde(skip_serializing_if = "Option::is_none")]
    footprint_cells: Option<f64>,
}

/// A step without the fields that the page does not show.
#[derive(Serialize)]
struct Frame<'a> {
    t: u32,
    positions: &'a [Cell],
    pilot_density: &'a [f64],
    battery_uj: &'a [u64],
    grounded: &'a [usize],
    returning: &'a [usize],
    links: &'a [[usize; 2]],
    knowledge: &'a [Vec<usize>],
    confirmed: &'a [usize],
    informed: &'a [usize],
    #[serde(skip_serializing_if = "Option::is_none")]
    false_alarms: Option<&'a [Vec<Cell>]>,
    #[serde(skip_serializing_if = "Option::is_none")]
    falsely_confirmed: Option<&'a [Cell]>,
    #[serde(skip_serializing_if = "Option::is_none")]
    reports: Option<&'a [Vec<Vec<Cell>>]>,
    carbon_intensity_mg_per_kwh: u64,
    co2_ng: u64,
    throughput: f64,
    reward: &'a Rewards,
    state_hash: Hex,
    /// Hotspots that the host moved before this step, with their new cells.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    moved_hotspots: Vec<(usize, Cell)>,
}

impl<'a> Episode<'a> {
    pub(super) fn of(trace: &'a Trace) -> Result<Self, TraceError> {
        let Trace {
            header, steps, end, ..
        } = trace;
        let mut line = 2;
        for step in steps {
            line += step.host.len();
            check_step(line, step, header)?;
            line += 1;
        }
        let started = started(header, steps.first())?;
        check_header(&started)?;
        let mut steps: Vec<Frame<'_>> = steps.iter().map(Frame::of).collect();
        if let Some(first) = steps.first_mut() {
            first.moved_hotspots.clear();
        }
        let footprint_cells = footprint_cells(&started.config);
        Ok(Self {
            hosted: trace.steps.iter().any(|step| !step.host.is_empty()) || !end.host.is_empty(),
            footprint_cells,
            header: started,
            steps,
            end,
        })
    }

    pub(super) fn to_json(&self) -> String {
        serde_json::to_string(self).expect("numbers, strings and lists are JSON")
    }

    /// The title of the browser's tab.
    pub(super) fn title(&self) -> String {
        let Header {
            policy,
            pilot,
            seed,
            config,
            ..
        } = self.header.as_ref();
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

impl<'a> Frame<'a> {
    fn of(step: &'a Step) -> Self {
        Self {
            t: step.t,
            positions: &step.positions,
            pilot_density: &step.pilot_density,
            battery_uj: &step.battery_uj,
            grounded: &step.grounded,
            returning: &step.returning,
            links: &step.links,
            knowledge: &step.knowledge,
            confirmed: &step.confirmed,
            informed: &step.informed,
            false_alarms: step.false_alarms.as_deref(),
            falsely_confirmed: step.falsely_confirmed.as_deref(),
            reports: step.reports.as_deref(),
            carbon_intensity_mg_per_kwh: step.carbon_intensity_mg_per_kwh,
            co2_ng: step.co2_ng,
            throughput: step.throughput,
            reward: &step.reward,
            state_hash: step.state_hash,
            moved_hotspots: step.host.iter().filter_map(moved_hotspot).collect(),
        }
    }
}

/// The distance of the farthest cell of a footprint; none without false alarms.
fn footprint_cells(config: &Config) -> Option<f64> {
    if config.false_alarm_per_cell == 0.0 {
        return None;
    }
    let model = Model::new(*config).ok()?;
    let columns = 0..config.grid_width;
    let offsets = columns.flat_map(|dx| (0..config.grid_height).map(move |dy| (dx, dy)));
    let inside = offsets.filter(|&(dx, dy)| model.false_alarm_probability(dx, dy) > 0.0);
    let distances = inside.map(|(dx, dy)| f64::from(dx).hypot(f64::from(dy)));
    Some(distances.fold(0.0, f64::max))
}

fn moved_hotspot(call: &Host) -> Option<(usize, Cell)> {
    match *call {
        Host::MoveHotspot { hotspot, cell } => Some((hotspot, cell)),
        _ => None,
    }
}

/// The header with the host's changes before the first step.
fn started<'a>(header: &'a Header, first: Option<&Step>) -> Result<Cow<'a, Header>, TraceError> {
    let mut header = Cow::Borrowed(header);
    let calls = first.map_or(&[][..], |step| &step.host);
    for (line, call) in (2..).zip(calls) {
        match call {
            Host::SetStarts { cells } => header.to_mut().initial.positions.clone_from(cells),
            Host::SetHotspots { cells } => header.to_mut().hotspots.clone_from(cells),
            Host::SetBatteries { charges_uj } => {
                header.to_mut().initial.battery_uj.clone_from(charges_uj);
            }
            Host::SetBattery { uav, charge_uj } => {
                check_ids(line, "uav", &[*uav], header.initial.battery_uj.len())?;
                header.to_mut().initial.battery_uj[*uav] = *charge_uj;
            }
            Host::MoveHotspot { hotspot, cell } => {
                check_ids(line, "hotspot", &[*hotspot], header.hotspots.len())?;
                header.to_mut().hotspots[*hotspot] = *cell;
            }
            _ => {}
        }
    }
    Ok(header)
}

fn check_header(header: &Header) -> Result<(), TraceError> {
    let uavs = header.config.uav_count as usize;
    let hotspots = header.config.hotspot_count as usize;
    check_length(1, "hotspots", header.hotspots.len(), hotspots)?;
    check_length(1, "positions", header.initial.positions.len(), uavs)?;
    check_length(1, "battery_uj", header.initial.battery_uj.len(), uavs)?;
    check_cells(1, "hotspots", &header.hotspots, header)?;
    check_cells(1, "depots", &header.depots, header)?;
    check_cells(1, "positions", &header.initial.positions, header)
}

fn check_step(line: usize, step: &Step, header: &Header) -> Result<(), TraceError> {
    let uavs = header.config.uav_count as usize;
    let hotspots = header.config.hotspot_count as usize;
    check_cells(line, "positions", &step.positions, header)?;
    for alarms in step.false_alarms.iter().flatten() {
        check_cells(line, "false_alarms", alarms, header)?;
    }
    for levels in step.reports.iter().flatten().flatten() {
        check_cells(line, "reports", levels, header)?;
    }
    let falsely = step.falsely_confirmed.as_deref().unwrap_or_default();
    check_cells(line, "falsely_confirmed", falsely, header)?;
    if let Some(reports) = &step.reports {
        check_length(line, "reports", reports.len(), uavs)?;
    }
    for (hotspot, cell) in step.host.iter().filter_map(moved_hotspot) {
        check_ids(line, "hotspot", &[hotspot], hotspots)?;
        check_cells(line, "cell", &[cell], header)?;
    }
    for (field, ids, count) in [
        ("grounded", step.grounded.as_slice(), uavs),
        ("returning", &step.returning, uavs),
        ("links", step.links.as_flattened(), uavs),
        ("confirmed", &step.confirmed, hotspots),
        ("informed", &step.informed, hotspots),
    ] {
        check_ids(line, field, ids, count)?;
    }
    for known in &step.knowledge {
        check_ids(line, "knowledge", known, hotspots)?;
    }
    Ok(())
}

fn check_length(line: usize, field: &str, found: usize, wanted: usize) -> Result<(), TraceError> {
    if found == wanted {
        return Ok(());
    }
    Err(malformed(
        line,
        format!("{field} has {found} elements: must have {wanted}"),
    ))
}

fn check_cells(
    line: usize,
    field: &str,
    cells: &[Cell],
    header: &Header,
) -> Result<(), TraceError> {
    let (width, height) = (header.config.grid_width, header.config.grid_height);
    match cells
        .iter()
        .find(|cell| cell.x >= width || cell.y >= height)
    {
        None => Ok(()),
        Some(Cell { x, y }) => Err(malformed(
            line,
            format!("{field} holds [{x}, {y}]: must be on the {width} x {height} grid"),
        )),
    }
}

fn check_ids(line: usize, field: &str, ids: &[usize], count: usize) -> Result<(), TraceError> {
    match ids.iter().find(|id| **id >= count) {
        None => Ok(()),
        Some(id) => Err(malformed(
            line,
            format!("{field} holds {id}: must be below {count}"),
        )),
    }
}

fn malformed(line: usize, problem: String) -> TraceError {
    TraceError::Malformed { line, problem }
}
