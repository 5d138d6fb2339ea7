//! Tests that episodes of shipped policies end in the same states, to the last bit.

mod episode;

use episode::{EPISODES, fly};
use jcas_core::{Config, Model, Preset, Sim};
use jcas_policy::head::Mode;
use jcas_policy::network::MatmulKernel;
use jcas_policy::{Policy, Trained};

#[test]
fn shipped_policies_fly_the_same_missions_everywhere() {
    assert_eq!(
        EPISODES.map(|episode| fly(episode, MatmulKernel::default())),
        EPISODES
    );
}

#[test]
fn a_sampled_mission_follows_from_its_seed() {
    let of_seed = |seed| {
        let episode = episode::Episode {
            seed,
            mode: Mode::Sampled,
            ..EPISODES[2]
        };
        fly(episode, MatmulKernel::default())
    };
    assert_eq!(of_seed(4), of_seed(4));
    assert_ne!(of_seed(4).hash, of_seed(5).hash);
}

/// Flies episodes with long horizons and returns the greatest number of steps.
fn slowest(policy: &[u8], preset: Preset, (uavs, hotspots): (u32, u32), seeds: &[u64]) -> u32 {
    let mut policy = Trained::read("shipped", policy).unwrap();
    let model = Model::new(Config {
        uav_count: uavs,
        hotspot_count: hotspots,
        horizon_steps: 2000,
        ..Config::preset(preset)
    })
    .unwrap();
    let mut sim = Sim::new(&model);
    let mut observations = vec![0.0; model.uav_count() * model.observation_len()];
    let mut actions = vec![0.0; model.action_len()];
    let steps = |&seed| {
        sim.reset(seed);
        while !sim.state().terminated() && !sim.state().truncated() {
            sim.observe(&mut observations).unwrap();
            policy.see(&observations);
            policy.act(&model, &sim.state(), &mut actions);
            sim.step(&actions).unwrap();
        }
        sim.state().t()
    };
    seeds.iter().map(steps).max().unwrap()
}

const MISSION: &[u8] = include_bytes!("../../policies/mission/policy.safetensors");
const PAPER: &[u8] = include_bytes!("../../policies/paper/policy.safetensors");

// In these episodes a fleet that may turn back without a new confirmation flies to and fro
// between two cells for ever. It stays undecided where to go next.
#[test]
fn an_undecided_fleet_goes_on() {
    let seeds = [0x1a36_af05_ddbd_c71c, 0x0d4e_c01e_770a_7f8a];
    assert!(slowest(MISSION, Preset::Mission, (20, 11), &seeds) < 100);
}

// In these episodes batteries run low. A fleet that leaves the depot at the threshold turns back
// after one cell, and does not end within 2000 steps.
#[test]
fn a_fleet_charges_for_a_flight_that_is_worth_while() {
    let seeds = [0x42cf_79cc_badf_dcc1, 0x0702_9362_dcac_144d];
    assert!(slowest(PAPER, Preset::Paper, (3, 7), &seeds) < 500);
    assert!(slowest(MISSION, Preset::Mission, (4, 7), &[11]) < 1000);
}
