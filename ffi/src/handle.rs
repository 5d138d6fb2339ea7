//! Handles: blocks of memory that begin with a seal.
//!
//! A seal mixes a constant of the handle's kind with the block's own address. A handle that is
//! freed, of another kind or copied therefore fails the check. In a block that changes, the mark of
//! the calls that use it follows ([`InUse`]).
//!
//! | block | content |
//! | --- | --- |
//! | model | [`ModelBlock`], then the words of its tables |
//! | simulation | [`SimBlock`], then the words of the state, the working memory and a spare state |
//! | batch | [`BatchBlock`](crate::batch_block::BatchBlock), then states, working memory, threads |
//! | policy | [`PolicyBlock`](crate::policy_block::PolicyBlock), then what its network works with |
//! | plan | [`PlanBlock`](crate::plan_block::PlanBlock) alone; the plan itself is on the heap |

use std::alloc::{Layout, alloc, dealloc};
use std::slice;
use std::sync::atomic::{AtomicU32, Ordering};

use jcas_core::host::Call;
use jcas_core::{Config, Error, Model, Scratch, StateMut};

use crate::in_use::{Changing, InUse, Reading};
use crate::recording::{Recording, Sink, Workspace};
use crate::status::{
    Fault, JCAS_ERROR_ALIGNMENT, JCAS_ERROR_HANDLE, JCAS_ERROR_IN_USE, JCAS_ERROR_LENGTH,
    JCAS_ERROR_NULL, JCAS_ERROR_RESOURCES, guard,
};

/// The kind of a handle.
#[derive(Clone, Copy)]
pub(crate) enum Kind {
    Model,
    Sim,
    Batch,
    Policy,
    Plan,
}

impl Kind {
    const ALL: [Self; 5] = [
        Self::Model,
        Self::Sim,
        Self::Batch,
        Self::Policy,
        Self::Plan,
    ];

    /// Returns the seal of a block of this kind at an address.
    fn seal(self, address: usize) -> u64 {
        let name = match self {
            Self::Model => b"jcas mdl",
            Self::Sim => b"jcas sim",
            Self::Batch => b"jcas bat",
            Self::Policy => b"jcas pol",
            Self::Plan => b"jcas pln",
        };
        u64::from_le_bytes(*name) ^ address as u64
    }
}

/// A block of one kind.
///
/// # Safety
/// Implement it only for `repr(C)` structs whose first field is the seal, a `u64`.
pub(crate) unsafe trait Block: Sized {
    const KIND: Kind;

    /// Returns the seal of a block at an address.
    fn seal(at: *const Self) -> u64 {
        Self::KIND.seal(at.addr())
    }
}

#[repr(C)]
pub(crate) struct ModelBlock {
    seal: u64,
    memory: Memory,
    /// Number of simulations, batches and policies that use this model.
    users: AtomicU32,
    model: Model<'static>,
}

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
}

// SAFETY: `repr(C)`, the seal comes first.
unsafe impl Block for ModelBlock {
    const KIND: Kind = Kind::Model;
}
// SAFETY: as above.
unsafe impl Block for SimBlock {
    const KIND: Kind = Kind::Sim;
}

/// The size and owner of a block's memory.
#[derive(Clone, Copy)]
pub(crate) struct Memory {
    layout: Layout,
    ours: bool,
}

impl Memory {
    /// Allocates memory of the library.
    pub(crate) fn allocate(layout: Layout) -> Result<(*mut u8, Self), Fault> {
        // SAFETY: the layout is not empty, as no block is.
        let at = unsafe { alloc(layout) };
        if at.is_null() {
            return Err(Fault::Status(JCAS_ERROR_RESOURCES));
        }
        Ok((at, Self { layout, ours: true }))
    }

    /// Checks the caller's memory.
    ///
    /// # Safety
    /// If `at` is neither null nor misaligned, `size` bytes can be read there.
    pub(crate) unsafe fn lent(
        at: *mut u8,
        size: usize,
        layout: Layout,
    ) -> Result<(*mut u8, Self), Fault> {
        // SAFETY: the caller's promises, passed on.
        unsafe { check_lent(at, size, layout) }?;
        let ours = false;
        Ok((at, Self { layout, ours }))
    }

    /// Returns the size of the block in bytes.
    pub(crate) const fn size(&self) -> usize {
        self.layout.size()
    }

    /// Frees memory of the library.
    ///
    /// # Safety
    /// `at` came with this value from [`Memory::allocate`] or [`Memory::lent`], and nothing uses
    /// it.
    pub(crate) unsafe fn release(self, at: *mut u8) {
        if self.ours {
            // SAFETY: allocated with this very layout.
            unsafe { dealloc(at, self.layout) };
        }
    }
}

/// Checks that the caller's memory fits a layout and holds no living handle.
///
/// # Safety
/// If `at` is neither null nor misaligned, `size` bytes can be read there.
pub(crate) unsafe fn check_lent(at: *mut u8, size: usize, layout: Layout) -> Result<(), Fault> {
    if at.is_null() {
        Err(Fault::Status(JCAS_ERROR_NULL))
    } else if !at.addr().is_multiple_of(layout.align()) {
        Err(Fault::Status(JCAS_ERROR_ALIGNMENT))
    } else if size < layout.size() {
        Err(Fault::Status(JCAS_ERROR_LENGTH))
    // SAFETY: large enough and aligned, as was just checked.
    } else if unsafe { holds_a_handle(at) } {
        Err(Fault::Status(JCAS_ERROR_IN_USE))
    } else {
        Ok(())
    }
}

/// Whether memory holds a living handle, which another block would overwrite.
///
/// # Safety
/// Eight bytes can be read at `at`, which is aligned for them.
unsafe fn holds_a_handle(at: *mut u8) -> bool {
    // SAFETY: the caller's promise; the read is volatile, as the memory may be uninitialised.
    let seal = unsafe { at.cast::<u64>().read_volatile() };
    Kind::ALL.iter().any(|kind| kind.seal(at.addr()) == seal)
}

/// Returns the layout of a block of type `B` followed by `words` words.
pub(crate) fn block_layout<B>(words: usize) -> Result<Layout, Fault> {
    let too_large = |_| Fault::Status(JCAS_ERROR_RESOURCES);
    let tail = Layout::array::<u64>(words).map_err(too_large)?;
    let (layout, offset) = Layout::new::<B>().extend(tail).map_err(too_large)?;
    debug_assert_eq!(offset, size_of::<B>(), "no gap before the words");
    Ok(layout.pad_to_align())
}

/// Returns the words after a block.
///
/// # Safety
/// `count` words lie after the block at `at`, initialised, and nothing else uses them for `'a`.
pub(crate) unsafe fn words_after<'a, B>(at: *mut B, count: usize) -> &'a mut [u64] {
    // SAFETY: within the block's memory by the caller's promise.
    let first = unsafe { at.add(1) };
    // SAFETY: the caller's promise; a block's size is a multiple of a word's alignment.
    unsafe { slice::from_raw_parts_mut(first.cast(), count) }
}

/// Checks a handle.
///
/// # Safety
/// If `at` is neither null nor misaligned, eight bytes can be read there. If they are a seal, the
/// block is alive.
pub(crate) unsafe fn check<B: Block>(at: *const B) -> Result<(), Fault> {
    if at.is_null() {
        return Err(Fault::Status(JCAS_ERROR_NULL));
    }
    if !at.is_aligned() {
        return Err(Fault::Status(JCAS_ERROR_ALIGNMENT));
    }
    // SAFETY: readable by the caller's promise.
    let seal = unsafe { at.cast::<u64>().read() };
    if seal == B::seal(at) {
        Ok(())
    } else {
        Err(Fault::Status(JCAS_ERROR_HANDLE))
    }
}

/// Opens a model to read.
///
/// # Safety
/// The conditions of [`check`] hold, and the model is not freed for `'a`.
pub(crate) unsafe fn model<'a>(at: *const ModelBlock) -> Result<&'a ModelBlock, Fault> {
    // SAFETY: the caller's promises, passed on.
    unsafe { check(at) }?;
    // SAFETY: a living model block; no call changes it.
    Ok(unsafe { &*at })
}

impl ModelBlock {
    pub(crate) fn layout(config: &Config) -> Result<Layout, Fault> {
        block_layout::<Self>(Model::table_words(config).map_err(Error::from)?)
    }

    /// Builds a model in memory that has its layout.
    ///
    /// # Safety
    /// `at` and `memory` come from [`Memory`] with [`ModelBlock::layout`] of this configuration.
    pub(crate) unsafe fn build(
        config: Config,
        (at, memory): (*mut u8, Memory),
    ) -> Result<*mut Self, Fault> {
        let block = at.cast::<Self>();
        let count = Model::table_words(&config).map_err(Error::from)?;
        // SAFETY: the layout has room for the block and the words; all zero bits are a valid word.
        unsafe { at.write_bytes(0, memory.layout.size()) };
        // SAFETY: just initialised; the tables stay with the model for as long as the block lives.
        let words = unsafe { words_after(block, count) };
        let model = Model::new_in(config, words)?;
        let value = Self {
            seal: Self::seal(block),
            memory,
            users: AtomicU32::new(0),
            model,
        };
        // SAFETY: in front of the words, aligned by the layout.
        unsafe { block.write(value) };
        Ok(block)
    }

    /// Ends a model.
    ///
    /// # Safety
    /// The conditions of [`check`] hold, and no other thread uses the model.
    pub(crate) unsafe fn free(at: *mut Self) -> Result<(), Fault> {
        // SAFETY: the caller's promises, passed on.
        let block = unsafe { model(at) }?;
        if block.users.load(Ordering::Acquire) != 0 {
            return Err(Fault::Status(JCAS_ERROR_IN_USE));
        }
        let memory = block.memory;
        // SAFETY: only this call uses the block, and a later check finds no seal.
        unsafe { (&raw mut (*at).seal).write(0) };
        // SAFETY: nothing uses the block any more; a model over lent words owns nothing else.
        unsafe { memory.release(at.cast()) };
        Ok(())
    }

    pub(crate) fn get(&self) -> &Model<'static> {
        &self.model
    }

    pub(crate) fn add_user(&self) {
        self.users.fetch_add(1, Ordering::AcqRel);
    }

    pub(crate) fn drop_user(&self) {
        self.users.fetch_sub(1, Ordering::AcqRel);
    }
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
}

/// A simulation opened to read, which no call changes meanwhile.
pub(crate) struct SimRef<'a> {
    _mark: Reading<'a>,
    pub(crate) model: &'a Model<'static>,
    pub(crate) words: &'a [u64],
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
    let model = unsafe { &(*model).model };
    // SAFETY: by the mark, only this call uses these.
    let (refusal, recording) = unsafe { (&mut (*at).refusal, &mut (*at).recording) };
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
    let model = unsafe { &(*block.model).model };
    // SAFETY: the words of the state follow the block.
    let first = unsafe { at.add(1) };
    // SAFETY: as many as the model's states have.
    let words = unsafe { slice::from_raw_parts(first.cast(), block.state_words) };
    Ok(SimRef {
        _mark: mark,
        model,
        words,
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
        unsafe { at.write_bytes(0, memory.layout.size()) };
        let value = Self {
            seal: Self::seal(block),
            in_use: InUse::new(),
            memory,
            model,
            state_words: model.get().state_words(),
            scratch_words: Scratch::words_for(model.get()),
            refusal: None,
            recording: None,
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
        *self.recording = None;
        Ok(())
    }

    /// Replaces the state by an unrelated one, which ends a recording without its last line.
    pub(crate) fn replace(&mut self, words: &[u64]) {
        self.words.copy_from_slice(words);
        *self.recording = None;
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
