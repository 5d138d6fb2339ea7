//! The reasons why a call is refused.

use displaydoc::Display;

use crate::instance::Mode;

/// The reason why a call is refused. The text names the argument, its value and what is allowed.
#[derive(Debug, Display, thiserror::Error)]
pub enum Error {
    /// {call} is not allowed in the mode {mode:?}
    CallInMode {
        /// The function of the standard.
        call: String,
        /// The present mode.
        mode: Mode,
    },
    /// {0} is not offered by this unit
    NotOffered(&'static str),
    /// {0} is null
    Null(String),
    /// {argument} = {value}: {allowed}
    Argument {
        /// The argument of the standard.
        argument: &'static str,
        /// Its value.
        value: String,
        /// What is allowed.
        allowed: String,
    },
    /// nValues = {given}: these variables have {needed}
    Length {
        /// The number of values for which the importer has room.
        given: usize,
        /// The number of values of the variables.
        needed: usize,
    },
    /// value reference {0}: there is no such variable
    NoVariable(u32),
    /// value reference {0} is of another type
    OtherType(u32),
    /// {0} has no value
    NoValue(String),
    /// {0} does not fit
    TooLarge(serde_json::Value),
    /// {0} cannot be set
    ReadOnly(&'static str),
    /// {name} cannot be set in the mode {mode:?}
    SetInMode {
        /// The variable.
        name: &'static str,
        /// The present mode.
        mode: Mode,
    },
    /// {name} = {value}: must be {allowed}
    Value {
        /// The parameter.
        name: String,
        /// Its value.
        value: String,
        /// What is allowed.
        allowed: &'static str,
    },
    /// {0} is not of this type
    FieldType(String),
    /// {0} is not a whole number
    NotWhole(String),
    /// {name}: {source}
    Json {
        /// The parameter.
        name: String,
        /// What is wrong with its text.
        source: serde_json::Error,
    },
    /// {0}
    Save(serde_json::Error),
    /// {0}
    ZeroInText(#[from] std::ffi::NulError),
    /// {0}
    Utf8(#[from] std::str::Utf8Error),
    /// policy = {policy}: {reason}
    Policy {
        /// The parameter `policy`.
        policy: String,
        /// What is wrong with the policy that it names.
        reason: String,
    },
    /// {0}
    Baseline(String),
    /// pilot: {0}
    Pilot(String),
    /// preset = {name}: {source}
    Preset {
        /// The parameter `preset`.
        name: String,
        /// The known names.
        source: jcas_core::config::UnknownName,
    },
    /// {0}
    Kernel(#[from] jcas_core::Error),
    /// {0}
    Config(#[from] jcas_core::config::text::TextError),
    /// saved state: {0}
    Memory(jcas_policy::MemoryError),
    /// saved state: its inputs are not of its fleet
    ForeignInputs,
    /// the episode has not begun
    NoEpisode,
}
