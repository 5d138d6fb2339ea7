//! A table of `docs/plan.md`: the steps of `replan` with known hotspots, over the moves of its
//! first plan, and what a decision costs. The script `teams` and a trained policy stand beside it.
//!
//! `cargo run --release -p jcas-plan --example moves [EPISODES]`

use std::time::Instant;

use jcas_core::{Config, Model, Preset, Sim, StateRef};
use jcas_plan::{REPLAN_ITERATIONS, Replanner, Settings, TOUR_ITERATIONS};
use jcas_policy::{BaselineKind, PilotMode, Policy, Trained};
use jcas_simd::InstructionSet;

/// Moves of the first plan. Each later plan has a quarter of them, as by default.
const MOVES: [u64; 3] = [4_000, TOUR_ITERATIONS, 100_000];

/// `replan` with a number of moves for the first plan, and for the later ones.
struct Replan(Replanner);

impl Policy for Replan {
    fn name(&self) -> &str {
        "replan"
    }

    fn reset(&mut self, _: &Model<'_>, _: u64) {
        self.0.reset();
    }

    fn act(&mut self, model: &Model<'_>, state: &StateRef<'_>, actions: &mut [f32]) {
        self.0.try_plan(model, state).expect("a plan can be made");
        self.0.write(model, state, actions);
    }
}

fn main() -> Result<(), Box<dyn core::error::Error>> {
    let episodes = match std::env::args().nth(1) {
        Some(text) => text.parse()?,
        None => 200,
    };
    let weights = std::fs::read("policies/paper/policy.safetensors")?;
    println!("uavs policy moves | steps success | µs a step, the longest");
    for uavs in [5, 10, 15, 20] {
        let model = Model::new(Config {
            uav_count: uavs,
            hotspot_count: 7,
            ..Config::preset(Preset::Paper)
        })?;
        for first in MOVES {
            let settings = Settings {
                iterations: first * REPLAN_ITERATIONS / TOUR_ITERATIONS,
                seed: 1,
            };
            let mut replan = Replan(Replanner::new(first, settings));
            let flown = measured(&model, &mut replan, episodes)?;
            println!("{uavs} replan {first} | {flown}");
        }
        let mut teams = BaselineKind::Teams.build_privileged(PilotMode::Adaptive);
        let flown = measured(&model, &mut teams, episodes)?;
        println!("{uavs} teams - | {flown}");
        let learned = Trained::read("paper", &weights)?;
        let mut learned = learned.with_matmul(InstructionSet::best().matmul());
        let flown = measured(&model, &mut learned, episodes)?;
        println!("{uavs} policies/paper - | {flown}");
    }
    Ok(())
}

/// Flies episodes and describes their steps and the time of the decisions. An episode without
/// success counts with its horizon.
fn measured(
    model: &Model<'_>,
    policy: &mut dyn Policy,
    episodes: u64,
) -> Result<String, Box<dyn core::error::Error>> {
    let mut actions = vec![0.0; model.action_len()];
    let mut rows = vec![0.0; model.uav_count() * model.observation_len()];
    let (mut sum, mut squares, mut successes) = (0.0, 0.0, 0);
    let (mut seconds, mut longest) = (0.0, 0.0_f64);
    for seed in 0..episodes {
        let mut sim = Sim::new(model);
        sim.reset(seed);
        policy.reset(model, seed);
        loop {
            let begun = Instant::now();
            if policy.reads_observations() {
                sim.observe(&mut rows)?;
                policy.see(&rows);
            }
            policy.act(model, &sim.state(), &mut actions);
            let spent = begun.elapsed().as_secs_f64();
            seconds += spent;
            longest = longest.max(spent);
            let outcome = sim.step(&actions)?;
            if outcome.terminated || outcome.truncated {
                successes += u64::from(outcome.terminated);
                break;
            }
        }
        let steps = f64::from(sim.state().t());
        sum += steps;
        squares += steps * steps;
    }
    let count = episodes as f64;
    let mean = sum / count;
    let deviation = ((squares - sum * mean) / (count - 1.0)).sqrt();
    Ok(format!(
        "{mean:.2} ± {:.2} {:.3} | {:.1} {:.0}",
        1.96 * deviation / count.sqrt(),
        successes as f64 / count,
        seconds / sum * 1e6,
        longest * 1e6
    ))
}
