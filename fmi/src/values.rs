//! Values of variables: their types, and their conversion from fields and from the simulation.

use serde_json::Value;

use crate::episode::Episode;
use crate::error::Error;
use crate::variables::VariableType;

/// The values of one or more variables of one type, in one array.
#[derive(Clone, Debug, PartialEq)]
pub enum Values {
    /// 32-bit floats.
    Float32(Vec<f32>),
    /// 64-bit floats.
    Float64(Vec<f64>),
    /// 32-bit unsigned integers.
    UInt32(Vec<u32>),
    /// 64-bit unsigned integers.
    UInt64(Vec<u64>),
    /// Truth values.
    Boolean(Vec<bool>),
    /// Texts.
    String(Vec<String>),
}

impl Values {
    /// The type of the values.
    #[must_use]
    pub const fn kind(&self) -> VariableType {
        match self {
            Self::Float32(_) => VariableType::Float32,
            Self::Float64(_) => VariableType::Float64,
            Self::UInt32(_) => VariableType::UInt32,
            Self::UInt64(_) => VariableType::UInt64,
            Self::Boolean(_) => VariableType::Boolean,
            Self::String(_) => VariableType::String,
        }
    }
}

/// Returns the value of a field of the configuration.
pub(crate) fn field_values(kind: VariableType, value: &Value) -> Result<Values, Error> {
    Ok(match kind {
        VariableType::Float64 => Values::Float64(vec![value.as_f64().unwrap_or(f64::NAN)]),
        VariableType::UInt32 => Values::UInt32(vec![
            u32::try_from(value.as_u64().unwrap_or(0))
                .map_err(|_| Error::TooLarge(value.clone()))?,
        ]),
        _ => Values::String(vec![
            value
                .as_str()
                .map_or_else(|| value.to_string(), str::to_owned),
        ]),
    })
}

/// Returns the value of an output.
pub(crate) fn output(name: &str, episode: &Episode) -> Result<Values, Error> {
    let state = episode.state()?;
    let (uavs, hotspots) = (0..state.uav_count(), 0..state.hotspot_count());
    let real = |value: f64| Values::Float64(vec![value]);
    let truth = |value: bool| Values::Boolean(vec![value]);
    let metrics = state.metrics();
    Ok(match name {
        "cell" => Values::UInt32(
            uavs.flat_map(|i| [state.cell(i).x, state.cell(i).y])
                .collect(),
        ),
        "battery_kwh" => Values::Float64(
            uavs.map(|i| state.battery_uj(i) as f64 / jcas_core::energy::MICROJOULES_PER_KWH)
                .collect(),
        ),
        "pilot_density" => Values::Float64(uavs.map(|i| state.pilot_density(i)).collect()),
        "throughput" => Values::Float64(uavs.map(|i| state.throughput(i)).collect()),
        "grounded" => Values::Boolean(uavs.map(|i| state.grounded(i)).collect()),
        "knowledge" => Values::Boolean(
            uavs.flat_map(|i| hotspots.clone().map(move |j| (i, j)))
                .map(|(i, j)| state.knows(i, j))
                .collect(),
        ),
        "link" => Values::Boolean(
            uavs.clone()
                .flat_map(|i| uavs.clone().map(move |k| (i, k)))
                .map(|(i, k)| state.linked(i, k))
                .collect(),
        ),
        "hotspot_cell" => Values::UInt32(
            hotspots
                .flat_map(|j| [state.hotspot_cell(j).x, state.hotspot_cell(j).y])
                .collect(),
        ),
        "confirmed" => Values::Boolean(hotspots.map(|j| state.confirmed(j)).collect()),
        "informed" => Values::Boolean(hotspots.map(|j| state.informed(j)).collect()),
        "confirmed_count" => Values::UInt32(vec![metrics.confirmed]),
        "informed_count" => Values::UInt32(vec![metrics.informed]),
        "mean_throughput" => real(state.mean_throughput()),
        "energy_kwh" => real(metrics.energy_kwh),
        "co2_kg" => real(metrics.co2_kg),
        "carbon_intensity" => real(state.carbon_intensity_mg_per_kwh() as f64 / 1e6),
        "reward" => real(episode.reward),
        "return_sum" => real(metrics.return_sum),
        "terminated" => truth(metrics.terminated),
        "truncated" => truth(metrics.truncated),
        "state_hash" => Values::UInt64(vec![episode.hash()]),
        "reported_count" => {
            let cells = episode.model().config().cell_count();
            let reported = |i| (0..cells).filter(move |&cell| state.report_level(i, cell) > 0);
            Values::UInt32(uavs.map(|i| reported(i).count() as u32).collect())
        }
        "false_confirmation_count" => Values::UInt32(vec![metrics.false_confirmations]),
        other => return Err(Error::NoValue(other.to_owned())),
    })
}
