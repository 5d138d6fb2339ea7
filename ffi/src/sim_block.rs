//! The block of a simulation, and its views while a call uses it.

use std::alloc::Layout;
use std::slice;

use jcas_core::host::Call;
use jcas_core::{Error, Model, Scratch, StateMut};

use crate::handle::{Block, Kind, Memory, block_layout, check, words_after};
use crate::in_use::{Changing, InUse, Reading};
use crate::model_block::ModelBlock;
use crate::recording::{Recording, Sink, Workspace};
use crate::status::{Fault, guard};
use crate::timeline::Timeline;

#[repr(C)]
pub(crate) struct SimBlock {
    seal: u64,
    in_use: InUse,
    memory: Memory,
    model: *const ModelBlock,
    /// The model's sizes, kept here so that no call computes them again.
    state_words: usize,
    scratch_words: usize,
    /// The reason why the last call that could change the simulation was refused.
    pub(crate) refusal: Option<Fault>,
    recording: Option<Recording>,
    timeline: Timeline,
}

// SAFETY: `repr(C)`, the seal comes first.
unsafe impl Block for SimBlock {
    const KIND: Kind = Kind::Sim;
}

/// A simulation opened for change, which no other call uses meanwhile.
pub(crate) struct SimMut<'a> {
    _mark: Changing<'a>,
    pub(crate) model: &'a Model<'static>,
    pub(crate) words: &'a mut [u64],
    pub(crate) scratch: &'a mut [u64],
    pub(crate) spare: &'a mut [u64],
    pub(crate) refusal: &'a mut Option<Fault>,
    pub(crate) recording: &'a mut Option<Recording>,
    timeline: &'a mut Timeline,
}

/// A simulation opened to read, which no call changes meanwhile.
pub(crate) struct SimRef<'a> {
    _mark: Reading<'a>,
    pub(crate) model: &'a Model<'static>,
    pub(crate) words: &'a [u64],
    pub(crate) timeline: Timeline,
    pub(crate) refusal: &'a Option<Fault>,
}

/// Opens a simulation for change.
///
/// # Safety
/// The conditions of [`check`] hold, and the simulation is not freed for `'a`.
pub(crate) unsafe fn open<'a>(at: *mut SimBlock) -> Result<SimMut<'a>, Fault> {
    // SAFETY: the caller's promises, passed on.
    unsafe { check(at) }?;
    // SAFETY: the block is alive, and only its mark is read.
    let mark = unsafe { &(*at).in_use }.change()?;
    // SAFETY: what is read here never changes while the block lives.
    let (model, state, scratch) = unsafe { ((*at).model, (*at).state_words, (*at).scratch_words) };
    // SAFETY: a model cannot be freed while it has simulations.
    let model = unsafe { &*model }.get();
    // SAFETY: by the mark, only this call uses these.
    let (refusal, recording) = unsafe { (&mut (*at).refusal, &mut (*at).recording) };
    // SAFETY: as above.
    let timeline = unsafe { &mut (*at).timeline };
    // SAFETY: the block was laid out with these words after it, which only this call uses.
    let words = unsafe { words_after(at, 2 * state + scratch) };
    let (words, rest) = words.split_at_mut(state);
    let (spare, scratch) = rest.split_at_mut(state);
    Ok(SimMut {
        _mark: mark,
        model,
        words,
        scratch,
        spare,
        refusal,
        recording,
        timeline,
    })
}

/// Opens a simulation for change, and keeps the reason if the operation is refused.
///
/// # Safety
/// As [`open`].
pub(crate) unsafe fn change(
    at: *mut SimBlock,
    act: impl FnOnce(&mut SimMut<'_>) -> Result<(), Fault>,
) -> i32 {
    guard(|| {
        // SAFETY: the caller's promises, passed on.
        let mut sim = unsafe { open(at) }?;
        let done = act(&mut sim);
        *sim.refusal = done.err();
        done
    })
}

/// Opens a simulation to read.
///
/// # Safety
/// The conditions of [`check`] hold, and the simulation is not freed for `'a`.
pub(crate) unsafe fn see<'a>(at: *const SimBlock) -> Result<SimRef<'a>, Fault> {
    // SAFETY: the caller's promises, passed on.
    unsafe { check(at) }?;
    // SAFETY: the block is alive, and only its mark is read.
    let mark = unsafe { &(*at).in_use }.read()?;
    // SAFETY: by the mark, no call changes the block.
    let block = unsafe { &*at };
    // SAFETY: a model cannot be freed while it has simulations.
    let model = unsafe { &*block.model }.get();
    // SAFETY: the words of the state follow the block.
    let first = unsafe { at.add(1) };
    // SAFETY: as many as the model's states have.
    let words = unsafe { slice::from_raw_parts(first.cast(), block.state_words) };
    Ok(SimRef {
        _mark: mark,
        model,
        words,
        timeline: block.timeline,
        refusal: &block.refusal,
    })
}

impl SimBlock {
    pub(crate) fn layout(model: &Model<'_>) -> Result<Layout, Fault> {
        block_layout::<Self>(2 * model.state_words() + Scratch::words_for(model))
    }

    /// Builds a simulation of a model, at t = 0 of seed 0, in memory that has its layout.
    ///
    /// # Safety
    /// `at` and `memory` come from [`Memory`] with [`SimBlock::layout`] of this model.
    pub(crate) unsafe fn build(
        model: &ModelBlock,
        (at, memory): (*mut u8, Memory),
    ) -> Result<*mut Self, Fault> {
        let block = at.cast::<Self>();
        // SAFETY: the layout has room for the block and the words; all zero bits are a valid word.
        unsafe { at.write_bytes(0, memory.size()) };
        let value = Self {
            seal: Self::seal(block),
            in_use: InUse::new(),
            memory,
            model,
            state_words: model.get().state_words(),
            scratch_words: Scratch::words_for(model.get()),
            refusal: None,
            recording: None,
            timeline: Timeline::renewed(),
        };
        // SAFETY: in front of the words, aligned by the layout.
        unsafe { block.write(value) };
        // SAFETY: just built.
        unsafe { open(block) }?.reset(0)?;
        model.add_user();
        Ok(block)
    }

    /// Ends a simulation.
    ///
    /// # Safety
    /// The conditions of [`check`] hold, and no other thread frees the simulation.
    pub(crate) unsafe fn free(at: *mut Self) -> Result<(), Fault> {
        // SAFETY: the caller's promises, passed on.
        unsafe { check(at) }?;
        // SAFETY: the block is alive, and only its mark is read.
        unsafe { &(*at).in_use }.change()?.keep();
        // SAFETY: by the mark, only this call uses the block.
        let block = unsafe { &mut *at };
        // SAFETY: a model cannot be freed while it has simulations.
        unsafe { &*block.model }.drop_user();
        block.seal = 0;
        let memory = block.memory;
        // SAFETY: nothing uses the block any more.
        unsafe { memory.release(at.cast()) };
        Ok(())
    }
}

impl SimMut<'_> {
    pub(crate) fn reset(&mut self, seed: u64) -> Result<(), Fault> {
        let mut scratch = Scratch::new(self.model, self.scratch)?;
        self.model.reset(self.words, &mut scratch, seed)?;
        self.begin_anew();
        Ok(())
    }

    /// Loads a saved state.
    pub(crate) fn load(&mut self, saved: &[u8]) -> Result<(), Fault> {
        self.model.load(saved, self.words, self.spare)?;
        self.begin_anew();
        Ok(())
    }

    /// Replaces the state by an unrelated one.
    pub(crate) fn replace(&mut self, words: &[u64]) {
        self.words.copy_from_slice(words);
        self.begin_anew();
    }

    /// Ends a recording without its last line, and begins a timeline, as for an unrelated state.
    fn begin_anew(&mut self) {
        *self.recording = None;
        *self.timeline = Timeline::renewed();
    }

    /// Begins the episode of a seed and its recording. Nothing changes if the sink refuses.
    pub(crate) fn record(
        &mut self,
        seed: u64,
        sink: Sink,
        workspace: Workspace,
        names: (&str, &str),
    ) -> Result<(), Fault> {
        let Self {
            model,
            scratch,
            spare,
            ..
        } = self;
        let mut working = Scratch::new(model, scratch)?;
        model.reset(spare, &mut working, seed)?;
        let recording = Recording::begin(sink, workspace, names, model, spare, scratch)?;
        self.words.copy_from_slice(self.spare);
        self.begin_anew();
        *self.recording = Some(recording);
        Ok(())
    }

    /// Passes a host's call to the kernel and records it.
    pub(crate) fn own(&mut self, call: &Call<'_>) -> Result<(), Fault> {
        self.act(|model, state, scratch| call.apply(model, state, scratch))?;
        if let Some(recording) = self.recording {
            recording.host(call, self.model.uav_count());
        }
        Ok(())
    }

    /// Records the actions of this step.
    #[inline]
    pub(crate) fn tell_actions(&mut self, actions: &[f32]) {
        if let Some(recording) = self.recording {
            recording.acts(actions);
        }
    }

    /// Records the end of a step.
    #[inline]
    pub(crate) fn tell_step(&mut self) -> Result<(), Fault> {
        match self.recording {
            Some(recording) => recording.step(self.model, self.words, self.scratch),
            None => Ok(()),
        }
    }

    /// Runs the kernel on the state, and keeps the reason of a refusal.
    #[inline]
    pub(crate) fn act<T>(
        &mut self,
        act: impl FnOnce(&Model<'_>, &mut StateMut<'_>, &mut Scratch<'_>) -> Result<T, Error>,
    ) -> Result<T, Fault> {
        let mut scratch = Scratch::new(self.model, self.scratch)?;
        let acted = self
            .model
            .state_mut(self.words)
            .and_then(|mut state| act(self.model, &mut state, &mut scratch));
        Ok(acted?)
    }
}
