//! False alarms, false confirmations and reports.

use std::collections::{BTreeMap, BTreeSet};

use jcas_core::Cell;
use jcas_episode::trace::{Step, Trace};

use crate::support::{pairs, reproduced};

/// The number of UAVs that raised a false alarm in the cell in this step.
fn seen_by(step: &Step, cell: Cell) -> usize {
    let alarms = step
        .false_alarms
        .as_ref()
        .expect("a trace with false alarms");
    alarms.iter().filter(|cells| cells.contains(&cell)).count()
}

/// A cell is falsely confirmed once its alarms reach the quorum, and for good.
fn cells_are_confirmed_by_quorum(trace: &Trace) {
    let config = &trace.header.config;
    let mut confirmed: BTreeSet<(u32, u32)> = BTreeSet::new();
    for step in &trace.steps {
        let before = confirmed.len();
        for cell in step.false_alarms.iter().flatten().flatten() {
            assert!(
                !trace.header.hotspots.contains(cell),
                "a hotspot is no false alarm"
            );
            if seen_by(step, *cell) >= config.quorum as usize {
                confirmed.insert((cell.y, cell.x));
            }
        }
        let recorded = step.falsely_confirmed.iter().flatten();
        assert!(
            recorded
                .map(|cell| (cell.y, cell.x))
                .eq(confirmed.iter().copied())
        );
        if confirmed.len() > before && config.reward_detect == 0.0 {
            assert!(step.reward.0[0] < 0.0);
        }
    }
    let counted = trace.end.metrics.false_confirmations;
    assert_eq!(counted as usize, confirmed.len());
    assert!(counted > 0);
}

#[test]
fn false_alarms() {
    let trace = reproduced("false_alarms");
    cells_are_confirmed_by_quorum(&trace);
    let config = &trace.header.config;
    let pays = config.reward_false_confirmation;
    for (before, step) in pairs(&trace) {
        let count = |step: &Step| step.falsely_confirmed.as_ref().map_or(0, Vec::len);
        let fresh = count(step) - count(before);
        let found = step.confirmed.len() - before.confirmed.len();
        let expected = config.reward_detect * found as f64 + pays * fresh as f64;
        assert_eq!(step.reward.0[0], expected, "step {}", step.t);
    }
    // A footprint of 150 m reaches three cells.
    for step in &trace.steps {
        for (uav, alarms) in step.false_alarms.iter().flatten().enumerate() {
            let here = step.positions[uav];
            let near = |cell: &Cell| {
                let (dx, dy) = (cell.x.abs_diff(here.x), cell.y.abs_diff(here.y));
                dx * dx + dy * dy <= 9
            };
            assert!(alarms.iter().all(near));
        }
    }
}

#[test]
fn false_alarms_alone() {
    let trace = reproduced("false_alarms_alone");
    cells_are_confirmed_by_quorum(&trace);
    let alarms = trace
        .steps
        .iter()
        .flat_map(|step| step.false_alarms.iter().flatten());
    let most = alarms.map(Vec::len).max();
    assert_eq!(most, Some(8), "more alarms than eight count as eight");
}

/// The reports that a UAV knows after a step, as sets of (y, x) level by level.
fn reports_of(step: &Step, uav: usize) -> Vec<BTreeSet<(u32, u32)>> {
    let reports = step.reports.as_ref().expect("a trace with reports");
    let sets = reports[uav].iter();
    sets.map(|cells| cells.iter().map(|cell| (cell.y, cell.x)).collect())
        .collect()
}

/// A UAV reports its false alarms, once a level, and neighbours know the same.
#[test]
fn reports() {
    let trace = reproduced("reports");
    let uavs = trace.header.config.uav_count as usize;
    let mut alarms_of: Vec<BTreeMap<(u32, u32), u32>> = vec![BTreeMap::new(); uavs];
    let mut heard = 0;
    for step in &trace.steps {
        for (uav, cells) in step.false_alarms.iter().flatten().enumerate() {
            for cell in cells {
                *alarms_of[uav].entry((cell.y, cell.x)).or_insert(0) += 1;
            }
        }
        for (uav, own) in alarms_of.iter().enumerate() {
            let known = reports_of(step, uav);
            assert!(known[1].is_subset(&known[0]));
            for (cell, &times) in own {
                assert!(known[0].contains(cell) && (times < 2 || known[1].contains(cell)));
            }
            heard += known[0]
                .iter()
                .filter(|&cell| !own.contains_key(cell))
                .count();
        }
        for &[a, b] in &step.links {
            assert_eq!(reports_of(step, a), reports_of(step, b), "step {}", step.t);
        }
    }
    assert!(heard > 0, "word of others' sightings");
    for (before, step) in pairs(&trace) {
        for uav in 0..uavs {
            let known = reports_of(step, uav);
            let nested = reports_of(before, uav).into_iter().zip(&known);
            assert!(
                nested
                    .into_iter()
                    .all(|(before, after)| before.is_subset(after))
            );
        }
    }
    let last = trace.steps.last().expect("a step");
    assert!((0..uavs).any(|uav| !reports_of(last, uav)[1].is_empty()));
}
