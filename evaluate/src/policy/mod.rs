//! Policies: whatever turns the state of a mission into the next actions, and the baselines that every
//! learned policy is compared with.
//!
//! # What a baseline reads
//!
//! | baseline | steers by | privileged |
//! | --- | --- | --- |
//! | `random` | nothing: five equally likely motions | no |
//! | `greedy` | each UAV's own cell, the hotspots' cells and which are confirmed | positions |
//! | `swarm` | all UAVs' cells, the hotspots' cells and which are confirmed | positions |
//! | `teams` | all UAVs' cells and who can fly, the hotspots' cells and which are confirmed | positions |
//! | `sweep` | all UAVs' cells and who can fly; of the hotspots only how many are left | no |
//!
//! *Privileged* means: it reads the positions of hotspots that no UAV knows. With
//! `target_visibility = "known"` (the paper) every UAV observes these positions, so nobody is
//! privileged. With `"hidden"` they are withheld, and [`BaselineKind::build`] refuses the three
//! baselines that read them; [`BaselineKind::build_privileged`] builds them all the same, as a bound from
//! above or as a teacher.
//!
//! All of them, once every hotspot is confirmed, gather so that those who know less meet those who know
//! more ([`gather()`]); this and the decision to stay on a depot until a flight is worth while
//! ([`stays_to_charge`]) are shared. Both read what every UAV knows and its charge, which a real fleet would
//! have to exchange: the baselines are centralised, the learned policies are not.

mod baseline;
mod charge;
mod gather;
mod greedy;
mod pilot;
mod quorum;
mod random;
mod route;
mod swarm;
mod sweep;
mod teams;

pub use baseline::{Baseline, BaselineKind, PolicyError, Steering};
pub use charge::stays_to_charge;
pub use gather::gather;
pub use greedy::Greedy;
pub use pilot::{ADAPTIVE_RANGE_CELLS, PilotMode, action_of};
pub use quorum::quorum_probability;
pub use random::Random;
pub use route::route;
pub use swarm::Swarm;
pub use sweep::Sweep;
pub use teams::Teams;

use jcas_core::{Model, StateRef};

/// Decides the actions of a whole fleet, step by step.
pub trait Policy: Send {
    /// What reports and traces call it.
    fn name(&self) -> &str;

    /// What reports and traces call its choice of pilot density: a [`PilotMode`], or `learned`.
    fn pilot(&self) -> &str {
        "learned"
    }

    /// Called before the first step of every episode. All randomness has to follow from `seed`.
    fn reset(&mut self, model: &Model<'_>, seed: u64) {
        let _ = (model, seed);
    }

    /// Whether [`Policy::see`] has to be called before each [`Policy::act`].
    fn reads_observations(&self) -> bool {
        false
    }

    /// Hands over what the UAVs observe, one row for each UAV.
    fn see(&mut self, observations: &[f32]) {
        let _ = observations;
    }

    /// Writes (u_dir, u_pilot) of each UAV into `actions`, whose length is twice the number of UAVs.
    fn act(&mut self, model: &Model<'_>, state: &StateRef<'_>, actions: &mut [f32]);
}
