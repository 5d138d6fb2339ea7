//! The kernel against the specification, step by step, on random missions.
//!
//! Catches any difference between the kernel and the written model. The tests compare every
//! integer, set and flag of every state, every reward component and every entry of every
//! observation.

use jcas_core::Config;
use jcas_verification::mission::fly;
use jcas_verification::sampling::{self, Dice, Pilot, SEAMS, UAVS_MAX};
use jcas_verification::specification::{Specification, World};

/// Missions flown in one run of the test, each with a configuration of its own;
/// the environment variable `JCAS_MISSIONS` asks for more.
const MISSIONS: u64 = 1000;

/// How often each corner of the model was reached; none may stay at zero.
#[derive(Debug, Default)]
struct Reached {
    confirmed: u32,
    informed: u32,
    terminated: u32,
    truncated: u32,
    grounded: u32,
    returning: u32,
    shortfall: u32,
    charged_full: u32,
    partly_linked: u32,
    revisited: u32,
    hidden: u32,
    alone: u32,
    maps_differ: u32,
    reports_differ: u32,
}

#[test]
fn the_kernel_agrees_with_the_specification() {
    let mut reached = Reached::default();
    let mut steps = [0u32; UAVS_MAX as usize + 1];
    let asked = std::env::var("JCAS_MISSIONS")
        .ok()
        .and_then(|text| text.parse().ok());
    for mission in 0..asked.unwrap_or(MISSIONS) {
        let mut dice = Dice::new(mission);
        let config = sampling::configuration(&mut dice);
        let pilot = sampling::pilot(&mut dice);
        fly(&config, pilot, &mut dice, 1, |spec, world| {
            steps[config.uav_count as usize] += 1;
            note(spec, world, &mut reached);
        })
        .unwrap_or_else(|why| panic!("mission {mission}: {why}"));
    }
    println!("{reached:?}\nsteps by size: {steps:?}");
    let counts = [
        reached.confirmed,
        reached.informed,
        reached.terminated,
        reached.truncated,
        reached.grounded,
        reached.returning,
        reached.shortfall,
        reached.charged_full,
        reached.partly_linked,
        reached.revisited,
        reached.hidden,
        reached.alone,
        reached.maps_differ,
        reached.reports_differ,
    ];
    assert!(counts.iter().all(|&count| count > 50), "{reached:?}");
    for size in SEAMS {
        assert!(steps[size as usize] > 50, "{size} UAVs: {steps:?}");
    }
}

/// Fifteen UAVs are the fleet of most tables, a block of UAVs less one.
#[test]
fn fifteen_uavs_agree_for_thousands_of_steps() {
    let mut steps = 0;
    for mission in 0..400 {
        let mut dice = Dice::new(mission);
        let config = sampling::configuration_of(&mut dice, 15);
        let pilot = sampling::pilot(&mut dice);
        fly(&config, pilot, &mut dice, 1, |_, _| steps += 1)
            .unwrap_or_else(|why| panic!("mission {mission}: {why}"));
    }
    assert!(steps > 3000, "{steps} steps");
}

/// Catches a product that is rounded in another order than the page names. Where the product lies
/// on a half, the orders give different whole numbers. Random reals hit such a product once in 10^7
/// steps.
#[test]
fn products_on_a_half_are_rounded_in_one_order() {
    let sensing = [(2, 0.15, 0.2), (3, 0.35, 0.7), (4, 0.35, 0.4)];
    let charging = [(0.126614243, 63.5), (0.976842009, 34.5)];
    for (uj, pilot_density_min, pilot_density_max) in sensing {
        for (charge_power_kw, step_duration_s) in charging {
            let config = Config {
                sense_energy_kwh: f64::from(uj) / 3.6e12,
                pilot_density_min,
                pilot_density_max,
                charge_power_kw,
                step_duration_s,
                initial_soc_min: 0.1,
                initial_soc_max: 0.1,
                ..Config::default()
            };
            let mut dice = Dice::new(0);
            let (mut lowest, mut charged) = (0, 0);
            fly(&config, Pilot::Anything, &mut dice, 1, |spec, world| {
                let pilots = world.pilot.iter();
                lowest += pilots.filter(|&&pilot| pilot == pilot_density_min).count();
                let accepted = world.accepted_uj.iter();
                charged += accepted.filter(|&&uj| uj == spec.energy.charge_uj).count();
            })
            .unwrap_or_else(|why| panic!("{uj} uJ, {charge_power_kw} kW: {why}"));
            assert!(lowest > 10 && charged > 0, "{lowest} {charged}");
        }
    }
}

/// Catches a neighbour search that loses a link between buckets, and sets of more
/// than 64 members.
#[test]
fn large_fleets_agree_too() {
    let mut reached = Reached::default();
    for mission in 0..8 {
        let mut dice = Dice::new(mission);
        let config = sampling::large_configuration(&mut dice);
        fly(&config, Pilot::Spread, &mut dice, 1, |spec, world| {
            note(spec, world, &mut reached);
        })
        .unwrap_or_else(|why| panic!("mission {mission}: {why}"));
    }
    assert!(reached.partly_linked > 500, "{reached:?}");
}

fn note(spec: &Specification, world: &World, reached: &mut Reached) {
    let count = |flags: &[bool]| flags.iter().filter(|&&flag| flag).count() as u32;
    let at_now = |times: &[Option<u32>]| times.iter().filter(|&&at| at == Some(world.t)).count();
    reached.confirmed += at_now(&world.confirmed_at) as u32;
    reached.informed += at_now(&world.informed_at) as u32;
    reached.terminated += u32::from(world.terminated);
    reached.truncated += u32::from(world.truncated);
    reached.grounded += count(&world.grounded);
    reached.returning += count(&world.returning);
    reached.shortfall += world.shortfall_uj.iter().filter(|&&uj| uj > 0).count() as u32;
    for (i, &battery) in world.battery_uj.iter().enumerate() {
        let full = battery == spec.energy.capacity_uj;
        reached.charged_full += u32::from(full && world.accepted_uj[i] > 0);
        let degree = count(&world.linked[i]);
        let partly = degree > 0 && degree + 1 < spec.config.uav_count;
        reached.partly_linked += u32::from(partly);
    }
    reached.revisited += u32::from(world.rewards.revisit != 0.0);
    let hidden = spec.config.target_visibility == jcas_core::TargetVisibility::Hidden;
    reached.hidden += u32::from(hidden);
    reached.alone += u32::from(spec.config.uav_count == 1);
    let unlike = world.searched.iter().any(|map| *map != world.searched[0]);
    reached.maps_differ += u32::from(unlike);
    let mut reports = world.reported.iter();
    let unlike = reports.any(|levels| *levels != world.reported[0]);
    reached.reports_differ += u32::from(unlike);
}
