//! What a trace says: a view of its lines.

use core::fmt;

use jcas_core::reward::{COMPONENTS, NAMES};
use jcas_core::{Cell, Config, Metrics};
use serde::de::{Error as _, MapAccess, Visitor};
use serde::ser::SerializeMap;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use super::host::Host;

/// A complete trace: its text, and what its lines say.
#[derive(Clone, Debug, PartialEq)]
pub struct Trace {
    /// The bytes of the file, which a replay repeats.
    pub text: String,
    /// The configuration, the policy's name, and the state before the first step.
    pub header: Header,
    /// The steps; step t is at index t − 1.
    pub steps: Vec<Step>,
    /// The end of the episode.
    pub end: End,
}

/// The first line.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Header {
    /// Always `header`.
    pub kind: String,
    /// Always [`FORMAT`](super::FORMAT).
    pub format: String,
    /// Always [`FORMAT_VERSION`](super::FORMAT_VERSION).
    pub format_version: u32,
    /// Version of the kernel that ran the episode.
    pub core_version: String,
    /// The complete configuration.
    pub config: Config,
    /// Hash of the configuration.
    pub config_hash: Hex,
    /// Seed of the episode.
    pub seed: Hex,
    /// Name of the policy.
    pub policy: String,
    /// Pilot mode: how the pilot density was chosen.
    pub pilot: String,
    /// Cells of the hotspots.
    pub hotspots: Vec<Cell>,
    /// Cells of the depots.
    pub depots: Vec<Cell>,
    /// The state before the first step.
    pub initial: Initial,
}

/// The state before the first step.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Initial {
    /// Cell of each UAV.
    pub positions: Vec<Cell>,
    /// Charge of each UAV in microjoules.
    pub battery_uj: Vec<u64>,
    /// Carbon intensity that the first step bills.
    pub carbon_intensity_mg_per_kwh: u64,
    /// Hash of all observations.
    pub observation_hash: Hex,
    /// Hash of the kernel's state.
    pub state_hash: Hex,
}

/// One step.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Step {
    /// Always `step`.
    pub kind: String,
    /// Number of the step, from 1.
    pub t: u32,
    /// (u_dir, u_pilot) of each UAV, as given; infinities are clipped.
    pub actions: Vec<[f32; 2]>,
    /// Cell of each UAV after the move.
    pub positions: Vec<Cell>,
    /// Pilot density of each UAV in this step.
    pub pilot_density: Vec<f64>,
    /// Charge of each UAV after the step, in microjoules.
    pub battery_uj: Vec<u64>,
    /// Indices of the grounded UAVs.
    pub grounded: Vec<usize>,
    /// Indices of the UAVs that returned to base.
    pub returning: Vec<usize>,
    /// Links of this step: (i, j), i < j.
    pub links: Vec<[usize; 2]>,
    /// The hotspots that each UAV knows.
    pub knowledge: Vec<Vec<usize>>,
    /// Hotspots confirmed so far.
    pub confirmed: Vec<usize>,
    /// Hotspots that every UAV knows.
    pub informed: Vec<usize>,
    /// The cells in which each UAV raised a false alarm; absent where there are no false alarms.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub false_alarms: Option<Vec<Vec<Cell>>>,
    /// Cells falsely confirmed so far; absent where there are no false alarms.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub falsely_confirmed: Option<Vec<Cell>>,
    /// The reports that each UAV knows, level by level; absent where there are none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub reports: Option<Vec<Vec<Vec<Cell>>>>,
    /// Carbon intensity that this step billed.
    pub carbon_intensity_mg_per_kwh: u64,
    /// CO2 of the episode so far, in nanograms.
    pub co2_ng: u64,
    /// Mean normalised throughput over all UAVs.
    pub throughput: f64,
    /// The reward's components.
    pub reward: Rewards,
    /// Hash of all observations after the step.
    pub observation_hash: Hex,
    /// Hash of the kernel's state after the step.
    pub state_hash: Hex,
    /// Calls of the host since the previous step; each is a separate line.
    #[serde(skip)]
    pub host: Vec<Host>,
}

/// The last line. The checksum has to remain its last field.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct End {
    /// Always `end`.
    pub kind: String,
    /// Number of steps.
    pub steps: u32,
    /// Whether every UAV knows every hotspot.
    pub terminated: bool,
    /// Whether the horizon truncated the episode.
    pub truncated: bool,
    /// Metrics of the episode.
    pub metrics: Metrics,
    /// Checksum of all preceding bytes.
    pub checksum: Hex,
    /// Calls of the host after the last step; each is a separate line.
    #[serde(skip)]
    pub host: Vec<Host>,
}

impl End {
    /// The last line of an episode.
    pub(super) fn of(metrics: Metrics, checksum: Hex) -> Self {
        Self {
            kind: "end".to_owned(),
            steps: metrics.steps,
            terminated: metrics.terminated,
            truncated: metrics.truncated,
            metrics,
            checksum,
            host: Vec::new(),
        }
    }
}

/// Writes 64 bits as `0x` and sixteen digits, since many readers parse JSON numbers as doubles.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Hex(pub u64);

impl fmt::Display for Hex {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(out, "0x{:016x}", self.0)
    }
}

impl Serialize for Hex {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(self)
    }
}

impl<'de> Deserialize<'de> for Hex {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let text = String::deserialize(deserializer)?;
        text.strip_prefix("0x")
            .and_then(jcas_trace::hexadecimal)
            .map(Self)
            .ok_or_else(|| D::Error::custom(format!("\"{text}\": must be 0x and sixteen digits")))
    }
}

/// The components of a step's reward, by name and in the kernel's order.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rewards(pub [f64; COMPONENTS]);

impl Serialize for Rewards {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(Some(COMPONENTS))?;
        for (name, value) in NAMES.iter().zip(self.0) {
            map.serialize_entry(name, &value)?;
        }
        map.end()
    }
}

impl<'de> Deserialize<'de> for Rewards {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Components;
        impl<'de> Visitor<'de> for Components {
            type Value = Rewards;

            fn expecting(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
                write!(out, "the reward components {}", NAMES.join(", "))
            }

            fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Rewards, A::Error> {
                let mut found = [None; COMPONENTS];
                while let Some((name, value)) = map.next_entry::<String, f64>()? {
                    let index = NAMES
                        .iter()
                        .position(|known| *known == name)
                        .ok_or_else(|| A::Error::unknown_field(&name, &NAMES))?;
                    found[index] = Some(value);
                }
                let mut values = [0.0; COMPONENTS];
                for (index, value) in found.into_iter().enumerate() {
                    values[index] = value.ok_or_else(|| A::Error::missing_field(NAMES[index]))?;
                }
                Ok(Rewards(values))
            }
        }
        deserializer.deserialize_map(Components)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hex_reads_back_and_refuses_anything_else() {
        let text = serde_json::to_string(&Hex(0xdead_beef)).unwrap();
        assert_eq!(text, "\"0x00000000deadbeef\"");
        assert_eq!(
            serde_json::from_str::<Hex>(&text).unwrap(),
            Hex(0xdead_beef)
        );
        for bad in [
            "\"deadbeef\"",
            "\"0x12\"",
            "\"0x+000000000000001\"",
            "12",
            "\"0x00000000DEADBEEF\"",
        ] {
            assert!(serde_json::from_str::<Hex>(bad).is_err(), "{bad}");
        }
    }

    #[test]
    fn rewards_need_every_component_and_no_other() {
        let rewards = Rewards(std::array::from_fn(|k| k as f64 / 3.0));
        let text = serde_json::to_string(&rewards).unwrap();
        assert_eq!(serde_json::from_str::<Rewards>(&text).unwrap(), rewards);
        assert!(serde_json::from_str::<Rewards>(&text.replace("detect", "find")).is_err());
        assert!(serde_json::from_str::<Rewards>("{}").is_err());
    }
}
