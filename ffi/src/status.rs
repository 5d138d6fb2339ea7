//! Status codes, and the one place where results become statuses.

use std::ffi::{CStr, c_char};
use std::fmt;
use std::panic::{AssertUnwindSafe, catch_unwind};

use jcas_core::Error;

/// The result of a call: JCAS_OK or a negative JCAS_ERROR_... code.
pub type jcas_status = i32;

/// The call succeeded.
pub const JCAS_OK: i32 = 0;
/// A pointer that must not be NULL is NULL.
pub const JCAS_ERROR_NULL: i32 = -1;
/// A pointer is not aligned for its type.
pub const JCAS_ERROR_ALIGNMENT: i32 = -2;
/// A buffer, or memory for a handle, has the wrong size.
pub const JCAS_ERROR_LENGTH: i32 = -3;
/// A `struct_size` is not a size that this library knows.
pub const JCAS_ERROR_STRUCT_SIZE: i32 = -4;
/// A handle is not of the right kind, was freed, or was moved.
pub const JCAS_ERROR_HANDLE: i32 = -5;
/// A configuration field is outside its range, or a text is not a configuration.
pub const JCAS_ERROR_CONFIG: i32 = -6;
/// An argument is outside its range.
pub const JCAS_ERROR_ARGUMENT: i32 = -7;
/// An action component is NaN, or a network output is not finite.
pub const JCAS_ERROR_NAN: i32 = -8;
/// A state and a model, or two states, have different configurations.
pub const JCAS_ERROR_MODEL_MISMATCH: i32 = -9;
/// A function was called in the wrong phase of a step.
pub const JCAS_ERROR_OUT_OF_ORDER: i32 = -10;
/// The episode has ended: reset before the next step.
pub const JCAS_ERROR_EPISODE_OVER: i32 = -11;
/// The bytes are not a snapshot of this model, not a policy, not a plan, or not a trace.
pub const JCAS_ERROR_CORRUPT: i32 = -12;
/// The model still has simulations, batches or policies, or memory given to ..._init holds a living
/// handle.
pub const JCAS_ERROR_IN_USE: i32 = -13;
/// The system did not provide memory or threads.
pub const JCAS_ERROR_RESOURCES: i32 = -14;
/// The program was compiled for an incompatible version of this library.
pub const JCAS_ERROR_ABI: i32 = -15;
/// The library has a fault; please report it. Reset or free the handle of the call.
pub const JCAS_ERROR_INTERNAL: i32 = -16;

/// The batch has threads, which a forked process does not have. Build another batch there.
pub const JCAS_ERROR_FORKED: i32 = -17;
/// The caller's sink refused a part of a trace.
pub const JCAS_ERROR_SINK: i32 = -18;
/// The library does not reproduce a trace.
pub const JCAS_ERROR_DIFFERENT: i32 = -19;
/// Another call is using the object, on another thread or further up the stack.
pub const JCAS_ERROR_BUSY: i32 = -20;
/// What the policy remembers does not belong to the state, or to the policy.
pub const JCAS_ERROR_MEMORY: i32 = -21;

/// Returns the meaning of a status in English.
///
/// The result is a static string and never NULL, also for values that are not a status.
/// Threads: any.
#[unsafe(no_mangle)]
pub extern "C" fn jcas_status_string(status: jcas_status) -> *const c_char {
    // Each ends with its zero; Kani does not read C string literals.
    let text: &str = match status {
        JCAS_OK => "ok\0",
        JCAS_ERROR_NULL => "a required pointer is NULL\0",
        JCAS_ERROR_ALIGNMENT => "a pointer is not aligned for its type\0",
        JCAS_ERROR_LENGTH => "a buffer has the wrong size\0",
        JCAS_ERROR_STRUCT_SIZE => "struct_size is none that this library knows\0",
        JCAS_ERROR_HANDLE => "a handle is of another kind, closed or moved\0",
        JCAS_ERROR_CONFIG => "the configuration is not legal\0",
        JCAS_ERROR_ARGUMENT => "an argument is outside its range\0",
        JCAS_ERROR_NAN => "an action component is NaN, or a network output is not finite\0",
        JCAS_ERROR_MODEL_MISMATCH => "the configurations differ\0",
        JCAS_ERROR_OUT_OF_ORDER => "a part of a step was called out of its order\0",
        JCAS_ERROR_EPISODE_OVER => "the episode has ended: reset before the next step\0",
        JCAS_ERROR_CORRUPT => "the bytes are not what they should be, or were changed\0",
        JCAS_ERROR_IN_USE => "still in use: free what is alive first\0",
        JCAS_ERROR_RESOURCES => "memory or threads could not be had\0",
        JCAS_ERROR_ABI => "compiled for an incompatible version of the library\0",
        JCAS_ERROR_INTERNAL => "a fault of the library itself\0",
        JCAS_ERROR_FORKED => "the threads of the batch are in the parent process\0",
        JCAS_ERROR_SINK => "the sink has not taken all of the trace\0",
        JCAS_ERROR_DIFFERENT => "this library does not reproduce the trace\0",
        JCAS_ERROR_BUSY => "another call is using the object\0",
        JCAS_ERROR_MEMORY => "what the policy remembers does not belong to the state\0",
        _ => "not a status of jcas\0",
    };
    text.as_ptr().cast()
}

/// The reason why a call is refused.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Fault {
    /// A status of the ABI itself.
    Status(i32),
    /// A status of the ABI itself, with words that say more.
    Because(i32, &'static str),
    /// Two buffers that share memory.
    Overlap(&'static str, &'static str),
    /// A refusal of the kernel.
    Kernel(Error),
    /// A refusal of the kernel for one environment of a batch.
    Environment(usize, Error),
}

impl From<Error> for Fault {
    fn from(error: Error) -> Self {
        Self::Kernel(error)
    }
}

impl Fault {
    pub(crate) fn status(&self) -> i32 {
        match self {
            Self::Status(status) | Self::Because(status, _) => *status,
            Self::Overlap(..) => JCAS_ERROR_ARGUMENT,
            Self::Kernel(error) | Self::Environment(_, error) => match error {
                Error::Config(_) => JCAS_ERROR_CONFIG,
                Error::ActionNan { .. } => JCAS_ERROR_NAN,
                Error::Length { .. } => JCAS_ERROR_LENGTH,
                Error::Argument(_) => JCAS_ERROR_ARGUMENT,
                Error::ModelMismatch => JCAS_ERROR_MODEL_MISMATCH,
                // Every handle sizes its own scratch.
                Error::ScratchTooSmall { .. } => JCAS_ERROR_INTERNAL,
                Error::OutOfOrder { .. } => JCAS_ERROR_OUT_OF_ORDER,
                Error::EpisodeOver => JCAS_ERROR_EPISODE_OVER,
                Error::Corrupt(_) => JCAS_ERROR_CORRUPT,
                _ => JCAS_ERROR_INTERNAL,
            },
        }
    }
}

impl fmt::Display for Fault {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Status(status) => {
                // SAFETY: the text is a static C string.
                let words = unsafe { CStr::from_ptr(jcas_status_string(*status)) };
                out.write_str(words.to_str().unwrap_or_default())
            }
            Self::Because(_, words) => out.write_str(words),
            Self::Overlap(a, b) => write!(out, "{a} and {b} overlap: buffers must lie apart"),
            Self::Kernel(error) => error.fmt(out),
            Self::Environment(index, error) => write!(out, "environment {index}: {error}"),
        }
    }
}

/// Runs the body of an exported function. A panic, which would be a fault of the library, becomes a
/// status.
#[inline]
pub(crate) fn guard(body: impl FnOnce() -> Result<(), Fault>) -> jcas_status {
    match catch_unwind(AssertUnwindSafe(body)) {
        Ok(Ok(())) => JCAS_OK,
        Ok(Err(fault)) => fault.status(),
        Err(_) => JCAS_ERROR_INTERNAL,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_panic_becomes_a_status() {
        let status = guard(|| {
            let empty: [u8; 0] = [];
            let index = std::hint::black_box(3);
            let _ = empty.get(index).expect("nothing is there");
            Ok(())
        });
        assert_eq!(status, JCAS_ERROR_INTERNAL);
    }

    #[test]
    fn a_scratch_of_the_library_that_is_too_small_is_its_own_fault() {
        let model = jcas_core::Model::new(jcas_core::Config::default()).expect("a legal default");
        let refused = jcas_core::Scratch::new(&model, &mut []).expect_err("no memory");
        assert_eq!(Fault::from(refused).status(), JCAS_ERROR_INTERNAL);
    }
}
