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
use crate::memory::{Due, LastStep};
use crate::{BaselineKind, MemoryError, MemoryReader, Policy, stays_to_charge};

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
            // The draws of `untrained` are whole actions, beside the motions.
            Self::Random | Self::Untrained => Way::Random(Random),
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
            last: LastStep::default(),
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
    Random(Random),
    Greedy(Greedy),
    Teams(Teams),
    Squads(Squads),
    Line(Line),
    Answer(Answer),
}

impl Way {
    fn steering(&mut self) -> &mut dyn Steering {
        match self {
            Self::Random(way) => way,
            Self::Greedy(way) => way,
            Self::Teams(way) => way,
            Self::Squads(way) => way,
            Self::Line(way) => way,
            Self::Answer(way) => way,
        }
    }

    /// Takes over the formation of an equal rule, which takes long to choose.
    fn take_formation(&mut self, other: &Self) {
        match (self, other) {
            (Self::Line(way), Self::Line(other)) => way.take_formation(other),
            (Self::Answer(way), Self::Answer(other)) => way.take_formation(other),
            _ => {}
        }
    }

    fn save(&self, write: &mut dyn FnMut(u64)) {
        match self {
            Self::Random(_) | Self::Greedy(_) => {}
            Self::Teams(way) => way.save(write),
            Self::Squads(way) => way.save(write),
            Self::Line(way) => way.save(write),
            Self::Answer(way) => way.save(write),
        }
    }
}

/// A baseline: a scripted policy.
#[derive(Debug)]
pub struct Baseline {
    kind: BaselineKind,
    pilot: PilotMode,
    way: Way,
    motions: Vec<Motion>,
    last: LastStep,
}

impl Baseline {
    /// Chooses the motions of a step. This is the part of [`Policy::act`] that can run out of
    /// memory.
    ///
    /// # Errors
    /// [`MemoryError::OutOfMemory`] if memory runs out. A later call in the same state gives the
    /// same motions as without the failure. [`MemoryError::OtherState`] if the baseline remembers
    /// another state.
    pub fn try_plan(&mut self, model: &Model<'_>, state: &StateRef<'_>) -> Result<(), MemoryError> {
        if !self.kind.remembers() {
            return Ok(self.choose(model, state)?);
        }
        match self.last.due(state)? {
            Due::Begin => {
                self.last = LastStep::default();
                self.way.steering().reset(model)?;
            }
            Due::Continue => {}
            Due::Repeat => return Ok(()),
        }
        self.choose(model, state)?;
        self.last = LastStep::at(state);
        Ok(())
    }

    fn choose(&mut self, model: &Model<'_>, state: &StateRef<'_>) -> Result<(), OutOfMemory> {
        if self.motions.len() != model.uav_count() {
            self.motions = filled(Motion::Stay, model.uav_count())?;
        }
        self.motions.fill(Motion::Stay);
        let all_confirmed = (0..model.hotspot_count()).all(|hotspot| state.confirmed(hotspot));
        if all_confirmed && self.kind.gathers() {
            gather(model, state, &mut self.motions);
            return Ok(());
        }
        self.way.steering().steer(model, state, &mut self.motions)
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

    fn reset(&mut self, _: &Model<'_>, _: u64) {
        self.last = LastStep::default();
    }

    fn remembers(&self) -> bool {
        self.kind.remembers()
    }

    fn save_memory(&self, write: &mut dyn FnMut(u64)) {
        if !self.kind.remembers() {
            return;
        }
        self.last.save(write);
        if self.last.is_some() {
            self.motions.iter().for_each(|&motion| write(motion as u64));
            self.way.save(write);
        }
    }

    fn load_memory(
        &mut self,
        model: &Model<'_>,
        read: &mut MemoryReader<'_>,
    ) -> Result<(), MemoryError> {
        if !self.kind.remembers() {
            return read.end();
        }
        let mut loaded = self.kind.build_privileged(self.pilot);
        loaded.last = LastStep::load(read)?;
        if loaded.last.is_some() {
            loaded.motions = filled(Motion::Stay, model.uav_count())?;
            for motion in &mut loaded.motions {
                *motion = Motion::ALL[read.index(Motion::ALL.len())?];
            }
            loaded.way.take_formation(&self.way);
            loaded.way.steering().reset(model)?;
            loaded.way.steering().load(model, read)?;
        }
        read.end()?;
        *self = loaded;
        Ok(())
    }

    /// # Panics
    /// It panics if memory runs out, or if the baseline remembers another state;
    /// [`Baseline::try_plan`] does not.
    fn act(&mut self, model: &Model<'_>, state: &StateRef<'_>, actions: &mut [f32]) {
        self.try_plan(model, state)
            .expect("memory for a plan, and the state after the last one");
        self.write(model, state, actions);
    }
}
