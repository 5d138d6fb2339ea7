//! The reasons why a request is refused.

use displaydoc::Display;
use jcas_core::config::text::TextError;
use jcas_episode::trace::TraceError;
use jcas_plan::PlanError;
use jcas_policy::PolicyError;
use jcas_policy::network::{FlyError, LoadError};

/// The reason why a request is refused. The text names the field, the value and what is allowed.
#[derive(Debug, Display, thiserror::Error)]
pub(crate) enum Refusal<'q> {
    /// the question cannot be read: {0}
    Question(serde_json::Error),
    /// {0}
    Config(#[from] TextError),
    /// {0}
    Kernel(#[from] jcas_core::Error),
    /// {field} = {value}: the page runs at most {most}
    RunSize {
        /// The field, or a product of fields.
        field: &'static str,
        /// Its value.
        value: u64,
        /// The greatest value that the page accepts.
        most: u64,
    },
    /// {field} = {value}: the page plans for at most {most}
    PlanSize {
        /// The field, or a product of fields.
        field: &'static str,
        /// Its value.
        value: u64,
        /// The greatest value that the page plans for.
        most: u64,
    },
    /// interventions: t = 0: the first step is 1
    StepZero,
    /// interventions: {what} = {index}: must be below {count}
    Index {
        /// What is counted.
        what: &'static str,
        /// The index in the request.
        index: usize,
        /// How many there are.
        count: usize,
    },
    /// {0}
    Load(#[from] LoadError),
    /// {0}
    Network(#[from] FlyError),
    /// {0}
    Baseline(PolicyError<'q>),
    /// {0}
    Plan(#[from] PlanError),
    /// {0}
    Trace(#[from] TraceError),
}
