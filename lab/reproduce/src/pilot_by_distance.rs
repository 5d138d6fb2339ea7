//! What pilot density a policy holds at which distance from the nearest unconfirmed hotspot.

use jcas_core::{Model, Sim};
use jcas_episode::card::{EVALUATION_SEED, StoredPolicy};
use jcas_episode::mission::Campaign;
use jcas_policy::Policy;
use jcas_policy::head::Mode;

/// The table of it that a reproduction keeps of each training seed.
pub(crate) fn table(seed: u64) -> String {
    format!("approach-s{seed}.csv")
}

/// For each Manhattan distance: how many UAV-steps, and the sum of their pilot densities.
pub(crate) fn observe(
    model: &Model<'static>,
    policy: &StoredPolicy,
    episodes: u64,
) -> Result<Vec<(u64, f64)>, jcas_core::Error> {
    let config = model.config();
    let mut bins = vec![(0, 0.0); (config.grid_width + config.grid_height) as usize];
    let mut sim = Sim::new(model);
    let mut policy = policy.policy(Some(Mode::Deterministic));
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
