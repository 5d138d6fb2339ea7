//! False alarms against their definition: how often each cell of a footprint raises one.

use jcas_core::{Cell, Config, Model, Motion, MotionMap, Preset, Sim};

const LOOKS: u32 = 1_000_000;
const UAVS: u32 = 10;
const PER_CELL: f64 = 0.01;

/// Checks a count of alarms against `looks` looks at a cell, within some standard deviations.
fn near(count: u32, looks: f64, sigmas: f64) {
    as_often(count, looks, PER_CELL, sigmas);
}

/// Checks how often something happened in `looks` looks, within some standard deviations.
fn as_often(count: u32, looks: f64, probability: f64, sigmas: f64) {
    let deviation = (looks * probability * (1.0 - probability)).sqrt();
    let difference = f64::from(count) - looks * probability;
    assert!(difference.abs() < sigmas * deviation, "{difference}");
}

/// A million looks of UAVs that stay in the middle of the grid: the total lies within three
/// standard deviations.
#[test]
fn each_cell_of_a_footprint_raises_its_share_of_alarms() {
    let config = Config {
        uav_count: UAVS,
        hotspot_count: 1,
        quorum: UAVS + 1,
        horizon_steps: LOOKS / UAVS,
        false_alarm_per_cell: PER_CELL,
        sensing_footprint_m: Some(100.0),
        rtb_threshold_kwh: 0.0,
        sense_energy_kwh: 0.0,
        comm_energy_kwh: 0.0,
        ..Config::default()
    };
    let model = Model::new(config).expect("a legal configuration");
    let mut sim = Sim::new(&model);
    sim.set_hotspots(&[Cell { x: 0, y: 0 }])
        .expect("a free cell");
    let mut by_cell = vec![0u32; config.cell_count()];
    let stay = [Motion::Stay.to_action(MotionMap::Udlrs), 0.0].repeat(UAVS as usize);
    for _ in 0..LOOKS / UAVS {
        sim.step(&stay).expect("legal actions");
        for uav in 0..UAVS as usize {
            let alarms = sim.state().false_alarms_of(uav);
            alarms.for_each(|cell| by_cell[cell] += 1);
        }
    }
    let footprint = by_cell.iter().copied().filter(|&count| count > 0);
    assert_eq!(
        footprint.clone().count(),
        13,
        "the cells within two of the middle"
    );
    near(footprint.clone().sum(), 13.0 * f64::from(LOOKS), 3.0);
    // One of thirteen cells exceeds 3.8 standard deviations in one of 500 seeds.
    footprint.for_each(|count| near(count, f64::from(LOOKS), 3.8));
}

/// UAVs of the preset `isac` stay on their depot, at full pilot density.
///
/// They see a hotspot three cells away in half of a million looks. False alarms come from the other
/// 28 cells of the footprint.
#[test]
fn the_preset_isac_sees_half_of_the_hotspots_three_cells_away() {
    let config = Config {
        uav_count: UAVS,
        hotspot_count: 1,
        quorum: UAVS + 1,
        horizon_steps: LOOKS / UAVS,
        rtb_threshold_kwh: 0.0,
        sense_energy_kwh: 0.0,
        comm_energy_kwh: 0.0,
        ..Config::preset(Preset::Isac)
    };
    let model = Model::new(config).expect("a legal configuration");
    let mut sim = Sim::new(&model);
    sim.set_hotspots(&[Cell { x: 9, y: 6 }])
        .expect("a free cell");
    let (mut detections, mut alarms) = (0, 0);
    let stay = [Motion::Stay.to_action(MotionMap::Udlrs), 1.0].repeat(UAVS as usize);
    for _ in 0..LOOKS / UAVS {
        sim.step(&stay).expect("legal actions");
        for uav in 0..UAVS as usize {
            detections += u32::from(sim.state().detected(uav, 0));
            alarms += sim.state().false_alarms_of(uav).count() as u32;
        }
    }
    let looks = f64::from(LOOKS);
    as_often(detections, looks, 0.5, 3.0);
    // The hotspot's own cell raises none.
    near(alarms, 28.0 * looks, 3.0);
}
