//! Options without effect are refused, since a user believes that an accepted option acts.
//!
//! Whether an option acts may depend on the values of others, so each command names its idle
//! options itself. A default never counts as given.

use clap::parser::ValueSource;
use clap::{ArgMatches, Args};

use crate::error::CliError;

/// Options that do not act in this call, and the condition under which they do.
pub struct Idle {
    options: Vec<String>,
    applies: &'static str,
}

impl Idle {
    /// Single options, by the names of their fields.
    pub fn options(names: &[&str], applies: &'static str) -> Self {
        let options = names.iter().map(|&name| name.to_owned()).collect();
        Self { options, applies }
    }

    /// All options of a group.
    pub fn group<A: Args>(applies: &'static str) -> Self {
        let group = A::augment_args(clap::Command::new("group"));
        let ids = group.get_arguments().map(|option| option.get_id());
        let options = ids.map(ToString::to_string).collect();
        Self { options, applies }
    }
}

/// Refuses the first idle option that the command line names.
///
/// # Errors
/// The command line names one; the message says when it applies.
pub fn refuse(matches: &ArgMatches, idle: &[Idle]) -> Result<(), CliError> {
    let mut leaf = matches;
    while let Some((_, inner)) = leaf.subcommand() {
        leaf = inner;
    }
    for Idle { options, applies } in idle {
        for option in options {
            if leaf.value_source(option) == Some(ValueSource::CommandLine) {
                let flag = option.replace('_', "-");
                let message = format!("--{flag}: has no effect here; it applies {applies}");
                return Err(CliError::Input(message));
            }
        }
    }
    Ok(())
}
