//! Runs one episode, or many on all cores.
//!
//! ```
//! use jcas_core::{Config, Model};
//! use jcas_episode::campaign::{Campaign, fly};
//! use jcas_episode::statistics::Summary;
//! use jcas_policy::{BaselineKind, PilotMode, Policy};
//! use std::ops::ControlFlow;
//!
//! let model = Model::new(Config::default())?;
//! let make = || -> Box<dyn Policy> {
//!     Box::new(BaselineKind::Teams.build_privileged(PilotMode::Adaptive))
//! };
//! let campaign = Campaign { episodes: 20, seed: 1 };
//! let episodes = fly(&model, campaign, &make, &|| ControlFlow::Continue(()))?;
//! let summary = Summary::of(&episodes, model.config().horizon_steps);
//! assert_eq!(episodes.len(), 20);
//! assert!(summary.success_rate.low <= summary.success_rate.value);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use core::fmt;
use std::ops::ControlFlow;

use jcas_core::rng::derive_seed;
use jcas_core::{Error, Metrics, Model, Sim};

use jcas_policy::Policy;

use crate::shard::Shard;

/// The seeds of a campaign: which episodes to run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Campaign {
    /// Number of episodes.
    pub episodes: u64,
    /// Episode k has the seed `derive_seed(seed, k)`.
    pub seed: u64,
}

impl Campaign {
    /// The seed of one episode.
    #[must_use]
    pub fn episode_seed(&self, episode: u64) -> u64 {
        derive_seed(self.seed, episode)
    }
}

/// The reason why a campaign stopped early.
#[derive(Clone, Debug, PartialEq)]
pub enum FlightError {
    /// The kernel refused a step, for example because the policy gave NaN.
    Kernel {
        /// Index of the episode with the refused step.
        episode: u64,
        /// Seed of that episode.
        seed: u64,
        /// The kernel's error.
        error: Error,
    },
    /// The progress callback asked to stop.
    Stopped,
}

impl fmt::Display for FlightError {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Kernel {
                episode,
                seed,
                error,
            } => write!(out, "episode {episode} (seed 0x{seed:016x}): {error}"),
            Self::Stopped => out.write_str("stopped before the last episode"),
        }
    }
}

impl std::error::Error for FlightError {}

/// Runs one episode to its end.
///
/// # Errors
/// The kernel refuses a step, which happens only where the policy gives NaN.
pub fn fly_episode(
    model: &Model<'_>,
    sim: &mut Sim<'_>,
    policy: &mut dyn Policy,
    seed: u64,
) -> Result<Metrics, Error> {
    let mut actions = vec![0.0; 2 * model.uav_count()];
    let mut observations = if policy.reads_observations() {
        vec![0.0; model.uav_count() * model.observation_len()]
    } else {
        Vec::new()
    };
    sim.reset(seed);
    policy.reset(model, seed);
    // The horizon bounds the episode; the kernel truncates it there.
    for _ in 0..model.config().horizon_steps {
        if policy.reads_observations() {
            sim.observe(&mut observations)?;
            policy.see(&observations);
        }
        policy.act(model, &sim.state(), &mut actions);
        let outcome = sim.step(&actions)?;
        if outcome.terminated || outcome.truncated {
            break;
        }
    }
    Ok(sim.state().metrics())
}

/// Runs every episode of a campaign, on all cores of the current rayon pool with the feature
/// `parallel`. The metrics of episode k are at index k for any number of threads.
///
/// `make_policy` makes one policy for each worker. `progress` is called once for every finished
/// episode, from any thread, and may stop the campaign.
///
/// # Errors
/// The first refusal by the kernel, or [`FlightError::Stopped`].
pub fn fly(
    model: &Model<'_>,
    campaign: Campaign,
    make_policy: &(dyn Fn() -> Box<dyn Policy> + Sync),
    progress: &(dyn Fn() -> ControlFlow<()> + Sync),
) -> Result<Vec<Metrics>, FlightError> {
    fly_part(model, campaign, Shard::WHOLE, make_policy, progress)
}

/// Runs the episodes of one part of a campaign, as [`fly`] runs all of them. The metrics are in the
/// order of [`Shard::cells`].
///
/// # Errors
/// As those of [`fly`].
pub fn fly_part(
    model: &Model<'_>,
    campaign: Campaign,
    part: Shard,
    make_policy: &(dyn Fn() -> Box<dyn Policy> + Sync),
    progress: &(dyn Fn() -> ControlFlow<()> + Sync),
) -> Result<Vec<Metrics>, FlightError> {
    let episodes = part.cells(campaign.episodes as usize);
    let worker = || (Sim::new(model), make_policy());
    let one = |(sim, policy): &mut (Sim<'_>, Box<dyn Policy>), episode: usize| {
        let episode = episode as u64;
        let seed = campaign.episode_seed(episode);
        let metrics = fly_episode(model, sim, policy.as_mut(), seed).map_err(|error| {
            FlightError::Kernel {
                episode,
                seed,
                error,
            }
        })?;
        match progress() {
            ControlFlow::Continue(()) => Ok(metrics),
            ControlFlow::Break(()) => Err(FlightError::Stopped),
        }
    };
    #[cfg(feature = "parallel")]
    {
        use rayon::prelude::*;
        // A policy may plan for long before its first episode. Each thread therefore gets only a
        // few parts, each with one policy.
        let parts = 4 * rayon::current_num_threads();
        let episodes: Vec<usize> = episodes.collect();
        let least = episodes.len().div_ceil(parts);
        episodes
            .into_par_iter()
            .with_min_len(least)
            .map_init(worker, one)
            .collect()
    }
    #[cfg(not(feature = "parallel"))]
    {
        let mut worker = worker();
        episodes.map(|episode| one(&mut worker, episode)).collect()
    }
}
