//! A simulation that owns its memory, for callers that have an allocator.

use alloc::vec;
use alloc::vec::Vec;

use crate::config::Cell;
use crate::error::Error;
use crate::hash;
use crate::host::Call;
use crate::model::Model;
use crate::observation;
use crate::scratch::Scratch;
use crate::state::{StateMut, StateRef};
use crate::step::StepOutcome;

/// A simulation: a state of a model together with its working memory.
///
/// A clone is a fork: with the same actions both continue with the same bits.
#[derive(Clone, Debug)]
pub struct Sim<'m> {
    model: &'m Model<'m>,
    words: Vec<u64>,
    scratch: Vec<u64>,
}

impl<'m> Sim<'m> {
    /// Creates a simulation at the start of the episode with seed 0.
    #[must_use]
    pub fn new(model: &'m Model<'m>) -> Self {
        let mut sim = Self {
            model,
            words: vec![0; model.state_words()],
            scratch: vec![0; Scratch::words_for(model)],
        };
        sim.reset(0);
        sim
    }

    /// The model of the simulation.
    #[must_use]
    pub const fn model(&self) -> &'m Model<'m> {
        self.model
    }

    /// Begins the episode that follows from a seed.
    pub fn reset(&mut self, seed: u64) {
        let Self {
            model,
            words,
            scratch,
        } = self;
        let reset = Scratch::new(model, scratch).and_then(|mut s| model.reset(words, &mut s, seed));
        debug_assert_eq!(reset, Ok(()), "the memory has the model's own size");
    }

    fn with<T>(
        &mut self,
        act: impl FnOnce(&Model<'_>, &mut StateMut<'_>, &mut Scratch<'_>) -> Result<T, Error>,
    ) -> Result<T, Error> {
        let mut state = self.model.state_mut(&mut self.words)?;
        let mut scratch = Scratch::new(self.model, &mut self.scratch)?;
        act(self.model, &mut state, &mut scratch)
    }

    /// Runs one whole step; see [`Model::step`].
    ///
    /// # Errors
    /// The errors of [`Model::step`].
    pub fn step(&mut self, actions: &[f32]) -> Result<StepOutcome, Error> {
        self.with(|model, state, scratch| model.step(state, scratch, actions))
    }

    /// Runs part 1 of a step; see [`Model::step_begin`].
    ///
    /// # Errors
    /// The errors of [`Model::step_begin`].
    pub fn step_begin(&mut self, actions: &[f32]) -> Result<(), Error> {
        self.with(|model, state, _| model.step_begin(state, actions))
    }

    /// Applies a call of a host simulator; see [`Call::apply`].
    ///
    /// # Errors
    /// The errors of [`Call::apply`].
    pub fn apply(&mut self, call: &Call<'_>) -> Result<(), Error> {
        self.with(|model, state, scratch| call.apply(model, state, scratch))
    }

    /// Sets the positions of the UAVs; see [`Model::set_positions`].
    ///
    /// # Errors
    /// The errors of [`Model::set_positions`].
    pub fn set_positions(&mut self, cells: &[Cell]) -> Result<(), Error> {
        self.with(|model, state, _| model.set_positions(state, cells))
    }

    /// Runs part 2 of a step; see [`Model::step_sense`].
    ///
    /// # Errors
    /// The errors of [`Model::step_sense`].
    pub fn step_sense(&mut self) -> Result<(), Error> {
        self.with(|model, state, scratch| model.step_sense(state, scratch))
    }

    /// Runs part 3 of a step; see [`Model::step_communicate`].
    ///
    /// # Errors
    /// The errors of [`Model::step_communicate`].
    pub fn step_communicate(&mut self) -> Result<(), Error> {
        self.with(|model, state, scratch| model.step_communicate(state, scratch))
    }

    /// Runs part 3 of a step over the host's links; see [`Model::step_communicate_with`].
    ///
    /// # Errors
    /// The errors of [`Model::step_communicate_with`].
    pub fn step_communicate_with(
        &mut self,
        links: &[u8],
        throughput: Option<&[f64]>,
    ) -> Result<(), Error> {
        self.with(|model, state, scratch| {
            model.step_communicate_with(state, scratch, links, throughput)
        })
    }

    /// Runs part 4 of a step; see [`Model::step_end`].
    ///
    /// # Errors
    /// The errors of [`Model::step_end`].
    pub fn step_end(&mut self) -> Result<StepOutcome, Error> {
        self.with(|model, state, scratch| model.step_end(state, scratch))
    }

    /// Places the hotspots; see [`Model::set_hotspots`].
    ///
    /// # Errors
    /// The errors of [`Model::set_hotspots`].
    pub fn set_hotspots(&mut self, cells: &[Cell]) -> Result<(), Error> {
        self.with(|model, state, scratch| model.set_hotspots(state, scratch, cells))
    }

    /// Sets the initial charge of all batteries; see [`Model::set_batteries`].
    ///
    /// # Errors
    /// The errors of [`Model::set_batteries`].
    pub fn set_batteries(&mut self, charges_uj: &[u64]) -> Result<(), Error> {
        self.with(|model, state, scratch| model.set_batteries(state, scratch, charges_uj))
    }

    /// Keeps a UAV on the ground in this step; see [`Model::ground`].
    ///
    /// # Errors
    /// The errors of [`Model::ground`].
    pub fn ground(&mut self, uav: usize) -> Result<(), Error> {
        self.with(|model, state, _| model.ground(state, uav))
    }

    /// Runs part 2 of a step with the host's detections; see [`Model::step_sense_with`].
    ///
    /// # Errors
    /// The errors of [`Model::step_sense_with`].
    pub fn step_sense_with(&mut self, detections: &[u8]) -> Result<(), Error> {
        self.with(|model, state, scratch| model.step_sense_with(state, scratch, detections))
    }

    /// Confirms a hotspot; see [`Model::confirm_hotspot`].
    ///
    /// # Errors
    /// The errors of [`Model::confirm_hotspot`].
    pub fn confirm_hotspot(&mut self, hotspot: usize) -> Result<(), Error> {
        self.with(|model, state, _| model.confirm_hotspot(state, hotspot))
    }

    /// Moves a hotspot; see [`Model::move_hotspot`].
    ///
    /// # Errors
    /// The errors of [`Model::move_hotspot`].
    pub fn move_hotspot(&mut self, hotspot: usize, cell: Cell) -> Result<(), Error> {
        self.with(|model, state, scratch| model.move_hotspot(state, scratch, hotspot, cell))
    }

    /// Places the UAVs at the start; see [`Model::set_starts`].
    ///
    /// # Errors
    /// The errors of [`Model::set_starts`].
    pub fn set_starts(&mut self, cells: &[Cell]) -> Result<(), Error> {
        self.with(|model, state, scratch| model.set_starts(state, scratch, cells))
    }

    /// Sets the charge of one battery; see [`Model::set_battery`].
    ///
    /// # Errors
    /// The errors of [`Model::set_battery`].
    pub fn set_battery(&mut self, uav: usize, charge_uj: u64) -> Result<(), Error> {
        self.with(|model, state, scratch| model.set_battery(state, scratch, uav, charge_uj))
    }

    /// Writes the observations of all UAVs; see [`observation::observe`].
    ///
    /// # Errors
    /// The errors of [`observation::observe`].
    pub fn observe(&mut self, out: &mut [f32]) -> Result<(), Error> {
        self.with(|model, state, scratch| {
            observation::observe(model, &state.as_ref(), scratch, out)
        })
    }

    /// Writes the global state; see [`observation::observe_global`].
    ///
    /// # Errors
    /// The errors of [`observation::observe_global`].
    pub fn observe_global(&self, out: &mut [f32]) -> Result<(), Error> {
        observation::observe_global(self.model, &self.state(), out)
    }

    /// A read-only view of the state.
    #[must_use]
    pub fn state(&self) -> StateRef<'_> {
        StateRef::split(*self.model.layout(), &self.words)
    }

    /// The words of the state.
    #[must_use]
    pub fn words(&self) -> &[u64] {
        &self.words
    }

    /// FNV-1a hash of the state; equal states have equal hashes.
    #[must_use]
    pub fn state_hash(&self) -> u64 {
        hash::words(&self.words)
    }

    /// Saves the state as bytes; see [`Model::save`].
    #[must_use]
    pub fn save(&self) -> Vec<u8> {
        let mut bytes = vec![0; self.model.save_len()];
        let saved = self.model.save(&self.words, &mut bytes);
        debug_assert_eq!(saved, Ok(()), "the buffer has the snapshot's own size");
        bytes
    }

    /// Loads a saved state; see [`Model::load`].
    ///
    /// # Errors
    /// The errors of [`Model::load`].
    pub fn load(&mut self, bytes: &[u8]) -> Result<(), Error> {
        let mut spare = vec![0; self.words.len()];
        self.model.load(bytes, &mut self.words, &mut spare)
    }
}
