//! The functions of the standard that this unit does not offer: Model Exchange, Scheduled
//! Execution, clocks, derivatives.

use std::ffi::{c_char, c_void};
use std::ptr::null_mut;

use crate::error::Error;
use crate::handle::{Handle, LogMessage, Status, call};

/// Defines functions of the standard that are exported and always return an error.
macro_rules! refused {
    ($($name:ident($($type:ty),*);)+) => { $(
        /// This unit does not offer the function.
        #[unsafe(no_mangle)]
        #[allow(clippy::too_many_arguments)]
        pub extern "C" fn $name(handle: *mut Handle $(, _: $type)*) -> Status {
            call(handle, |_| Err(Error::NotOffered(stringify!($name))))
        }
    )+ };
}

type In<T> = *const T;
type Out<T> = *mut T;

refused! {
    fmi3EnterEventMode();
    fmi3EnterStepMode();
    fmi3GetInt8(In<u32>, usize, Out<i8>, usize);
    fmi3GetUInt8(In<u32>, usize, Out<u8>, usize);
    fmi3GetInt16(In<u32>, usize, Out<i16>, usize);
    fmi3GetUInt16(In<u32>, usize, Out<u16>, usize);
    fmi3GetInt32(In<u32>, usize, Out<i32>, usize);
    fmi3GetInt64(In<u32>, usize, Out<i64>, usize);
    fmi3GetBinary(In<u32>, usize, Out<usize>, Out<*const u8>, usize);
    fmi3GetClock(In<u32>, usize, Out<bool>);
    fmi3SetInt8(In<u32>, usize, In<i8>, usize);
    fmi3SetUInt8(In<u32>, usize, In<u8>, usize);
    fmi3SetInt16(In<u32>, usize, In<i16>, usize);
    fmi3SetUInt16(In<u32>, usize, In<u16>, usize);
    fmi3SetInt32(In<u32>, usize, In<i32>, usize);
    fmi3SetInt64(In<u32>, usize, In<i64>, usize);
    fmi3SetBinary(In<u32>, usize, In<usize>, In<*const u8>, usize);
    fmi3SetClock(In<u32>, usize, In<bool>);
    fmi3GetNumberOfVariableDependencies(u32, Out<usize>);
    fmi3GetVariableDependencies(u32, Out<usize>, Out<u32>, Out<usize>, Out<i32>, usize);
    fmi3GetDirectionalDerivative(In<u32>, usize, In<u32>, usize, In<f64>, usize, Out<f64>, usize);
    fmi3GetAdjointDerivative(In<u32>, usize, In<u32>, usize, In<f64>, usize, Out<f64>, usize);
    fmi3GetIntervalDecimal(In<u32>, usize, Out<f64>, Out<i32>);
    fmi3GetIntervalFraction(In<u32>, usize, Out<u64>, Out<u64>, Out<i32>);
    fmi3GetShiftDecimal(In<u32>, usize, Out<f64>);
    fmi3GetShiftFraction(In<u32>, usize, Out<u64>, Out<u64>);
    fmi3SetIntervalDecimal(In<u32>, usize, In<f64>);
    fmi3SetIntervalFraction(In<u32>, usize, In<u64>, In<u64>);
    fmi3SetShiftDecimal(In<u32>, usize, In<f64>);
    fmi3SetShiftFraction(In<u32>, usize, In<u64>, In<u64>);
    fmi3EvaluateDiscreteStates();
    fmi3UpdateDiscreteStates(Out<bool>, Out<bool>, Out<bool>, Out<bool>, Out<bool>, Out<f64>);
    fmi3EnterContinuousTimeMode();
    fmi3CompletedIntegratorStep(bool, Out<bool>, Out<bool>);
    fmi3SetTime(f64);
    fmi3SetContinuousStates(In<f64>, usize);
    fmi3GetContinuousStateDerivatives(Out<f64>, usize);
    fmi3GetEventIndicators(Out<f64>, usize);
    fmi3GetContinuousStates(Out<f64>, usize);
    fmi3GetNominalsOfContinuousStates(Out<f64>, usize);
    fmi3GetNumberOfEventIndicators(Out<usize>);
    fmi3GetNumberOfContinuousStates(Out<usize>);
    fmi3GetOutputDerivatives(In<u32>, usize, In<i32>, Out<f64>, usize);
    fmi3ActivateModelPartition(u32, f64);
}

/// Model Exchange is not offered.
#[unsafe(no_mangle)]
pub extern "C" fn fmi3InstantiateModelExchange(
    _: In<c_char>,
    _: In<c_char>,
    _: In<c_char>,
    _: bool,
    _: bool,
    _: *mut c_void,
    _: LogMessage,
) -> *mut Handle {
    null_mut()
}

/// Scheduled Execution is not offered.
#[unsafe(no_mangle)]
#[allow(clippy::too_many_arguments)]
pub extern "C" fn fmi3InstantiateScheduledExecution(
    _: In<c_char>,
    _: In<c_char>,
    _: In<c_char>,
    _: bool,
    _: bool,
    _: *mut c_void,
    _: LogMessage,
    _: *const c_void,
    _: *const c_void,
    _: *const c_void,
) -> *mut Handle {
    null_mut()
}
