//! A batch behind its handle: states side by side, a share of the working memory for each thread.

use jcas_core::batch::BatchOut;
use jcas_core::header::Phase;
use jcas_core::{Error, Metrics, Model, Scratch, reward};
use rayon::{ThreadPool, ThreadPoolBuilder};

use crate::handle::{Block, ModelBlock, check};
use crate::status::{Fault, JCAS_ERROR_ARGUMENT, JCAS_ERROR_RESOURCES};

/// Shares of the batch per thread: enough that no thread waits long for another at the end.
const SHARES_PER_THREAD: usize = 4;

#[repr(C)]
pub(crate) struct BatchBlock {
    seal: u64,
    model: *const ModelBlock,
    count: usize,
    shares: usize,
    states: Vec<u64>,
    scratch: Vec<u64>,
    metrics: Vec<Metrics>,
    pool: Option<ThreadPool>,
    refusal: Option<Error>,
}

// SAFETY: `repr(C)`, the seal comes first.
unsafe impl Block for BatchBlock {
    const SEAL: u64 = u64::from_le_bytes(*b"jcas bat");
}

/// Lengths of the buffers of a batch.
#[derive(Clone, Copy)]
pub(crate) struct Sizes {
    pub(crate) count: usize,
    pub(crate) actions: usize,
    pub(crate) observations: usize,
    pub(crate) global: usize,
    pub(crate) uavs: usize,
}

/// Some environments of a batch with all that belongs to them.
struct Work<'a> {
    states: &'a mut [u64],
    scratch: &'a mut [u64],
    actions: &'a [f32],
    out: BatchOut<'a>,
    shares: usize,
}

impl BatchBlock {
    pub(crate) fn build(
        block: &ModelBlock,
        count: usize,
        threads: usize,
    ) -> Result<Box<Self>, Fault> {
        let model = block.get();
        let threads = match threads {
            0 => std::thread::available_parallelism().map_or(1, usize::from),
            threads => threads,
        };
        let threads = threads.min(count);
        let shares = if threads == 1 {
            1
        } else {
            count.min(SHARES_PER_THREAD * threads)
        };
        let pool = match threads {
            1 => None,
            _ => Some(
                ThreadPoolBuilder::new()
                    .num_threads(threads)
                    .thread_name(|index| format!("jcas-batch-{index}"))
                    .build()
                    .map_err(|_| Fault::Status(JCAS_ERROR_RESOURCES))?,
            ),
        };
        let mut batch = Box::new(Self {
            seal: 0,
            model: block,
            count,
            shares,
            states: filled(count, model.state_words(), 0)?,
            scratch: filled(shares, Scratch::words_for(model), 0)?,
            metrics: filled(count, 1, Metrics::default())?,
            pool,
            refusal: None,
        });
        batch.each_mut(|model, _, words, scratch| model.reset(words, scratch, 0))?;
        batch.seal = Self::seal(&raw const *batch);
        block.add_user();
        Ok(batch)
    }

    /// Ends a batch.
    ///
    /// # Safety
    /// As [`check`]; no other thread uses the batch.
    pub(crate) unsafe fn free(at: *mut Self) -> Result<(), Fault> {
        // SAFETY: passed on.
        unsafe { check(at) }?;
        // SAFETY: a living batch came from a box and is not used again.
        let mut batch = unsafe { Box::from_raw(at) };
        batch.seal = 0;
        // SAFETY: a model cannot be freed while it has batches.
        unsafe { &*batch.model }.drop_user();
        Ok(())
    }

    /// Opens a batch for change.
    ///
    /// # Safety
    /// As [`check`], and no other thread uses the batch for `'a`.
    pub(crate) unsafe fn open<'a>(at: *mut Self) -> Result<&'a mut Self, Fault> {
        // SAFETY: passed on.
        unsafe { check(at) }?;
        // SAFETY: a living batch that only this call uses.
        Ok(unsafe { &mut *at })
    }

    /// Opens a batch to read.
    ///
    /// # Safety
    /// As [`check`], and no thread changes the batch for `'a`.
    pub(crate) unsafe fn see<'a>(at: *const Self) -> Result<&'a Self, Fault> {
        // SAFETY: passed on.
        unsafe { check(at) }?;
        // SAFETY: a living batch that nobody changes.
        Ok(unsafe { &*at })
    }

    pub(crate) fn model(&self) -> &'static Model<'static> {
        // SAFETY: a model cannot be freed while it has batches, and the reference is not kept in one.
        unsafe { &*self.model }.get()
    }

    pub(crate) fn sizes(&self) -> Sizes {
        let model = self.model();
        Sizes {
            count: self.count,
            actions: self.count * model.action_len(),
            observations: self.count * model.uav_count() * model.observation_len(),
            global: self.count * model.global_len(),
            uavs: self.count * model.uav_count(),
        }
    }

    pub(crate) fn message(&self) -> String {
        self.refusal
            .as_ref()
            .map_or_else(String::new, ToString::to_string)
    }

    pub(crate) fn state(&self, index: usize) -> Result<&[u64], Fault> {
        let mut states = self.states.chunks_exact(self.model().state_words());
        states.nth(index).ok_or(Fault::Status(JCAS_ERROR_ARGUMENT))
    }

    pub(crate) fn state_mut(&mut self, index: usize) -> Result<&mut [u64], Fault> {
        let words = self.model().state_words();
        let mut states = self.states.chunks_exact_mut(words);
        states.nth(index).ok_or(Fault::Status(JCAS_ERROR_ARGUMENT))
    }

    pub(crate) fn reset(
        &mut self,
        seeds: &[u64],
        observations: &mut [f32],
        global: &mut [f32],
    ) -> Result<(), Fault> {
        let model = self.model();
        let mut scratch = Scratch::new(model, &mut self.scratch).ok_or(Error::ModelMismatch)?;
        let states = &mut self.states;
        Ok(model.batch_reset(states, &mut scratch, seeds, observations, global)?)
    }

    /// Visits every environment, on this thread.
    pub(crate) fn each(
        &mut self,
        mut visit: impl FnMut(&Model<'_>, usize, &[u64], &mut Scratch<'_>) -> Result<(), Error>,
    ) -> Result<(), Fault> {
        self.each_mut(|model, m, words, scratch| visit(model, m, words, scratch))
    }

    fn each_mut(
        &mut self,
        mut visit: impl FnMut(&Model<'_>, usize, &mut [u64], &mut Scratch<'_>) -> Result<(), Error>,
    ) -> Result<(), Fault> {
        let model = self.model();
        let mut scratch = Scratch::new(model, &mut self.scratch).ok_or(Error::ModelMismatch)?;
        let states = self.states.chunks_exact_mut(model.state_words());
        for (m, words) in states.enumerate() {
            visit(model, m, words, &mut scratch)?;
        }
        Ok(())
    }

    /// Steps every environment and, where wanted, hands the metrics of each ended episode to `ended`.
    pub(crate) fn step(
        &mut self,
        actions: &[f32],
        auto_reset: bool,
        out: BatchOut<'_>,
        metrics_wanted: bool,
        mut ended: impl FnMut(usize, &Metrics),
    ) -> Result<(), Fault> {
        let model = self.model();
        let final_metrics: &mut [Metrics] = if metrics_wanted {
            &mut self.metrics
        } else {
            &mut []
        };
        let stepped = if let Some(pool) = &self.pool {
            // A share must not refuse after another has stepped.
            check_all(model, &self.states, actions).and_then(|()| {
                let work = Work {
                    states: &mut self.states,
                    scratch: &mut self.scratch,
                    actions,
                    out: BatchOut {
                        final_metrics,
                        ..out
                    },
                    shares: self.shares,
                };
                pool.install(|| work.run(model, auto_reset))
            })
        } else {
            let work = Work {
                states: &mut self.states,
                scratch: &mut self.scratch,
                actions,
                out: BatchOut {
                    final_metrics,
                    ..out
                },
                shares: 1,
            };
            work.run(model, auto_reset)
        };
        stepped.inspect_err(|error| self.refusal = Some(*error))?;
        if metrics_wanted {
            for (m, metrics) in self.metrics.iter_mut().enumerate() {
                if metrics.terminated || metrics.truncated {
                    ended(m, metrics);
                    *metrics = Metrics::default();
                }
            }
        }
        Ok(())
    }
}

impl Work<'_> {
    fn run(mut self, model: &Model<'_>, auto_reset: bool) -> Result<(), Error> {
        if self.shares > 1 {
            let (left, right) = self.split(model);
            let (a, b) = rayon::join(
                || left.run(model, auto_reset),
                || right.run(model, auto_reset),
            );
            return a.and(b);
        }
        let mut scratch = Scratch::new(model, self.scratch).ok_or(Error::ModelMismatch)?;
        model.batch_step(
            self.states,
            &mut scratch,
            self.actions,
            auto_reset,
            &mut self.out,
        )
    }

    /// Two parts, each with its shares' environments, buffers and working memory.
    fn split<'b>(self, model: &Model<'_>) -> (Work<'b>, Work<'b>)
    where
        Self: 'b,
    {
        let count = self.states.len() / model.state_words();
        let shares = self.shares / 2;
        let left = count * shares / self.shares;
        let per_observation = model.uav_count() * model.observation_len();
        let (states, other_states) = self.states.split_at_mut(left * model.state_words());
        let (scratch, other_scratch) = self
            .scratch
            .split_at_mut(shares * Scratch::words_for(model));
        let (actions, other_actions) = self.actions.split_at(left * model.action_len());
        let out = self.out;
        let (observations, b_observations) = cut(out.observations, left * per_observation);
        let (global, b_global) = cut(out.global, left * model.global_len());
        let (rewards, b_rewards) = cut(out.rewards, left);
        let (components, b_components) = cut(out.components, left * reward::COMPONENTS);
        let (terminated, b_terminated) = cut(out.terminated, left);
        let (truncated, b_truncated) = cut(out.truncated, left);
        let (final_observations, b_final_observations) =
            cut(out.final_observations, left * per_observation);
        let (final_global, b_final_global) = cut(out.final_global, left * model.global_len());
        let (final_metrics, b_final_metrics) = cut(out.final_metrics, left);
        let uavs = left * model.uav_count();
        let (uav_rewards, b_uav_rewards) = cut(out.uav_rewards, uavs);
        let (uav_components, b_uav_components) = cut(out.uav_components, uavs * reward::COMPONENTS);
        let one = Work {
            states,
            scratch,
            actions,
            out: BatchOut {
                observations,
                global,
                rewards,
                components,
                terminated,
                truncated,
                final_observations,
                final_global,
                final_metrics,
                uav_rewards,
                uav_components,
            },
            shares,
        };
        let other = Work {
            states: other_states,
            scratch: other_scratch,
            actions: other_actions,
            out: BatchOut {
                observations: b_observations,
                global: b_global,
                rewards: b_rewards,
                components: b_components,
                terminated: b_terminated,
                truncated: b_truncated,
                final_observations: b_final_observations,
                final_global: b_final_global,
                final_metrics: b_final_metrics,
                uav_rewards: b_uav_rewards,
                uav_components: b_uav_components,
            },
            shares: self.shares - shares,
        };
        (one, other)
    }
}

/// Both sides of a buffer; a buffer left out has two empty sides.
fn cut<T>(buffer: &mut [T], at: usize) -> (&mut [T], &mut [T]) {
    let at = if buffer.is_empty() { 0 } else { at };
    buffer.split_at_mut(at)
}

/// What could make any environment refuse a step.
fn check_all(model: &Model<'_>, states: &[u64], actions: &[f32]) -> Result<(), Error> {
    if let Some(index) = actions.iter().position(|value| value.is_nan()) {
        return Err(Error::ActionNan {
            uav: index / 2,
            component: index % 2,
        });
    }
    for words in states.chunks_exact(model.state_words()) {
        match model.state(words)?.header.phase() {
            Some(Phase::Ready) => {}
            Some(phase) if phase.is_over() => return Err(Error::EpisodeOver),
            _ => {
                return Err(Error::OutOfOrder {
                    called: "batch_step",
                    after: "step_end",
                });
            }
        }
    }
    Ok(())
}

/// `count` times `each` values, or a status where a system without the memory would abort.
fn filled<T: Clone>(count: usize, each: usize, value: T) -> Result<Vec<T>, Fault> {
    let scarce = || Fault::Status(JCAS_ERROR_RESOURCES);
    let len = count.checked_mul(each).ok_or_else(scarce)?;
    let mut values = Vec::new();
    values.try_reserve_exact(len).map_err(|_| scarce())?;
    values.resize(len, value);
    Ok(values)
}
