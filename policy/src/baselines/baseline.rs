//! A baseline: a way to steer, a choice of pilot density, and what all baselines share.

use core::str::FromStr;

use jcas_core::{Model, Motion, StateRef, TargetVisibility};

use super::charge::stays_to_charge;
use super::charging::Charging;
use super::error::PolicyError;
use super::frontier::Frontier;
use super::gather::gather;
use super::greedy::Greedy;
use super::kind::BaselineKind;
use super::line::Line;
use super::pilot::PilotMode;
use super::random::Random;
use super::steering::Steering;
use super::swarm::Swarm;
use super::sweep::Sweep;
use super::teams::Teams;
use crate::Policy;

impl BaselineKind {
    /// Builds the baseline.
    ///
    /// # Errors
    /// [`PolicyError::Hidden`] where it reads positions that the model withholds from the UAVs,
    /// [`PolicyError::PilotOutOfRange`] where the mission does not allow the pilot density.
    pub fn build(self, model: &Model<'_>, pilot: PilotMode) -> Result<Baseline, PolicyError> {
        let hidden = model.config().target_visibility == TargetVisibility::Hidden;
        if hidden && self.reads_positions() {
            return Err(PolicyError::Hidden(self));
        }
        pilot.check(model.config())?;
        Ok(self.build_privileged(pilot))
    }

    /// Builds the baseline even where it reads positions that the UAVs do not know.
    #[must_use]
    pub fn build_privileged(self, pilot: PilotMode) -> Baseline {
        let steering: Box<dyn Steering> = match self {
            Self::Random => Box::new(Random::default()),
            Self::Greedy => Box::new(Greedy),
            Self::Swarm => Box::new(Swarm),
            Self::Teams => Box::new(Teams::new(pilot)),
            Self::Sweep => Box::new(Sweep::new(pilot)),
            Self::Line => Box::new(Line::new(pilot)),
            Self::Frontier => Box::new(Frontier::new(pilot)),
            Self::Relay => Box::new(Frontier::connected(pilot)),
            Self::Charging => Box::new(Charging::greedy(pilot)),
            Self::Clean => Box::new(Charging::clean(pilot)),
        };
        Baseline {
            kind: self,
            pilot,
            pilot_name: pilot.name(),
            steering,
            motions: Vec::new(),
        }
    }
}

impl FromStr for BaselineKind {
    type Err = PolicyError;

    fn from_str(text: &str) -> Result<Self, PolicyError> {
        Self::ALL
            .into_iter()
            .find(|kind| kind.name() == text)
            .ok_or_else(|| PolicyError::UnknownPolicy(text.to_owned()))
    }
}

/// A baseline, ready to fly.
pub struct Baseline {
    kind: BaselineKind,
    pilot: PilotMode,
    pilot_name: String,
    steering: Box<dyn Steering>,
    motions: Vec<Motion>,
}

impl Policy for Baseline {
    fn name(&self) -> &str {
        self.kind.name()
    }

    fn pilot(&self) -> &str {
        &self.pilot_name
    }

    fn reset(&mut self, model: &Model<'_>, seed: u64) {
        self.steering.reset(model, seed);
    }

    fn act(&mut self, model: &Model<'_>, state: &StateRef<'_>, actions: &mut [f32]) {
        self.motions.clear();
        self.motions.resize(model.uav_count(), Motion::Stay);
        if (0..model.hotspot_count()).all(|hotspot| state.confirmed(hotspot)) {
            gather(model, state, &mut self.motions);
        } else {
            self.steering.steer(model, state, &mut self.motions);
        }
        for (uav, action) in actions.chunks_exact_mut(2).enumerate() {
            let motion = if stays_to_charge(model, state, uav) {
                Motion::Stay
            } else {
                self.motions[uav]
            };
            action[0] = motion.to_action();
            action[1] = self.pilot.action(model, state, uav);
        }
    }
}
