//! A trained actor as a policy: inference and files.

pub mod files;

use crate::environment::Shape;
use crate::network::Network;
use crate::ppo::normalise::Affine;
use files::Precision;
use jcas_core::Model;
use jcas_policy::Trained;
use jcas_policy::head::{Head, Mode};
use jcas_policy::network::ActOptions;
use jcas_policy::network::reach::reach_cells;
use jcas_simd::InstructionSet;

/// An actor: a network with its weights, head and scaling of inputs.
#[derive(Clone, Debug, PartialEq)]
pub struct Actor {
    /// Its network.
    pub network: Network,
    /// Its weights.
    pub parameters: Vec<f32>,
    /// Action head, the distribution of its outputs.
    pub head: Head,
    /// Normalisation of observations.
    pub inputs: Affine,
    /// The action u_pilot that overrides the network's.
    pub constant_pilot: Option<f32>,
}

impl Actor {
    /// Builds the policy for the inference that every host uses; `name` is its name in reports.
    #[must_use]
    pub fn fly(&self, name: &str, mode: Mode) -> Trained {
        let note = files::read_besides(&self.network.architecture);
        let bytes = files::weights(self, Precision::Single, note.trim_start())
            .expect("arrays of their own length");
        let trained = Trained::read(name, &bytes).expect("an actor's own file");
        let trained = trained.with_matmul(InstructionSet::best().matmul());
        trained.with_act_options(self.act_options(mode))
    }

    /// The acting mode with the actor's held pilot action.
    #[must_use]
    pub fn act_options(&self, mode: Mode) -> ActOptions {
        ActOptions {
            mode,
            pilot: self.constant_pilot,
        }
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
        reach: reach_cells(model),
        motion_map: config.motion_map,
    }
}
