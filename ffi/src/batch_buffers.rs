//! The buffers of a batch step: their checks, and the kernel's view of them.

use jcas_core::batch::BatchOut;
use jcas_core::reward;

use crate::batch_block::Sizes;
use crate::batch_step::jcas_batch_out;
use crate::memory::{Buffer, Span, check_apart};
use crate::records::jcas_metrics;
use crate::status::{Fault, JCAS_ERROR_ARGUMENT, JCAS_ERROR_STRUCT_SIZE};

/// The buffers of a step. Each has the length that the batch needs, and no two overlap.
pub(crate) struct StepBuffers {
    actions: Buffer<f32>,
    observations: Buffer<f32>,
    rewards: Buffer<f32>,
    terminated: Buffer<u8>,
    truncated: Buffer<u8>,
    global: Buffer<f32>,
    components: Buffer<f64>,
    final_observations: Buffer<f32>,
    final_global: Buffer<f32>,
    final_metrics: Buffer<jcas_metrics>,
    uav_rewards: Buffer<f32>,
}

impl StepBuffers {
    /// Checks the caller's record and each buffer. `actions` is a pointer with its count.
    pub(crate) fn check(
        c: &jcas_batch_out,
        actions: (*const f32, usize),
        sizes: Sizes,
    ) -> Result<Self, Fault> {
        if c.reserved != 0 {
            return Err(Fault::Status(JCAS_ERROR_ARGUMENT));
        }
        if !c.final_metrics.is_null() && c.metrics_size != size_of::<jcas_metrics>() {
            return Err(Fault::Status(JCAS_ERROR_STRUCT_SIZE));
        }
        let (m, seen, shared) = (sizes.count, sizes.observations, sizes.global);
        let credited = m * reward::COMPONENTS;
        let buffers = Self {
            actions: Buffer::new("actions", actions.0, actions.1, sizes.actions)?,
            observations: Buffer::new("observations", c.observations, c.observation_count, seen)?,
            rewards: Buffer::new("rewards", c.rewards, c.reward_count, m)?,
            terminated: Buffer::new("terminated", c.terminated, c.terminated_count, m)?,
            truncated: Buffer::new("truncated", c.truncated, c.truncated_count, m)?,
            global: Buffer::optional("global", c.global, c.global_count, shared)?,
            components: Buffer::optional("components", c.components, c.component_count, credited)?,
            final_observations: Buffer::optional(
                "final_observations",
                c.final_observations,
                c.final_observation_count,
                seen,
            )?,
            final_global: Buffer::optional(
                "final_global",
                c.final_global,
                c.final_global_count,
                shared,
            )?,
            final_metrics: Buffer::optional(
                "final_metrics",
                c.final_metrics,
                c.final_metrics_count,
                m,
            )?,
            uav_rewards: Buffer::optional(
                "uav_rewards",
                c.uav_rewards,
                c.uav_reward_count,
                sizes.uavs,
            )?,
        };
        check_apart(&buffers.spans())?;
        Ok(buffers)
    }

    fn spans(&self) -> [Span; 11] {
        [
            self.actions.span,
            self.observations.span,
            self.rewards.span,
            self.terminated.span,
            self.truncated.span,
            self.global.span,
            self.components.span,
            self.final_observations.span,
            self.final_global.span,
            self.final_metrics.span,
            self.uav_rewards.span,
        ]
    }

    /// Returns the actions, the outputs of the kernel, and the metrics of ended episodes.
    ///
    /// # Safety
    /// As [`Buffer::read`] for the actions, and as [`Buffer::write`] for every other buffer.
    pub(crate) unsafe fn open<'a>(&self) -> (&'a [f32], BatchOut<'a>, &'a mut [jcas_metrics]) {
        // SAFETY: the caller's promise; `check` has checked that the buffers lie apart.
        let (actions, metrics) = unsafe { (self.actions.read(), self.final_metrics.write()) };
        // SAFETY: as above.
        let out = unsafe {
            BatchOut {
                observations: self.observations.write(),
                global: self.global.write(),
                rewards: self.rewards.write(),
                components: self.components.write(),
                terminated: self.terminated.write(),
                truncated: self.truncated.write(),
                final_observations: self.final_observations.write(),
                final_global: self.final_global.write(),
                final_metrics: &mut [],
                uav_rewards: self.uav_rewards.write(),
                uav_components: &mut [],
            }
        };
        (actions, out, metrics)
    }
}
