//! Planning policies, which are named `plan`, `replan`, or `plan:` and a file.

use std::path::Path;

use jcas_core::Model;
use jcas_plan::{PlanFile, Planned, PlannedKind};

use crate::error::CliError;
use crate::files;
use crate::learned::PolicyFactory;

/// Prefix of the name of a policy that is read from a plan.
const FILE: &str = "plan:";

/// The file of a policy `plan:FILE`.
#[must_use]
pub fn file_of(policy: &str) -> Option<&Path> {
    policy.strip_prefix(FILE).map(Path::new)
}

/// Whether a policy of this name follows plans.
#[must_use]
pub fn is_plan(policy: &str) -> bool {
    PlannedKind::named(policy).is_some() || file_of(policy).is_some()
}

/// Reads a plan.
///
/// # Errors
/// The file cannot be read or is no plan.
pub fn read(path: &Path) -> Result<PlanFile, CliError> {
    let text = files::read_text(path)?;
    PlanFile::parse(&text).map_err(|error| CliError::file(path, error))
}

/// Makes the policy of this name; `None` if the name is not that of a planning policy.
///
/// # Errors
/// A plan cannot be made, or its file does not fit the model.
pub fn factory(policy: &str, model: &Model<'_>) -> Result<Option<PolicyFactory>, CliError> {
    let planned = if let Some(path) = file_of(policy) {
        let plan = read(path)?.plan(model);
        Planned::following(plan.map_err(|error| CliError::file(path, error))?)
    } else if let Some(kind) = PlannedKind::named(policy) {
        kind.build(model).map_err(CliError::input)?
    } else {
        return Ok(None);
    };
    Ok(Some(Box::new(move || Box::new(planned.clone()))))
}
