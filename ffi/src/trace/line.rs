//! The lines of a trace, written from a state without an allocation, byte for byte as `jcas trace record` writes
//! them.

use std::fmt::{self, Display, Write};

use jcas_core::config::{Config, FieldValue};
use jcas_core::{Cell, Metrics, Model, StateRef, action, reward};

use super::number::Real;

/// The version of the format that is written.
pub(crate) const FORMAT_VERSION: u32 = 2;

/// Fingerprints of a moment.
#[derive(Clone, Copy)]
pub(crate) struct Hashes {
    pub(crate) observations: u64,
    pub(crate) state: u64,
}

/// What a header says beside the state.
pub(crate) struct Header<'h> {
    pub(crate) version: u32,
    pub(crate) core_version: &'h dyn Display,
    pub(crate) policy: &'h dyn Display,
    pub(crate) pilot: &'h dyn Display,
    pub(crate) seed: u64,
}

/// A text as JSON has it between quotes.
pub(crate) struct Escaped<'t>(pub(crate) &'t str);

impl Display for Escaped<'_> {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        for character in self.0.chars() {
            match character {
                '"' => out.write_str("\\\""),
                '\\' => out.write_str("\\\\"),
                '\n' => out.write_str("\\n"),
                '\r' => out.write_str("\\r"),
                '\t' => out.write_str("\\t"),
                '\u{8}' => out.write_str("\\b"),
                '\u{c}' => out.write_str("\\f"),
                control if control < ' ' => write!(out, "\\u{:04x}", u32::from(control)),
                other => out.write_char(other),
            }?;
        }
        Ok(())
    }
}

impl Header<'_> {
    pub(crate) fn write(
        &self,
        out: &mut impl Write,
        model: &Model<'_>,
        state: &StateRef<'_>,
        hashes: Hashes,
    ) -> fmt::Result {
        write!(
            out,
            "{{\"kind\":\"header\",\"format\":\"jcas-trace\",\"format_version\":{},\"core_version\":\"{}\",\"config\":",
            self.version, self.core_version
        )?;
        config(out, model.config())?;
        write!(
            out,
            ",\"config_hash\":\"0x{:016x}\",\"seed\":\"0x{:016x}\",\"policy\":\"{}\",\"pilot\":\"{}\",\"hotspots\":",
            model.config_hash(),
            self.seed,
            self.policy,
            self.pilot
        )?;
        cells(
            out,
            (0..model.hotspot_count()).map(|j| state.hotspot_cell(j)),
        )?;
        out.write_str(",\"depots\":")?;
        cells(out, model.depots().iter().copied())?;
        out.write_str(",\"initial\":{\"positions\":")?;
        cells(out, (0..model.uav_count()).map(|i| state.cell(i)))?;
        out.write_str(",\"battery_uj\":")?;
        numbers(out, (0..model.uav_count()).map(|i| state.battery_uj(i)))?;
        write!(
            out,
            ",\"carbon_intensity_mg_per_kwh\":{}",
            state.carbon_intensity_mg_per_kwh()
        )?;
        finish(out, hashes)?;
        out.write_str("}}\n")
    }
}

/// The line of the step that led to a state.
pub(crate) fn step(
    out: &mut impl Write,
    model: &Model<'_>,
    state: &StateRef<'_>,
    actions: &[f32],
    hashes: Hashes,
) -> fmt::Result {
    let (uavs, hotspots) = (0..model.uav_count(), 0..model.hotspot_count());
    write!(out, "{{\"kind\":\"step\",\"t\":{},\"actions\":", state.t())?;
    list(out, actions.chunks_exact(2), |out, pair| {
        write!(out, "[{},{}]", Real(finite(pair[0])), Real(finite(pair[1])))
    })?;
    out.write_str(",\"positions\":")?;
    cells(out, uavs.clone().map(|i| state.cell(i)))?;
    out.write_str(",\"pilot_density\":")?;
    numbers(out, uavs.clone().map(|i| Real(state.pilot_density(i))))?;
    out.write_str(",\"battery_uj\":")?;
    numbers(out, uavs.clone().map(|i| state.battery_uj(i)))?;
    out.write_str(",\"grounded\":")?;
    numbers(out, uavs.clone().filter(|&i| state.grounded(i)))?;
    out.write_str(",\"returning\":")?;
    numbers(out, uavs.clone().filter(|&i| state.returning(i)))?;
    out.write_str(",\"links\":")?;
    let links = uavs
        .clone()
        .flat_map(|i| state.neighbours(i).map(move |k| (i, k)));
    pairs(out, links.filter(|(i, k)| i < k))?;
    out.write_str(",\"knowledge\":")?;
    list(out, uavs, |out, i| {
        numbers(out, hotspots.clone().filter(|&j| state.knows(i, j)))
    })?;
    out.write_str(",\"confirmed\":")?;
    numbers(out, hotspots.clone().filter(|&j| state.confirmed(j)))?;
    out.write_str(",\"informed\":")?;
    numbers(out, hotspots.filter(|&j| state.informed(j)))?;
    write!(
        out,
        ",\"carbon_intensity_mg_per_kwh\":{},\"co2_ng\":{},\"throughput\":{},\"reward\":{{",
        state.billed_intensity_mg_per_kwh(),
        state.co2_ng(),
        Real(state.mean_throughput())
    )?;
    for (index, (name, value)) in reward::NAMES.iter().zip(state.rewards()).enumerate() {
        let comma = if index > 0 { "," } else { "" };
        write!(out, "{comma}\"{name}\":{}", Real(value))?;
    }
    out.write_char('}')?;
    finish(out, hashes)?;
    out.write_str("}\n")
}

/// The last line up to its checksum.
pub(crate) fn end(out: &mut impl Write, metrics: &Metrics) -> fmt::Result {
    let Metrics {
        steps,
        terminated,
        truncated,
        confirmed,
        informed,
        moves,
        ..
    } = metrics;
    write!(
        out,
        "{{\"kind\":\"end\",\"steps\":{steps},\"terminated\":{terminated},\"truncated\":{truncated},\"metrics\":{{\
         \"steps\":{steps},\"terminated\":{terminated},\"truncated\":{truncated},\"confirmed\":{confirmed},\
         \"informed\":{informed},\"moves\":{moves}"
    )?;
    for (name, value) in [
        ("return_sum", metrics.return_sum),
        ("energy_kwh", metrics.energy_kwh),
        ("accepted_kwh", metrics.accepted_kwh),
        ("shortfall_kwh", metrics.shortfall_kwh),
        ("grid_kwh", metrics.grid_kwh),
        ("co2_kg", metrics.co2_kg),
        ("throughput_mean", metrics.throughput_mean),
        ("pilot_density_mean", metrics.pilot_density_mean),
    ] {
        write!(out, ",\"{name}\":{}", Real(value))?;
    }
    out.write_char('}')
}

/// The checksum of all bytes before it, and the end of the last line.
pub(crate) fn checksum(out: &mut impl Write, hash: u64) -> fmt::Result {
    writeln!(out, "{CHECKSUM}{hash:016x}\"}}")
}

/// What separates the bytes under the checksum from the checksum.
pub(crate) const CHECKSUM: &str = ",\"checksum\":\"0x";

fn finish(out: &mut impl Write, hashes: Hashes) -> fmt::Result {
    write!(
        out,
        ",\"observation_hash\":\"0x{:016x}\",\"state_hash\":\"0x{:016x}\"",
        hashes.observations, hashes.state
    )
}

fn config(out: &mut impl Write, config: &Config) -> fmt::Result {
    let mut before = '{';
    for (info, value) in Config::FIELDS.iter().zip(config.values()) {
        if value.is_derived() {
            continue;
        }
        write!(out, "{before}\"{}\":", info.name)?;
        match value {
            FieldValue::Real(real) | FieldValue::Optional(Some(real)) => {
                write!(out, "{}", Real(real))?;
            }
            other => write!(out, "{other}")?,
        }
        before = ',';
    }
    out.write_char('}')
}

/// JSON has no infinity; clipped, as the kernel clips it, it means the same.
fn finite(component: f32) -> f32 {
    if component.is_finite() {
        component
    } else {
        action::clip(component)
    }
}

pub(crate) fn list<W: Write, T>(
    out: &mut W,
    items: impl Iterator<Item = T>,
    mut write: impl FnMut(&mut W, T) -> fmt::Result,
) -> fmt::Result {
    out.write_char('[')?;
    for (index, item) in items.enumerate() {
        if index > 0 {
            out.write_char(',')?;
        }
        write(out, item)?;
    }
    out.write_char(']')
}

pub(crate) fn numbers<W: Write>(
    out: &mut W,
    items: impl Iterator<Item = impl Display>,
) -> fmt::Result {
    list(out, items, |out, item| write!(out, "{item}"))
}

pub(crate) fn cells<W: Write>(out: &mut W, items: impl Iterator<Item = Cell>) -> fmt::Result {
    pairs(out, items.map(|cell| (cell.x as usize, cell.y as usize)))
}

pub(crate) fn pairs<W: Write>(
    out: &mut W,
    items: impl Iterator<Item = (usize, usize)>,
) -> fmt::Result {
    list(out, items, |out, (i, k)| write!(out, "[{i},{k}]"))
}
