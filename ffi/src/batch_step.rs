//! The operations of a batch: reset, step, observe, save and load, with the caller's contiguous
//! buffers.

use std::ffi::{c_char, c_void};

use jcas_core::batch::BatchLens;
use jcas_core::{Error, Metrics, Model, Scratch, observation};

use crate::batch::jcas_batch;
use crate::batch_block::{Batch, BatchBlock};
use crate::batch_buffers::{StepBuffers, jcas_batch_out};
use crate::memory::{Buffer, Words, check_apart, input, output, place, read_record, text_out};
use crate::records::jcas_metrics;
use crate::sim::jcas_sim;
use crate::sim_block::{self, SimMut, see};
use crate::status::{
    Fault, JCAS_ERROR_ARGUMENT, JCAS_ERROR_MODEL_MISMATCH, JCAS_OK, guard, jcas_status,
};

/// Opens a batch for change, and keeps the reason if the operation is refused.
///
/// # Safety
/// As [`BatchBlock::open`].
pub(crate) unsafe fn change(
    batch: *mut jcas_batch,
    act: impl FnOnce(&mut Batch) -> Result<(), Fault>,
) -> i32 {
    guard(|| {
        // SAFETY: the caller's promises, passed on.
        let (batch, _mark) = unsafe { BatchBlock::open(batch.cast()) }?;
        let done = act(batch);
        batch.refusal = done.err();
        done
    })
}

/// Begins an episode in each environment and writes the first observations.
///
/// `seeds`: M; not NULL. `observations`: M * uav_count * observation_len; not NULL. `global`: M *
/// global_len, or NULL with a count of 0. No buffer may overlap another.
/// Threads: only this one uses `batch`.
/// Statuses: NULL, ALIGNMENT, LENGTH, HANDLE, ARGUMENT.
#[must_use]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn jcas_batch_reset(
    batch: *mut jcas_batch,
    seeds: *const u64,
    seed_count: usize,
    observations: *mut f32,
    observation_count: usize,
    global: *mut f32,
    global_count: usize,
) -> jcas_status {
    let (observations, global) = ((observations, observation_count), (global, global_count));
    // SAFETY: the caller's promises, passed on.
    unsafe { reset(batch, None, (seeds, seed_count), observations, global) }
}

/// Begins an episode in each environment whose `mask` is not 0 and writes its observations. The
/// other environments, and their rows of the buffers, do not change.
///
/// `mask`: M; not NULL. The other arguments are as for jcas_batch_reset. Seeds of environments
/// whose mask is 0 are not used.
/// Threads: only this one uses `batch`.
/// Statuses: NULL, ALIGNMENT, LENGTH, HANDLE, ARGUMENT.
#[must_use]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn jcas_batch_reset_some(
    batch: *mut jcas_batch,
    mask: *const u8,
    mask_count: usize,
    seeds: *const u64,
    seed_count: usize,
    observations: *mut f32,
    observation_count: usize,
    global: *mut f32,
    global_count: usize,
) -> jcas_status {
    let (observations, global) = ((observations, observation_count), (global, global_count));
    // SAFETY: the caller's promises, passed on.
    unsafe {
        reset(
            batch,
            Some((mask, mask_count)),
            (seeds, seed_count),
            observations,
            global,
        )
    }
}

/// Begins an episode in each environment, or in those where a mask is not 0. Each buffer is a
/// pointer with its count of elements.
///
/// # Safety
/// As [`jcas_batch_reset_some`].
unsafe fn reset(
    batch: *mut jcas_batch,
    mask: Option<(*const u8, usize)>,
    seeds: (*const u64, usize),
    observations: (*mut f32, usize),
    global: (*mut f32, usize),
) -> jcas_status {
    let act = |batch: &mut Batch| {
        let sizes = batch.sizes();
        let (count, length) = (sizes.count, sizes.observations);
        let mask = match mask {
            Some((at, given)) => Buffer::new("mask", at, given, count),
            None => Buffer::optional("mask", std::ptr::null(), 0, count),
        }?;
        let seeds = Buffer::new("seeds", seeds.0, seeds.1, count)?;
        let observations = Buffer::new("observations", observations.0, observations.1, length)?;
        let global = Buffer::optional("global", global.0, global.1, sizes.global)?;
        check_apart(&[mask.span, seeds.span, observations.span, global.span])?;
        // SAFETY: the caller's promise for each buffer, which lie apart.
        let (mask, seeds) = unsafe { (mask.read(), seeds.read()) };
        // SAFETY: as above.
        let (observations, global) = unsafe { (observations.write(), global.write()) };
        batch.each_mut(|model, m, words, scratch| {
            if mask.get(m) == Some(&0) {
                return Ok(());
            }
            model.reset(words, scratch, seeds[m])?;
            observe(model, m, words, scratch, observations, global)
        })?;
        let reset = (0..count).filter(|&m| mask.get(m) != Some(&0));
        reset.for_each(|m| batch.renew(m));
        Ok(())
    };
    // SAFETY: the caller's promise for `batch`.
    unsafe { change(batch, act) }
}

/// Steps every environment once and writes rewards and observations.
///
/// With `auto_reset` = 1 the next episode follows at once; its seed is jcas_derive_seed(seed, 0).
/// With 0 the batch refuses the step while any environment's episode has ended. Everything is
/// checked before any environment steps, so an error changes nothing.
///
/// `actions`: M * action_len, one row as for jcas_sim_step for each environment; not NULL. `out`:
/// not NULL; see jcas_batch_out.
/// Threads: only this one uses `batch`. A batch with worker threads steps only in the process that
/// built it. After a fork the child gets JCAS_ERROR_FORKED; it may read and free the batch.
/// Statuses: NULL, ALIGNMENT, LENGTH, STRUCT_SIZE, HANDLE, ARGUMENT, NAN, OUT_OF_ORDER,
/// EPISODE_OVER, FORKED.
#[must_use]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn jcas_batch_step(
    batch: *mut jcas_batch,
    actions: *const f32,
    action_count: usize,
    auto_reset: i32,
    out: *const jcas_batch_out,
) -> jcas_status {
    let act = |batch: &mut Batch| {
        let auto_reset = match auto_reset {
            0 => false,
            1 => true,
            _ => return Err(Fault::Status(JCAS_ERROR_ARGUMENT)),
        };
        // SAFETY: the caller's promise for `out`.
        let out = unsafe { read_record(out) }?;
        let lens = BatchLens::of(batch.model());
        let buffers = StepBuffers::check(&out, (actions, action_count), batch.sizes(), &lens)?;
        // SAFETY: the caller's promise for each buffer.
        let (actions, out, metrics) = unsafe { buffers.open() };
        let wanted = !metrics.is_empty();
        let keep = |at: usize, ended: &Metrics| metrics[at] = jcas_metrics::of(ended);
        batch.step(actions, auto_reset, out, wanted, keep)
    };
    // SAFETY: the caller's promise for `batch`.
    unsafe { change(batch, act) }
}

/// Observes environment `m` into its rows.
fn observe(
    model: &Model<'_>,
    m: usize,
    words: &[u64],
    scratch: &mut Scratch<'_>,
    observations: &mut [f32],
    global: &mut [f32],
) -> Result<(), Error> {
    let state = model.state(words)?;
    let len = model.uav_count() * model.observation_len();
    let own = &mut observations[m * len..(m + 1) * len];
    observation::observe(model, &state, scratch, own)?;
    if !global.is_empty() {
        let len = model.global_len();
        observation::observe_global(model, &state, &mut global[m * len..(m + 1) * len])?;
    }
    Ok(())
}

/// Writes the present observations and global states of all environments.
///
/// `observations`: M * uav_count * observation_len; not NULL. `global`: M * global_len, or NULL
/// with a count of 0. No buffer may overlap another.
/// Threads: only this one uses `batch`.
/// Statuses: NULL, ALIGNMENT, LENGTH, HANDLE, ARGUMENT.
#[must_use]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn jcas_batch_observe(
    batch: *mut jcas_batch,
    observations: *mut f32,
    observation_count: usize,
    global: *mut f32,
    global_count: usize,
) -> jcas_status {
    let act = |batch: &mut Batch| {
        let sizes = batch.sizes();
        let length = sizes.observations;
        let observations = Buffer::new("observations", observations, observation_count, length)?;
        let global = Buffer::optional("global", global, global_count, sizes.global)?;
        check_apart(&[observations.span, global.span])?;
        // SAFETY: the caller's promise for both buffers, which lie apart.
        let (observations, global) = unsafe { (observations.write(), global.write()) };
        batch.each_mut(|model, m, words, scratch| {
            observe(model, m, words, scratch, observations, global)
        })
    };
    // SAFETY: the caller's promise for `batch`.
    unsafe { change(batch, act) }
}

/// Saves every environment as M consecutive snapshots in the format of jcas_sim_save.
///
/// `batch`, `snapshots`: not NULL. `size`: M * snapshot_size bytes.
/// Threads: none changes `batch`.
/// Statuses: NULL, ALIGNMENT, LENGTH, HANDLE.
#[must_use]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn jcas_batch_save(
    batch: *const jcas_batch,
    snapshots: *mut c_void,
    size: usize,
) -> jcas_status {
    guard(|| {
        // SAFETY: the caller's promise for `batch`.
        let (batch, _mark) = unsafe { BatchBlock::see(batch.cast()) }?;
        // SAFETY: the caller's promise for `snapshots`.
        let out = unsafe { output::<u8>(snapshots.cast(), size, batch.sizes().snapshots) }?;
        batch.save(out)
    })
}

/// Loads the snapshots that jcas_batch_save wrote for a batch of equal size and configuration. If
/// any snapshot is invalid, it returns JCAS_ERROR_CORRUPT or JCAS_ERROR_MODEL_MISMATCH and changes
/// nothing.
///
/// `batch`, `snapshots`: not NULL. `size`: M * snapshot_size bytes.
/// Threads: only this one uses `batch`.
/// Statuses: NULL, ALIGNMENT, LENGTH, HANDLE, MODEL_MISMATCH, CORRUPT.
#[must_use]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn jcas_batch_load(
    batch: *mut jcas_batch,
    snapshots: *const c_void,
    size: usize,
) -> jcas_status {
    let act = |batch: &mut Batch| {
        // SAFETY: the caller's promise for `snapshots`.
        let saved = unsafe { input::<u8>(snapshots.cast(), size, batch.sizes().snapshots) }?;
        batch.load(saved)
    };
    // SAFETY: the caller's promise for `batch`.
    unsafe { change(batch, act) }
}

/// Writes the fingerprint of all states of a batch in their order (FNV-1a, 64 bits).
///
/// `batch`, `states_hash`: not NULL.
/// Threads: none changes `batch`.
/// Statuses: NULL, ALIGNMENT, HANDLE.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn jcas_batch_hash(
    batch: *const jcas_batch,
    states_hash: *mut u64,
) -> jcas_status {
    guard(|| {
        // SAFETY: the caller's promise for `batch`.
        let (batch, _mark) = unsafe { BatchBlock::see(batch.cast()) }?;
        // SAFETY: the caller's promise for `states_hash`.
        let out = unsafe { place(states_hash) }?;
        out.put(batch.hash());
        Ok(())
    })
}

/// Copies an environment of a batch into a simulation of an equal configuration. The simulation can
/// then read or save the state.
///
/// `batch`, `sim`: not NULL. `index`: below M, or JCAS_ERROR_ARGUMENT.
/// Threads: none changes `batch`, only this one uses `sim`.
/// Statuses: NULL, ALIGNMENT, HANDLE, ARGUMENT, MODEL_MISMATCH.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn jcas_batch_get(
    batch: *const jcas_batch,
    index: u32,
    sim: *mut jcas_sim,
) -> jcas_status {
    guard(|| {
        // SAFETY: the caller's promise for `batch`.
        let (batch, _mark) = unsafe { BatchBlock::see(batch.cast()) }?;
        let copy = |sim: &mut SimMut<'_>| {
            if batch.model().config_hash() != sim.model.config_hash() {
                return Err(Fault::Status(JCAS_ERROR_MODEL_MISMATCH));
            }
            sim.replace(batch.state(index as usize)?);
            Ok(())
        };
        // SAFETY: the caller's promise for `sim`.
        match unsafe { sim_block::change(sim.cast(), copy) } {
            JCAS_OK => Ok(()),
            status => Err(Fault::Status(status)),
        }
    })
}

/// Copies a simulation of an equal configuration into an environment of a batch. The simulation
/// should be between steps: jcas_batch_step refuses a state in the middle of a step by parts.
///
/// `batch`, `sim`: not NULL. `index`: below M, or JCAS_ERROR_ARGUMENT.
/// Threads: only this one uses `batch`, none changes `sim`.
/// Statuses: NULL, ALIGNMENT, HANDLE, ARGUMENT, MODEL_MISMATCH.
#[must_use]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn jcas_batch_set(
    batch: *mut jcas_batch,
    index: u32,
    sim: *const jcas_sim,
) -> jcas_status {
    let act = |batch: &mut Batch| {
        // SAFETY: the caller's promise for `sim`.
        let sim = unsafe { see(sim.cast()) }?;
        if batch.model().config_hash() != sim.model.config_hash() {
            return Err(Fault::Status(JCAS_ERROR_MODEL_MISMATCH));
        }
        batch.replace(index as usize, sim.words)
    };
    // SAFETY: the caller's promise for `batch`.
    unsafe { change(batch, act) }
}

/// Writes why the last call that took this batch without const was refused. The text names the
/// value and what is allowed; it is empty if that call succeeded. UAVs are counted over the whole
/// batch.
///
/// `text`, `capacity`, `length`: as for jcas_config_to_json.
/// Threads: none changes `batch`.
/// Statuses: NULL, ALIGNMENT, LENGTH, HANDLE.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn jcas_batch_message(
    batch: *const jcas_batch,
    text: *mut c_char,
    capacity: usize,
    length: *mut usize,
) -> jcas_status {
    guard(|| {
        // SAFETY: the caller's promise for `batch`.
        let (batch, _mark) = unsafe { BatchBlock::see(batch.cast()) }?;
        // SAFETY: the caller's promises for `text` and `length`.
        unsafe { text_out(&Words(batch.refusal), text, capacity, length) }
    })
}
