//! A baseline: a way to steer, a choice of pilot density, and what all baselines share.

use core::fmt;
use core::str::FromStr;

use jcas_core::{Model, Motion, StateRef, TargetVisibility};

use super::charge::stays_to_charge;
use super::gather::gather;
use super::pilot::PilotMode;
use super::{Greedy, Policy, Random, Swarm, Sweep, Teams};

/// How a baseline moves while hotspots are unconfirmed.
pub trait Steering: Send {
    /// Before the first step of an episode.
    fn reset(&mut self, model: &Model<'_>, seed: u64) {
        let _ = (model, seed);
    }

    /// Writes each UAV's motion. Motions of UAVs that are grounded or return to base have no effect.
    fn steer(&mut self, model: &Model<'_>, state: &StateRef<'_>, motions: &mut [Motion]);
}

/// Which baseline.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BaselineKind {
    /// [`Random`].
    Random,
    /// [`Greedy`].
    Greedy,
    /// [`Swarm`].
    Swarm,
    /// [`Teams`].
    Teams,
    /// [`Sweep`].
    Sweep,
}

impl BaselineKind {
    /// All baselines.
    pub const ALL: [Self; 5] = [
        Self::Random,
        Self::Greedy,
        Self::Swarm,
        Self::Teams,
        Self::Sweep,
    ];

    /// As it is typed.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Random => "random",
            Self::Greedy => "greedy",
            Self::Swarm => "swarm",
            Self::Teams => "teams",
            Self::Sweep => "sweep",
        }
    }

    /// Whether it steers by the positions of hotspots that no UAV knows yet.
    #[must_use]
    pub fn reads_positions(self) -> bool {
        matches!(self, Self::Greedy | Self::Swarm | Self::Teams)
    }

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

impl fmt::Display for BaselineKind {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        out.write_str(self.name())
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

/// Why a baseline cannot be had.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum PolicyError {
    /// No baseline has this name.
    UnknownPolicy(String),
    /// No pilot mode has this name.
    UnknownPilot(String),
    /// The mission does not allow this pilot density.
    PilotOutOfRange {
        /// What was asked for.
        density: f64,
        /// The least that is allowed.
        low: f64,
        /// The most that is allowed.
        high: f64,
    },
    /// It needs positions that are hidden.
    Hidden(BaselineKind),
}

impl fmt::Display for PolicyError {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::UnknownPolicy(name) => write!(
                out,
                "policy = {name}: must be one of random, greedy, swarm, teams, sweep"
            ),
            Self::UnknownPilot(name) => write!(
                out,
                "pilot = {name}: must be one of min, mid, max, adaptive, or a density such as 0.15"
            ),
            Self::PilotOutOfRange { density, low, high } => write!(
                out,
                "pilot = {density}: must be a density from {low} (pilot_density_min) to {high} (pilot_density_max)"
            ),
            Self::Hidden(kind) => write!(
                out,
                "policy = {kind}: steers by positions that target_visibility = hidden withholds; \
                 must be one of random, sweep"
            ),
        }
    }
}

impl std::error::Error for PolicyError {}

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

/// Whether a UAV goes where it is told: neither grounded, nor on its way to a depot, nor charging.
pub(super) fn can_fly(state: &StateRef<'_>, uav: usize) -> bool {
    !state.grounded(uav) && !state.returning(uav)
}
