//! The work of a rollout: each environment of a batch makes several steps, apart from the others.

use std::ffi::c_void;
use std::marker::PhantomData;
use std::sync::PoisonError;

use jcas_core::action::refuse_nan;
use jcas_core::{Error, Model, Scratch, StateRef};
use jcas_simd::InstructionSet;

use crate::batch_job::{Begin, Crew, Range, Shares};
use crate::policy_block::SharedNetwork;
use crate::records::jcas_metrics;
use crate::scripted::{Flown, Place};
use crate::status::{Fault, JCAS_ERROR_RESOURCES};
use crate::sync::{AtomicBool, Mutex};
use crate::timeline::Timeline;

/// Where the actions of a rollout come from.
pub(crate) enum ActionSource<'a> {
    /// A row for each environment and step.
    Given(&'a [f32]),
    /// A trained network.
    Network(SharedNetwork<'a>),
    /// A controller for each environment.
    Scripted(&'a mut [Flown]),
}

impl ActionSource<'_> {
    /// Checks the actions, or that what controllers remember belongs to the states.
    pub(crate) fn check(&self, steps: usize, batch: &RolloutBatch<'_>) -> Result<(), Fault> {
        let model = batch.model;
        match self {
            Self::Network(_) => Ok(()),
            Self::Given(actions) => {
                let each = actions.chunks_exact(steps * model.action_len());
                for (m, rows) in each.enumerate() {
                    for row in rows.chunks_exact(model.action_len()) {
                        refuse_nan(row).map_err(|error| Fault::Environment(m, error))?;
                    }
                }
                Ok(())
            }
            Self::Scripted(controllers) => {
                let states = batch.states.chunks_exact(model.state_words());
                for ((words, flown), &timeline) in
                    states.zip(controllers.iter()).zip(batch.timelines)
                {
                    let state = model.state(words)?;
                    if !(state.terminated() || state.truncated()) {
                        flown.remembers(Place::of(timeline, &state))?;
                    }
                }
                Ok(())
            }
        }
    }
}

/// The environments of a rollout.
pub(crate) struct RolloutBatch<'a> {
    pub(crate) model: &'a Model<'a>,
    pub(crate) timelines: &'a [Timeline],
    pub(crate) states: &'a mut [u64],
    /// Working memory of each share.
    pub(crate) scratch: &'a mut [u64],
}

/// Declares the outputs of a rollout: each has a name, a type and its elements per environment.
macro_rules! outputs {
    ($model:ident: $( $name:ident: $type:ty, $each:expr; )+) => {
        /// The outputs of a rollout, each of which may be empty.
        pub(crate) struct RolloutOut<'a> {
            $( pub(crate) $name: &'a mut [$type], )+
        }

        /// The start of each output.
        struct Outputs {
            $( $name: Begin<$type>, )+
        }

        impl Outputs {
            fn of(out: RolloutOut<'_>) -> Self {
                Self { $( $name: Begin::of(out.$name), )+ }
            }

            /// Returns the outputs of the environments `range`.
            ///
            /// # Safety
            /// As [`Begin::part`] for each output.
            unsafe fn part<'a>(&self, range: &Range, $model: &Model<'_>) -> RolloutOut<'a> {
                // SAFETY: the caller's promise.
                unsafe { RolloutOut { $( $name: self.$name.part(range, $each), )+ } }
            }
        }
    };
}

outputs! { model:
    returns: f64, 1;
    steps: u32, 1;
    terminated: u8, 1;
    truncated: u8, 1;
    metrics: jcas_metrics, 1;
    snapshots: u8, model.save_len();
}

/// What an environment has made of its steps.
#[derive(Clone, Copy, Default)]
struct Made {
    total: f64,
    steps: u32,
}

impl RolloutOut<'_> {
    /// Writes the outputs of the environment at an index, in the state that it came to.
    fn write(
        &mut self,
        index: usize,
        made: Made,
        model: &Model<'_>,
        words: &[u64],
    ) -> Result<(), Error> {
        let state = model.state(words)?;
        put(self.returns, index, || made.total);
        put(self.steps, index, || made.steps);
        put(self.terminated, index, || state.terminated().into());
        put(self.truncated, index, || state.truncated().into());
        put(self.metrics, index, || jcas_metrics::of(&state.metrics()));
        match self.snapshots.chunks_exact_mut(model.save_len()).nth(index) {
            Some(bytes) => model.save(words, bytes),
            None => Ok(()),
        }
    }
}

fn put<T>(buffer: &mut [T], index: usize, value: impl FnOnce() -> T) {
    if let Some(place) = buffer.get_mut(index) {
        *place = value();
    }
}

/// A rollout of a batch, with all buffers that it reads and writes.
pub(crate) struct RolloutJob<'a> {
    model: &'a Model<'a>,
    count: usize,
    steps: usize,
    timelines: &'a [Timeline],
    states: Begin<u64>,
    scratch: Begin<u64>,
    source: SharedSource<'a>,
    out: Outputs,
    shares: Shares<'a>,
    /// The refusal of the first environment that refused a step, and its index.
    refused: Mutex<Option<(usize, Fault)>>,
    buffers: PhantomData<&'a mut [u64]>,
}

/// A source that the threads divide.
enum SharedSource<'a> {
    Given(&'a [f32]),
    Network(SharedNetwork<'a>),
    Scripted(Begin<Flown>),
}

/// What the environments of a share take their actions from.
enum ShareSource<'a> {
    Given(&'a [f32]),
    Network(SharedNetwork<'a>, Vec<f32>, Vec<f32>),
    Scripted(&'a mut [Flown], Vec<f32>),
}

/// Returns this many zeros.
fn zeros(count: usize) -> Result<Vec<f32>, Fault> {
    let mut zeros = Vec::new();
    zeros
        .try_reserve_exact(count)
        .map_err(|_| Fault::Status(JCAS_ERROR_RESOURCES))?;
    zeros.resize(count, 0.0);
    Ok(zeros)
}

impl<'a> RolloutJob<'a> {
    pub(crate) fn new(
        batch: RolloutBatch<'a>,
        steps: usize,
        source: ActionSource<'a>,
        out: RolloutOut<'a>,
        taken: &'a [AtomicBool],
    ) -> Self {
        Self {
            model: batch.model,
            count: batch.timelines.len(),
            steps,
            timelines: batch.timelines,
            states: Begin::of(batch.states),
            scratch: Begin::of(batch.scratch),
            source: match source {
                ActionSource::Given(actions) => SharedSource::Given(actions),
                ActionSource::Network(network) => SharedSource::Network(network),
                ActionSource::Scripted(each) => SharedSource::Scripted(Begin::of(each)),
            },
            out: Outputs::of(out),
            shares: Shares::new(taken),
            refused: Mutex::new(None),
            buffers: PhantomData,
        }
    }

    /// Rolls every environment out. One that refuses a step stays where it is, and the others go
    /// on, so that the result does not depend on the threads.
    pub(crate) fn run(self, crew: Crew<'_>) -> Result<(), Fault> {
        let context = (&raw const self).cast_mut().cast();
        let work = |index| {
            self.share(index);
            Ok(())
        };
        self.shares.run(crew, take_share, context, work)?;
        let refused = self.refused.lock().unwrap_or_else(PoisonError::into_inner);
        refused.map_or(Ok(()), |(_, fault)| Err(fault))
    }

    fn refuse(&self, environment: usize, fault: Fault) {
        let mut refused = self.refused.lock().unwrap_or_else(PoisonError::into_inner);
        if refused.is_none_or(|(first, _)| environment < first) {
            *refused = Some((environment, fault));
        }
    }

    /// Rolls the environments of a share out.
    fn share(&self, index: usize) {
        let range = Range::of_share(self.count, index, self.shares.len());
        // SAFETY: lengths were checked against the model, and only one thread takes a share.
        let (states, scratch, mut out) = unsafe {
            (
                self.states.part(&range, self.model.state_words()),
                (self.scratch).part(&Range::one(index), Scratch::words_for(self.model)),
                self.out.part(&range, self.model),
            )
        };
        let begun = Scratch::new(self.model, scratch).map_err(Fault::from);
        let begun = begun.and_then(|scratch| Ok((scratch, self.source_of(&range)?)));
        let (mut scratch, mut source) = match begun {
            Ok(begun) => begun,
            Err(fault) => return self.refuse(range.begin, fault),
        };
        for (own, words) in states
            .chunks_exact_mut(self.model.state_words())
            .enumerate()
        {
            let m = range.begin + own;
            let mut made = Made::default();
            let rolled = self.environment((m, own), words, &mut scratch, &mut source, &mut made);
            let written = out.write(own, made, self.model, words);
            if let Err(fault) = rolled.and(written.map_err(Fault::from)) {
                self.refuse(m, fault);
            }
        }
    }

    /// Steps an environment, which has one index in the batch and one in its share.
    fn environment(
        &self,
        (m, own): (usize, usize),
        words: &mut [u64],
        scratch: &mut Scratch<'_>,
        source: &mut ShareSource<'_>,
        made: &mut Made,
    ) -> Result<(), Fault> {
        let (model, set) = (self.model, InstructionSet::best());
        for step in 0..self.steps {
            let state = model.state(words)?;
            if state.terminated() || state.truncated() {
                break;
            }
            let row = own * self.steps + step;
            let place = Place::of(self.timelines[m], &state);
            let actions = source.act(own, row, place, model, &state, scratch)?;
            let outcome = set.step(model, &mut model.state_mut(words)?, scratch, actions)?;
            made.total += outcome.reward;
            made.steps += 1;
        }
        Ok(())
    }

    /// Returns what the environments of a share take their actions from.
    fn source_of(&self, range: &Range) -> Result<ShareSource<'a>, Fault> {
        let action_len = self.model.action_len();
        Ok(match &self.source {
            SharedSource::Given(actions) => {
                let each = self.steps * action_len;
                ShareSource::Given(&actions[range.begin * each..range.end * each])
            }
            SharedSource::Network(network) => {
                let memory = zeros(network.memory_len())?;
                ShareSource::Network(*network, memory, zeros(action_len)?)
            }
            SharedSource::Scripted(controllers) => {
                // SAFETY: there is a controller for each environment, and one thread has a share.
                let own = unsafe { controllers.part(range, 1) };
                ShareSource::Scripted(own, zeros(action_len)?)
            }
        })
    }
}

impl ShareSource<'_> {
    /// Returns the actions of an environment of the share in a state: a given row, or those that
    /// the policy chooses.
    fn act(
        &mut self,
        own: usize,
        row: usize,
        place: Place,
        model: &Model<'_>,
        state: &StateRef<'_>,
        scratch: &mut Scratch<'_>,
    ) -> Result<&[f32], Fault> {
        match self {
            Self::Given(rows) => {
                let len = model.action_len();
                Ok(&rows[row * len..(row + 1) * len])
            }
            Self::Network(network, memory, actions) => {
                network.act(model, state, scratch, memory, actions)?;
                Ok(actions)
            }
            Self::Scripted(controllers, actions) => {
                let flown = &mut controllers[own];
                flown.plan(place, model, state)?;
                flown.write(model, state, actions);
                Ok(actions)
            }
        }
    }
}

/// Runs a share as a task.
///
/// # Safety
/// `job` is a [`RolloutJob`] that lives until the task ends.
unsafe extern "C" fn take_share(job: *mut c_void, index: u32) {
    // SAFETY: the caller's promise; threads share a job and divide its buffers by its shares.
    let job = unsafe { &*job.cast::<RolloutJob<'_>>() };
    let index = index as usize;
    let work = || {
        job.share(index);
        Ok(())
    };
    job.shares.take(index, work);
}
