//! Other readings of the paper's text: the quorum, what a detection teaches, where UAVs start.

use std::collections::BTreeSet;

use jcas_core::{Model, Sim};

use crate::support::reproduced;

#[test]
fn other_readings() {
    let trace = reproduced("other_readings");
    let model = Model::new(trace.header.config).unwrap();
    let quorum = trace.header.config.quorum as usize;
    let (uavs, hotspots) = (model.uav_count(), model.hotspot_count());
    let mut sim = Sim::new(&model);
    sim.reset(trace.header.seed.0);
    let starts: BTreeSet<_> = (0..uavs)
        .map(|uav| <(u32, u32)>::from(sim.state().cell(uav)))
        .collect();
    assert_eq!(starts.len(), uavs, "UAVs start apart");

    let mut seers = vec![BTreeSet::new(); hotspots];
    let (mut late, mut unconfirmed) = (0, 0);
    for step in &trace.steps {
        sim.step(step.actions.as_flattened()).unwrap();
        let state = sim.state();
        for (hotspot, seers) in seers.iter_mut().enumerate() {
            let now: Vec<usize> = (0..uavs)
                .filter(|&uav| state.detected(uav, hotspot))
                .collect();
            seers.extend(now.iter().copied());
            assert_eq!(state.confirmed(hotspot), seers.len() >= quorum);
            let fresh = state.confirmed_at(hotspot) == Some(step.t);
            late += usize::from(fresh && now.len() < quorum);
            for &uav in &now {
                assert!(state.knows(uav, hotspot));
                unconfirmed += usize::from(!state.confirmed(hotspot));
            }
        }
    }
    assert!(late > 0, "a quorum is reached over several steps");
    assert!(unconfirmed > 0, "a UAV learns what is not confirmed");
}

/// A cell is falsely confirmed by the UAVs that have raised an alarm there in any step.
#[test]
fn false_confirmations_over_the_episode() {
    let trace = reproduced("other_readings");
    let quorum = trace.header.config.quorum as usize;
    let mut alarms = BTreeSet::new();
    for step in &trace.steps {
        for (uav, cells) in step.false_alarms.iter().flatten().enumerate() {
            alarms.extend(cells.iter().map(|cell| (cell.y, cell.x, uav)));
        }
        let cells: BTreeSet<_> = alarms.iter().map(|&(y, x, _)| (y, x)).collect();
        let seers = |(y, x)| alarms.range((y, x, 0)..(y, x + 1, 0)).count();
        let expected = cells.iter().filter(|&&cell| seers(cell) >= quorum);
        let recorded = step.falsely_confirmed.iter().flatten();
        assert!(expected.copied().eq(recorded.map(|cell| (cell.y, cell.x))));
    }
    assert!(trace.end.metrics.false_confirmations > 0);
}
