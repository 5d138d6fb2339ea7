//! The steps of the kernel and the matrix multiplication of policies, compiled for several
//! instruction sets. The instruction set is chosen at run time.
//!
//! Each has one source and gives the same bits on every instruction set; only their speed differs.
//! A function with target features is `unsafe` to call, as the processor may lack them. This crate
//! contains those calls and nothing else.
#![deny(clippy::undocumented_unsafe_blocks)]

use jcas_core::batch::BatchOut;
use jcas_core::{Error, Model, Scratch, StateMut, StepOutcome};
use jcas_policy::network::MatmulKernel;

/// An instruction set that the code is compiled for and that this machine has.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct InstructionSet(Set);

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Set {
    /// The instruction set that the whole program is compiled for.
    Baseline,
    /// x86-64-v3 of the psABI: 256-bit vectors. It excludes fused multiply-add, which would change
    /// results.
    #[cfg(target_arch = "x86_64")]
    V3,
    /// x86-64-v4 of the psABI: 512-bit vectors. It also excludes fused multiply-add.
    #[cfg(target_arch = "x86_64")]
    V4,
}

impl InstructionSet {
    /// The instruction set that the whole program is compiled for.
    pub const BASELINE: Self = Self(Set::Baseline);

    /// Returns the fastest instruction set that this machine has.
    #[must_use]
    pub fn best() -> Self {
        #[cfg(target_arch = "x86_64")]
        if has_v4() {
            return Self(Set::V4);
        } else if has_v3() {
            return Self(Set::V3);
        }
        Self::BASELINE
    }

    /// Returns all instruction sets that this machine has, the slowest first.
    pub fn all() -> impl Iterator<Item = Self> {
        #[cfg(target_arch = "x86_64")]
        let others = [(Set::V3, has_v3()), (Set::V4, has_v4())];
        #[cfg(not(target_arch = "x86_64"))]
        let others = [];
        let there = |(set, has): (Set, bool)| has.then_some(Self(set));
        core::iter::once(Self::BASELINE).chain(others.into_iter().filter_map(there))
    }

    /// Returns the name of the instruction set.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self.0 {
            Set::Baseline => "baseline",
            #[cfg(target_arch = "x86_64")]
            Set::V3 => "x86-64-v3",
            #[cfg(target_arch = "x86_64")]
            Set::V4 => "x86-64-v4",
        }
    }

    /// Runs [`Model::batch_step`] with this instruction set.
    ///
    /// # Errors
    /// The errors are those of [`Model::batch_step`].
    pub fn batch_step(
        self,
        model: &Model<'_>,
        states: &mut [u64],
        scratch: &mut Scratch<'_>,
        actions: &[f32],
        auto_reset: bool,
        out: &mut BatchOut<'_>,
    ) -> Result<(), Error> {
        match self.0 {
            Set::Baseline => model.batch_step(states, scratch, actions, auto_reset, out),
            #[cfg(target_arch = "x86_64")]
            // SAFETY: only `best` and `all` make this variant, and only if the machine has its
            // features.
            Set::V3 => unsafe { batch_step_v3(model, states, scratch, actions, auto_reset, out) },
            #[cfg(target_arch = "x86_64")]
            // SAFETY: as above.
            Set::V4 => unsafe { batch_step_v4(model, states, scratch, actions, auto_reset, out) },
        }
    }

    /// Runs [`Model::step`] with this instruction set.
    ///
    /// # Errors
    /// The errors are those of [`Model::step`].
    #[inline]
    pub fn step(
        self,
        model: &Model<'_>,
        state: &mut StateMut<'_>,
        scratch: &mut Scratch<'_>,
        actions: &[f32],
    ) -> Result<StepOutcome, Error> {
        match self.0 {
            Set::Baseline => model.step(state, scratch, actions),
            #[cfg(target_arch = "x86_64")]
            // SAFETY: only `best` and `all` make this variant, and only if the machine has its
            // features.
            Set::V3 => unsafe { step_v3(model, state, scratch, actions) },
            #[cfg(target_arch = "x86_64")]
            // SAFETY: as above.
            Set::V4 => unsafe { step_v4(model, state, scratch, actions) },
        }
    }

    /// Returns the matrix multiplication of networks for this instruction set.
    #[must_use]
    pub fn matmul(self) -> MatmulKernel {
        match self.0 {
            Set::Baseline => MatmulKernel::default(),
            #[cfg(target_arch = "x86_64")]
            // SAFETY: only `best` and `all` make this variant, and only if the machine has its
            // features.
            Set::V3 => MatmulKernel::new(|operands| unsafe { multiply_v3(operands) }),
            #[cfg(target_arch = "x86_64")]
            // SAFETY: as above.
            Set::V4 => MatmulKernel::new(|operands| unsafe { multiply_v4(operands) }),
        }
    }
}

#[cfg(target_arch = "x86_64")]
fn has_v3() -> bool {
    is_x86_feature_detected!("avx2")
        && is_x86_feature_detected!("bmi1")
        && is_x86_feature_detected!("bmi2")
        && is_x86_feature_detected!("lzcnt")
        && is_x86_feature_detected!("popcnt")
}

#[cfg(target_arch = "x86_64")]
fn has_v4() -> bool {
    has_v3()
        && is_x86_feature_detected!("avx512f")
        && is_x86_feature_detected!("avx512bw")
        && is_x86_feature_detected!("avx512cd")
        && is_x86_feature_detected!("avx512dq")
        && is_x86_feature_detected!("avx512vl")
}

/// Compiles both steps and the matrix multiplication for an instruction set.
#[cfg(target_arch = "x86_64")]
macro_rules! compile_for {
    ($has:ident, $features:literal, $batch_step:ident, $step:ident, $multiply:ident) => {
        /// # Safety
        #[doc = concat!("The processor has what [`", stringify!($has), "`] looks for.")]
        #[target_feature(enable = $features)]
        unsafe fn $batch_step(
            model: &Model<'_>,
            states: &mut [u64],
            scratch: &mut Scratch<'_>,
            actions: &[f32],
            auto_reset: bool,
            out: &mut BatchOut<'_>,
        ) -> Result<(), Error> {
            model.batch_step_inline(states, scratch, actions, auto_reset, out)
        }

        /// # Safety
        #[doc = concat!("The processor has what [`", stringify!($has), "`] looks for.")]
        #[target_feature(enable = $features)]
        unsafe fn $step(
            model: &Model<'_>,
            state: &mut StateMut<'_>,
            scratch: &mut Scratch<'_>,
            actions: &[f32],
        ) -> Result<StepOutcome, Error> {
            model.step_inline(state, scratch, actions)
        }

        /// # Safety
        #[doc = concat!("The processor has what [`", stringify!($has), "`] looks for.")]
        #[target_feature(enable = $features)]
        unsafe fn $multiply(operands: jcas_policy::network::MatmulArgs<'_>) {
            operands.multiply_inline::<64>();
        }
    };
}

#[cfg(target_arch = "x86_64")]
compile_for!(
    has_v3,
    "avx2,bmi1,bmi2,lzcnt,popcnt",
    batch_step_v3,
    step_v3,
    multiply_v3
);
#[cfg(target_arch = "x86_64")]
compile_for!(
    has_v4,
    "avx2,bmi1,bmi2,lzcnt,popcnt,avx512f,avx512bw,avx512cd,avx512dq,avx512vl",
    batch_step_v4,
    step_v4,
    multiply_v4
);
