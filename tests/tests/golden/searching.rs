//! Detection and search: hidden hotspots, search maps, detection curves.

use jcas_core::{Cell, DetectionCurve, Model, PilotGain, TargetVisibility};
use jcas_episode::trace::Trace;

use crate::support::{pairs, reproduced};

#[test]
fn hidden_targets() {
    let trace = reproduced("hidden_targets");
    assert_eq!(
        trace.header.config.target_visibility,
        TargetVisibility::Hidden
    );
    assert!(
        trace.end.metrics.confirmed > 0,
        "the search finds something"
    );
    // With visible hotspots the same actions lead to the same episode with other observations.
    let mut shown = trace.clone();
    shown.header.config.target_visibility = TargetVisibility::Known;
    let model = Model::new(shown.header.config).unwrap();
    let mut sim = jcas_core::Sim::new(&model);
    sim.reset(trace.header.seed.0);
    let mut observations = vec![0.0; model.uav_count() * model.observation_len()];
    for step in &trace.steps {
        sim.step(step.actions.as_flattened()).unwrap();
        sim.observe(&mut observations).unwrap();
        let positions: Vec<Cell> = (0..model.uav_count())
            .map(|i| sim.state().cell(i))
            .collect();
        assert_eq!(positions, step.positions);
        let everything_known = step
            .knowledge
            .iter()
            .all(|known| known.len() == model.hotspot_count());
        assert_eq!(
            jcas_core::hash::reals(&observations) == step.observation_hash.0,
            everything_known,
            "step {}",
            step.t
        );
    }
}

#[test]
fn search() {
    let trace = reproduced("search");
    assert!(trace.end.terminated);
    let model = Model::new(trace.header.config).unwrap();
    let mut sim = jcas_core::Sim::new(&model);
    sim.reset(trace.header.seed.0);
    let (uavs, width) = (model.uav_count(), trace.header.config.grid_width);
    let cells = trace.header.config.cell_count();
    let mut maps = vec![vec![false; cells]; uavs];
    let mut differed = 0;
    for step in &trace.steps {
        // A trace has each UAV's cell and links, which determine its map.
        for (map, cell) in maps.iter_mut().zip(&step.positions) {
            for (index, looked) in map.iter_mut().enumerate() {
                let (x, y) = (index as u32 % width, index as u32 / width);
                let (dx, dy) = (x.abs_diff(cell.x), y.abs_diff(cell.y));
                // A radius of 100 m is two cells.
                *looked |= dx * dx + dy * dy <= 4;
            }
        }
        for _ in 0..uavs {
            for &[i, k] in &step.links {
                let both: Vec<bool> = maps[i].iter().zip(&maps[k]).map(|(a, b)| a | b).collect();
                (maps[i], maps[k]) = (both.clone(), both);
            }
        }
        sim.step(step.actions.as_flattened()).unwrap();
        for (i, map) in maps.iter().enumerate() {
            for (index, &looked) in map.iter().enumerate() {
                assert_eq!(sim.state().searched(i, index), looked);
            }
        }
        differed += usize::from(maps.iter().any(|map| *map != maps[0]));
    }
    assert!(differed > 3 && differed < trace.steps.len());
}

/// UAVs that detected a hotspot while flying at the lowest and at the highest pilot density.
fn learners_by_density(trace: &Trace) -> [usize; 2] {
    let config = &trace.header.config;
    let mut learners = [0; 2];
    for (before, step) in pairs(trace) {
        for uav in 0..step.positions.len() {
            if step.knowledge[uav].len() > before.knowledge[uav].len() {
                let density = step.pilot_density[uav];
                learners[0] += usize::from(density == config.pilot_density_min);
                learners[1] += usize::from(density == config.pilot_density_max);
            }
        }
    }
    learners
}

#[test]
fn coherent_pilots() {
    let trace = reproduced("coherent_pilots");
    let config = &trace.header.config;
    assert_eq!(config.pilot_gain, PilotGain::Coherent);
    assert_eq!(config.detection_curve, DetectionCurve::Logistic);
    assert!(trace.end.metrics.confirmed > 0);
    assert!(learners_by_density(&trace).iter().all(|&count| count > 0));
}

#[test]
fn swerling1() {
    let trace = reproduced("swerling1");
    let config = &trace.header.config;
    assert_eq!(config.pilot_gain, PilotGain::Coherent);
    assert_eq!(config.detection_curve, DetectionCurve::Swerling1);
    assert!(trace.end.metrics.confirmed > 0);
    assert!(learners_by_density(&trace).iter().all(|&count| count > 0));
}

/// Fewer UAVs than a wide block, and no gain of the pilots.
#[test]
fn swerling1_alone() {
    let trace = reproduced("swerling1_alone");
    let config = &trace.header.config;
    assert_eq!(config.pilot_gain, PilotGain::None);
    assert_eq!(config.detection_curve, DetectionCurve::Swerling1);
    assert!(trace.end.metrics.confirmed > 0);
}

#[test]
fn detection_table() {
    let trace = reproduced("detection_table");
    let config = &trace.header.config;
    assert_eq!(config.detection_curve, DetectionCurve::Table);
    assert_eq!(config.detection_table.len(), 3);
    assert!(trace.end.metrics.confirmed > 0);
    assert!(learners_by_density(&trace).iter().all(|&count| count > 0));
}
