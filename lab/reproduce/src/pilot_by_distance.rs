//! What pilot density a policy holds at which distance from the nearest unconfirmed hotspot.

use crate::campaign::OURS;
use crate::scope::Scope;
use jcas_core::{Model, Sim};
use jcas_episode::card::EVALUATION_SEED;
use jcas_episode::mission::Campaign;
use jcas_policy::{Policy, Trained};
use jcas_train::error::TrainError;
use serde::Deserialize;
use std::path::{Path, PathBuf};

/// The densities of one policy.
#[derive(Clone, Debug, PartialEq)]
pub struct Approach {
    /// Name of the policy in the tables.
    pub policy: &'static str,
    /// Training seed.
    pub seed: u64,
    /// Missions that were flown.
    pub missions: u64,
    /// One for each distance, rising.
    pub bins: Vec<DistanceBin>,
}

/// The density at one distance.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
pub struct DistanceBin {
    /// Manhattan distance to the nearest unconfirmed hotspot.
    pub distance_cells: u32,
    /// Steps of single UAVs there.
    pub uav_steps: u64,
    /// Mean pilot density over these.
    pub pilot_density_mean: f64,
}

/// The table of it that a reproduction keeps of each training seed of a policy.
pub(crate) fn table(policy: &str, seed: u64) -> String {
    match policy {
        OURS => format!("approach-s{seed}.csv"),
        learner => format!("approach-{learner}-s{seed}.csv"),
    }
}

/// Missions for such a table.
pub(crate) fn missions(scope: &Scope) -> u64 {
    scope.episodes.min(100)
}

/// The tables that a folder has, by policy and from the first training seed on.
pub(crate) fn tables(scope: &Scope, out: &Path) -> Vec<(&'static str, u64, PathBuf)> {
    let learners = scope.learners().into_iter().map(|learner| learner.name);
    let of = |policy: &'static str| {
        let paths = (0..).map(move |seed| (policy, seed, out.join(table(policy, seed))));
        paths.take_while(|(_, _, path)| path.exists())
    };
    [OURS].into_iter().chain(learners).flat_map(of).collect()
}

/// What the tables of a folder say.
pub(crate) fn approaches(scope: &Scope, out: &Path) -> Result<Vec<Approach>, TrainError> {
    let mut approaches = Vec::new();
    for (policy, seed, path) in tables(scope, out) {
        let mut reader = csv::Reader::from_path(&path).map_err(TrainError::format(&path))?;
        let bins = reader.deserialize();
        let bins = bins.map(|bin| bin.map_err(TrainError::format(&path)));
        approaches.push(Approach {
            policy,
            seed,
            missions: missions(scope),
            bins: bins.collect::<Result<_, _>>()?,
        });
    }
    Ok(approaches)
}

/// The text of a table.
pub(crate) fn text(bins: &[(u64, f64)]) -> String {
    let mut text = String::from("distance_cells,uav_steps,pilot_density_mean\n");
    for (distance, (count, sum)) in bins.iter().enumerate() {
        if *count > 0 {
            text += &format!("{distance},{count},{:.6}\n", sum / *count as f64);
        }
    }
    text
}

/// For each Manhattan distance: how many UAV-steps, and the sum of their pilot densities.
pub(crate) fn observe(
    model: &Model<'static>,
    mut policy: Trained,
    episodes: u64,
) -> Result<Vec<(u64, f64)>, jcas_core::Error> {
    let config = model.config();
    let mut bins = vec![(0, 0.0); (config.grid_width + config.grid_height) as usize];
    let mut sim = Sim::new(model);
    let mut observations = vec![0.0; model.uav_count() * model.observation_len()];
    let mut actions = vec![0.0; model.action_len()];
    let campaign = Campaign {
        episodes,
        seed: EVALUATION_SEED,
    };
    for episode in 0..episodes {
        let seed = campaign.episode_seed(episode);
        sim.reset(seed);
        policy.reset(model, seed);
        for _ in 0..config.horizon_steps {
            sim.observe(&mut observations)?;
            policy.see(&observations);
            policy.act(model, &sim.state(), &mut actions);
            let before: Vec<Option<u32>> = nearest_unconfirmed(model, &sim);
            let outcome = sim.step(&actions)?;
            for (uav, distance) in before.iter().enumerate() {
                if let Some(distance) = distance {
                    let bin = &mut bins[*distance as usize];
                    bin.0 += 1;
                    bin.1 += sim.state().pilot_density(uav);
                }
            }
            if outcome.terminated || outcome.truncated {
                break;
            }
        }
    }
    Ok(bins)
}

fn nearest_unconfirmed(model: &Model<'static>, sim: &Sim<'_>) -> Vec<Option<u32>> {
    let state = sim.state();
    (0..model.uav_count())
        .map(|uav| {
            (0..model.hotspot_count())
                .filter(|&hotspot| !state.confirmed(hotspot))
                .map(|hotspot| state.cell(uav).manhattan(state.hotspot_cell(hotspot)))
                .min()
        })
        .collect()
}
