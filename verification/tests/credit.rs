//! Rewards of each UAV: their mean is the team's, and a confirmation lowers none of them.

use jcas_core::reward::{COMPONENTS, NAMES};
use jcas_core::{Model, Motion, Sim, StateRef};
use jcas_verification::sampling::{self, Dice, Pilot};
use jcas_verification::specification::{Specification, World};

/// Missions flown, each with a configuration of its own.
const MISSIONS: u64 = 500;

/// Whether numbers are the mean of others up to rounding. The rounding is relative to the largest
/// of them, and to the potentials whose difference a shaping term is.
fn is_mean(what: &str, mean: f64, parts: &[f64], potential: f64) -> Result<(), String> {
    let mut scale = 1.0 + potential.abs();
    for part in parts {
        scale = f64::max(scale, part.abs());
    }
    let sum: f64 = parts.iter().sum();
    let difference = sum / parts.len() as f64 - mean;
    if difference.abs() <= 1e-12 * scale {
        Ok(())
    } else {
        Err(format!("{what}: {mean} is off its mean by {difference}"))
    }
}

/// Catches a term that is credited twice, to nobody, or to the wrong scale.
fn means_are_the_teams(world: &World, state: &StateRef<'_>, potential: f64) -> Result<(), String> {
    let uavs = state.uav_count();
    let team = state.rewards();
    for index in 0..COMPONENTS {
        let own: Vec<f64> = (0..uavs).map(|i| state.uav_rewards(i)[index]).collect();
        is_mean(NAMES[index], team[index], &own, potential)?;
        let own: Vec<f64> = world
            .uav_rewards
            .iter()
            .map(|own| own.terms()[index])
            .collect();
        let name = format!("specified {}", NAMES[index]);
        is_mean(&name, world.rewards.terms()[index], &own, potential)?;
    }
    let own: Vec<f64> = (0..uavs).map(|i| state.uav_reward(i)).collect();
    is_mean("R_t", jcas_core::reward::total(&team), &own, potential)
}

#[test]
fn the_mean_over_uavs_is_the_teams_reward() {
    let mut apart = 0;
    for mission in 0..MISSIONS {
        let mut dice = Dice::new(mission);
        let config = if mission == 0 {
            sampling::large_configuration(&mut dice)
        } else {
            sampling::configuration(&mut dice)
        };
        let pilot = sampling::pilot(&mut dice);
        let model = Model::new(config).unwrap();
        let spec = Specification::new(&config);
        let seed = dice.bits();
        let mut world = spec.reset(seed);
        let mut sim = Sim::new(&model);
        sim.reset(seed);
        while !world.terminated && !world.truncated {
            let before = sim.state().header.goal_potential();
            let actions = sampling::actions(&mut dice, pilot, &spec, &world);
            spec.step(&mut world, &actions);
            let flat: Vec<f32> = actions.iter().flat_map(|&(a, b)| [a, b]).collect();
            sim.step(&flat).unwrap();
            means_are_the_teams(&world, &sim.state(), before)
                .unwrap_or_else(|why| panic!("mission {mission}, t = {}: {why}", world.t));
            let first = sim.state().uav_reward(0);
            let differs = |i| sim.state().uav_reward(i) != first;
            apart += u32::from((1..model.uav_count()).any(differs));
        }
    }
    assert!(apart > 1000, "rewards of UAVs differ in {apart} steps only");
}

/// Catches a potential that punishes the fleet for a confirmation.
#[test]
fn a_confirmation_lowers_no_potential() {
    let mut confirmations = 0;
    for mission in 0..MISSIONS {
        let mut dice = Dice::new(mission);
        let mut config = sampling::configuration(&mut dice);
        config.shaping_unconfirmed_weight = 1.0;
        config.rtb_threshold_kwh = 0.0;
        config.quorum = 1;
        let model = Model::new(config).unwrap();
        let spec = Specification::new(&config);
        let seed = dice.bits();
        let mut world = spec.reset(seed);
        let mut sim = Sim::new(&model);
        sim.reset(seed);
        while !world.terminated && !world.truncated {
            let (t, confirmed) = (world.t, sim.state().confirmed_count());
            let before: Vec<f64> = goal_potentials(&sim);
            let mut actions = sampling::actions(&mut dice, Pilot::Swarm, &spec, &world);
            // Every other step the fleet stays where it is, so that nothing but confirmations
            // counts.
            let stays = t % 2 == 0;
            if stays {
                let stay = Motion::Stay.to_action(config.motion_map);
                actions.iter_mut().for_each(|action| action.0 = stay);
            }
            spec.step(&mut world, &actions);
            let flat: Vec<f32> = actions.iter().flat_map(|&(a, b)| [a, b]).collect();
            sim.step(&flat).unwrap();
            if stays {
                confirmations += sim.state().confirmed_count() - confirmed;
                for (i, (old, new)) in before.iter().zip(goal_potentials(&sim)).enumerate() {
                    assert!(
                        new >= *old,
                        "mission {mission}, t = {t}, UAV {i}: {old} to {new}"
                    );
                }
            }
        }
    }
    assert!(confirmations > 100, "only {confirmations} confirmations");
}

fn goal_potentials(sim: &Sim<'_>) -> Vec<f64> {
    let state = sim.state();
    (0..state.uav_count())
        .map(|i| state.goal_potential(i))
        .collect()
}
