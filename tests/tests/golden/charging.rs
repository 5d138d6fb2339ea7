//! Batteries: return to base, charging, and UAVs that run empty.

use jcas_core::{Config, motion};

use crate::support::{pairs, reproduced};

fn capacity_uj(config: &Config) -> u64 {
    (config.battery_capacity_kwh * 3.6e12).round() as u64
}

#[test]
fn return_to_base() {
    let trace = reproduced("return_to_base");
    let depot = trace.header.depots[0];
    let mut homeward = 0;
    let mut charging = 0;
    for (before, step) in pairs(&trace) {
        for &uav in &step.returning {
            let (from, to) = (before.positions[uav], step.positions[uav]);
            let home = motion::toward(from, depot);
            let grid = (
                trace.header.config.grid_width,
                trace.header.config.grid_height,
            );
            assert_eq!(to, motion::destination(from, home, grid.0, grid.1));
            homeward += usize::from(from != to);
            charging += usize::from(from == depot && step.battery_uj[uav] > before.battery_uj[uav]);
        }
    }
    assert!(homeward > 0, "a UAV flies home");
    assert!(charging > 0, "a UAV stays on the depot and charges");
    let left_again = pairs(&trace).any(|(before, step)| {
        before
            .returning
            .iter()
            .any(|uav| !step.returning.contains(uav) && before.positions[*uav] == depot)
    });
    assert!(left_again, "a UAV has charged above the threshold");
}

#[test]
fn charging_to_full() {
    let trace = reproduced("charging_to_full");
    let capacity = capacity_uj(&trace.header.config);
    let filled = pairs(&trace).any(|(before, step)| {
        (0..step.battery_uj.len())
            .any(|uav| before.battery_uj[uav] < capacity && step.battery_uj[uav] == capacity)
    });
    assert!(filled, "a battery fills up");
    assert!(trace.end.metrics.accepted_kwh > 0.0);
    assert!(trace.end.metrics.co2_kg > 0.0);
}

#[test]
fn grounded() {
    let trace = reproduced("grounded");
    let depot = trace.header.depots[0];
    let mut stranded = 0;
    for (before, step) in pairs(&trace) {
        for &uav in &step.grounded {
            assert_eq!(before.battery_uj[uav], 0);
            assert_eq!(
                before.positions[uav], step.positions[uav],
                "a grounded UAV stays"
            );
            assert!(
                step.links.iter().flatten().all(|&linked| linked != uav),
                "and is silent"
            );
            stranded += usize::from(step.positions[uav] != depot);
        }
    }
    assert!(stranded > 0, "a UAV is grounded away from the depot");
    assert!(
        trace.end.metrics.shortfall_kwh > 0.0,
        "a step asked for more than was left"
    );
}

#[test]
fn grounded_on_depot() {
    let trace = reproduced("grounded_on_depot");
    let first = &trace.steps[0];
    assert_eq!(first.grounded.len(), first.positions.len());
    assert!(
        first.battery_uj.iter().all(|&charge| charge > 0),
        "grounded UAVs charge"
    );
    assert!(trace.steps[1].grounded.is_empty(), "and recover");
    assert!(
        trace.end.metrics.moves == 0,
        "but return to base keeps them"
    );
}

#[test]
fn several_depots() {
    let trace = reproduced("several_depots");
    assert!(trace.header.depots.len() > 1);
    let charged_elsewhere = pairs(&trace).any(|(before, step)| {
        (0..step.positions.len()).any(|uav| {
            trace.header.depots[1..].contains(&step.positions[uav])
                && step.battery_uj[uav] > before.battery_uj[uav]
        })
    });
    assert!(
        charged_elsewhere,
        "a UAV charges on a depot other than the first"
    );
    assert!(
        trace
            .header
            .hotspots
            .iter()
            .all(|cell| !trace.header.depots.contains(cell))
    );
}
