//! The errors of the kernel and their messages.

use core::fmt;

/// A refused value, for messages.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Value {
    /// A whole number.
    Integer(u64),
    /// A real number.
    Real(f64),
    /// A cell (x, y).
    Cell(u32, u32),
    /// A pair of real numbers.
    Pair(f64, f64),
    /// A value in words.
    Name(&'static str),
}

impl fmt::Display for Value {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Integer(value) => write!(out, "{value}"),
            Self::Real(value) => write!(out, "{value:?}"),
            Self::Cell(x, y) => write!(out, "[{x}, {y}]"),
            Self::Pair(x, y) => write!(out, "[{x:?}, {y:?}]"),
            Self::Name(name) => out.write_str(name),
        }
    }
}

/// Description of the legal values, for messages.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Allowed {
    /// A finite number between two bounds, both included.
    Range(f64, f64),
    /// At most a bound that follows from other fields.
    AtMost(f64, &'static str),
    /// A rule in words.
    Rule(&'static str),
}

impl fmt::Display for Allowed {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Range(low, high) => write!(out, "a number from {low} to {high}"),
            Self::AtMost(bound, why) => write!(out, "at most {bound} ({why})"),
            Self::Rule(rule) => out.write_str(rule),
        }
    }
}

/// A configuration field or an argument outside its legal range.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ConfigError {
    /// Name of the field.
    pub field: &'static str,
    /// The value that was refused.
    pub value: Value,
    /// The legal values.
    pub allowed: Allowed,
}

impl fmt::Display for ConfigError {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            field,
            value,
            allowed,
        } = self;
        match (value, allowed) {
            (Value::Integer(_), Allowed::Range(low, high)) => {
                write!(
                    out,
                    "{field} = {value}: must be a whole number from {low} to {high}"
                )
            }
            _ => write!(out, "{field} = {value}: must be {allowed}"),
        }
    }
}

/// Reason for refusing the bytes of a snapshot.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Corruption {
    /// The bytes are shorter or longer than a snapshot of this model.
    Length,
    /// The first eight bytes are not those of a snapshot.
    Magic,
    /// The snapshot has another version of the format.
    Version,
    /// The checksum does not match the content.
    Checksum,
    /// The checksum matches, but the state violates an invariant of the kernel.
    Content,
}

/// An error of the kernel. A call that returns an error has not changed the caller's data.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Error {
    /// A configuration field is outside its range.
    Config(ConfigError),
    /// An action component is NaN.
    ActionNan {
        /// Index of the UAV.
        uav: usize,
        /// The component: 0 for the direction, 1 for the pilot density.
        component: usize,
    },
    /// A buffer has the wrong length.
    Length {
        /// Name of the buffer.
        what: &'static str,
        /// Elements that it must have.
        expected: usize,
        /// Elements that it has.
        got: usize,
    },
    /// A value that a host supplied is outside its range.
    Argument(ConfigError),
    /// The state belongs to a model with another configuration, or was never reset.
    ModelMismatch,
    /// The working memory of a step has fewer words than the model needs.
    ScratchTooSmall {
        /// Words that it must have at least.
        words_min: usize,
        /// Words that it has.
        words: usize,
    },
    /// A part of the step was called out of its order.
    OutOfOrder {
        /// Name of the call.
        called: &'static str,
        /// Name of the call that must come before.
        after: &'static str,
    },
    /// The episode has ended; reset first.
    EpisodeOver,
    /// Saved bytes are not a snapshot of this model.
    Corrupt(Corruption),
}

impl From<ConfigError> for Error {
    fn from(error: ConfigError) -> Self {
        Self::Config(error)
    }
}

impl fmt::Display for Error {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Config(error) | Self::Argument(error) => error.fmt(out),
            Self::ActionNan { uav, component } => write!(
                out,
                "actions[{uav}][{component}] = NaN: must be a number (clipped to -1..1)"
            ),
            Self::Length {
                what,
                expected,
                got,
            } => write!(out, "{what} has {got} elements: must have {expected}"),
            Self::ModelMismatch => out.write_str(
                "the state was never reset or belongs to another configuration: \
                 reset it with this model",
            ),
            Self::ScratchTooSmall { words_min, words } => write!(
                out,
                "the scratch has {words} words: must have at least {words_min}"
            ),
            Self::OutOfOrder { called, after } => {
                write!(out, "{called} was called out of order: {after} comes first")
            }
            Self::EpisodeOver => out.write_str("the episode has ended: reset before the next step"),
            Self::Corrupt(what) => write!(
                out,
                "not a snapshot of this model: {}",
                match what {
                    Corruption::Length => "wrong length",
                    Corruption::Magic => "it does not begin as a snapshot does",
                    Corruption::Version => "another version of the format",
                    Corruption::Checksum => "the checksum does not match",
                    Corruption::Content => "its content contradicts itself",
                }
            ),
        }
    }
}

impl core::error::Error for ConfigError {}
impl core::error::Error for Error {}
