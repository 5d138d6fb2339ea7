//! The memory block of a policy.
//!
//! The words of the kernel's working memory follow a network's block. From the next cache line on
//! follow its weights, its own working memory, the observations and the actions. So a network acts
//! without an allocation. Baselines and plans are on the heap ([`Scripted`]).

use std::alloc::Layout;
use std::slice;

use jcas_core::{Model, Scratch, StateRef, observation};
use jcas_policy::network::{ActOptions, FlyError, LINE_LEN, Network, line_offset};
use jcas_simd::InstructionSet;

use crate::handle::{Block, Kind, Memory, block_layout, check, words_after};
use crate::in_use::{Changing, InUse};
use crate::model_block::ModelBlock;
use crate::rollout_job::ActionSource;
use crate::scripted::{Script, Scripted, Whom};
use crate::status::{Fault, JCAS_ERROR_INTERNAL, JCAS_ERROR_MODEL_MISMATCH, JCAS_ERROR_NAN};
use crate::timeline::Timeline;

#[repr(C)]
pub(crate) struct PolicyBlock {
    seal: u64,
    in_use: InUse,
    memory: Memory,
    model: *const ModelBlock,
    pilot: Pilot,
}

// SAFETY: `repr(C)`, the seal comes first.
unsafe impl Block for PolicyBlock {
    const KIND: Kind = Kind::Policy;
}

/// The controller of a policy.
// Each is stored in its handle's own memory.
#[allow(clippy::large_enum_variant)]
enum Pilot {
    Network(Learned),
    Scripted(Scripted),
}

/// A network and the lengths of the arrays that follow the block.
#[derive(Clone, Copy)]
struct Learned {
    network: Network,
    options: ActOptions,
    lengths: Lengths,
}

#[derive(Clone, Copy)]
struct Lengths {
    kernel_words: usize,
    weights: usize,
    scratch: usize,
    observations: usize,
    actions: usize,
}

impl Lengths {
    fn of(network: &Network, model: &Model<'_>) -> Self {
        Self {
            kernel_words: Scratch::words_for(model),
            weights: network.weights_len(),
            scratch: network.scratch_len(model),
            observations: model.uav_count() * model.observation_len(),
            actions: model.action_len(),
        }
    }

    fn memory(&self) -> usize {
        self.scratch + self.observations
    }

    fn words(&self) -> usize {
        let floats = LINE_LEN + self.weights + self.memory() + self.actions;
        self.kernel_words + floats.div_ceil(2)
    }
}

/// The arrays that follow the block of a network.
struct PolicyParts<'a> {
    kernel: &'a mut [u64],
    weights: &'a mut [f32],
    /// What [`SharedNetwork::act`] works in.
    memory: &'a mut [f32],
    actions: &'a mut [f32],
}

/// # Safety
/// `at` has the layout of [`PolicyBlock::layout`] for these lengths, initialised, and nothing else
/// uses the words after it for `'a`.
unsafe fn parts<'a>(at: *mut PolicyBlock, lengths: &Lengths) -> PolicyParts<'a> {
    // SAFETY: the caller's promises, passed on.
    let words = unsafe { words_after(at, lengths.words()) };
    let (kernel, rest) = words.split_at_mut(lengths.kernel_words);
    // SAFETY: every pattern of bits is two floats, of half the alignment; the words are not used
    // otherwise.
    let floats = unsafe { slice::from_raw_parts_mut(rest.as_mut_ptr().cast(), 2 * rest.len()) };
    let line = line_offset(floats);
    let (weights, rest) = floats[line..].split_at_mut(lengths.weights);
    let (memory, rest) = rest.split_at_mut(lengths.memory());
    PolicyParts {
        kernel,
        weights,
        memory,
        actions: &mut rest[..lengths.actions],
    }
}

/// Converts a refusal of a network to a status.
pub(crate) fn fault(error: FlyError) -> Fault {
    Fault::Status(match error {
        FlyError::Observation { .. } | FlyError::Visibility => JCAS_ERROR_MODEL_MISMATCH,
        FlyError::NotFinite { .. } => JCAS_ERROR_NAN,
        _ => JCAS_ERROR_INTERNAL,
    })
}

impl PolicyBlock {
    /// Returns the layout of a network's block, or with `None` that of a block without one.
    pub(crate) fn layout(model: &Model<'_>, network: Option<&Network>) -> Result<Layout, Fault> {
        let words = network.map_or(0, |network| Lengths::of(network, model).words());
        block_layout::<Self>(words)
    }

    /// Builds a network's policy in memory that has its layout. The weights have already been
    /// checked.
    ///
    /// # Safety
    /// `at` and `memory` come from [`Memory`] with [`PolicyBlock::layout`] of this model and
    /// network.
    pub(crate) unsafe fn build_network(
        model: &ModelBlock,
        network: &Network,
        file: &[u8],
        (at, memory): (*mut u8, Memory),
    ) -> Result<*mut Self, Fault> {
        let block = at.cast::<Self>();
        let lengths = Lengths::of(network, model.get());
        // SAFETY: the layout has room for the block and the words; all zero is a value of each.
        unsafe { at.write_bytes(0, memory.size()) };
        // SAFETY: just initialised, and nobody else has it.
        let parts = unsafe { parts(block, &lengths) };
        if Network::load(file, parts.weights).is_err() {
            // SAFETY: nothing uses the memory; no handle was made.
            unsafe { memory.release(at) };
            return Err(Fault::Status(crate::JCAS_ERROR_CORRUPT));
        }
        let pilot = Pilot::Network(Learned {
            network: network.with_matmul(InstructionSet::best().matmul()),
            options: network.act_options(model.get().config()),
            lengths,
        });
        // SAFETY: the memory has the layout of the block.
        unsafe { Self::begin(block, memory, model, pilot) };
        Ok(block)
    }

    /// Builds a policy without a network in memory of the library.
    pub(crate) fn build_script(model: &ModelBlock, script: Script) -> Result<*mut Self, Fault> {
        let (at, memory) = Memory::allocate(Self::layout(model.get(), None)?)?;
        let block = at.cast::<Self>();
        let pilot = Pilot::Scripted(Scripted::new(script));
        // SAFETY: the memory was just allocated with the layout of the block.
        unsafe { Self::begin(block, memory, model, pilot) };
        Ok(block)
    }

    /// # Safety
    /// `block` can be written, and `memory` is its own.
    unsafe fn begin(block: *mut Self, memory: Memory, model: &ModelBlock, pilot: Pilot) {
        let value = Self {
            seal: Self::seal(block),
            in_use: InUse::new(),
            memory,
            model,
            pilot,
        };
        // SAFETY: the caller's promise.
        unsafe { block.write(value) };
        model.add_user();
    }

    /// Ends a policy.
    ///
    /// # Safety
    /// The conditions of [`check`] hold, and no other thread frees the policy.
    pub(crate) unsafe fn free(at: *mut Self) -> Result<(), Fault> {
        // SAFETY: the caller's promises, passed on.
        unsafe { Self::hold(at) }?.keep();
        // SAFETY: by the mark, only this call uses the block, which is read out whole and not used
        // again.
        let block = unsafe { at.read() };
        // SAFETY: as above; a later call finds no seal.
        unsafe { (&raw mut (*at).seal).write(0) };
        // SAFETY: a model cannot be freed while it has policies.
        unsafe { &*block.model }.drop_user();
        // SAFETY: nothing uses the block any more.
        unsafe { block.memory.release(at.cast()) };
        Ok(())
    }

    /// Marks a policy as being used. No other call uses it while the mark lives.
    ///
    /// # Safety
    /// The conditions of [`check`] hold, and the policy is not freed for `'a`.
    pub(crate) unsafe fn hold<'a>(at: *mut Self) -> Result<Changing<'a>, Fault> {
        // SAFETY: the caller's promises, passed on.
        unsafe { check(at) }?;
        // SAFETY: the block is alive, and only its mark is read.
        unsafe { &(*at).in_use }.change()
    }

    /// Sets how a network's actions follow from its outputs. It affects no other policy.
    ///
    /// # Safety
    /// The caller [holds](PolicyBlock::hold) the policy.
    pub(crate) unsafe fn set_mode(at: *mut Self, mode: jcas_policy::head::Mode) {
        // SAFETY: only this call uses the block.
        if let Pilot::Network(learned) = unsafe { &mut (*at).pilot } {
            learned.options.mode = mode;
        }
    }

    /// Prepares the actions for one state, which is the only part that allocates. The state's model
    /// has this policy's configuration.
    ///
    /// # Safety
    /// The caller [holds](PolicyBlock::hold) the policy.
    pub(crate) unsafe fn plan(
        at: *mut Self,
        whom: Whom,
        timeline: Timeline,
        model: &Model<'_>,
        words: &[u64],
    ) -> Result<(), Fault> {
        // SAFETY: the caller's promise.
        unsafe { Self::check_model(at, model) }?;
        let state = model.state(words)?;
        // SAFETY: only this call uses the block.
        match unsafe { &mut (*at).pilot } {
            Pilot::Network(_) => Ok(()),
            Pilot::Scripted(scripted) => scripted.plan(whom, timeline, model, &state),
        }
    }

    /// Checks that a model has the configuration of a policy.
    ///
    /// # Safety
    /// The caller [holds](PolicyBlock::hold) the policy.
    unsafe fn check_model(at: *mut Self, model: &Model<'_>) -> Result<(), Fault> {
        // SAFETY: never changes while the block lives.
        let own = unsafe { (*at).model };
        // SAFETY: a model cannot be freed while it has policies.
        let own = unsafe { &*own }.get();
        if own.config_hash() == model.config_hash() {
            Ok(())
        } else {
            Err(Fault::Status(JCAS_ERROR_MODEL_MISMATCH))
        }
    }

    /// Returns the controllers of a policy without a network.
    ///
    /// # Safety
    /// The caller [holds](PolicyBlock::hold) the policy, and the mark lives for `'a`.
    pub(crate) unsafe fn scripted<'a>(
        at: *mut Self,
        model: &Model<'_>,
    ) -> Result<Option<&'a mut Scripted>, Fault> {
        // SAFETY: the caller's promise.
        unsafe { Self::check_model(at, model) }?;
        // SAFETY: only the call that holds the policy uses the block.
        Ok(match unsafe { &mut (*at).pilot } {
            Pilot::Network(_) => None,
            Pilot::Scripted(scripted) => Some(scripted),
        })
    }

    /// Returns the policy as the source of the actions of a batch, whose threads may share it.
    ///
    /// # Safety
    /// As [`PolicyBlock::scripted`].
    pub(crate) unsafe fn source<'a>(
        at: *mut Self,
        model: &Model<'_>,
        count: usize,
    ) -> Result<ActionSource<'a>, Fault> {
        // SAFETY: the caller's promise.
        unsafe { Self::check_model(at, model) }?;
        // SAFETY: only the call that holds the policy uses the block.
        match unsafe { &mut (*at).pilot } {
            Pilot::Network(learned) => {
                // SAFETY: the block was laid out with these lengths.
                let weights = unsafe { parts(at, &learned.lengths) }.weights;
                Ok(ActionSource::Network(SharedNetwork { learned, weights }))
            }
            Pilot::Scripted(scripted) => Ok(ActionSource::Scripted(scripted.environments(count)?)),
        }
    }

    /// Makes a policy forget what it remembers.
    ///
    /// # Safety
    /// The caller [holds](PolicyBlock::hold) the policy.
    pub(crate) unsafe fn forget(at: *mut Self) {
        // SAFETY: never changes while the block lives.
        let own = unsafe { (*at).model };
        // SAFETY: a model cannot be freed while it has policies.
        let own = unsafe { &*own }.get();
        // SAFETY: only this call uses the block.
        if let Pilot::Scripted(scripted) = unsafe { &mut (*at).pilot } {
            scripted.forget(own);
        }
    }

    /// Writes the actions for a state that [`PolicyBlock::plan`] has just prepared.
    ///
    /// # Safety
    /// The caller [holds](PolicyBlock::hold) the policy.
    pub(crate) unsafe fn act(
        at: *mut Self,
        whom: Whom,
        model: &Model<'_>,
        words: &[u64],
        actions: &mut [f32],
    ) -> Result<(), Fault> {
        let state = model.state(words)?;
        // SAFETY: only this call uses the block, which does not contain its words.
        match unsafe { &mut (*at).pilot } {
            Pilot::Network(learned) => {
                // SAFETY: the block was laid out with these lengths.
                let parts = unsafe { parts(at, &learned.lengths) };
                let network = SharedNetwork {
                    learned,
                    weights: parts.weights,
                };
                let mut kernel = Scratch::new(model, parts.kernel)?;
                network.act(model, &state, &mut kernel, parts.memory, parts.actions)?;
                actions.copy_from_slice(parts.actions);
                Ok(())
            }
            Pilot::Scripted(scripted) => {
                scripted.write(whom, model, &state, actions);
                Ok(())
            }
        }
    }
}

/// A network whose weights several threads may read, each with working memory of its own.
#[derive(Clone, Copy)]
pub(crate) struct SharedNetwork<'a> {
    learned: &'a Learned,
    weights: &'a [f32],
}

impl SharedNetwork<'_> {
    /// Returns the length of the memory that [`SharedNetwork::act`] works in.
    pub(crate) fn memory_len(&self) -> usize {
        self.learned.lengths.memory()
    }

    /// Observes a state and writes the actions.
    pub(crate) fn act(
        &self,
        model: &Model<'_>,
        state: &StateRef<'_>,
        kernel: &mut Scratch<'_>,
        memory: &mut [f32],
        actions: &mut [f32],
    ) -> Result<(), Fault> {
        let Learned {
            network,
            options,
            lengths,
        } = *self.learned;
        let (scratch, observations) = memory.split_at_mut(lengths.scratch);
        observation::observe(model, state, kernel, observations)?;
        network
            .act(
                self.weights,
                options,
                model,
                state,
                observations,
                scratch,
                actions,
            )
            .map_err(fault)
    }
}
