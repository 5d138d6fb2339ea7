//! Planning policies, which are named `plan`, `replan`, or `plan:` and a file.

use std::path::Path;

use jcas_core::{Model, TargetVisibility};
use jcas_episode::plan_file::PlanFile;
use jcas_episode::planned::{Planned, PlannedTour, Replanned, checked};

use crate::error::CliError;
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
    policy == "plan" || policy == "replan" || file_of(policy).is_some()
}

/// Reads a plan.
///
/// # Errors
/// The file cannot be read or is no plan.
pub fn read(path: &Path) -> Result<PlanFile, CliError> {
    let text = std::fs::read_to_string(path).map_err(CliError::io(path))?;
    PlanFile::parse(&text).map_err(|error| CliError::file(path, error))
}

/// Makes the policy of this name; `None` if the name is not that of a planning policy.
///
/// # Errors
/// A plan cannot be made, or its file does not fit the model.
pub fn factory(policy: &str, model: &Model<'_>) -> Result<Option<PolicyFactory>, CliError> {
    if let Some(path) = file_of(policy) {
        let file = read(path)?;
        let plan = file
            .plan(model)
            .map_err(|error| CliError::file(path, error))?;
        return Ok(Some(Box::new(move || Box::new(Planned::new(plan.clone())))));
    }
    if !is_plan(policy) {
        return Ok(None);
    }
    checked(model).map_err(CliError::input)?;
    if policy == "replan" {
        let policy = Replanned::new(model).map_err(CliError::input)?;
        return Ok(Some(Box::new(move || Box::new(policy.clone()))));
    }
    if model.config().target_visibility == TargetVisibility::Known {
        return Ok(Some(Box::new(|| Box::new(PlannedTour::default()))));
    }
    let plan = Planned::search(model).map_err(CliError::input)?;
    Ok(Some(Box::new(move || Box::new(Planned::new(plan.clone())))))
}
