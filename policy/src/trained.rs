//! A trained network as a policy, with its weights and its working memory.

use core::fmt::Display;
use std::sync::Arc;

use jcas_core::{Model, StateRef};

use crate::Policy;
use crate::network::{
    ActOptions, FlyError, LINE_LEN, LoadError, MatmulKernel, Network, PolicyMetadata, line_offset,
};

/// A trained policy, which runs one episode at a time. Every UAV acts from its own observation. A
/// clone shares the weights.
#[derive(Clone)]
pub struct Trained {
    name: String,
    network: Network,
    /// The weights begin at index `first`, which is aligned to a cache line.
    weights: Arc<[f32]>,
    first: usize,
    options: Option<ActOptions>,
    observations: Vec<f32>,
    scratch: Vec<f32>,
}

impl Trained {
    /// Reads the bytes of a `policy.safetensors`. Reports use `name`.
    ///
    /// # Errors
    /// [`LoadError`] if the bytes do not hold a policy.
    pub fn read(name: &str, bytes: &[u8]) -> Result<Self, LoadError> {
        let len = Network::read(bytes)?.weights_len();
        let mut weights: Arc<[f32]> = vec![0.0; len + LINE_LEN].into();
        let first = line_offset(&weights);
        let own =
            Arc::get_mut(&mut weights).map_or(&mut [][..], |all| &mut all[first..first + len]);
        let network = Network::load(bytes, own)?;
        Ok(Self {
            name: name.to_owned(),
            network,
            weights,
            first,
            options: None,
            observations: Vec::new(),
            scratch: Vec::new(),
        })
    }

    /// Replaces the way of acting that the file states.
    #[must_use]
    pub fn with_act_options(self, options: ActOptions) -> Self {
        Self {
            options: Some(options),
            ..self
        }
    }

    /// Replaces the compilation of the innermost loops. The results stay the same.
    #[must_use]
    pub fn with_matmul(self, matmul: MatmulKernel) -> Self {
        Self {
            network: self.network.with_matmul(matmul),
            ..self
        }
    }

    /// The metadata of the file about how the policy acts.
    #[must_use]
    pub const fn metadata(&self) -> PolicyMetadata {
        self.network.metadata()
    }

    /// Checks that the policy can read the observations of this model.
    ///
    /// # Errors
    /// [`FlyError`] states what does not fit.
    pub fn check(&self, model: &Model<'_>) -> Result<(), FlyError> {
        self.network.check(model)
    }

    /// Returns the network's outputs, one row for each observation. `observations` holds rows of
    /// `Model::observation_len` numbers.
    ///
    /// # Errors
    /// [`FlyError`] if the model does not fit.
    pub fn outputs(
        &mut self,
        model: &Model<'_>,
        observations: &[f32],
    ) -> Result<Vec<f32>, FlyError> {
        let rows = observations.len() / model.observation_len();
        let mut outputs = vec![0.0; rows * self.network.head().outputs()];
        self.scratch.resize(self.network.scratch_len(model), 0.0);
        self.network.outputs(
            &self.weights[self.first..][..self.network.weights_len()],
            model,
            observations,
            &mut self.scratch,
            &mut outputs,
        )?;
        Ok(outputs)
    }
}

impl Policy for Trained {
    fn name(&self) -> &str {
        &self.name
    }

    fn pilot(&self) -> &dyn Display {
        let constant = match self.options {
            Some(options) => options.pilot.is_some(),
            None => self.metadata().pilot_density.is_some(),
        };
        if constant { &"constant" } else { &"learned" }
    }

    fn reads_observations(&self) -> bool {
        true
    }

    fn see(&mut self, observations: &[f32]) {
        self.observations.clear();
        self.observations.extend_from_slice(observations);
    }

    /// # Panics
    /// It panics with a model that [`Trained::check`] refuses.
    fn act(&mut self, model: &Model<'_>, state: &StateRef<'_>, actions: &mut [f32]) {
        let options = self
            .options
            .unwrap_or_else(|| self.network.act_options(model.config()));
        self.scratch.resize(self.network.scratch_len(model), 0.0);
        self.network
            .act(
                &self.weights[self.first..][..self.network.weights_len()],
                options,
                model,
                state,
                &self.observations,
                &mut self.scratch,
                actions,
            )
            .expect("a mission that the network fits");
    }
}
