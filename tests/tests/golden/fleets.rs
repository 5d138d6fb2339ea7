//! Sizes of fleets and grids, and the links of each size.

use std::collections::BTreeSet;

use jcas_core::action::motion;
use jcas_core::{Config, Model, Motion, MotionMap};
use jcas_episode::trace::{Step, Trace};

use crate::support::{pairs, reproduced};

#[test]
fn link_on_threshold() {
    let trace = reproduced("link_on_threshold");
    let model = Model::new(trace.header.config).unwrap();
    let throughput = |step: &Step, i: usize, k: usize| {
        let (a, b) = (step.positions[i], step.positions[k]);
        model.link_throughput(a.x.abs_diff(b.x), a.y.abs_diff(b.y), step.pilot_density[i])
    };
    let needed = trace.header.config.link_throughput_min;
    let (mut on_threshold, mut below) = (0, 0);
    for step in &trace.steps {
        for i in 0..step.positions.len() {
            for k in i + 1..step.positions.len() {
                let weaker = throughput(step, i, k).min(throughput(step, k, i));
                assert_eq!(step.links.contains(&[i, k]), weaker >= needed);
                on_threshold += usize::from(weaker == needed);
                below += usize::from(weaker < needed);
            }
        }
    }
    assert!(on_threshold > 0, "a pair is exactly on the threshold");
    assert!(below > 0, "a pair is below it");
}

#[test]
fn narrow_grid() {
    let trace = reproduced("narrow_grid");
    let config = &trace.header.config;
    assert_ne!(config.grid_width, config.grid_height);
    assert!(
        config.neighbour_slots < config.uav_count - 1,
        "not all neighbours are observed"
    );
    let stopped_by_edge = pairs(&trace).any(|(before, step)| {
        (0..step.positions.len()).any(|uav| {
            let moves = motion(step.actions[uav][0], config.motion_map);
            moves != Motion::Stay && before.positions[uav] == step.positions[uav]
        })
    });
    assert!(stopped_by_edge, "a move off the grid is a stay");
}

/// A fleet makes the same moves by either order of the bins, and all five of them.
#[test]
fn symmetric_motions() {
    let trace = reproduced("symmetric_motions");
    let map = trace.header.config.motion_map;
    assert_eq!(map, MotionMap::Symmetric);
    let taken = pairs(&trace).flat_map(|(before, step)| {
        let cells = before.positions.iter().zip(&step.positions);
        cells.zip(&step.actions).map(|((from, to), action)| {
            let offset = (to.x as i32 - from.x as i32, to.y as i32 - from.y as i32);
            assert_eq!(offset, motion(action[0], map).offset());
            offset
        })
    });
    assert_eq!(taken.collect::<BTreeSet<_>>().len(), Motion::ALL.len());
}

/// Steps in which some pairs of UAVs are linked and others are not.
fn partly_linked(trace: &Trace) -> usize {
    let uavs = trace.header.config.uav_count as usize;
    let pairs = uavs * (uavs - 1) / 2;
    let partly = |step: &&Step| !step.links.is_empty() && step.links.len() < pairs;
    trace.steps.iter().filter(partly).count()
}

#[test]
fn large_fleet() {
    let trace = reproduced("large_fleet");
    assert!(
        trace.header.config.uav_count > 64,
        "sets span several words"
    );
    assert!(trace.header.config.hotspot_count > 64);
    let pairs = |step: &Step| step.positions.len() * (step.positions.len() - 1) / 2;
    assert!(
        trace
            .steps
            .iter()
            .any(|step| step.links.len() < pairs(step)),
        "not all are linked"
    );
    assert!(trace.end.metrics.confirmed > 0);
}

#[test]
fn ten_uavs() {
    let trace = reproduced("ten_uavs");
    let config = &trace.header.config;
    assert_eq!(config.uav_count, 10);
    // R_min bounds distances between cells from below, not the distance that sets the threshold.
    let least_m = config.range_min_m.unwrap_or(config.cell_size_m / 2.0);
    assert!(config.sensing_range_m.is_some_and(|range| range < least_m));
    assert!(trace.end.metrics.confirmed > trace.end.metrics.informed);
    assert!(partly_linked(&trace) > 20);
    let returning = trace.steps.iter().flat_map(|step| &step.returning);
    let (first, rest): (Vec<usize>, Vec<usize>) = returning.partition(|&&uav| uav < 8);
    assert!(
        !first.is_empty() && !rest.is_empty(),
        "UAVs return in both parts of the fleet"
    );
}

#[test]
fn fifteen_uavs() {
    let trace = reproduced("fifteen_uavs");
    let paper = Config {
        uav_count: 15,
        hotspot_count: 5,
        ..Config::preset(jcas_core::Preset::Paper)
    };
    assert_eq!(trace.header.config, paper);
    assert!(trace.end.terminated);
    assert!(partly_linked(&trace) > 10);
}

#[test]
fn twenty_uavs() {
    let trace = reproduced("twenty_uavs");
    let search = Config {
        uav_count: 20,
        hotspot_count: 5,
        horizon_steps: 20,
        ..Config::preset(jcas_core::Preset::Search)
    };
    assert_eq!(trace.header.config, search);
    assert!(trace.end.terminated);
    let travelling = |step: &&Step| step.confirmed.len() > step.informed.len();
    assert!(trace.steps.iter().filter(travelling).count() > 10);
}

/// Checks a trace with low charge, whose fleet size is next to the one where buckets begin.
fn short_of_charge(trace: &Trace, uavs: u32) {
    assert_eq!(trace.header.config.uav_count, uavs);
    assert!(trace.end.metrics.confirmed > 0);
    assert!(partly_linked(trace) > 5);
    let growing = pairs(trace).all(|(a, b)| b.grounded.len() >= a.grounded.len());
    assert!(growing, "UAVs run empty one after another");
    let mixed = |step: &Step, block: usize| {
        let uavs = 16 * block..16 * block + 16;
        let grounded = step.grounded.iter().filter(|uav| uavs.contains(uav));
        let grounded = grounded.count();
        0 < grounded && grounded < 16
    };
    let all_mixed = |step: &Step| (0..3).all(|block| mixed(step, block));
    assert!(
        trace.steps.iter().any(all_mixed),
        "some of each sixteen are grounded, some fly"
    );
}

#[test]
fn forty_eight_uavs() {
    short_of_charge(&reproduced("forty_eight_uavs"), 48);
}

#[test]
fn forty_nine_uavs() {
    short_of_charge(&reproduced("forty_nine_uavs"), 49);
}

#[test]
fn hundred_uavs() {
    let trace = reproduced("hundred_uavs");
    assert_eq!(trace.header.config.uav_count, 100);
    assert!(partly_linked(&trace) > 5);
    // Links join UAVs of both words of a set.
    let across = |&[i, k]: &[usize; 2]| i < 64 && k >= 64;
    assert!(trace.steps.iter().any(|step| step.links.iter().any(across)));
    assert!(trace.end.metrics.confirmed > 0 && trace.end.metrics.informed == 0);
}
