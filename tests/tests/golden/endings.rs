//! How an episode ends, and what its end pays.

use jcas_core::Config;

use crate::support::{pairs, reproduced};

#[test]
fn completion() {
    let trace = reproduced("completion");
    assert!(trace.end.terminated && !trace.end.truncated);
    let last = trace.steps.last().unwrap();
    assert_eq!(last.informed.len(), trace.header.hotspots.len());
    assert!(last.reward.0[2] > 0.0, "the completion pays");
    // Confirmed exceeds informed at some time, since knowledge has to spread.
    assert!(
        trace
            .steps
            .iter()
            .any(|step| step.confirmed.len() > step.informed.len())
    );
    // A hotspot is paid once: a step without a newly informed hotspot pays nothing.
    assert!(
        pairs(&trace)
            .filter(|(a, b)| !a.informed.is_empty() && a.informed == b.informed)
            .all(|(_, step)| step.reward.0[1] == 0.0)
    );
}

#[test]
fn completion_on_horizon() {
    let trace = reproduced("completion_on_horizon");
    assert_eq!(trace.end.steps, trace.header.config.horizon_steps);
    assert!(trace.end.terminated && !trace.end.truncated);
    // The paper's penalty applies at t = T_max, whether the mission is complete or not.
    assert!(trace.steps.last().unwrap().reward.0[7] < 0.0);
    assert!(
        trace.steps.last().unwrap().reward.0[2] > 0.0,
        "the completion pays"
    );
}

#[test]
fn truncation() {
    let trace = reproduced("truncation");
    assert!(trace.end.truncated && !trace.end.terminated);
    assert_eq!(trace.end.steps, trace.header.config.horizon_steps);
    assert!(
        trace.steps.last().unwrap().reward.0[7] < 0.0,
        "truncation costs"
    );
    assert!(
        trace.end.metrics.confirmed > 0,
        "something was confirmed before"
    );
}

#[test]
fn paper_preset() {
    let trace = reproduced("paper_preset");
    let config = &trace.header.config;
    let paper = Config {
        uav_count: config.uav_count,
        hotspot_count: config.hotspot_count,
        // Stronger chargers than the paper's have a rating above what a battery accepts.
        charge_power_kw: config.charge_power_kw,
        ..Config::preset(jcas_core::Preset::Paper)
    };
    assert_eq!(*config, paper);
    // The letter pays informed hotspots again at every step.
    assert!(
        pairs(&trace).any(|(a, b)| !a.informed.is_empty()
            && a.informed == b.informed
            && b.reward.0[1] > 0.0)
    );
    // It bills chargers by their rating, also for full batteries.
    assert!(trace.end.metrics.grid_kwh > trace.end.metrics.accepted_kwh);
}

#[test]
fn one_uav() {
    let trace = reproduced("one_uav");
    assert_eq!(trace.header.config.uav_count, 1);
    assert!(trace.end.terminated, "alone it completes");
    assert!(
        trace
            .steps
            .iter()
            .all(|step| step.links.is_empty() && step.throughput == 0.0)
    );
}
