//! A baseline: a steering rule, a choice of pilot density, and the parts that all baselines share.

use core::fmt::Display;

use jcas_core::{Model, Motion, StateRef, TargetVisibility};

use super::answer::Answer;
use super::error::PolicyError;
use super::gather::gather;
use super::greedy::Greedy;
use super::line::Line;
use super::memory::{OutOfMemory, filled};
use super::pilot::PilotMode;
use super::random::{Random, Untrained};
use super::squads::Squads;
use super::steering::Steering;
use super::teams::Teams;
use crate::{BaselineKind, Policy, stays_to_charge};

impl BaselineKind {
    /// Builds the baseline.
    ///
    /// # Errors
    /// [`PolicyError::Hidden`] if it reads positions that the model hides.
    /// [`PolicyError::PilotOutOfRange`] if the model does not allow the pilot density.
    pub fn build(
        self,
        model: &Model<'_>,
        pilot: PilotMode,
    ) -> Result<Baseline, PolicyError<'static>> {
        let hidden = model.config().target_visibility == TargetVisibility::Hidden;
        if hidden && self.reads_positions() {
            return Err(PolicyError::Hidden(self));
        }
        pilot.check(model.config())?;
        Ok(self.build_privileged(pilot))
    }

    /// Builds the baseline even if it reads positions that the UAVs do not know.
    #[must_use]
    pub fn build_privileged(self, pilot: PilotMode) -> Baseline {
        let way = match self {
            Self::Random => Way::Random(Random),
            Self::Untrained => Way::Untrained,
            Self::Greedy => Way::Greedy(Greedy),
            Self::Teams => Way::Teams(Teams::new(pilot)),
            Self::Squads => Way::Squads(Squads::new(pilot)),
            Self::Line => Way::Line(Line::new(pilot)),
            Self::Answer => Way::Answer(Answer::new(pilot)),
        };
        Baseline {
            kind: self,
            pilot,
            way,
            motions: Vec::new(),
        }
    }

    /// Returns the baseline of this name.
    ///
    /// # Errors
    /// [`PolicyError::UnknownPolicy`] if no baseline has this name.
    pub fn named(text: &str) -> Result<Self, PolicyError<'_>> {
        Self::ALL
            .into_iter()
            .find(|kind| kind.name() == text)
            .ok_or(PolicyError::UnknownPolicy(text))
    }
}

/// A steering rule, stored without a heap allocation.
#[derive(Debug)]
enum Way {
    Untrained,
    Random(Random),
    Greedy(Greedy),
    Teams(Teams),
    Squads(Squads),
    Line(Line),
    Answer(Answer),
}

impl Way {
    /// The rule for motions; `None` for a baseline that draws whole actions.
    fn steering(&mut self) -> Option<&mut dyn Steering> {
        Some(match self {
            Self::Untrained => return None,
            Self::Random(way) => way,
            Self::Greedy(way) => way,
            Self::Teams(way) => way,
            Self::Squads(way) => way,
            Self::Line(way) => way,
            Self::Answer(way) => way,
        })
    }
}

/// A baseline: a scripted policy.
#[derive(Debug)]
pub struct Baseline {
    kind: BaselineKind,
    pilot: PilotMode,
    way: Way,
    motions: Vec<Motion>,
}

impl Baseline {
    /// Resets like [`Policy::reset`], and returns an error if memory runs out.
    ///
    /// # Errors
    /// [`OutOfMemory`] if memory runs out. The call must then succeed once before the next action.
    pub fn try_reset(&mut self, model: &Model<'_>, seed: u64) -> Result<(), OutOfMemory> {
        self.motions = filled(Motion::Stay, model.uav_count())?;
        match self.way.steering() {
            Some(steering) => steering.reset(model, seed),
            None => Ok(()),
        }
    }

    /// Chooses the motions of a step. This is the part of [`Policy::act`] that can run out of
    /// memory.
    ///
    /// # Errors
    /// [`OutOfMemory`] if memory runs out. A later call in the same state gives the same motions as
    /// without the failure.
    pub fn try_plan(&mut self, model: &Model<'_>, state: &StateRef<'_>) -> Result<(), OutOfMemory> {
        self.motions.fill(Motion::Stay);
        let all_confirmed = (0..model.hotspot_count()).all(|hotspot| state.confirmed(hotspot));
        if all_confirmed && self.kind.gathers() {
            gather(model, state, &mut self.motions);
            return Ok(());
        }
        match self.way.steering() {
            Some(steering) => steering.steer(model, state, &mut self.motions),
            None => Ok(()),
        }
    }

    /// Writes the actions that [`Baseline::try_plan`] has chosen in this state: (u_dir, u_pilot) of
    /// each UAV.
    pub fn write(&self, model: &Model<'_>, state: &StateRef<'_>, actions: &mut [f32]) {
        for (uav, action) in actions.chunks_exact_mut(2).enumerate() {
            if self.kind == BaselineKind::Untrained {
                let [direction, pilot] = Untrained::action(state, uav);
                action[0] = direction;
                action[1] = self.pilot.fixed(model.config()).unwrap_or(pilot);
                continue;
            }
            let charges = !self.kind.is_random() && stays_to_charge(model, state, uav);
            let motion = if charges {
                Motion::Stay
            } else {
                self.motions[uav]
            };
            action[0] = motion.to_action(model.config().motion_map);
            action[1] = self.pilot.action(model, state, uav);
        }
    }
}

impl Policy for Baseline {
    fn name(&self) -> &str {
        self.kind.name()
    }

    fn pilot(&self) -> &dyn Display {
        if self.kind == BaselineKind::Untrained && self.pilot == PilotMode::Adaptive {
            return &"drawn";
        }
        &self.pilot
    }

    /// # Panics
    /// It panics if memory runs out; [`Baseline::try_reset`] does not.
    fn reset(&mut self, model: &Model<'_>, seed: u64) {
        self.try_reset(model, seed).expect("memory for a plan");
    }

    /// # Panics
    /// It panics if memory runs out; [`Baseline::try_plan`] does not.
    fn act(&mut self, model: &Model<'_>, state: &StateRef<'_>, actions: &mut [f32]) {
        self.try_plan(model, state).expect("memory for a plan");
        self.write(model, state, actions);
    }
}
