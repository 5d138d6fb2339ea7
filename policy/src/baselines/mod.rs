//! The baselines: scripted policies that every learned policy is compared with.
//!
//! # What a baseline reads
//!
//! | baseline | steers by | privileged |
//! | --- | --- | --- |
//! | `random` | nothing: five equally likely motions | no |
//! | `untrained` | nothing: clipped normal draws of both action components | no |
//! | `greedy` | each UAV's own cell, the hotspots' cells and which are confirmed | positions |
//! | `teams` | cells of UAVs that can fly, hotspots' cells and which are confirmed | positions |
//! | `squads` | as `teams`, but each radio component by what its members know or knew | positions |
//! | `line` | cells of UAVs that can fly; of the hotspots only whether any is left | no |
//! | `answer` | as `line`; what each UAV knows of reports | no |
//!
//! A *privileged* baseline reads the positions of hotspots that no UAV knows. With
//! `target_visibility = "known"` (the paper) every UAV observes these positions, so no baseline is
//! privileged. With `"hidden"` they are withheld, and [`build`](crate::BaselineKind::build)
//! refuses the baselines that read them.
//! [`build_privileged`](crate::BaselineKind::build_privileged) builds them anyway, as an upper
//! bound or as a teacher.
//!
//! `random` and `untrained` read nothing at all. Once every hotspot is confirmed, the others but
//! `squads` gather, so that UAVs share what they know ([`gather()`]). This rule reads the cells of
//! all UAVs, which a real fleet would have to exchange. They stay on a depot until a flight is
//! worth while, by their own charge ([`stays_to_charge`](crate::stays_to_charge)). The baselines
//! are centralised, but for `squads`; the learned policies are not.

mod answer;
mod assignment;
mod baseline;
mod division;
mod error;
mod gather;
mod greedy;
mod line;
mod memory;
mod pilot;
mod quorum;
mod random;
mod route;
mod squads;
mod steering;
mod teams;

pub use answer::Answer;
pub use baseline::Baseline;
pub use error::{PolicyError, similar};
pub use gather::gather;
pub use greedy::Greedy;
pub use line::Line;
pub use memory::OutOfMemory;
pub use pilot::{ADAPTIVE_RANGE_CELLS, PilotMode};
pub use quorum::quorum_probability;
pub use random::{Random, Untrained};
pub use route::route;
pub use squads::Squads;
pub use steering::Steering;
pub use teams::Teams;
