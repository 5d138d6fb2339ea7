//! Policies on disk: a folder with weights (safetensors), a card (JSON) and the ONNX graph.

use super::onnx;
use super::{Actor, Mode, shape_of};
use crate::environment::Shape;
use crate::error::TrainError;
use crate::head::Head;
use crate::network::{Architecture, Network, set};
use crate::ppo::normalise::Affine;
use crate::settings::Settings;
use crate::store::{Array, Arrays, encode, write_whole};
use jcas_core::{Config, Model, TargetVisibility, UavTag};
use jcas_evaluate::policy::Trained;
use jcas_evaluate::policy::action_of;
use jcas_evaluate::policy::strata::{FLEETS_MAX, FleetStarts, Starts};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Arc;

/// Weights.
pub const WEIGHTS: &str = "policy.safetensors";
/// What they are.
pub const CARD: &str = "policy.json";
/// The same function for other runtimes.
pub const ONNX: &str = "policy.onnx";

const FORMAT: u32 = 1;

/// What a policy is, where it comes from and how it did. Other trainers (`jcas.rllib`) write cards as
/// well, without what they do not know and with more of their own.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Card {
    /// Version of this card.
    pub format: u32,
    /// Name in reports.
    pub name: String,
    /// Action head.
    pub head: Head,
    /// Network of the actor.
    pub architecture: Architecture,
    /// Whether observations are normalised by stored statistics.
    pub normalised_inputs: bool,
    /// Pilot density held, whatever the network says; absent: it chooses.
    pub constant_pilot_density: Option<f64>,
    /// How it should be flown.
    pub mode: Mode,
    /// How fleets begin that are flown stratified, by N: a number for each phase of a mission; absent: all 0.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub starts: BTreeMap<u32, Starts>,
    /// Fleets and hotspots it was trained on: (N, n).
    pub trained_on: Vec<(u32, u32)>,
    /// The first configuration it was trained on.
    pub config: Config,
    /// Its hash.
    pub config_hash: String,
    /// Settings of the training run, where `jcas train` made it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub settings: Option<Settings>,
    /// Environment steps it was trained for.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub environment_steps: Option<u64>,
    /// Evaluations after training.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub evaluations: Vec<Evaluation>,
}

/// Missions flown with fixed seeds.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Evaluation {
    /// UAVs.
    pub uav_count: u32,
    /// Hotspots.
    pub hotspot_count: u32,
    /// How actions followed from the network.
    pub mode: Mode,
    /// Missions.
    pub episodes: u64,
    /// Seed of the campaign.
    pub seed: u64,
    /// Share that succeeded.
    pub success_rate: f64,
    /// Steps; a mission that failed counts its horizon.
    pub mission_steps_mean: f64,
    /// Energy of the fleet.
    pub energy_kwh_mean: f64,
    /// Normalised throughput.
    pub throughput_mean: f64,
}

/// Width of the stored numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Precision {
    /// As trained.
    Single,
    /// Half the size, for shipping.
    Half,
}

/// Writes weights, card and ONNX graph. Equal policies give equal bytes.
pub fn save(
    folder: &Path,
    actor: &Actor,
    card: &Card,
    shape: &Shape,
    precision: Precision,
) -> Result<(), TrainError> {
    std::fs::create_dir_all(folder).map_err(TrainError::file(folder))?;
    let path = folder.join(WEIGHTS);
    let bytes = weights(actor, precision, &note(card)).map_err(TrainError::format(&path))?;
    write_whole(&path, &bytes)?;
    // The graph gives what the stored weights give, which half precision has rounded.
    let stored = read_actor(&bytes, card).map_err(TrainError::format(&path))?;
    write_whole(&folder.join(ONNX), &onnx::encode(&stored, shape))?;
    let text = serde_json::to_string_pretty(card).map_err(TrainError::format(&path))?;
    write_whole(&folder.join(CARD), (text + "\n").as_bytes())
}

/// A policy's arrays as safetensors, with what else a host without the card has to know.
pub(super) fn weights(actor: &Actor, precision: Precision, note: &str) -> Result<Vec<u8>, String> {
    let array = match precision {
        Precision::Single => Array::f32,
        Precision::Half => Array::f16,
    };
    let blocks = actor.network.blocks.iter();
    let mut arrays: Vec<Array> = blocks
        .map(|block| {
            let values = &actor.parameters[block.offset..block.offset + block.len()];
            array(&block.name, &[block.rows, block.columns], values)
        })
        .collect();
    let inputs = &actor.inputs;
    if !inputs.offset.is_empty() {
        let fields = [inputs.offset.len()];
        arrays.push(Array::f32("inputs.offset", &fields, &inputs.offset));
        arrays.push(Array::f32("inputs.scale", &fields, &inputs.scale));
    }
    encode(&arrays, note)
}

/// How a policy is flown, for hosts that read its weights without the card.
fn note(card: &Card) -> String {
    let mode = match card.mode {
        Mode::Deterministic => "deterministic",
        Mode::Sampled => "sampled",
        Mode::Stratified => "stratified",
    };
    let visibility = visibility(card.config.target_visibility);
    let pilot = card.constant_pilot_density;
    let pilot = pilot.map_or(String::new(), |density| format!(" pilot_density={density}"));
    let starts: Vec<String> = card
        .starts
        .iter()
        .map(|(uavs, starts)| {
            let starts = starts.map(|start| start.to_string());
            format!("{uavs}:{}", starts.join(":"))
        })
        .collect();
    let starts = match starts.len() {
        0 => String::new(),
        _ => format!(" starts={}", starts.join(",")),
    };
    let read = read_besides(&card.architecture);
    format!("mode={mode} target_visibility={visibility}{pilot}{starts}{read}")
}

/// What a network reads that no observation shows, as a part of the note.
pub(super) fn read_besides(architecture: &Architecture) -> &'static str {
    match architecture {
        Architecture::SetActor {
            fleet_size: true, ..
        } => " fleet_size=read",
        _ => "",
    }
}

/// A card with the constructor arguments that its reader does not choose.
impl Card {
    /// Current format.
    pub fn format() -> u32 {
        FORMAT
    }
}

/// A policy read from a folder.
#[derive(Clone, Debug)]
pub struct Stored {
    /// What it is.
    pub card: Card,
    /// What it computes.
    pub actor: Arc<Actor>,
}

fn read_actor(bytes: &[u8], card: &Card) -> Result<Actor, String> {
    let network = Network::new(card.architecture.clone());
    let arrays = Arrays::decode(bytes)?;
    let mut parameters = Vec::with_capacity(network.parameters());
    for block in &network.blocks {
        parameters.extend(arrays.f32(&block.name, block.len())?);
    }
    let inputs = match (&card.architecture, card.normalised_inputs) {
        (Architecture::Mlp { sizes }, true) => Affine {
            offset: arrays.f32("inputs.offset", sizes[0])?,
            scale: arrays.f32("inputs.scale", sizes[0])?,
        },
        (_, true) => return Err("normalised_inputs: only an MLP has input statistics".to_owned()),
        (_, false) => Affine::default(),
    };
    let constant_pilot = card
        .constant_pilot_density
        .map(|density| action_of(&card.config, density));
    let starts = card.starts.iter().map(|(&uavs, &starts)| (uavs, starts));
    let starts = FleetStarts::new(starts).ok_or_else(|| {
        format!(
            "starts: of {} sizes of fleets, at most {FLEETS_MAX} are read",
            card.starts.len()
        )
    })?;
    Ok(Actor {
        network,
        parameters,
        head: card.head,
        inputs,
        constant_pilot,
        starts,
    })
}

/// Reads weights and card.
pub fn load(folder: &Path) -> Result<Stored, TrainError> {
    let path = folder.join(CARD);
    let text = std::fs::read_to_string(&path).map_err(TrainError::file(&path))?;
    let card: Card = serde_json::from_str(&text).map_err(TrainError::format(&path))?;
    if card.format != FORMAT {
        let what = format!(
            "format: {} is not read by this version, only {FORMAT}",
            card.format
        );
        return Err(TrainError::Format(path, what));
    }
    let path = folder.join(WEIGHTS);
    let bytes = std::fs::read(&path).map_err(TrainError::file(&path))?;
    let actor = read_actor(&bytes, &card).map_err(TrainError::format(&path))?;
    Ok(Stored {
        card,
        actor: Arc::new(actor),
    })
}

impl Stored {
    /// The same with its pilot action held, whatever its outputs say.
    #[must_use]
    pub fn holding(mut self, pilot: f32) -> Stored {
        Arc::make_mut(&mut self.actor).constant_pilot = Some(pilot);
        self
    }

    /// Refuses a mission whose observations the network cannot read, saying which and why.
    pub fn check(&self, model: &Model<'_>) -> Result<(), TrainError> {
        let config = model.config();
        // A set network that reads a tag where the mission shows none numbers the UAVs itself.
        let shown = set::added(&shape_of(model));
        let untagged = config.uav_tag == UavTag::Off;
        match &self.card.architecture {
            Architecture::Mlp { sizes } if sizes[0] != model.observation_len() => {
                Err(TrainError::Fit(format!(
                    "policy {}: reads {} observation fields ({}), this mission has {} \
                     (uav_count = {}, hotspot_count = {}, neighbour_slots = {})",
                    self.card.name,
                    sizes[0],
                    describe(&self.card.config),
                    model.observation_len(),
                    config.uav_count,
                    config.hotspot_count,
                    model.neighbour_slots(),
                )))
            }
            Architecture::SetActor { added, .. }
                if *added != shown && !(untagged && *added == shown + 1) =>
            {
                Err(TrainError::Fit(format!(
                    "policy {}: reads {added} fields of search map, directions and tag, this mission \
                     shows {shown} (map_window_radius, map_directions, uav_tag)",
                    self.card.name,
                )))
            }
            _ if self.card.config.target_visibility != config.target_visibility => {
                Err(TrainError::Fit(format!(
                    "policy {}: trained with target_visibility = {}, this mission has {}",
                    self.card.name,
                    visibility(self.card.config.target_visibility),
                    visibility(config.target_visibility),
                )))
            }
            _ => Ok(()),
        }
    }

    /// Ready to fly; `mode` absent: as the card says.
    pub fn policy(&self, mode: Option<Mode>) -> Trained {
        self.actor
            .fly(&self.card.name, mode.unwrap_or(self.card.mode))
    }
}

fn describe(config: &Config) -> String {
    format!(
        "uav_count = {}, hotspot_count = {}",
        config.uav_count, config.hotspot_count
    )
}

fn visibility(visibility: TargetVisibility) -> &'static str {
    match visibility {
        TargetVisibility::Known => "known",
        TargetVisibility::Hidden => "hidden",
    }
}
