//! The lines of a trace, which are displayed from a state.

use core::fmt::{self, Display, Write};

use jcas_core::config::{Config, FieldValue};
use jcas_core::{
    Cell, Error, Metrics, Model, Scratch, StateRef, action, hash, observation, reward,
};

use crate::number::Real;

/// The name of the format, in every header.
pub const FORMAT: &str = "jcas-trace";
/// The version of the format.
pub const FORMAT_VERSION: u32 = 1;
/// The separator between the bytes under the checksum and the checksum.
pub const CHECKSUM: &str = ",\"checksum\":\"0x";

/// Fingerprints of a state and of its observations.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Hashes {
    /// The fingerprint of all observations.
    pub observations: u64,
    /// The fingerprint of the words of the state.
    pub state: u64,
}

impl Hashes {
    /// Computes the fingerprints of a state. `words` are its words, and `observations` is
    /// overwritten.
    ///
    /// # Errors
    /// The call fails if `words`, `scratch` or `observations` do not have the model's sizes.
    pub fn of(
        model: &Model<'_>,
        words: &[u64],
        scratch: &mut [u64],
        observations: &mut [f32],
    ) -> Result<Self, Error> {
        let mut scratch = Scratch::new(model, scratch)?;
        observation::observe(model, &model.state(words)?, &mut scratch, observations)?;
        Ok(Self {
            observations: hash::reals(observations),
            state: hash::words(words),
        })
    }
}

impl Display for Hashes {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            out,
            ",\"observation_hash\":\"0x{:016x}\",\"state_hash\":\"0x{:016x}\"",
            self.observations, self.state
        )
    }
}

/// The first line, of a state at t = 0.
#[derive(Clone, Copy)]
pub struct HeaderLine<'a> {
    /// Version of the kernel.
    pub core_version: &'a dyn Display,
    /// Name of the policy, as JSON has it between quotes ([`Escaped`]).
    pub policy: &'a dyn Display,
    /// How the pilot density is chosen, as JSON has it between quotes.
    pub pilot: &'a dyn Display,
    /// The model of the state.
    pub model: &'a Model<'a>,
    /// The state before the first step and before any call of a host.
    pub state: &'a StateRef<'a>,
    /// The fingerprints of the state.
    pub hashes: Hashes,
}

/// The line of the step that led to a state.
#[derive(Clone, Copy)]
pub struct StepLine<'a> {
    /// The model of the state.
    pub model: &'a Model<'a>,
    /// The state after the step.
    pub state: &'a StateRef<'a>,
    /// The actions of the step, \[N\]\[2\].
    pub actions: &'a [f32],
    /// The fingerprints of the state.
    pub hashes: Hashes,
}

/// The last line up to its checksum.
#[derive(Clone, Copy, Debug)]
pub struct EndLine {
    /// The metrics of the episode.
    pub metrics: Metrics,
}

/// A text that is displayed with JSON escapes, without quotes.
#[derive(Clone, Copy, Debug)]
pub struct Escaped<'t>(pub &'t str);

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

impl Display for HeaderLine<'_> {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { model, state, .. } = self;
        write!(
            out,
            "{{\"kind\":\"header\",\"format\":\"{FORMAT}\",\"format_version\":{FORMAT_VERSION},\
             \"core_version\":\"{}\",\"config\":",
            self.core_version
        )?;
        config(out, model.config())?;
        write!(
            out,
            ",\"config_hash\":\"0x{:016x}\",\"seed\":\"0x{:016x}\",\"policy\":\"{}\",\
             \"pilot\":\"{}\",\"hotspots\":",
            model.config_hash(),
            state.seed(),
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
        writeln!(out, "{}}}}}", self.hashes)
    }
}

impl Display for StepLine<'_> {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            model,
            state,
            actions,
            hashes,
        } = *self;
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
        if model.config().false_alarm_per_cell > 0.0 {
            alarms(out, model, state)?;
        }
        if model.config().report_levels > 0 {
            reports(out, model, state)?;
        }
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
        writeln!(out, "{hashes}}}")
    }
}

impl Display for EndLine {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { metrics } = self;
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
            "{{\"kind\":\"end\",\"steps\":{steps},\"terminated\":{terminated},\
             \"truncated\":{truncated},\"metrics\":{{\"steps\":{steps},\
             \"terminated\":{terminated},\"truncated\":{truncated},\"confirmed\":{confirmed},\
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
        let count = metrics.false_confirmations;
        write!(out, ",\"false_confirmations\":{count}}}")
    }
}

/// The false alarms of each UAV, and the cells that are falsely confirmed.
fn alarms(out: &mut fmt::Formatter<'_>, model: &Model<'_>, state: &StateRef<'_>) -> fmt::Result {
    let width = model.config().grid_width as usize;
    let place = move |index: usize| (index % width, index / width);
    out.write_str(",\"false_alarms\":")?;
    list(out, 0..model.uav_count(), |out, i| {
        pairs(out, state.false_alarms_of(i).map(place))
    })?;
    out.write_str(",\"falsely_confirmed\":")?;
    pairs(out, state.falsely_confirmed_cells().map(place))
}

/// The cells of each level of the reports that each UAV knows.
fn reports(out: &mut fmt::Formatter<'_>, model: &Model<'_>, state: &StateRef<'_>) -> fmt::Result {
    let width = model.config().grid_width as usize;
    let cells = model.config().cell_count();
    out.write_str(",\"reports\":")?;
    list(out, 0..model.uav_count(), |out, i| {
        list(out, 1..=model.config().report_levels, |out, level| {
            let known = (0..cells).filter(|&index| state.report_level(i, index) >= level);
            pairs(out, known.map(|index| (index % width, index / width)))
        })
    })
}

fn config(out: &mut fmt::Formatter<'_>, config: &Config) -> fmt::Result {
    let mut before = '{';
    for (info, value) in config.stated() {
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

/// JSON has no infinity. The number is clipped as the kernel clips it, which changes no result.
fn finite(component: f32) -> f32 {
    if component.is_finite() {
        component
    } else {
        action::clip(component)
    }
}

pub(crate) fn list<T>(
    out: &mut fmt::Formatter<'_>,
    items: impl Iterator<Item = T>,
    mut write: impl FnMut(&mut fmt::Formatter<'_>, T) -> fmt::Result,
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

pub(crate) fn numbers(
    out: &mut fmt::Formatter<'_>,
    items: impl Iterator<Item = impl Display>,
) -> fmt::Result {
    list(out, items, |out, item| write!(out, "{item}"))
}

pub(crate) fn cells(
    out: &mut fmt::Formatter<'_>,
    items: impl Iterator<Item = Cell>,
) -> fmt::Result {
    pairs(out, items.map(|cell| (cell.x as usize, cell.y as usize)))
}

pub(crate) fn pairs(
    out: &mut fmt::Formatter<'_>,
    items: impl Iterator<Item = (usize, usize)>,
) -> fmt::Result {
    list(out, items, |out, (i, k)| write!(out, "[{i},{k}]"))
}
