//! Inference of trained networks in memory of the caller, with the same bits on every platform.
//!
//! A [`Network`] is laid out from the bytes of a safetensors file. Its weights take a slice of
//! [`Network::weights_len`] numbers. A call takes working memory of [`Network::scratch_len`]
//! numbers. Two families differ by the names of their arrays:
//!
//! - An MLP has `0.weight` (inputs × outputs), `0.bias`, `1.weight`, and so on. If its inputs are
//!   normalised, it also has `inputs.offset` and `inputs.scale`.
//! - A set network takes any number of hotspots and neighbours. It has `neighbour.0`,
//!   `neighbour.1`, `hotspot.0`, `hotspot.own`, `hotspot.1`, `hotspot.2`, `hotspot.others`,
//!   `score`, `trunk.0`, and so on.
//!
//! The shapes give the widths, and the number of fields of an observation that are the UAV's own.
//! Weights are f32 or f16. The outputs of the last layer decide the action head. A file that does
//! not fit is refused, with the name of the array.
//!
//! Sums are taken in the order of the inputs. No product is fused with a sum, and exponentials come
//! from the pinned libm.
//!
//! ```
//! use jcas_core::{Config, Model, Preset, Sim};
//! use jcas_policy::head::Mode;
//! use jcas_policy::network::{ActOptions, Network};
//!
//! let bytes = std::fs::read("../policies/paper/policy.safetensors")?;
//! let mut weights = vec![0.0; Network::read(&bytes)?.weights_len()];
//! let network = Network::load(&bytes, &mut weights)?;
//!
//! let model = Model::new(Config::preset(Preset::Paper))?;
//! let mut sim = Sim::new(&model);
//! sim.reset(1);
//! let mut observations = vec![0.0; model.uav_count() * model.observation_len()];
//! sim.observe(&mut observations)?;
//! let mut scratch = vec![0.0; network.scratch_len(&model)];
//! let mut actions = vec![0.0; model.action_len()];
//! let options = ActOptions { mode: Mode::Sampled, pilot: None };
//! let state = sim.state();
//! network.act(&weights, options, &model, &state, &observations, &mut scratch, &mut actions)?;
//! sim.step(&actions)?;
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

pub mod choices;
mod dense;
mod error;
pub mod features;
mod file;
mod layout;
mod matmul;
mod metadata;
mod mlp;
pub mod reach;
pub mod row;
mod set;
mod way_back;

#[cfg(any(kani, test))]
pub(crate) use dense::Layer;
#[cfg(any(kani, test))]
pub(crate) use file::{HEADER_MAX, place, split, with_digit};

pub use error::{ArrayName, FlyError, LoadError};
pub use layout::DEPTH_MAX;
pub use matmul::{MatmulArgs, MatmulKernel};
pub use metadata::PolicyMetadata;

use jcas_core::{Config, Model, Motion, StateRef, UavTag};

use crate::charge::stays_to_charge;
use crate::head::{Draw, Head, Mode};
use choices::read_choices;
use dense::padded;
use file::File;
use layout::Kind;
use row::{HOTSPOT_FIELDS, RowLayout, SLOT_FIELDS};
use set::Sizes;
use way_back::turns_round;

/// Numbers (f32) in a cache line. Weights are read fastest where they begin at one.
pub const LINE_LEN: usize = 16;

/// Returns the index of the first number in `memory` that begins a cache line. It is less than
/// [`LINE_LEN`].
#[must_use]
pub fn line_offset(memory: &[f32]) -> usize {
    let offset = memory.as_ptr().align_offset(LINE_LEN * size_of::<f32>());
    offset.min(LINE_LEN - 1)
}

/// The layout of a network. The caller holds the weights.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Network {
    kind: Kind,
    head: Head,
    weights_len: usize,
    metadata: PolicyMetadata,
    matmul: MatmulKernel,
}

/// The options of [`Network::act`]: the acting mode and the pilot density.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ActOptions {
    /// The acting mode: it decides how actions follow from the distribution.
    pub mode: Mode,
    /// The action u_pilot that overrides that of the network, in [-1, 1]. `None` keeps that of the
    /// network.
    pub pilot: Option<f32>,
}

/// Returns the sizes of a model's observations, and of the inputs that a policy reads besides.
fn sizes(model: &Model<'_>, metadata: PolicyMetadata) -> Sizes {
    Sizes {
        row: RowLayout::of(model),
        uavs: model.uav_count(),
        fleet_size: metadata.fleet_size,
        reach: metadata.choices.then(|| reach::reach_cells(model)),
    }
}

fn length(what: &'static str, expected: usize, got: usize) -> Result<(), FlyError> {
    if got == expected {
        Ok(())
    } else {
        Err(FlyError::Length {
            what,
            expected,
            got,
        })
    }
}

impl Network {
    /// Lays out the network in the bytes of a safetensors file and checks its weights, without
    /// storing them.
    ///
    /// # Errors
    /// [`LoadError`] if the bytes are not such a file, or if its arrays form no known network.
    /// [`LoadError::Value`] if a weight is not finite.
    pub fn read(bytes: &[u8]) -> Result<Self, LoadError> {
        Self::read_into(bytes, None)
    }

    /// Reads like [`Network::read`], and stores the weights in [`Network::weights_len`] numbers.
    ///
    /// # Errors
    /// The errors of [`Network::read`]. [`LoadError::Memory`] if `weights` has another length.
    pub fn load(bytes: &[u8], weights: &mut [f32]) -> Result<Self, LoadError> {
        Self::read_into(bytes, Some(weights))
    }

    fn read_into(bytes: &[u8], weights: Option<&mut [f32]>) -> Result<Self, LoadError> {
        let file = File::open(bytes)?;
        let metadata = PolicyMetadata::read(file.metadata)?;
        let (kind, head, weights_len) = layout::read(file, metadata.choices, weights)?;
        let reads_size = matches!(&kind, Kind::Set(set) if set.own_fields() > 0);
        if metadata.fleet_size && !reads_size {
            return Err(LoadError::Metadata(
                "fleet_size: only a set network reads it",
            ));
        }
        if metadata.choices && !matches!(&kind, Kind::Set(_)) {
            return Err(LoadError::Metadata(
                "choices: only a set network reads them",
            ));
        }
        Ok(Self {
            kind,
            head,
            weights_len,
            metadata,
            matmul: MatmulKernel::default(),
        })
    }

    /// Replaces the compilation of the innermost loops. The results stay the same.
    #[must_use]
    pub const fn with_matmul(self, matmul: MatmulKernel) -> Self {
        Self { matmul, ..self }
    }

    /// The length of the weights, in numbers.
    #[must_use]
    pub const fn weights_len(&self) -> usize {
        self.weights_len
    }

    /// The action head: the distribution that the outputs describe.
    #[must_use]
    pub const fn head(&self) -> Head {
        self.head
    }

    /// The metadata of the file about how the policy acts.
    #[must_use]
    pub const fn metadata(&self) -> PolicyMetadata {
        self.metadata
    }

    /// The way of acting that the file states, for this configuration.
    #[must_use]
    pub fn act_options(&self, config: &Config) -> ActOptions {
        ActOptions {
            mode: self.metadata.mode,
            pilot: self
                .metadata
                .pilot_density
                .map(|density| crate::action_of(config, density)),
        }
    }

    /// The length of the working memory of [`Network::act`] and [`Network::outputs`] for this
    /// model, in numbers.
    #[must_use]
    pub fn scratch_len(&self, model: &Model<'_>) -> usize {
        self.row_len(model)
            + match &self.kind {
                Kind::Mlp(mlp) => mlp.scratch_len(),
                Kind::Set(set) => set.scratch_len(model.hotspot_count()),
            }
    }

    /// The length of the row that choices are added to.
    fn row_len(&self, model: &Model<'_>) -> usize {
        if self.metadata.choices {
            model.observation_len()
        } else {
            0
        }
    }

    /// Refuses a model with observations that the network cannot read.
    ///
    /// # Errors
    /// [`FlyError::Observation`] if the number of fields differs. [`FlyError::Visibility`] if the
    /// policy was trained with the other visibility.
    pub fn check(&self, model: &Model<'_>) -> Result<(), FlyError> {
        let sizes = sizes(model, self.metadata);
        let of_sets = HOTSPOT_FIELDS * sizes.row.hotspots + SLOT_FIELDS * sizes.row.slots;
        let (expected, got) = match &self.kind {
            Kind::Mlp(mlp) => (mlp.stack.inputs(), sizes.row.observation_len),
            Kind::Set(set) => (
                // The fleet size is no part of an observation, so it does not count.
                set.own_fields() - usize::from(sizes.fleet_size),
                sizes.row.observation_len.saturating_sub(of_sets),
            ),
        };
        // A set network that reads a tag numbers the UAVs itself if observations have none.
        let numbers = matches!(self.kind, Kind::Set(_)) && model.config().uav_tag == UavTag::Off;
        if expected != got && !(numbers && expected == got + 1) {
            return Err(FlyError::Observation { expected, got });
        }
        match self.metadata.target_visibility {
            Some(visibility) if visibility != model.config().target_visibility => {
                Err(FlyError::Visibility)
            }
            _ => Ok(()),
        }
    }

    /// Refuses a model, weights or working memory that the network cannot work with.
    fn check_all(
        &self,
        weights: &[f32],
        model: &Model<'_>,
        scratch: &[f32],
    ) -> Result<(), FlyError> {
        self.check(model)?;
        length("weights", self.weights_len, weights.len())?;
        length("working memory", self.scratch_len(model), scratch.len())
    }

    /// Visits the outputs for observations, the first of which has the index `row`.
    fn visit(
        &self,
        weights: &[f32],
        sizes: Sizes,
        observations: &[f32],
        mut row: usize,
        scratch: &mut [f32],
        mut visit: impl FnMut(usize, &[f32]) -> Result<(), FlyError>,
    ) -> Result<(), FlyError> {
        for observations in observations.chunks(mlp::ROWS * sizes.row.observation_len) {
            let outputs = match &self.kind {
                Kind::Mlp(mlp) => mlp.outputs(self.matmul, weights, observations, scratch),
                Kind::Set(set) => {
                    set.outputs(self.matmul, weights, observations, row, sizes, scratch)
                }
            };
            for outputs in outputs.chunks_exact(padded(self.head.outputs())) {
                visit(row, &outputs[..self.head.outputs()])?;
                row += 1;
            }
        }
        Ok(())
    }

    /// Computes the network's outputs for any number of observations. `out` takes one row of
    /// [`Head::outputs`] numbers for each.
    ///
    /// # Errors
    /// [`FlyError`] if the model or the length of a buffer does not fit.
    pub fn outputs(
        &self,
        weights: &[f32],
        model: &Model<'_>,
        observations: &[f32],
        scratch: &mut [f32],
        out: &mut [f32],
    ) -> Result<(), FlyError> {
        let (len, count) = (model.observation_len(), self.head.outputs());
        let rows = observations.len() / len;
        length("observations", rows * len, observations.len())?;
        length("outputs", rows * count, out.len())?;
        self.check_all(weights, model, scratch)?;
        let sizes = sizes(model, self.metadata);
        let scratch = &mut scratch[self.row_len(model)..];
        self.visit(weights, sizes, observations, 0, scratch, |row, outputs| {
            out[row * count..][..count].copy_from_slice(outputs);
            Ok(())
        })
    }

    /// Writes (u_dir, u_pilot) of each UAV into `actions`. `observations` holds what the UAVs
    /// observe in `state`, one row for each. Draws are a function of the seed and step of the
    /// state.
    ///
    /// With [`PolicyMetadata::choices`] the UAVs choose in the order of their indices. In the
    /// deterministic mode those on a depot stay to charge ([`stays_to_charge`]). Those whose most
    /// likely motion is the way back, without a new confirmation, sample their motions.
    ///
    /// # Errors
    /// [`FlyError`] if the model or the length of a buffer does not fit, or if an output is not
    /// finite. The actions are unspecified then.
    #[allow(clippy::too_many_arguments)]
    pub fn act(
        &self,
        weights: &[f32],
        options: ActOptions,
        model: &Model<'_>,
        state: &StateRef<'_>,
        observations: &[f32],
        scratch: &mut [f32],
        actions: &mut [f32],
    ) -> Result<(), FlyError> {
        let uavs = model.uav_count();
        length(
            "observations",
            uavs * model.observation_len(),
            observations.len(),
        )?;
        length("actions", 2 * uavs, actions.len())?;
        self.check_all(weights, model, scratch)?;
        let sizes = sizes(model, self.metadata);
        let (row, scratch) = scratch.split_at_mut(self.row_len(model));
        let (seed, t) = (state.seed(), state.t());
        let map = model.config().motion_map;
        let choose = |actions: &mut [f32], uav: usize, outputs: &[f32]| {
            if outputs.iter().any(|output| !output.is_finite()) {
                return Err(FlyError::NotFinite { uav });
            }
            let draw = Draw {
                seed,
                t,
                uav: uav as u32,
            };
            let [direction, pilot] = match options.mode {
                Mode::Deterministic => {
                    let [likely, pilot] = self.head.deterministic(outputs, map);
                    let direction = if !self.metadata.choices {
                        likely
                    } else if stays_to_charge(model, state, uav) {
                        Motion::Stay.to_action(map)
                    } else if turns_round(state, uav, likely, map) {
                        self.head.sample(outputs, map, draw)[0]
                    } else {
                        likely
                    };
                    [direction, pilot]
                }
                Mode::Sampled => self.head.sample(outputs, map, draw),
            };
            let action = &mut actions[2 * uav..][..2];
            action.copy_from_slice(&[direction, options.pilot.unwrap_or(pilot)]);
            Ok(())
        };
        if !self.metadata.choices {
            return self.visit(weights, sizes, observations, 0, scratch, |uav, outputs| {
                choose(actions, uav, outputs)
            });
        }
        for uav in 0..uavs {
            read_choices(sizes.row, observations, actions, uav, row);
            self.visit(weights, sizes, row, uav, scratch, |uav, outputs| {
                choose(actions, uav, outputs)
            })?;
        }
        Ok(())
    }
}
