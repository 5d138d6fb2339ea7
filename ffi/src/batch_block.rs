//! The memory block of a batch: its states, and a share of the working memory for each task.
//!
//! | part | content |
//! | --- | --- |
//! | [`BatchBlock`] | the mark of calls, the pool of threads, sizes, where the other parts begin |
//! | words | the states, two spare states, the working memory of each share |
//! | metrics | the metrics of ended episodes, while a step passes them on |
//! | timelines | the timeline of each environment |
//! | taken | one flag a share: whether a thread has taken it in the present step |
//! | threads | handles of the batch's own threads |

use std::alloc::Layout;
use std::slice;

use jcas_core::batch::BatchOut;
use jcas_core::{Error, Metrics, Model, Scratch, action, hash};

use crate::batch_job::{BatchJob, Crew, Runner, check_between_steps, check_ready};
use crate::handle::{Block, Kind, Memory, check};
use crate::in_use::{Changing, InUse, Reading};
use crate::model_block::ModelBlock;
use crate::rollout_job::{ActionSource, RolloutBatch, RolloutJob, RolloutOut};
use crate::status::{Fault, JCAS_ERROR_ARGUMENT, JCAS_ERROR_FORKED, JCAS_ERROR_RESOURCES};
use crate::sync::AtomicBool;
use crate::thread_pool::{Thread, ThreadPool, join, processors, start};
use crate::timeline::Timeline;

/// Shares of a batch for each thread, enough that no thread waits long for another at the end.
const SHARES_PER_THREAD: usize = 4;

#[repr(C)]
pub(crate) struct BatchBlock {
    seal: u64,
    in_use: InUse,
    pool: ThreadPool,
    batch: Batch,
}

/// The part of a batch that calls read and change.
pub(crate) struct Batch {
    /// The block that contains this part.
    block: *mut BatchBlock,
    memory: Memory,
    model: *const ModelBlock,
    shape: BatchShape,
    parts: BatchParts,
    /// The process that started the threads; a forked process does not have them.
    process: u32,
    /// Whether every environment is known to be ready for a step. The states are in the caches of
    /// other threads, so checking each of them takes a tenth of a step.
    ready: bool,
    pub(crate) refusal: Option<Fault>,
}

// SAFETY: `repr(C)`, the seal comes first.
unsafe impl Block for BatchBlock {
    const KIND: Kind = Kind::Batch;
}

/// The size of a batch and the threads that step it.
#[derive(Clone, Copy)]
pub(crate) struct BatchShape {
    pub(crate) count: usize,
    /// Worker threads, without the caller's thread.
    threads: usize,
    shares: usize,
    runner: Option<Runner>,
}

/// The offsets of the parts behind a block, in bytes from its start.
#[derive(Clone, Copy)]
struct BatchParts {
    words: usize,
    metrics: usize,
    timelines: usize,
    taken: usize,
    threads: usize,
}

/// The lengths of the buffers of a batch, in elements.
#[derive(Clone, Copy)]
pub(crate) struct Sizes {
    pub(crate) count: usize,
    pub(crate) actions: usize,
    pub(crate) observations: usize,
    pub(crate) global: usize,
    pub(crate) snapshots: usize,
}

impl BatchShape {
    /// `threads` is the caller's argument: 0 means one for each processor. With a runner it is the
    /// number of tasks.
    pub(crate) fn new(count: usize, threads: usize, runner: Option<Runner>) -> Result<Self, Fault> {
        if count == 0 {
            return Err(Fault::Status(JCAS_ERROR_ARGUMENT));
        }
        let wanted = if threads == 0 { processors() } else { threads }.min(count);
        let (threads, shares) = match (runner, wanted) {
            (Some(_), tasks) => (0, tasks),
            (None, 1) => (0, 1),
            (None, threads) => (threads - 1, count.min(SHARES_PER_THREAD * threads)),
        };
        Ok(Self {
            count,
            threads,
            shares,
            runner,
        })
    }

    fn words(&self, model: &Model<'_>) -> Option<usize> {
        let states = (self.count.checked_add(2)?).checked_mul(model.state_words())?;
        let scratch = self.shares.checked_mul(Scratch::words_for(model))?;
        states.checked_add(scratch)
    }

    pub(crate) fn layout(&self, model: &Model<'_>) -> Result<Layout, Fault> {
        Ok(self.parts(model)?.0)
    }

    fn parts(&self, model: &Model<'_>) -> Result<(Layout, BatchParts), Fault> {
        let scarce = Fault::Status(JCAS_ERROR_RESOURCES);
        let lay_out = || {
            let words = Layout::array::<u64>(self.words(model)?).ok()?;
            let metrics = Layout::array::<Metrics>(self.count).ok()?;
            let timelines = Layout::array::<Timeline>(self.count).ok()?;
            let taken = Layout::array::<AtomicBool>(self.shares).ok()?;
            let threads = Layout::array::<Thread>(self.threads).ok()?;
            let (layout, words) = Layout::new::<BatchBlock>().extend(words).ok()?;
            let (layout, metrics) = layout.extend(metrics).ok()?;
            let (layout, timelines) = layout.extend(timelines).ok()?;
            let (layout, taken) = layout.extend(taken).ok()?;
            let (layout, threads) = layout.extend(threads).ok()?;
            let parts = BatchParts {
                words,
                metrics,
                timelines,
                taken,
                threads,
            };
            Some((layout.pad_to_align(), parts))
        };
        lay_out().ok_or(scarce)
    }
}

/// The parts of an open batch.
struct BatchMut<'a> {
    model: &'static Model<'static>,
    states: &'a mut [u64],
    spare: &'a mut [u64],
    scratch: &'a mut [u64],
    metrics: &'a mut [Metrics],
    taken: &'a [AtomicBool],
}

impl BatchBlock {
    /// Builds a batch in memory that has its layout.
    ///
    /// # Safety
    /// `at` and `memory` come from [`Memory`] with [`BatchShape::layout`] of this model.
    pub(crate) unsafe fn build(
        model: &ModelBlock,
        shape: BatchShape,
        (at, memory): (*mut u8, Memory),
    ) -> Result<*mut Self, Fault> {
        let block = at.cast::<Self>();
        let parts = shape.parts(model.get())?.1;
        // SAFETY: the layout has room for all parts; all zero bits are valid words, metrics and
        // flags.
        unsafe { at.write_bytes(0, memory.size()) };
        let value = Self {
            seal: Self::seal(block),
            in_use: InUse::new(),
            pool: ThreadPool::new(shape.threads as u32),
            batch: Batch {
                block,
                memory,
                model,
                shape,
                parts,
                process: std::process::id(),
                ready: false,
                refusal: None,
            },
        };
        // SAFETY: the block is in front of the other parts and aligned by the layout.
        unsafe { block.write(value) };
        // SAFETY: just built, and no other call has it.
        unsafe { &mut (*block).batch }
            .each_mut(|model, _, words, scratch| model.reset(words, scratch, 0))?;
        // SAFETY: as above; the block is not moved while threads work in its pool.
        if let Err(fault) = unsafe { Self::start_threads(block) } {
            // SAFETY: as above; the handle has not been given out.
            unsafe { (&raw mut (*block).seal).write(0) };
            // SAFETY: the threads have ended.
            unsafe { memory.release(at) };
            return Err(fault);
        }
        model.add_user();
        Ok(block)
    }

    /// Starts all worker threads of a batch, or none.
    ///
    /// # Safety
    /// A batch that was just built.
    unsafe fn start_threads(block: *mut Self) -> Result<(), Fault> {
        // SAFETY: the caller's promise; only shared parts of the block are used from here on.
        let (batch, pool) = unsafe { (&(*block).batch, &(*block).pool) };
        for index in 0..batch.shape.threads {
            // SAFETY: the pool stays in the block until `stop_threads`.
            let Some(thread) = (unsafe { start(pool) }) else {
                // SAFETY: `count` threads were started.
                unsafe { Self::stop_threads(block, index) };
                return Err(Fault::Status(JCAS_ERROR_RESOURCES));
            };
            // SAFETY: the layout has room for this many.
            unsafe { batch.threads().add(index).write(thread) };
        }
        Ok(())
    }

    /// Stops threads and joins them.
    ///
    /// # Safety
    /// A batch of which `count` threads were started in this process, and none was stopped.
    unsafe fn stop_threads(block: *mut Self, count: usize) {
        if count == 0 {
            return;
        }
        // SAFETY: the caller's promise; only shared parts of the block are used.
        let (batch, pool) = unsafe { (&(*block).batch, &(*block).pool) };
        pool.quit();
        for index in 0..count {
            // SAFETY: written when the thread was started, and read once.
            let thread = unsafe { batch.threads().add(index).read() };
            // SAFETY: the caller's promise.
            unsafe { join(thread) };
        }
    }

    /// Ends a batch.
    ///
    /// # Safety
    /// The conditions of [`check`] hold, and no other thread frees the batch.
    pub(crate) unsafe fn free(at: *mut Self) -> Result<(), Fault> {
        // SAFETY: the caller's promises, passed on.
        unsafe { check(at) }?;
        // SAFETY: the block is alive, and only its mark is read.
        unsafe { &(*at).in_use }.change()?.keep();
        // SAFETY: by the mark, only this call and the batch's own threads use the block.
        let batch = unsafe { &(*at).batch };
        let memory = batch.memory;
        // A forked process has no threads to join.
        if !batch.is_forked() {
            // SAFETY: started when the batch was built.
            unsafe { Self::stop_threads(at, batch.shape.threads) };
        }
        // SAFETY: a model cannot be freed while it has batches.
        unsafe { &*batch.model }.drop_user();
        // SAFETY: no call uses the block any more; a later one finds no seal.
        unsafe { (&raw mut (*at).seal).write(0) };
        // SAFETY: nothing uses the block any more.
        unsafe { memory.release(at.cast()) };
        Ok(())
    }

    /// Opens a batch for change. No other call uses it while the mark lives.
    ///
    /// # Safety
    /// The conditions of [`check`] hold, and the batch is not freed for `'a`.
    pub(crate) unsafe fn open<'a>(at: *mut Self) -> Result<(&'a mut Batch, Changing<'a>), Fault> {
        // SAFETY: the caller's promises, passed on.
        unsafe { check(at) }?;
        // SAFETY: the block is alive, and only its mark is read.
        let mark = unsafe { &(*at).in_use }.change()?;
        // SAFETY: by the mark, only this call uses the batch; its threads use the pool.
        Ok((unsafe { &mut (*at).batch }, mark))
    }

    /// Opens a batch to read. No call changes it while the mark lives.
    ///
    /// # Safety
    /// The conditions of [`check`] hold, and the batch is not freed for `'a`.
    pub(crate) unsafe fn see<'a>(at: *const Self) -> Result<(&'a Batch, Reading<'a>), Fault> {
        // SAFETY: the caller's promises, passed on.
        unsafe { check(at) }?;
        // SAFETY: the block is alive, and only its mark is read.
        let mark = unsafe { &(*at).in_use }.read()?;
        // SAFETY: by the mark, no call changes the batch.
        Ok((unsafe { &(*at).batch }, mark))
    }
}

impl Batch {
    fn is_forked(&self) -> bool {
        self.shape.threads > 0 && self.process != std::process::id()
    }

    /// Returns a pointer to a part behind the block.
    fn part<T>(&self, offset: usize) -> *mut T {
        self.block.cast::<u8>().wrapping_add(offset).cast()
    }

    fn threads(&self) -> *mut Thread {
        self.part(self.parts.threads)
    }

    pub(crate) fn model(&self) -> &'static Model<'static> {
        // SAFETY: a model cannot be freed while it has batches, and the reference is not kept in
        // one.
        unsafe { &*self.model }.get()
    }

    pub(crate) fn sizes(&self) -> Sizes {
        let (model, count) = (self.model(), self.shape.count);
        Sizes {
            count,
            actions: count * model.action_len(),
            observations: count * model.uav_count() * model.observation_len(),
            global: count * model.global_len(),
            snapshots: count * model.save_len(),
        }
    }

    fn states(&self) -> &[u64] {
        let count = self.shape.count * self.model().state_words();
        // SAFETY: the words begin with the states, initialised when the batch was built.
        unsafe { slice::from_raw_parts(self.part(self.parts.words), count) }
    }

    fn parts_mut(&mut self) -> BatchMut<'_> {
        self.ready = false;
        let model = self.model();
        let (shape, parts) = (self.shape, self.parts);
        let count = shape.words(model).unwrap_or(0);
        // SAFETY: laid out behind the block by `BatchShape::parts`, initialised when it was built.
        let words = unsafe { slice::from_raw_parts_mut(self.part(parts.words), count) };
        // SAFETY: as above; no part overlaps another.
        let metrics = unsafe { slice::from_raw_parts_mut(self.part(parts.metrics), shape.count) };
        // SAFETY: as above.
        let taken = unsafe { slice::from_raw_parts(self.part(parts.taken), shape.shares) };
        let (states, rest) = words.split_at_mut(shape.count * model.state_words());
        let (spare, scratch) = rest.split_at_mut(2 * model.state_words());
        BatchMut {
            model,
            states,
            spare,
            scratch,
            metrics,
            taken,
        }
    }

    pub(crate) fn state(&self, index: usize) -> Result<&[u64], Fault> {
        let mut states = self.states().chunks_exact(self.model().state_words());
        states.nth(index).ok_or(Fault::Status(JCAS_ERROR_ARGUMENT))
    }

    /// Returns the timeline of an environment, which [`Batch::state`] has.
    pub(crate) fn timeline(&self, index: usize) -> Timeline {
        // SAFETY: laid out behind the block, initialised when it was built.
        let all = unsafe {
            slice::from_raw_parts(
                self.part::<Timeline>(self.parts.timelines),
                self.shape.count,
            )
        };
        all[index]
    }

    /// Begins a timeline for an environment whose state was replaced.
    pub(crate) fn renew(&mut self, index: usize) {
        let at = self.part::<Timeline>(self.parts.timelines);
        // SAFETY: as for `timeline`, and by the exclusive reference only this call uses them.
        let all = unsafe { slice::from_raw_parts_mut(at, self.shape.count) };
        all[index] = Timeline::renewed();
    }

    /// Replaces the state of an environment.
    pub(crate) fn replace(&mut self, index: usize, words: &[u64]) -> Result<(), Fault> {
        let BatchMut { model, states, .. } = self.parts_mut();
        let mut states = states.chunks_exact_mut(model.state_words());
        let state = states.nth(index);
        let state = state.ok_or(Fault::Status(JCAS_ERROR_ARGUMENT))?;
        state.copy_from_slice(words);
        self.renew(index);
        Ok(())
    }

    /// Visits every environment on this thread.
    pub(crate) fn each_mut(
        &mut self,
        mut visit: impl FnMut(&Model<'_>, usize, &mut [u64], &mut Scratch<'_>) -> Result<(), Error>,
    ) -> Result<(), Fault> {
        let BatchMut {
            model,
            states,
            scratch,
            ..
        } = self.parts_mut();
        let mut scratch = Scratch::new(model, scratch)?;
        for (m, words) in states.chunks_exact_mut(model.state_words()).enumerate() {
            visit(model, m, words, &mut scratch)?;
        }
        Ok(())
    }

    /// Returns the fingerprint of all states in their order.
    pub(crate) fn hash(&self) -> u64 {
        hash::words(self.states())
    }

    /// Saves every environment as consecutive snapshots.
    pub(crate) fn save(&self, out: &mut [u8]) -> Result<(), Fault> {
        let model = self.model();
        let states = self.states().chunks_exact(model.state_words());
        for (words, bytes) in states.zip(out.chunks_exact_mut(model.save_len())) {
            model.save(words, bytes)?;
        }
        Ok(())
    }

    /// Loads every environment, after a check of all snapshots.
    pub(crate) fn load(&mut self, saved: &[u8]) -> Result<(), Fault> {
        let BatchMut {
            model,
            states,
            spare,
            ..
        } = self.parts_mut();
        let (trial, spare) = spare.split_at_mut(model.state_words());
        for bytes in saved.chunks_exact(model.save_len()) {
            model.load(bytes, trial, spare)?;
        }
        let states = states.chunks_exact_mut(model.state_words());
        for (words, bytes) in states.zip(saved.chunks_exact(model.save_len())) {
            model.load(bytes, words, spare)?;
        }
        (0..self.shape.count).for_each(|index| self.renew(index));
        Ok(())
    }

    /// Returns the threads that do the work of this batch, in the process that built it.
    fn crew(&self) -> Crew<'static> {
        match self.shape.runner {
            Some(runner) => Crew::Runner(runner),
            None if self.shape.threads == 0 => Crew::Caller,
            // SAFETY: the block lives as long as the batch; its threads share the pool with a call.
            None => Crew::Pool(unsafe { &(*self.block).pool }),
        }
    }

    /// Puts a state in the place of every environment, with seeds of their own or its seed.
    pub(crate) fn fork(&mut self, words: &[u64], seeds: &[u64]) -> Result<(), Fault> {
        let BatchMut { model, states, .. } = self.parts_mut();
        for (m, state) in states.chunks_exact_mut(model.state_words()).enumerate() {
            state.copy_from_slice(words);
            if let Some(&seed) = seeds.get(m) {
                model.reseed(state, seed)?;
            }
        }
        (0..self.shape.count).for_each(|index| self.renew(index));
        Ok(())
    }

    /// Steps every environment several times, until its episode ends.
    pub(crate) fn roll_out(
        &mut self,
        steps: usize,
        source: ActionSource<'_>,
        out: RolloutOut<'_>,
    ) -> Result<(), Fault> {
        if self.is_forked() {
            return Err(Fault::Status(JCAS_ERROR_FORKED));
        }
        let (crew, timelines) = (self.crew(), self.part(self.parts.timelines));
        // SAFETY: laid out behind the block, initialised when it was built; no step changes them.
        let timelines = unsafe { slice::from_raw_parts(timelines, self.shape.count) };
        let BatchMut {
            model,
            states,
            scratch,
            taken,
            ..
        } = self.parts_mut();
        check_between_steps(model, states)?;
        let batch = RolloutBatch {
            model,
            timelines,
            states,
            scratch,
        };
        source.check(steps, &batch)?;
        RolloutJob::new(batch, steps, source, out, taken).run(crew)
    }

    /// Steps every environment and passes the metrics of each ended episode to `ended`, if it is
    /// present.
    pub(crate) fn step(
        &mut self,
        actions: &[f32],
        auto_reset: bool,
        out: BatchOut<'_>,
        metrics_wanted: bool,
        mut ended: impl FnMut(usize, &Metrics),
    ) -> Result<(), Fault> {
        if self.is_forked() {
            return Err(Fault::Status(JCAS_ERROR_FORKED));
        }
        let (crew, ready) = (self.crew(), self.ready);
        let open = self.parts_mut();
        // Every environment is checked first, as no share may refuse after another has stepped.
        action::refuse_nan(actions)?;
        if !ready {
            check_ready(open.model, open.states)?;
        }
        let final_metrics = if metrics_wanted {
            &mut *open.metrics
        } else {
            &mut []
        };
        let job = BatchJob::new(
            open.model,
            open.states,
            open.scratch,
            actions,
            auto_reset,
            BatchOut {
                final_metrics,
                terminated: &mut *out.terminated,
                truncated: &mut *out.truncated,
                ..out
            },
            open.taken,
        );
        job.run(crew)?;
        if metrics_wanted {
            for (m, metrics) in self.parts_mut().metrics.iter_mut().enumerate() {
                if metrics.terminated || metrics.truncated {
                    ended(m, metrics);
                    *metrics = Metrics::default();
                }
            }
        }
        let ended = || out.terminated.contains(&1) || out.truncated.contains(&1);
        self.ready = auto_reset || !ended();
        Ok(())
    }
}
