//! Controllers without a network: baselines, and the policies that plan. They work on the heap.

use ::jcas_policy::memory::{LastStep, Step};
use ::jcas_policy::{Baseline, BaselineKind, MemoryError, MemoryReader, PilotMode, Policy};
use jcas_core::hash::Fnv1a;
use jcas_core::{Model, StateRef};
use jcas_plan::{PlanError, Planned};

use crate::status::{
    Fault, JCAS_ERROR_ARGUMENT, JCAS_ERROR_CORRUPT, JCAS_ERROR_MEMORY, JCAS_ERROR_RESOURCES,
};
use crate::timeline::Timeline;

impl From<MemoryError> for Fault {
    fn from(error: MemoryError) -> Self {
        Self::Status(match error {
            MemoryError::OtherState { .. } => JCAS_ERROR_MEMORY,
            MemoryError::Corrupt => JCAS_ERROR_CORRUPT,
            MemoryError::OutOfMemory => JCAS_ERROR_RESOURCES,
        })
    }
}

impl From<PlanError> for Fault {
    fn from(error: PlanError) -> Self {
        Self::Status(match error {
            PlanError::OutOfMemory { .. } => JCAS_ERROR_RESOURCES,
            PlanError::Memory(error) => return error.into(),
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

impl Controller {
    fn policy(&self) -> &dyn Policy {
        match self {
            Self::Baseline(baseline) => baseline,
            Self::Planned(planned) => planned,
        }
    }

    fn policy_mut(&mut self) -> &mut dyn Policy {
        match self {
            Self::Baseline(baseline) => baseline,
            Self::Planned(planned) => planned,
        }
    }
}

/// Where a state stands: its timeline, and its step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Place {
    timeline: Timeline,
    step: Step,
}

impl Place {
    pub(crate) fn of(timeline: Timeline, state: &StateRef<'_>) -> Self {
        Self {
            timeline,
            step: Step::of(state),
        }
    }

    /// Returns whether a state is this one or the next one.
    fn leads_to(self, now: Self) -> bool {
        let (acted, given) = (self.step, now.step);
        let next = acted.t.checked_add(1) == Some(given.t);
        self.timeline == now.timeline && acted.seed == given.seed && (acted.t == given.t || next)
    }
}

/// A controller, and the place at which it last acted, if it remembers one.
pub(crate) struct Flown {
    controller: Controller,
    acted: Option<Place>,
}

impl Flown {
    /// Returns whether the controller remembers the state before this one, or this one. It is an
    /// error if it remembers another one. At t = 0 what it remembers does not matter.
    pub(crate) fn remembers(&self, now: Place) -> Result<bool, Fault> {
        match self.acted {
            Some(acted) if now.step.t > 0 => {
                if acted.leads_to(now) {
                    Ok(true)
                } else {
                    Err(Fault::Status(JCAS_ERROR_MEMORY))
                }
            }
            _ => Ok(false),
        }
    }

    /// Prepares the actions for a state. This is the part that takes memory.
    pub(crate) fn plan(
        &mut self,
        now: Place,
        model: &Model<'_>,
        state: &StateRef<'_>,
    ) -> Result<(), Fault> {
        self.remembers(now)?;
        match &mut self.controller {
            Controller::Baseline(baseline) => baseline.try_plan(model, state)?,
            Controller::Planned(planned) => planned.try_plan(model, state)?,
        }
        self.acted = self.controller.policy().remembers().then_some(now);
        Ok(())
    }

    /// Writes the actions that [`Flown::plan`] has prepared.
    pub(crate) fn write(&self, model: &Model<'_>, state: &StateRef<'_>, actions: &mut [f32]) {
        match &self.controller {
            Controller::Baseline(baseline) => baseline.write(model, state, actions),
            Controller::Planned(planned) => planned.write(model, state, actions),
        }
    }
}

/// Whom a policy acts for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Whom {
    /// A simulation.
    Sim,
    /// The environment of a batch with this index.
    Environment(usize),
}

/// A script and its controllers, one for simulations and one for each environment of a batch.
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

    /// Returns the controller for someone, which begins if there is none.
    fn flown(&mut self, whom: Whom) -> Result<&mut Flown, Fault> {
        let index = index_of(whom);
        let missing = (index + 1).saturating_sub(self.each.len());
        self.each
            .try_reserve(missing)
            .map_err(|_| Fault::Status(JCAS_ERROR_RESOURCES))?;
        while self.each.len() <= index {
            self.each.push(Flown {
                controller: self.script.begin(),
                acted: None,
            });
        }
        Ok(&mut self.each[index])
    }

    /// Returns the controllers for the environments of a batch, which begin if there are none.
    pub(crate) fn environments(&mut self, count: usize) -> Result<&mut [Flown], Fault> {
        let last = count.saturating_sub(1);
        self.flown(Whom::Environment(last))?;
        Ok(&mut self.each[1..=count])
    }

    /// Prepares the actions for a state, as [`Flown::plan`].
    pub(crate) fn plan(
        &mut self,
        whom: Whom,
        timeline: Timeline,
        model: &Model<'_>,
        state: &StateRef<'_>,
    ) -> Result<(), Fault> {
        self.flown(whom)?
            .plan(Place::of(timeline, state), model, state)
    }

    /// Writes the actions that [`Scripted::plan`] has prepared.
    pub(crate) fn write(
        &self,
        whom: Whom,
        model: &Model<'_>,
        state: &StateRef<'_>,
        actions: &mut [f32],
    ) {
        self.each[index_of(whom)].write(model, state, actions);
    }

    /// Makes every controller begin anew in the next state that it acts in.
    pub(crate) fn forget(&mut self, model: &Model<'_>) {
        for flown in &mut self.each {
            flown.controller.policy_mut().reset(model, 0);
            flown.acted = None;
        }
    }

    /// Returns a number that equal scripts share.
    pub(crate) fn fingerprint(&self) -> u64 {
        let mut hash = Fnv1a::new();
        match &self.script {
            Script::Baseline(kind, mode) => {
                hash.write(kind.name().as_bytes());
                let density = match mode {
                    PilotMode::Fixed(density) => density.to_bits(),
                    _ => PilotMode::ALL
                        .iter()
                        .position(|other| other == mode)
                        .unwrap_or(0) as u64,
                };
                hash.write(&density.to_le_bytes());
            }
            Script::Planned(planned) => hash.write(planned.name().as_bytes()),
        }
        hash.finish()
    }

    /// Writes what the controller for someone remembers before a state; nothing where it does not
    /// matter.
    pub(crate) fn save(
        &self,
        whom: Whom,
        now: Place,
        write: &mut dyn FnMut(u64),
    ) -> Result<(), Fault> {
        let Some(flown) = self.each.get(index_of(whom)) else {
            return Ok(());
        };
        if flown.remembers(now)? {
            flown.controller.policy().save_memory(write);
        }
        Ok(())
    }

    /// Returns the words of [`Scripted::save`].
    pub(crate) fn remembered(&self, whom: Whom, now: Place) -> Result<Vec<u64>, Fault> {
        let mut count = 0;
        self.save(whom, now, &mut |_| count += 1)?;
        let mut words = Vec::new();
        words
            .try_reserve_exact(count)
            .map_err(|_| Fault::Status(JCAS_ERROR_RESOURCES))?;
        self.save(whom, now, &mut |word| words.push(word))?;
        Ok(words)
    }

    /// Replaces what the controller for someone remembers. Without words it remembers nothing.
    pub(crate) fn load(
        &mut self,
        whom: Whom,
        now: Place,
        model: &Model<'_>,
        words: &[u64],
    ) -> Result<(), Fault> {
        let flown = self.flown(whom)?;
        let policy = flown.controller.policy_mut();
        if words.is_empty() {
            policy.reset(model, 0);
            flown.acted = None;
            return Ok(());
        }
        policy.load_memory(model, &mut MemoryReader::new(words))?;
        // The step at which it acted comes first.
        let acted = LastStep::load(&mut MemoryReader::new(words))?;
        flown.acted = acted.step().map(|step| Place { step, ..now });
        Ok(())
    }
}

const fn index_of(whom: Whom) -> usize {
    match whom {
        Whom::Sim => 0,
        Whom::Environment(index) => index + 1,
    }
}
