//! Trained policies, which are named by a folder with a `policy.json` in place of a baseline.

use std::path::Path;

use jcas_core::{Model, Printable};
use jcas_episode::card::{CARD, Card, CardError, StoredPolicy, load, load_card};
use jcas_policy::head::Mode;
use jcas_policy::{PilotMode, Policy, PolicyNames, similar};

use crate::error::CliError;
use crate::planned;

/// A function that makes one policy for each worker.
pub type PolicyFactory = Box<dyn Fn() -> Box<dyn Policy> + Sync>;

/// Whether a name is a folder with a trained policy.
pub fn is_policy(name: &str) -> bool {
    Path::new(name).join(CARD).is_file()
}

/// The error of a name that is neither that of a baseline nor a folder with a trained policy.
pub fn absent(name: &str) -> CliError {
    let reason = if Path::new(name).is_dir() {
        format!("the folder holds no {CARD}")
    } else {
        "there is no such folder".to_owned()
    };
    let hint = similar(name).map_or(String::new(), |near| format!("; did you mean {near}?"));
    CliError::input(format!(
        "policy = {name}: must be one of {PolicyNames}, plan:FILE, or the folder of a trained \
         policy, with a {CARD}; {reason}{hint}"
    ))
}

/// The pilot rule that a report names. An adaptive trained policy follows its own, or has the
/// constant density of its card.
pub fn pilot_rule(policy: &str, pilot: &str) -> Result<String, CliError> {
    if planned::is_plan(policy) {
        return Ok("planned".to_owned());
    }
    let own = matches!(PilotMode::named(pilot), Ok(PilotMode::Adaptive)) && is_policy(policy);
    if !own {
        return Ok(pilot.to_owned());
    }
    let constant = card(Path::new(policy))?.constant_pilot_density;
    Ok(constant.map_or_else(|| "learned".to_owned(), |density| density.to_string()))
}

/// Reads a trained policy and checks that it fits the model.
pub fn open(folder: &Path, model: &Model<'_>) -> Result<StoredPolicy, CliError> {
    let stored = load(folder)?;
    stored.check(model)?;
    Ok(stored)
}

/// The description of a trained policy on its card.
pub fn card(folder: &Path) -> Result<Card, CliError> {
    Ok(load_card(folder)?)
}

/// Prints on standard error where a configuration differs from the one of a policy's training.
pub fn say_changes(policy: &str, changes: &[(&str, String)]) {
    if !changes.is_empty() {
        let words: Vec<&str> = changes.iter().map(|(_, words)| words.as_str()).collect();
        let line = format!(
            "{policy}: its card's configuration, but {}",
            words.join(", ")
        );
        eprintln!("{}", Printable(line));
    }
}

/// Makes a trained policy for each worker. Without `mode`, the card's mode applies. An adaptive
/// pilot density is the policy's own; otherwise it is fixed.
pub fn factory(
    folder: &Path,
    pilot: &str,
    model: &Model<'_>,
    mode: Option<Mode>,
) -> Result<PolicyFactory, CliError> {
    let mut stored = open(folder, model)?;
    let pilot = PilotMode::named(pilot)?;
    pilot.check(model.config())?;
    if let Some(action) = pilot.fixed(model.config()) {
        stored = stored.holding(action);
    }
    Ok(Box::new(move || Box::new(stored.policy(mode))))
}

impl From<CardError> for CliError {
    fn from(error: CardError) -> Self {
        match error {
            CardError::File(path, error) => Self::Io(path, error),
            other => Self::input(other),
        }
    }
}
