//! A trained actor as a policy that flies missions, reads files and is read by others.

pub mod files;
pub mod onnx;

use crate::environment::Shape;
use crate::head::Head;
use crate::network::Network;
use crate::ppo::normalise::Affine;
use files::Precision;
use jcas_core::{Model, StateRef};
use jcas_evaluate::policy::network::{self as inference, Flight};
use std::sync::Arc;

/// How actions follow from the actor's distribution.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Mode {
    /// The most likely motion and the mean pilot density.
    Deterministic,
    /// A draw; which draw follows from the mission's seed.
    Sampled,
}

impl From<Mode> for jcas_evaluate::policy::head::Mode {
    fn from(mode: Mode) -> Self {
        match mode {
            Mode::Deterministic => Self::Deterministic,
            Mode::Sampled => Self::Sampled,
        }
    }
}

/// What an actor computes, apart from how it is used.
#[derive(Clone, Debug, PartialEq)]
pub struct Actor {
    /// Its network.
    pub network: Network,
    /// Its weights.
    pub parameters: Vec<f32>,
    /// Which distribution its outputs describe.
    pub head: Head,
    /// Normalisation of observations.
    pub inputs: Affine,
    /// Pilot action held, whatever the outputs say.
    pub constant_pilot: Option<f32>,
}

/// An actor flying one mission at a time, every UAV from its own observation, by the code that every host
/// flies stored policies with.
pub struct LearnedPolicy {
    name: String,
    network: inference::Network,
    weights: Arc<[f32]>,
    flight: Flight,
    observations: Vec<f32>,
    scratch: Vec<f32>,
}

impl LearnedPolicy {
    /// Ready to fly; reports call it `name`.
    pub fn new(name: &str, actor: &Actor, mode: Mode) -> LearnedPolicy {
        let bytes =
            files::weights(actor, Precision::Single, "").expect("arrays of their own length");
        let layout = inference::Network::read(&bytes).expect("an actor's own file");
        let mut weights = vec![0.0; layout.weights_len()];
        let network = inference::Network::load(&bytes, &mut weights).expect("finite weights");
        LearnedPolicy {
            name: name.to_owned(),
            network,
            weights: weights.into(),
            flight: Flight {
                mode: mode.into(),
                pilot: actor.constant_pilot,
            },
            observations: Vec::new(),
            scratch: Vec::new(),
        }
    }

    /// Actor outputs, one row for each observation of missions of this model.
    pub fn outputs(&mut self, model: &Model<'_>, observations: &[f32]) -> Vec<f32> {
        let rows = observations.len() / model.observation_len();
        let mut outputs = vec![0.0; rows * self.network.head().outputs()];
        self.scratch.resize(self.network.scratch_len(model), 0.0);
        self.network
            .outputs(
                &self.weights,
                model,
                observations,
                &mut self.scratch,
                &mut outputs,
            )
            .expect("a mission that the actor fits");
        outputs
    }
}

/// Sizes of one mission of a model.
pub fn shape_of(model: &Model<'_>) -> Shape {
    let config = model.config();
    Shape {
        environments: 1,
        agents: model.uav_count(),
        observation_len: model.observation_len(),
        global_len: model.global_len(),
        hotspots: model.hotspot_count(),
        neighbour_slots: model.neighbour_slots(),
        grid: [config.grid_width, config.grid_height],
    }
}

impl jcas_evaluate::policy::Policy for LearnedPolicy {
    fn name(&self) -> &str {
        &self.name
    }

    fn reads_observations(&self) -> bool {
        true
    }

    fn see(&mut self, observations: &[f32]) {
        self.observations.clear();
        self.observations.extend_from_slice(observations);
    }

    fn act(&mut self, model: &Model<'_>, state: &StateRef<'_>, actions: &mut [f32]) {
        self.scratch.resize(self.network.scratch_len(model), 0.0);
        self.network
            .act(
                &self.weights,
                self.flight,
                model,
                state,
                &self.observations,
                &mut self.scratch,
                actions,
            )
            .expect("a mission that the actor fits");
    }
}
