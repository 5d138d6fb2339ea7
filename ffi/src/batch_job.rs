//! Work on a batch, divided into shares that any number of threads may take, and one step of it.

use std::ffi::c_void;
use std::marker::PhantomData;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::slice;

use jcas_core::batch::{BatchLens, BatchOut};
use jcas_core::header::Phase;
use jcas_core::{Error, Metrics, Model, Scratch};
use jcas_simd::InstructionSet;

use crate::status::{Fault, JCAS_ERROR_ARGUMENT, JCAS_ERROR_INTERNAL};
use crate::sync::{AtomicBool, AtomicUsize, Ordering, yield_now};
use crate::thread_pool::{Job, Task, ThreadPool};

/// The caller's function that runs tasks, and its context.
#[derive(Clone, Copy)]
pub(crate) struct Runner {
    pub(crate) run: unsafe extern "C" fn(Option<Task>, *mut c_void, u32, *mut c_void),
    pub(crate) context: *mut c_void,
}

impl Runner {
    pub(crate) fn run(&self, job: Job) {
        // SAFETY: the caller promised a function that runs tasks and returns when they are done.
        unsafe { (self.run)(Some(job.task), job.context, job.count, self.context) };
    }
}

/// The threads that do the work of a batch.
#[derive(Clone, Copy)]
pub(crate) enum Crew<'a> {
    /// The caller's thread alone.
    Caller,
    /// The batch's own threads, with the caller's.
    Pool(&'a ThreadPool),
    /// The caller's function.
    Runner(Runner),
}

/// The start of an optional buffer.
pub(crate) struct Begin<T>(Option<*mut T>);

impl<T> Begin<T> {
    pub(crate) fn of(buffer: &mut [T]) -> Self {
        Self((!buffer.is_empty()).then_some(buffer.as_mut_ptr()))
    }

    /// Returns the elements `range` · `each` of the buffer, or an empty slice without a buffer.
    ///
    /// # Safety
    /// The buffer is as long as the batch needs, and no two shares ask for the same range.
    pub(crate) unsafe fn part<'a>(&self, range: &Range, each: usize) -> &'a mut [T] {
        match self.0 {
            None => &mut [],
            // SAFETY: within the buffer by the caller's promise.
            Some(at) => unsafe {
                slice::from_raw_parts_mut(at.add(range.begin * each), range.len() * each)
            },
        }
    }
}

/// A range of environments.
pub(crate) struct Range {
    pub(crate) begin: usize,
    pub(crate) end: usize,
}

impl Range {
    /// Returns the environments of a share, of `count`.
    pub(crate) const fn of_share(count: usize, index: usize, shares: usize) -> Self {
        Self {
            begin: count * index / shares,
            end: count * (index + 1) / shares,
        }
    }

    /// Returns the element of a share in a buffer with one for each.
    pub(crate) const fn one(index: usize) -> Self {
        Self {
            begin: index,
            end: index + 1,
        }
    }

    pub(crate) const fn len(&self) -> usize {
        self.end - self.begin
    }
}

/// The shares of a job, of which exactly one thread takes each.
pub(crate) struct Shares<'a> {
    taken: &'a [AtomicBool],
    finished: AtomicUsize,
    failed: AtomicBool,
}

impl<'a> Shares<'a> {
    /// Builds shares of which none is taken.
    pub(crate) fn new(taken: &'a [AtomicBool]) -> Self {
        for share in taken {
            share.store(false, Ordering::Relaxed);
        }
        Self {
            taken,
            finished: AtomicUsize::new(0),
            failed: AtomicBool::new(false),
        }
    }

    pub(crate) fn len(&self) -> usize {
        self.taken.len()
    }

    /// Whether any thread has taken a share.
    pub(crate) fn any_taken(&self) -> bool {
        self.taken.iter().any(|share| share.load(Ordering::Relaxed))
    }

    /// Does the work of a share, unless another thread has taken it. A panic or an error is a
    /// failure of the job.
    pub(crate) fn take(&self, index: usize, work: impl FnOnce() -> Result<(), Error>) {
        let Some(share) = self.taken.get(index) else {
            return;
        };
        if share.swap(true, Ordering::AcqRel) {
            return;
        }
        let done = catch_unwind(AssertUnwindSafe(work));
        if !matches!(done, Ok(Ok(()))) {
            self.failed.store(true, Ordering::Relaxed);
        }
        self.finished.fetch_add(1, Ordering::Release);
    }

    /// Does the work of every share. `task` takes a share of the job behind `context`.
    pub(crate) fn run(
        &self,
        crew: Crew<'_>,
        task: Task,
        context: *mut c_void,
        work: impl FnMut(usize) -> Result<(), Error>,
    ) -> Result<(), Fault> {
        let job = Job {
            task,
            context,
            count: self.len() as u32,
        };
        match crew {
            Crew::Caller => {}
            Crew::Pool(pool) => pool.run(job),
            Crew::Runner(runner) => {
                runner.run(job);
                if !self.any_taken() {
                    return Err(Fault::Because(
                        JCAS_ERROR_ARGUMENT,
                        "run returned before it had run a task of the step",
                    ));
                }
            }
        }
        self.finish(work)
    }

    /// Does the work of the shares that no thread has taken, and waits for the others.
    pub(crate) fn finish(
        &self,
        mut work: impl FnMut(usize) -> Result<(), Error>,
    ) -> Result<(), Fault> {
        for index in 0..self.len() {
            self.take(index, || work(index));
        }
        while self.finished.load(Ordering::Acquire) < self.len() {
            yield_now();
        }
        if self.failed.load(Ordering::Relaxed) {
            return Err(Fault::Status(JCAS_ERROR_INTERNAL));
        }
        Ok(())
    }
}

/// Declares the start of each output of a batch step.
macro_rules! outputs {
    ($( $name:ident: $type:ty; )+) => {
        /// The start of each output of a batch step.
        struct Outputs {
            $( $name: Begin<$type>, )+
        }

        impl Outputs {
            fn of(out: BatchOut<'_>) -> Self {
                Self { $( $name: Begin::of(out.$name), )+ }
            }

            /// Returns the buffers of the environments `range`.
            ///
            /// # Safety
            /// As [`Begin::part`] for each buffer.
            unsafe fn part<'a>(&self, range: &Range, lens: &BatchLens) -> BatchOut<'a> {
                // SAFETY: the caller's promise.
                unsafe { BatchOut { $( $name: self.$name.part(range, lens.$name), )+ } }
            }
        }
    };
}

jcas_core::for_each_batch_output!(outputs);

/// One step of a batch, with all buffers that it reads and writes.
pub(crate) struct BatchJob<'a> {
    model: &'a Model<'a>,
    count: usize,
    auto_reset: bool,
    states: Begin<u64>,
    scratch: Begin<u64>,
    actions: &'a [f32],
    out: Outputs,
    shares: Shares<'a>,
    buffers: PhantomData<&'a mut [u64]>,
}

impl<'a> BatchJob<'a> {
    pub(crate) fn new(
        model: &'a Model<'a>,
        states: &'a mut [u64],
        scratch: &'a mut [u64],
        actions: &'a [f32],
        auto_reset: bool,
        out: BatchOut<'a>,
        taken: &'a [AtomicBool],
    ) -> Self {
        Self {
            model,
            count: states.len() / model.state_words(),
            auto_reset,
            states: Begin::of(states),
            scratch: Begin::of(scratch),
            actions,
            out: Outputs::of(out),
            shares: Shares::new(taken),
            buffers: PhantomData,
        }
    }

    /// Steps every environment.
    pub(crate) fn run(&self, crew: Crew<'_>) -> Result<(), Fault> {
        let context = (&raw const *self).cast_mut().cast();
        (self.shares).run(crew, take_share, context, |index| self.step(index))
    }

    fn step(&self, index: usize) -> Result<(), Error> {
        let model = self.model;
        let shares = self.shares.len();
        let range = Range::of_share(self.count, index, shares);
        let own = Range::one(index);
        let action_len = model.action_len();
        let actions = &self.actions[range.begin * action_len..range.end * action_len];
        // SAFETY: lengths were checked against the model, and only one thread takes a share.
        let (states, scratch, mut out) = unsafe {
            (
                self.states.part(&range, model.state_words()),
                self.scratch.part(&own, Scratch::words_for(model)),
                self.out.part(&range, &BatchLens::of(model)),
            )
        };
        let mut scratch = Scratch::new(model, scratch)?;
        InstructionSet::best().batch_step(
            model,
            states,
            &mut scratch,
            actions,
            self.auto_reset,
            &mut out,
        )
    }
}

/// Runs a share as a task.
///
/// # Safety
/// `job` is a [`BatchJob`] that lives until the task ends.
unsafe extern "C" fn take_share(job: *mut c_void, index: u32) {
    // SAFETY: the caller's promise; threads share a job and divide its buffers by its shares.
    let job = unsafe { &*job.cast::<BatchJob<'_>>() };
    let index = index as usize;
    job.shares.take(index, || job.step(index));
}

/// Checks that no environment would refuse a step.
pub(crate) fn check_ready(model: &Model<'_>, states: &[u64]) -> Result<(), Fault> {
    check_phases(model, states, false)
}

/// Checks that no environment is in the middle of a step.
pub(crate) fn check_between_steps(model: &Model<'_>, states: &[u64]) -> Result<(), Fault> {
    check_phases(model, states, true)
}

fn check_phases(model: &Model<'_>, states: &[u64], over: bool) -> Result<(), Fault> {
    for (index, words) in states.chunks_exact(model.state_words()).enumerate() {
        let error = match model.state(words)?.header.phase() {
            Some(Phase::Ready) => continue,
            Some(phase) if phase.is_over() && over => continue,
            Some(phase) if phase.is_over() => Error::EpisodeOver,
            _ => Error::OutOfOrder {
                called: "batch_step",
                after: "step_end",
            },
        };
        return Err(Fault::Environment(index, error));
    }
    Ok(())
}
