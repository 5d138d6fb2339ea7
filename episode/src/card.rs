//! Trained policies on disk: a folder with weights (`policy.safetensors`) and a card
//! (`policy.json`).

use core::fmt;
use std::path::{Path, PathBuf};

use jcas_core::{Config, Model, Printable, TargetVisibility};
use jcas_policy::head::{Head, Mode};
use jcas_policy::network::{ActOptions, FlyError};
use jcas_policy::{Trained, action_of};
use jcas_simd::InstructionSet;
use serde::{Deserialize, Serialize};
use serde_json::Value;

use crate::files;

/// File of the weights in a policy's folder.
pub const WEIGHTS: &str = "policy.safetensors";
/// File of the card in a policy's folder.
pub const CARD: &str = "policy.json";
/// Version of the card that is written and read.
pub const FORMAT: u32 = 1;
/// Seed of the campaign in which all policies and baselines are compared.
pub const EVALUATION_SEED: u64 = 1;

/// Description of a trained policy: its network, its origin and its results.
///
/// Other trainers (`jcas.rllib`) write cards as well, with fields of their own, which are ignored.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Card {
    /// Version of the card, [`FORMAT`].
    pub format: u32,
    /// Name in reports.
    pub name: String,
    /// Action head.
    pub head: Head,
    /// Network of the actor, as its trainer describes it. Running the policy reads the shapes from
    /// the weights.
    pub architecture: Value,
    /// Whether observations are normalised by stored statistics.
    pub normalised_inputs: bool,
    /// Pilot density that overrides the network's; `None`: the network chooses.
    pub constant_pilot_density: Option<f64>,
    /// Mode in which the policy should act.
    pub mode: Mode,
    /// Numbers of UAVs and hotspots of its training: (N, n).
    pub trained_on: Vec<(u32, u32)>,
    /// The first configuration of its training.
    pub config: Config,
    /// Hash of that configuration.
    pub config_hash: String,
    /// Settings of the training run, as its trainer wrote them.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub settings: Option<Value>,
    /// Environment steps of its training.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub environment_steps: Option<u64>,
    /// Results of evaluations after training.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub evaluations: Vec<Evaluation>,
}

/// Means over a campaign of episodes with fixed seeds.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Evaluation {
    /// Number of UAVs.
    pub uav_count: u32,
    /// Number of hotspots.
    pub hotspot_count: u32,
    /// The mode in which actions were taken from the network's outputs.
    pub mode: Mode,
    /// Number of episodes.
    pub episodes: u64,
    /// Seed of the campaign.
    pub seed: u64,
    /// Fraction of the episodes that succeeded, 0 to 1.
    pub success_rate: f64,
    /// Mean number of steps; a failed episode counts its horizon.
    pub mission_steps_mean: f64,
    /// Mean energy of the fleet, kWh.
    pub energy_kwh_mean: f64,
    /// Mean normalised throughput.
    pub throughput_mean: f64,
}

/// The reason why a trained policy cannot be read or run.
#[derive(Debug)]
pub enum CardError {
    /// A file could not be read.
    File(PathBuf, std::io::Error),
    /// A file has invalid content.
    Format(PathBuf, String),
    /// The policy does not fit the configuration.
    Fit(String),
}

impl fmt::Display for CardError {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::File(path, error) => write!(out, "{}: {error}", Printable(path.display())),
            Self::Format(path, what) => {
                write!(out, "{}: {}", Printable(path.display()), Printable(what))
            }
            Self::Fit(what) => Printable(what).fmt(out),
        }
    }
}

impl std::error::Error for CardError {}

/// A trained policy with its card, read from a folder.
#[derive(Clone)]
pub struct StoredPolicy {
    /// Its card.
    pub card: Card,
    trained: Trained,
    /// The action u_pilot in [−1, 1] that overrides the network's.
    pilot: Option<f32>,
}

/// Reads the card of a policy's folder.
///
/// # Errors
/// [`CardError::File`] or [`CardError::Format`].
pub fn load_card(folder: &Path) -> Result<Card, CardError> {
    let path = folder.join(CARD);
    let text = files::read_text(&path, files::TEXT_BYTES_MAX)
        .map_err(|error| CardError::File(path.clone(), error))?;
    let card: Card = serde_json::from_str(&text)
        .map_err(|error| CardError::Format(path.clone(), error.to_string()))?;
    if card.format != FORMAT {
        let what = format!(
            "format: {} is not read by this version, only {FORMAT}",
            card.format
        );
        return Err(CardError::Format(path, what));
    }
    Ok(card)
}

/// Reads the card and the weights of a policy's folder.
///
/// # Errors
/// [`CardError::File`] or [`CardError::Format`].
pub fn load(folder: &Path) -> Result<StoredPolicy, CardError> {
    let card = load_card(folder)?;
    let path = folder.join(WEIGHTS);
    let bytes = files::read(&path, files::WEIGHTS_BYTES_MAX)
        .map_err(|error| CardError::File(path.clone(), error))?;
    let trained = Trained::read(&card.name, &bytes)
        .map_err(|error| CardError::Format(path, error.to_string()))?
        .with_matmul(InstructionSet::best().matmul());
    let pilot = card
        .constant_pilot_density
        .map(|density| action_of(&card.config, density));
    Ok(StoredPolicy {
        card,
        trained,
        pilot,
    })
}

impl StoredPolicy {
    /// Returns the same policy with its action u_pilot fixed at a value in [−1, 1].
    #[must_use]
    pub fn holding(self, pilot: f32) -> Self {
        Self {
            pilot: Some(pilot),
            ..self
        }
    }

    /// Refuses a model whose observations the network cannot read.
    ///
    /// # Errors
    /// [`CardError::Fit`] names the policy, both sizes, and the fields that determine the sizes.
    pub fn check(&self, model: &Model<'_>) -> Result<(), CardError> {
        let (own, config) = (&self.card.config, model.config());
        let unfit =
            |what: String| Err(CardError::Fit(format!("policy {}: {what}", self.card.name)));
        if own.target_visibility != config.target_visibility {
            return unfit(format!(
                "trained with target_visibility = {}, this configuration has {}",
                visibility(own.target_visibility),
                visibility(config.target_visibility),
            ));
        }
        match self.trained.check(model) {
            Ok(()) => Ok(()),
            Err(error @ FlyError::Observation { .. }) => unfit(format!(
                "{error}; trained with {}, this configuration has {}",
                observed(own),
                observed(config)
            )),
            Err(error) => unfit(error.to_string()),
        }
    }

    /// Returns the policy ready to act in a mode, by default the card's.
    #[must_use]
    pub fn policy(&self, mode: Option<Mode>) -> Trained {
        self.trained.clone().with_act_options(ActOptions {
            mode: mode.unwrap_or(self.card.mode),
            pilot: self.pilot,
        })
    }
}

/// The fields that determine the size of an observation, with their values.
fn observed(config: &Config) -> String {
    const FIELDS: [&str; 9] = [
        "uav_count",
        "hotspot_count",
        "neighbour_slots",
        "search_maps",
        "map_window_radius",
        "map_directions",
        "uav_tag",
        "report_levels",
        "report_slots",
    ];
    let values = config.values();
    let fields = Config::FIELDS.iter().zip(values.iter());
    let named = fields.filter(|(info, _)| FIELDS.contains(&info.name));
    let texts: Vec<String> = named
        .map(|(info, value)| format!("{} = {value}", info.name))
        .collect();
    texts.join(", ")
}

fn visibility(visibility: TargetVisibility) -> &'static str {
    match visibility {
        TargetVisibility::Known => "known",
        TargetVisibility::Hidden => "hidden",
    }
}
