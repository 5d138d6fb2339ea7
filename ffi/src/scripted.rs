//! Controllers without a network: baselines, and the policies that plan. They work on the heap.

use ::jcas_policy::{Baseline, BaselineKind, OutOfMemory, PilotMode, Policy};
use jcas_core::{Model, StateRef};
use jcas_plan::{PlanError, Planned};

use crate::status::{Fault, JCAS_ERROR_ARGUMENT, JCAS_ERROR_RESOURCES};

impl From<OutOfMemory> for Fault {
    fn from(_: OutOfMemory) -> Self {
        Self::Status(JCAS_ERROR_RESOURCES)
    }
}

impl From<PlanError> for Fault {
    fn from(error: PlanError) -> Self {
        Self::Status(match error {
            PlanError::OutOfMemory { .. } => JCAS_ERROR_RESOURCES,
            _ => JCAS_ERROR_ARGUMENT,
        })
    }
}

/// What the controllers of a policy begin as.
// A planned one is stored in its handle's own memory.
#[allow(clippy::large_enum_variant)]
pub(crate) enum Script {
    Baseline(BaselineKind, PilotMode),
    Planned(Planned),
}

impl Script {
    /// Begins a controller. It takes no memory: copies share their first plan.
    fn begin(&self) -> Controller {
        match self {
            Self::Baseline(kind, mode) => Controller::Baseline(kind.build_privileged(*mode)),
            Self::Planned(planned) => Controller::Planned(planned.clone()),
        }
    }
}

// As above.
#[allow(clippy::large_enum_variant)]
enum Controller {
    Baseline(Baseline),
    Planned(Planned),
}

/// A controller and the episode that it is in.
struct Flown {
    controller: Controller,
    seed: Option<u64>,
}

impl Flown {
    fn plan(&mut self, model: &Model<'_>, state: &StateRef<'_>) -> Result<(), Fault> {
        let seed = state.seed();
        let begins = state.t() == 0 || self.seed != Some(seed);
        if begins {
            self.seed = None;
        }
        match &mut self.controller {
            Controller::Baseline(baseline) => {
                if begins {
                    baseline.try_reset(model, seed)?;
                }
                self.seed = Some(seed);
                baseline.try_plan(model, state)?;
            }
            Controller::Planned(planned) => {
                if begins {
                    planned.reset(model, seed);
                }
                self.seed = Some(seed);
                planned.try_plan(model, state)?;
            }
        }
        Ok(())
    }
}

/// A script and its controllers, one for each environment of a batch. The first one also acts for
/// single simulations.
pub(crate) struct Scripted {
    script: Script,
    each: Vec<Flown>,
}

impl Scripted {
    pub(crate) fn new(script: Script) -> Self {
        Self {
            script,
            each: Vec::new(),
        }
    }

    /// Prepares the actions for a state. This is the part that takes memory.
    pub(crate) fn plan(
        &mut self,
        place: usize,
        model: &Model<'_>,
        state: &StateRef<'_>,
    ) -> Result<(), Fault> {
        let missing = (place + 1).saturating_sub(self.each.len());
        self.each
            .try_reserve(missing)
            .map_err(|_| Fault::Status(JCAS_ERROR_RESOURCES))?;
        while self.each.len() <= place {
            self.each.push(Flown {
                controller: self.script.begin(),
                seed: None,
            });
        }
        self.each[place].plan(model, state)
    }

    /// Writes the actions that [`Scripted::plan`] has prepared.
    pub(crate) fn write(
        &self,
        place: usize,
        model: &Model<'_>,
        state: &StateRef<'_>,
        actions: &mut [f32],
    ) {
        match &self.each[place].controller {
            Controller::Baseline(baseline) => baseline.write(model, state, actions),
            Controller::Planned(planned) => planned.write(model, state, actions),
        }
    }
}
