//! A trained actor as a policy that flies missions, reads files and is read by others.

pub mod files;
pub mod onnx;

use crate::environment::Shape;
use crate::network::Network;
use crate::ppo::normalise::Affine;
use files::Precision;
use jcas_core::Model;
use jcas_policy::Trained;
use jcas_policy::head::{Head, Mode};
use jcas_policy::network::Flight;
use jcas_policy::strata::FleetStarts;
use jcas_simd::InstructionSet;

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
    /// The action u_pilot that overrides the network's.
    pub constant_pilot: Option<f32>,
}

impl Actor {
    /// Ready to fly, by the code that every host flies stored policies with; reports call it
    /// `name`.
    #[must_use]
    pub fn fly(&self, name: &str, mode: Mode) -> Trained {
        let note = files::read_besides(&self.network.architecture).trim_start();
        let bytes =
            files::weights(self, Precision::Single, note).expect("arrays of their own length");
        let trained = Trained::read(name, &bytes).expect("an actor's own file");
        let trained = trained.with_product(InstructionSet::best().product());
        trained.with_flight(self.flight(mode))
    }

    /// How it is flown in this mode.
    #[must_use]
    pub fn flight(&self, mode: Mode) -> Flight {
        Flight {
            mode,
            pilot: self.constant_pilot,
            starts: FleetStarts::default(),
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
        survey_len: 0,
        hotspots: model.hotspot_count(),
        neighbour_slots: model.neighbour_slots(),
        grid: [config.grid_width, config.grid_height],
    }
}
