//! A simulation that owns its memory, for callers that have an allocator.

use alloc::vec;
use alloc::vec::Vec;

use crate::config::Cell;
use crate::error::Error;
use crate::host::Call;
use crate::model::Model;
use crate::observation;
use crate::state::scratch::Scratch;
use crate::state::{StateMut, StateRef};
use crate::step::StepOutcome;
use crate::words::hash;

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

    /// Applies a call of a host simulator; see [`Call::apply`].
    ///
    /// # Errors
    /// The errors of [`Call::apply`].
    pub fn apply(&mut self, call: &Call<'_>) -> Result<(), Error> {
        self.with(|model, state, scratch| call.apply(model, state, scratch))
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

/// Declares methods that open the state and call the method of [`Model`] that has the same name.
macro_rules! methods_of_model {
    (|$model:ident, $state:ident, $scratch:tt| $(
        $doc:literal, $name:ident($( $argument:ident: $type:ty ),*) -> $ok:ty { $call:expr }
    )+) => {
        impl Sim<'_> { $(
            #[doc = concat!($doc, "; see [`Model::", stringify!($name), "`].")]
            ///
            /// # Errors
            #[doc = concat!("The errors of [`Model::", stringify!($name), "`].")]
            pub fn $name(&mut self, $( $argument: $type ),*) -> Result<$ok, Error> {
                self.with(|$model, $state, $scratch| $call)
            }
        )+ }
    };
}

methods_of_model! { |model, state, scratch|
    "Runs one whole step", step(actions: &[f32]) -> StepOutcome {
        model.step(state, scratch, actions)
    }
    "Runs part 2 of a step", step_sense() -> () {
        model.step_sense(state, scratch)
    }
    "Runs part 2 of a step with the host's detections", step_sense_with(detections: &[u8]) -> () {
        model.step_sense_with(state, scratch, detections)
    }
    "Runs part 3 of a step", step_communicate() -> () {
        model.step_communicate(state, scratch)
    }
    "Runs part 3 of a step over the host's links",
    step_communicate_with(links: &[u8], throughput: Option<&[f64]>) -> () {
        model.step_communicate_with(state, scratch, links, throughput)
    }
    "Runs part 4 of a step", step_end() -> StepOutcome {
        model.step_end(state, scratch)
    }
    "Places the hotspots", set_hotspots(cells: &[Cell]) -> () {
        model.set_hotspots(state, scratch, cells)
    }
    "Moves a hotspot", move_hotspot(hotspot: usize, cell: Cell) -> () {
        model.move_hotspot(state, scratch, hotspot, cell)
    }
    "Places the UAVs at the start", set_starts(cells: &[Cell]) -> () {
        model.set_starts(state, scratch, cells)
    }
    "Sets the initial charge of all batteries", set_batteries(charges_uj: &[u64]) -> () {
        model.set_batteries(state, scratch, charges_uj)
    }
    "Sets the charge of one battery", set_battery(uav: usize, charge_uj: u64) -> () {
        model.set_battery(state, scratch, uav, charge_uj)
    }
}

methods_of_model! { |model, state, _|
    "Runs part 1 of a step", step_begin(actions: &[f32]) -> () {
        model.step_begin(state, actions)
    }
    "Sets the positions of the UAVs", set_positions(cells: &[Cell]) -> () {
        model.set_positions(state, cells)
    }
    "Keeps a UAV on the ground in this step", ground(uav: usize) -> () {
        model.ground(state, uav)
    }
    "Confirms a hotspot", confirm_hotspot(hotspot: usize) -> () {
        model.confirm_hotspot(state, hotspot)
    }
}
