//! Rollouts: several steps of every environment of a batch in one call.

use std::ffi::c_void;

use crate::batch::jcas_batch;
use crate::batch_block::{Batch, Sizes};
use crate::batch_step::change;
use crate::memory::{Buffer, Plain, Record, check_apart, read_record};
use crate::policy::jcas_policy;
use crate::policy_block::PolicyBlock;
use crate::records::jcas_metrics;
use crate::rollout_job::{ActionSource, RolloutOut};
use crate::status::{
    Fault, JCAS_ERROR_ARGUMENT, JCAS_ERROR_LENGTH, JCAS_ERROR_STRUCT_SIZE, jcas_status,
};

/// The buffers that a rollout writes, for M environments. Each pointer is followed by its number of
/// elements. Optional buffers may be NULL with a count of 0. No buffer may overlap another buffer
/// or the actions.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct jcas_rollout_out {
    /// sizeof(jcas_rollout_out).
    pub struct_size: u32,
    /// Reserved; set it to 0.
    pub reserved: u32,
    /// M: the sum of the team rewards of the steps made.
    pub returns: *mut f64,
    /// Elements of returns.
    pub return_count: usize,
    /// M: the number of steps made, which is smaller where an episode ended; optional.
    pub steps: *mut u32,
    /// Elements of steps.
    pub step_count: usize,
    /// M: 1 where the episode has ended because every hotspot is confirmed and informed, else 0;
    /// optional.
    pub terminated: *mut u8,
    /// Elements of terminated.
    pub terminated_count: usize,
    /// M: 1 where the episode has ended at the horizon, else 0; optional.
    pub truncated: *mut u8,
    /// Elements of truncated.
    pub truncated_count: usize,
    /// M: the metrics of the episode up to the last state; optional.
    pub metrics: *mut jcas_metrics,
    /// Elements of metrics.
    pub metrics_count: usize,
    /// sizeof(jcas_metrics), or 0 without metrics.
    pub metrics_size: usize,
    /// M * snapshot_size: the last states, in the format of jcas_batch_save; optional.
    pub snapshots: *mut c_void,
    /// Bytes of snapshots.
    pub snapshots_size: usize,
}

// SAFETY: every bit pattern is a valid raw pointer, and no pointer is followed unchecked.
unsafe impl Plain for jcas_rollout_out {}
// SAFETY: `struct_size` comes first.
unsafe impl Record for jcas_rollout_out {}

/// Steps every environment `steps` times, or until its episode ends. A policy chooses the actions,
/// or they are given. An environment whose episode has ended already makes no step.
///
/// The results are those of jcas_policy_act_batch and jcas_batch_step in turn, and do not depend on
/// the threads. Each thread takes one environment after the other through all its steps, and makes
/// no observation that no policy reads.
///
/// `batch`, `out`: not NULL; see jcas_rollout_out. `policy`: of the same configuration, or NULL if
/// the actions are given. `actions`: M * steps * action_len, environment by environment, then step
/// by step; or NULL with a count of 0 if there is a policy. `steps`: at least 1. Arguments are
/// checked before any environment steps, and so is what the policy remembers. If a network output
/// is not finite (JCAS_ERROR_NAN) or a policy finds no memory (JCAS_ERROR_RESOURCES), that
/// environment stays where it is. The others go on, and the outputs are written.
/// Threads: only this one uses `batch` and `policy`; see jcas_batch_step.
/// Statuses: NULL, ALIGNMENT, LENGTH, STRUCT_SIZE, HANDLE, ARGUMENT, NAN, MODEL_MISMATCH,
/// OUT_OF_ORDER, RESOURCES, FORKED, MEMORY.
#[must_use]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn jcas_batch_rollout(
    batch: *mut jcas_batch,
    policy: *mut jcas_policy,
    actions: *const f32,
    action_count: usize,
    steps: u32,
    out: *const jcas_rollout_out,
) -> jcas_status {
    let act = |batch: &mut Batch| {
        // SAFETY: the caller's promise for `out`.
        let out = unsafe { read_record(out) }?;
        let (sizes, steps) = (batch.sizes(), steps as usize);
        let buffers = Buffers::check(&out, (actions, action_count), sizes, steps)?;
        if policy.is_null() == buffers.actions.is_none() {
            return Err(Fault::Because(
                JCAS_ERROR_ARGUMENT,
                "a rollout must have either a policy or actions, and the other NULL",
            ));
        }
        if let Some(actions) = &buffers.actions {
            // SAFETY: the caller's promise for `actions`.
            let source = ActionSource::Given(unsafe { actions.read() });
            // SAFETY: the caller's promise for each buffer.
            return batch.roll_out(steps, source, unsafe { buffers.open() });
        }
        // SAFETY: the caller's promise for `policy`.
        let _mark = unsafe { PolicyBlock::hold(policy.cast()) }?;
        let (model, count) = (batch.model(), sizes.count);
        // SAFETY: this call holds the policy until it returns.
        let source = unsafe { PolicyBlock::source(policy.cast(), model, count) }?;
        // SAFETY: the caller's promise for each buffer.
        batch.roll_out(steps, source, unsafe { buffers.open() })
    };
    // SAFETY: the caller's promise for `batch`.
    unsafe { change(batch, act) }
}

/// The buffers of a rollout. Each has the length that the batch needs, and no two overlap.
struct Buffers {
    actions: Option<Buffer<f32>>,
    returns: Buffer<f64>,
    steps: Buffer<u32>,
    terminated: Buffer<u8>,
    truncated: Buffer<u8>,
    metrics: Buffer<jcas_metrics>,
    snapshots: Buffer<u8>,
}

impl Buffers {
    fn check(
        c: &jcas_rollout_out,
        actions: (*const f32, usize),
        sizes: Sizes,
        steps: usize,
    ) -> Result<Self, Fault> {
        if c.reserved != 0 {
            let why = "reserved of jcas_rollout_out must be 0";
            return Err(Fault::Because(JCAS_ERROR_ARGUMENT, why));
        }
        if steps == 0 {
            let why = "steps = 0: must be at least 1";
            return Err(Fault::Because(JCAS_ERROR_ARGUMENT, why));
        }
        if !c.metrics.is_null() && c.metrics_size != size_of::<jcas_metrics>() {
            return Err(Fault::Status(JCAS_ERROR_STRUCT_SIZE));
        }
        let count = sizes.count;
        let acted = sizes.actions.checked_mul(steps);
        let acted = acted.ok_or(Fault::Status(JCAS_ERROR_LENGTH))?;
        let given = Buffer::optional("actions", actions.0, actions.1, acted)?;
        let snapshots = c.snapshots.cast::<u8>();
        let buffers = Self {
            returns: Buffer::new("returns", c.returns, c.return_count, count)?,
            steps: Buffer::optional("steps", c.steps, c.step_count, count)?,
            terminated: Buffer::optional("terminated", c.terminated, c.terminated_count, count)?,
            truncated: Buffer::optional("truncated", c.truncated, c.truncated_count, count)?,
            metrics: Buffer::optional("metrics", c.metrics, c.metrics_count, count)?,
            snapshots: {
                let size = c.snapshots_size;
                Buffer::optional("snapshots", snapshots, size, sizes.snapshots)?
            },
            actions: None,
        };
        check_apart(&[
            given.span,
            buffers.returns.span,
            buffers.steps.span,
            buffers.terminated.span,
            buffers.truncated.span,
            buffers.metrics.span,
            buffers.snapshots.span,
        ])?;
        Ok(Self {
            actions: (!actions.0.is_null()).then_some(given),
            ..buffers
        })
    }

    /// # Safety
    /// As [`Buffer::write`] for every buffer but the actions.
    unsafe fn open<'a>(&self) -> RolloutOut<'a> {
        // SAFETY: the caller's promise; `check` has checked that the buffers lie apart.
        unsafe {
            RolloutOut {
                returns: self.returns.write(),
                steps: self.steps.write(),
                terminated: self.terminated.write(),
                truncated: self.truncated.write(),
                metrics: self.metrics.write(),
                snapshots: self.snapshots.write(),
            }
        }
    }
}
