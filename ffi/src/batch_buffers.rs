//! The buffers of a batch step: the C struct, the checks, and the kernel's view.

use jcas_core::batch::{BatchLens, BatchOut};

use crate::batch_block::Sizes;
use crate::memory::{Buffer, Plain, Record, Span, check_apart};
use crate::records::jcas_metrics;
use crate::status::{Fault, JCAS_ERROR_ARGUMENT, JCAS_ERROR_STRUCT_SIZE};

/// Declares the outputs of a batch step in C once, in the order of the struct. Each has its check,
/// its name, the name of its number of elements, and its type; a field may follow.
macro_rules! batch_out {
    (
        $(#[doc = $struct_doc:literal])+
        struct;
        $(
            $(#[doc = $doc:literal])+
            $check:ident $name:ident[$count:ident]: $type:ident;
            $( then $next:ident: $next_type:ident, $next_doc:literal; )?
        )+
    ) => {
        $(#[doc = $struct_doc])+
        #[repr(C)]
        #[derive(Clone, Copy, Debug)]
        pub struct jcas_batch_out {
            /// sizeof(jcas_batch_out).
            pub struct_size: u32,
            /// Reserved; set it to 0.
            pub reserved: u32,
            $(
                $(#[doc = $doc])+
                pub $name: *mut $type,
                #[doc = concat!("Elements of ", stringify!($name), ".")]
                pub $count: usize,
                $( #[doc = $next_doc] pub $next: $next_type, )?
            )+
        }

        /// The text of [`jcas_batch_out`] for `examples/generate_header.rs`, since cbindgen does
        /// not expand macros.
        #[doc(hidden)]
        pub const BATCH_OUT_SOURCE: &str = concat!(
            $( "///", $struct_doc, "\n", )+
            "#[repr(C)]\npub struct jcas_batch_out {\n",
            "/// sizeof(jcas_batch_out).\npub struct_size: u32,\n",
            "/// Reserved; set it to 0.\npub reserved: u32,\n",
            $(
                $( "///", $doc, "\n", )+
                "pub ", stringify!($name), ": *mut ", stringify!($type), ",\n",
                "/// Elements of ", stringify!($name), ".\n",
                "pub ", stringify!($count), ": usize,\n",
                $(
                    "///", $next_doc, "\n",
                    "pub ", stringify!($next), ": ", stringify!($next_type), ",\n",
                )?
            )+
            "}\n",
        );

        /// The buffers of a step. Each has the length that the batch needs, and no two overlap.
        pub(crate) struct StepBuffers {
            actions: Buffer<f32>,
            $( $name: Buffer<$type>, )+
        }

        impl StepBuffers {
            /// Checks each buffer of the caller's record.
            fn each(
                c: &jcas_batch_out,
                actions: Buffer<f32>,
                m: usize,
                lens: &BatchLens,
            ) -> Result<Self, Fault> {
                Ok(Self {
                    actions,
                    $( $name: {
                        Buffer::$check(stringify!($name), c.$name, c.$count, m * lens.$name)?
                    }, )+
                })
            }

            fn spans(&self) -> [Span; 1 + [$( stringify!($name) ),+].len()] {
                [self.actions.span, $( self.$name.span, )+]
            }
        }
    };
}

batch_out! {
    /// The buffers that a batch step writes, for M environments. Each pointer is followed by its
    /// number of elements. Optional buffers may be NULL with a count of 0. No buffer may overlap
    /// another buffer or the actions.
    struct;
    /// M * uav_count * observation_len: the observation of each UAV. After an automatic reset it is
    /// the first one of the new episode.
    new observations[observation_count]: f32;
    /// M: the team reward.
    new rewards[reward_count]: f32;
    /// M: 1 where the step ended the episode because every hotspot is confirmed and informed, else
    /// 0.
    new terminated[terminated_count]: u8;
    /// M: 1 where the step ended the episode at the horizon, else 0.
    new truncated[truncated_count]: u8;
    /// M * global_len: the global state; optional.
    optional global[global_count]: f32;
    /// M * reward_len: the components of each reward; optional.
    optional components[component_count]: f64;
    /// M * uav_count * observation_len: the last observation of each episode that was reset; other
    /// rows are not written; optional.
    optional final_observations[final_observation_count]: f32;
    /// M * global_len: the last global state of each episode that was reset; other rows are not
    /// written; optional.
    optional final_global[final_global_count]: f32;
    /// M: the metrics of each episode that ended; other elements are not written; optional.
    optional final_metrics[final_metrics_count]: jcas_metrics;
    then metrics_size: usize, " sizeof(jcas_metrics), or 0 without final_metrics.";
    /// M * uav_count: the reward of each UAV, whose mean over a fleet is the team reward; optional.
    optional uav_rewards[uav_reward_count]: f32;
}

// SAFETY: every bit pattern is a valid raw pointer, and no pointer is followed unchecked.
unsafe impl Plain for jcas_batch_out {}
// SAFETY: `struct_size` comes first.
unsafe impl Record for jcas_batch_out {}

/// Returns the kernel's view of a buffer. The kernel's metrics have another type than those of C,
/// and C has no components of each UAV's reward.
macro_rules! kernel_buffer {
    ($buffers:ident final_metrics) => {
        &mut []
    };
    ($buffers:ident uav_components) => {
        &mut []
    };
    ($buffers:ident $name:ident) => {
        $buffers.$name.write()
    };
}

/// Opens the buffers from the kernel's list of outputs, so that C lacks none by oversight.
macro_rules! open {
    ($( $name:ident: $type:ty; )+) => {
        impl StepBuffers {
            /// Returns the actions, the outputs of the kernel, and the metrics of ended episodes.
            ///
            /// # Safety
            /// As [`Buffer::read`] for the actions, and as [`Buffer::write`] for every other
            /// buffer.
            pub(crate) unsafe fn open<'a>(
                &self,
            ) -> (&'a [f32], BatchOut<'a>, &'a mut [jcas_metrics]) {
                let buffers = self;
                // SAFETY: the caller's promise; `check` has checked that the buffers lie apart.
                let out = unsafe { BatchOut { $( $name: kernel_buffer!(buffers $name), )+ } };
                // SAFETY: as above.
                unsafe { (self.actions.read(), out, self.final_metrics.write()) }
            }
        }
    };
}

jcas_core::for_each_batch_output!(open);

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
        let buffers = Self::each(c, actions, sizes.count, lens)?;
        check_apart(&buffers.spans())?;
        Ok(buffers)
    }
}
