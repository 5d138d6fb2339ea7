//! The baselines: scripted policies that every learned policy is compared with.
//!
//! # What a baseline reads
//!
//! | baseline | steers by | privileged |
//! | --- | --- | --- |
//! | `random` | nothing: five equally likely motions | no |
//! | `untrained` | nothing: clipped normal draws of both action components | no |
//! | `greedy` | each UAV's own cell, the hotspots' cells and which are confirmed | positions |
//! | `swarm` | all UAVs' cells, the hotspots' cells and which are confirmed | positions |
//! | `teams` | cells of UAVs that can fly, hotspots' cells and which are confirmed | positions |
//! | `squads` | as `teams`, but each radio component by what its members know or knew | positions |
//! | `sweep` | cells of UAVs that can fly; of the hotspots only the number left | no |
//! | `line` | as `sweep` | no |
//! | `frontier` | as `sweep`; a search map per team (or visited cells), other teams' targets | no |
//! | `relay` | as `frontier`, and the link budget between teams | no |
//! | `answer` | as `line`; what each UAV knows of reports | no |
//! | `charging` | as `teams`, and every UAV's charge | positions |
//! | `clean` | as `charging`, and the carbon intensity of the next step | positions |
//!
//! A *privileged* baseline reads the positions of hotspots that no UAV knows. With
//! `target_visibility = "known"` (the paper) every UAV observes these positions, so no baseline is
//! privileged. With `"hidden"` they are withheld, and [`BaselineKind::build`] refuses the baselines
//! that read them. [`BaselineKind::build_privileged`] builds them anyway, as an upper bound or as a
//! teacher.
//!
//! `random` and `untrained` read nothing at all. Once every hotspot is confirmed, the others but
//! `squads` gather, so that UAVs share what they know ([`gather()`]). This rule reads the cells of
//! all UAVs, which a real fleet would have to exchange. They stay on a depot until a flight is
//! worth while, by their own charge ([`stays_to_charge`](crate::stays_to_charge)). The baselines
//! are centralised, but for `squads`; the learned policies are not.

mod answer;
mod assignment;
mod baseline;
mod charging;
mod division;
mod error;
mod frontier;
mod gather;
mod greedy;
mod kind;
mod line;
mod memory;
mod myopic;
mod pilot;
mod quorum;
mod random;
mod route;
mod squads;
mod steering;
mod swarm;
mod sweep;
mod teams;

pub use answer::Answer;
pub use baseline::Baseline;
pub use charging::Charging;
pub use error::PolicyError;
pub use frontier::Frontier;
pub use gather::gather;
pub use greedy::Greedy;
pub use kind::BaselineKind;
pub use line::Line;
pub use memory::OutOfMemory;
pub use pilot::{ADAPTIVE_RANGE_CELLS, PilotMode, action_of};
pub use quorum::quorum_probability;
pub use random::{Random, Untrained};
pub use route::route;
pub use squads::Squads;
pub use steering::Steering;
pub use swarm::Swarm;
pub use sweep::Sweep;
pub use teams::Teams;
