//! The buffers of a batch step: their checks, and the kernel's view of them.

use jcas_core::batch::{BatchLens, BatchOut};

use crate::batch_block::Sizes;
use crate::batch_step::jcas_batch_out;
use crate::memory::{Buffer, Span, check_apart};
use crate::records::jcas_metrics;
use crate::status::{Fault, JCAS_ERROR_ARGUMENT, JCAS_ERROR_STRUCT_SIZE};

/// Declares the buffers of a step that the kernel writes: the check, name and number of elements of
/// each in [`jcas_batch_out`].
macro_rules! step_buffers {
    ($( $check:ident $name:ident[$count:ident]: $type:ty; )+) => {
        /// The buffers of a step. Each has the length that the batch needs, and no two overlap.
        pub(crate) struct StepBuffers {
            actions: Buffer<f32>,
            final_metrics: Buffer<jcas_metrics>,
            $( $name: Buffer<$type>, )+
        }

        impl StepBuffers {
            /// Checks each buffer of the caller's record.
            fn each(
                c: &jcas_batch_out,
                actions: Buffer<f32>,
                sizes: Sizes,
                lens: &BatchLens,
            ) -> Result<Self, Fault> {
                let m = sizes.count;
                Ok(Self {
                    actions,
                    $( $name: {
                        Buffer::$check(stringify!($name), c.$name, c.$count, m * lens.$name)?
                    }, )+
                    final_metrics: {
                        let (metrics, count) = (c.final_metrics, c.final_metrics_count);
                        Buffer::optional("final_metrics", metrics, count, m)?
                    },
                })
            }

            fn spans(&self) -> [Span; 2 + [$( stringify!($name) ),+].len()] {
                [self.actions.span, $( self.$name.span, )+ self.final_metrics.span]
            }

            /// Returns the actions, the outputs of the kernel, and the metrics of ended episodes.
            ///
            /// # Safety
            /// As [`Buffer::read`] for the actions, and as [`Buffer::write`] for every other
            /// buffer.
            pub(crate) unsafe fn open<'a>(
                &self,
            ) -> (&'a [f32], BatchOut<'a>, &'a mut [jcas_metrics]) {
                // SAFETY: the caller's promise; `check` has checked that the buffers lie apart.
                let out = unsafe {
                    BatchOut { $( $name: self.$name.write(), )+ ..BatchOut::default() }
                };
                // SAFETY: as above.
                unsafe { (self.actions.read(), out, self.final_metrics.write()) }
            }
        }
    };
}

step_buffers! {
    new observations[observation_count]: f32;
    new rewards[reward_count]: f32;
    new terminated[terminated_count]: u8;
    new truncated[truncated_count]: u8;
    optional global[global_count]: f32;
    optional components[component_count]: f64;
    optional final_observations[final_observation_count]: f32;
    optional final_global[final_global_count]: f32;
    optional uav_rewards[uav_reward_count]: f32;
}

impl StepBuffers {
    /// Checks the caller's record and each buffer. `actions` is a pointer with its count.
    pub(crate) fn check(
        c: &jcas_batch_out,
        actions: (*const f32, usize),
        sizes: Sizes,
        lens: &BatchLens,
    ) -> Result<Self, Fault> {
        if c.reserved != 0 {
            return Err(Fault::Status(JCAS_ERROR_ARGUMENT));
        }
        if !c.final_metrics.is_null() && c.metrics_size != size_of::<jcas_metrics>() {
            return Err(Fault::Status(JCAS_ERROR_STRUCT_SIZE));
        }
        let actions = Buffer::new("actions", actions.0, actions.1, sizes.actions)?;
        let buffers = Self::each(c, actions, sizes, lens)?;
        check_apart(&buffers.spans())?;
        Ok(buffers)
    }
}
