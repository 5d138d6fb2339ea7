//! Batches: many environments of one model, stepped into the caller's contiguous buffers.

use std::ffi::c_char;

use jcas_core::batch::BatchOut;
use jcas_core::{Metrics, observation, reward};

use crate::batch_block::BatchBlock;
use crate::handle::{model, open, see};
use crate::memory::{Plain, Record, input, optional_output, output, place, read_record, text_out};
use crate::model::jcas_model;
use crate::records::jcas_metrics;
use crate::sim::jcas_sim;
use crate::status::{
    Fault, JCAS_ERROR_ARGUMENT, JCAS_ERROR_MODEL_MISMATCH, JCAS_ERROR_STRUCT_SIZE, JCAS_OK, guard,
};

/// M environments of one model, with their working memory and, if wanted, threads of their own. One
/// thread at a time may use it.
pub struct jcas_batch(());

/// Buffers that a batch step writes, for M environments; each pointer with its number of elements.
/// Optional ones may be NULL with a count of 0. No buffer may overlap another, or the actions.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct jcas_batch_out {
    /// sizeof(jcas_batch_out).
    pub struct_size: u32,
    /// Set it to 0.
    pub reserved: u32,
    /// M * uav_count * observation_len: what each UAV observes, after an automatic reset the new
    /// episode's first.
    pub observations: *mut f32,
    /// Elements of observations.
    pub observation_count: usize,
    /// M: the team reward.
    pub rewards: *mut f32,
    /// Elements of rewards.
    pub reward_count: usize,
    /// M: 1 where the step ended the episode because every hotspot is informed, else 0.
    pub terminated: *mut u8,
    /// Elements of terminated.
    pub terminated_count: usize,
    /// M: 1 where the step ended the episode at the horizon, else 0.
    pub truncated: *mut u8,
    /// Elements of truncated.
    pub truncated_count: usize,
    /// M * global_len: the global state; optional.
    pub global: *mut f32,
    /// Elements of global.
    pub global_count: usize,
    /// M * reward_len: the components of each reward; optional.
    pub components: *mut f64,
    /// Elements of components.
    pub component_count: usize,
    /// M * uav_count * observation_len: where an episode was reset, its last observation; untouched
    /// elsewhere; optional.
    pub final_observations: *mut f32,
    /// Elements of final_observations.
    pub final_observation_count: usize,
    /// M * global_len: where an episode was reset, its last global state; untouched elsewhere; optional.
    pub final_global: *mut f32,
    /// Elements of final_global.
    pub final_global_count: usize,
    /// M: where an episode ended, what it came to; untouched elsewhere; optional.
    pub final_metrics: *mut jcas_metrics,
    /// Elements of final_metrics.
    pub final_metrics_count: usize,
    /// sizeof(jcas_metrics), or 0 without final_metrics.
    pub metrics_size: usize,
    /// M * uav_count: the reward of each UAV, whose mean over a fleet is the team's; optional.
    pub uav_rewards: *mut f32,
    /// Elements of uav_rewards.
    pub uav_reward_count: usize,
}

// SAFETY: any bits are a raw pointer; none is followed unchecked.
unsafe impl Plain for jcas_batch_out {}
// SAFETY: `struct_size` comes first.
unsafe impl Record for jcas_batch_out {}

/// Builds M environments in memory of their own, each at t = 0 of seed 0.
///
/// `model`: not NULL; must not be freed before the batch. `environments`: M, at least 1. `threads`: how
/// many step at once; 1: the caller's own, no other is started; 0: one for each processor. Results do not
/// depend on it. `batch`: not NULL; receives the handle, to be ended by jcas_batch_free. Threads: any.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn jcas_batch_new(
    model: *const jcas_model,
    environments: u32,
    threads: u32,
    batch: *mut *mut jcas_batch,
) -> i32 {
    guard(|| {
        // SAFETY: the caller's promise for `model`.
        let model = unsafe { self::model(model.cast()) }?;
        // SAFETY: the caller's promise for `batch`.
        let out = unsafe { place(batch) }?;
        if environments == 0 {
            return Err(Fault::Status(JCAS_ERROR_ARGUMENT));
        }
        let block = BatchBlock::build(model, environments as usize, threads as usize)?;
        out.put(Box::into_raw(block).cast());
        Ok(())
    })
}

/// Ends a batch and its threads. NULL is allowed and does nothing.
///
/// Threads: none may be using the batch.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn jcas_batch_free(batch: *mut jcas_batch) -> i32 {
    if batch.is_null() {
        return JCAS_OK;
    }
    // SAFETY: the caller's promise for `batch`.
    guard(|| unsafe { BatchBlock::free(batch.cast()) })
}

/// Begins an episode in each environment and observes.
///
/// `seeds`: M; not NULL. `observations`: M * uav_count * observation_len; not NULL. `global`: M *
/// global_len, or NULL with a count of 0. Threads: only this one uses `batch`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn jcas_batch_reset(
    batch: *mut jcas_batch,
    seeds: *const u64,
    seed_count: usize,
    observations: *mut f32,
    observation_count: usize,
    global: *mut f32,
    global_count: usize,
) -> i32 {
    guard(|| {
        // SAFETY: the caller's promise for `batch`.
        let batch = unsafe { BatchBlock::open(batch.cast()) }?;
        let sizes = batch.sizes();
        apart(&[
            span(seeds, seed_count),
            span(observations, observation_count),
            span(global, global_count),
        ])?;
        // SAFETY: the caller's promise for `seeds`.
        let seeds = unsafe { input(seeds, seed_count, sizes.count) }?;
        // SAFETY: the caller's promise for `observations`.
        let observations = unsafe { output(observations, observation_count, sizes.observations) }?;
        // SAFETY: the caller's promise for `global`.
        let global = unsafe { optional_output(global, global_count, sizes.global) }?;
        batch.reset(seeds, observations, global)
    })
}

/// Steps every environment once and observes.
///
/// With `auto_reset` = 1 an episode that ends is followed at once by the next, whose seed derives from
/// the ended one's. With 0 an environment whose episode has ended refuses the step, and so the batch does.
/// All is checked before any environment steps, so nothing has changed after an error.
///
/// `actions`: M times those of jcas_sim_step; not NULL. `out`: not NULL; see jcas_batch_out.
/// Threads: only this one uses `batch`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn jcas_batch_step(
    batch: *mut jcas_batch,
    actions: *const f32,
    action_count: usize,
    auto_reset: i32,
    out: *const jcas_batch_out,
) -> i32 {
    guard(|| {
        // SAFETY: the caller's promise for `batch`.
        let batch = unsafe { BatchBlock::open(batch.cast()) }?;
        let sizes = batch.sizes();
        // SAFETY: the caller's promise for `actions`.
        let actions = unsafe { input(actions, action_count, sizes.actions) }?;
        let auto_reset = match auto_reset {
            0 => false,
            1 => true,
            _ => return Err(Fault::Status(JCAS_ERROR_ARGUMENT)),
        };
        // SAFETY: the caller's promise for `out`.
        let c = unsafe { read_record(out) }?;
        if !c.final_metrics.is_null() && c.metrics_size != size_of::<jcas_metrics>() {
            return Err(Fault::Status(JCAS_ERROR_STRUCT_SIZE));
        }
        apart(&[
            span(actions.as_ptr(), action_count),
            span(c.observations, c.observation_count),
            span(c.rewards, c.reward_count),
            span(c.terminated, c.terminated_count),
            span(c.truncated, c.truncated_count),
            span(c.global, c.global_count),
            span(c.components, c.component_count),
            span(c.final_observations, c.final_observation_count),
            span(c.final_global, c.final_global_count),
            span(c.final_metrics, c.final_metrics_count),
            span(c.uav_rewards, c.uav_reward_count),
        ])?;
        let m = sizes.count;
        // SAFETY: the caller's promise for each buffer; none overlaps another.
        let (buffers, metrics) = unsafe {
            let buffers = BatchOut {
                observations: output(c.observations, c.observation_count, sizes.observations)?,
                global: optional_output(c.global, c.global_count, sizes.global)?,
                rewards: output(c.rewards, c.reward_count, m)?,
                components: optional_output(
                    c.components,
                    c.component_count,
                    m * reward::COMPONENTS,
                )?,
                terminated: output(c.terminated, c.terminated_count, m)?,
                truncated: output(c.truncated, c.truncated_count, m)?,
                final_observations: optional_output(
                    c.final_observations,
                    c.final_observation_count,
                    sizes.observations,
                )?,
                final_global: optional_output(c.final_global, c.final_global_count, sizes.global)?,
                final_metrics: &mut [],
                uav_rewards: optional_output(c.uav_rewards, c.uav_reward_count, sizes.uavs)?,
                uav_components: &mut [],
            };
            let metrics = optional_output(c.final_metrics, c.final_metrics_count, m)?;
            (buffers, metrics)
        };
        let wanted = !metrics.is_empty();
        batch.step(
            actions,
            auto_reset,
            buffers,
            wanted,
            |at, ended: &Metrics| {
                metrics[at] = jcas_metrics::of(ended);
            },
        )
    })
}

/// Writes what the environments observe now; the buffers are those of jcas_batch_reset.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn jcas_batch_observe(
    batch: *mut jcas_batch,
    observations: *mut f32,
    observation_count: usize,
    global: *mut f32,
    global_count: usize,
) -> i32 {
    guard(|| {
        // SAFETY: the caller's promise for `batch`.
        let batch = unsafe { BatchBlock::open(batch.cast()) }?;
        let sizes = batch.sizes();
        apart(&[
            span(observations, observation_count),
            span(global, global_count),
        ])?;
        // SAFETY: the caller's promise for `observations`.
        let observations = unsafe { output(observations, observation_count, sizes.observations) }?;
        // SAFETY: the caller's promise for `global`.
        let global = unsafe { optional_output(global, global_count, sizes.global) }?;
        batch.each(|model, m, words, scratch| {
            let state = model.state(words)?;
            let len = observations.len() / sizes.count;
            let own = &mut observations[m * len..(m + 1) * len];
            observation::observe(model, &state, scratch, own)?;
            if !global.is_empty() {
                let len = model.global_len();
                let own = &mut global[m * len..(m + 1) * len];
                observation::observe_global(model, &state, own)?;
            }
            Ok(())
        })
    })
}

/// Copies an environment of a batch into a simulation of an equal configuration, to read every quantity
/// or to save it.
///
/// `batch`, `sim`: not NULL. `index`: below M, or JCAS_ERROR_ARGUMENT. Threads: none changes `batch`,
/// only this one uses `sim`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn jcas_batch_get(
    batch: *const jcas_batch,
    index: u32,
    sim: *mut jcas_sim,
) -> i32 {
    guard(|| {
        // SAFETY: the caller's promise for `batch`.
        let batch = unsafe { BatchBlock::see(batch.cast()) }?;
        // SAFETY: the caller's promise for `sim`.
        let sim = unsafe { open(sim.cast()) }?;
        if batch.model().config_hash() != sim.model.config_hash() {
            return Err(Fault::Status(JCAS_ERROR_MODEL_MISMATCH));
        }
        sim.words.copy_from_slice(batch.state(index as usize)?);
        Ok(())
    })
}

/// Copies a simulation of an equal configuration into an environment of a batch. It should be between
/// steps: one in the middle of a step by parts makes jcas_batch_step refuse.
///
/// `batch`, `sim`: not NULL. `index`: below M, or JCAS_ERROR_ARGUMENT. Threads: only this one uses
/// `batch`, none changes `sim`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn jcas_batch_set(
    batch: *mut jcas_batch,
    index: u32,
    sim: *const jcas_sim,
) -> i32 {
    guard(|| {
        // SAFETY: the caller's promise for `batch`.
        let batch = unsafe { BatchBlock::open(batch.cast()) }?;
        // SAFETY: the caller's promise for `sim`.
        let sim = unsafe { see(sim.cast()) }?;
        if batch.model().config_hash() != sim.model.config_hash() {
            return Err(Fault::Status(JCAS_ERROR_MODEL_MISMATCH));
        }
        batch.state_mut(index as usize)?.copy_from_slice(sim.words);
        Ok(())
    })
}

/// As jcas_sim_message, for a batch. UAVs are counted over the whole batch.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn jcas_batch_message(
    batch: *const jcas_batch,
    text: *mut c_char,
    capacity: usize,
    length: *mut usize,
) -> i32 {
    guard(|| {
        // SAFETY: the caller's promise for `batch`.
        let batch = unsafe { BatchBlock::see(batch.cast()) }?;
        // SAFETY: the caller's promises for `text` and `length`.
        unsafe { text_out(&batch.message(), text, capacity, length) }
    })
}

/// First address of a buffer and the one behind its last.
fn span<T>(buffer: *const T, count: usize) -> (usize, usize) {
    let begin = if buffer.is_null() { 0 } else { buffer.addr() };
    let bytes = count.saturating_mul(size_of::<T>());
    (begin, begin.saturating_add(bytes))
}

/// Whether no two buffers overlap; those left out never do.
fn apart(spans: &[(usize, usize)]) -> Result<(), Fault> {
    for (index, a) in spans.iter().enumerate() {
        for b in &spans[..index] {
            if a.0 != 0 && b.0 != 0 && a.0 < b.1 && b.0 < a.1 {
                return Err(Fault::Status(JCAS_ERROR_ARGUMENT));
            }
        }
    }
    Ok(())
}
