//! A trained actor as a policy that flies missions, reads files and is read by others.

pub mod files;
pub mod onnx;

use crate::environment::Shape;
use crate::head::Head;
use crate::network::{Network, values};
use crate::ppo::normalise::Affine;
use crate::random::stream;
use burn_tensor::{Device, Tensor};
use jcas_core::{Model, StateRef};
use rand_chacha::ChaCha8Rng;
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

/// An actor flying one mission at a time, every UAV from its own observation.
pub struct LearnedPolicy {
    name: String,
    actor: Arc<Actor>,
    mode: Mode,
    weights: Vec<Tensor<2>>,
    observations: Vec<f32>,
    random: ChaCha8Rng,
}

impl LearnedPolicy {
    /// Ready to fly; reports call it `name`.
    pub fn new(name: &str, actor: Arc<Actor>, mode: Mode) -> LearnedPolicy {
        let device = Device::flex();
        LearnedPolicy {
            name: name.to_owned(),
            weights: actor.network.tensors(&actor.parameters, &device),
            actor,
            mode,
            observations: Vec::new(),
            random: stream(0, 0),
        }
    }

    /// Actor outputs, one row for each UAV.
    pub fn outputs(&mut self, shape: &Shape, observations: &[f32]) -> Vec<f32> {
        let mut inputs = observations.to_vec();
        self.actor.inputs.apply(&mut inputs);
        values(self.actor.network.forward(&self.weights, inputs, shape))
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

    fn reset(&mut self, _model: &Model<'_>, seed: u64) {
        self.random = stream(seed, 0);
    }

    fn reads_observations(&self) -> bool {
        true
    }

    fn see(&mut self, observations: &[f32]) {
        self.observations.clear();
        self.observations.extend_from_slice(observations);
    }

    fn act(&mut self, model: &Model<'_>, _state: &StateRef<'_>, actions: &mut [f32]) {
        let observations = std::mem::take(&mut self.observations);
        let outputs = self.outputs(&shape_of(model), &observations);
        self.observations = observations;
        let head = self.actor.head;
        let rows = outputs.chunks_exact(head.output_len());
        for (action, row) in actions.chunks_exact_mut(2).zip(rows) {
            let raw = match self.mode {
                Mode::Deterministic => head.deterministic(row),
                Mode::Sampled => head.sample(row, &mut self.random).0,
            };
            action.copy_from_slice(&head.action(raw));
            if let Some(pilot) = self.actor.constant_pilot {
                action[1] = pilot;
            }
        }
    }
}
