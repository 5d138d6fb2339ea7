//! Plans through the C interface are those of Rust, bit for bit, and so are their flights.
//!
//! These tests catch a handle or a text that is accepted by mistake. They also catch a plan that
//! changes on its way through a file, a batch or a policy.

mod abi_support;

use std::ops::ControlFlow;
use std::process::Command;

use abi_support::{c_compilers, compile, root, run};
use jcas_core::{Cell, Config, Model, Sim, TargetVisibility};
use jcas_plan::{Plan, Planned, PlannedKind, Settings, search, tour};
use jcas_policy::Policy;

const SEED: u64 = 4;
const SETTINGS: Settings = Settings {
    iterations: 2_000,
    seed: 7,
};
const HOTSPOTS: [Cell; 2] = [Cell { x: 0, y: 1 }, Cell { x: 6, y: 5 }];

fn model(target_visibility: TargetVisibility) -> Model<'static> {
    Model::new(Config {
        uav_count: 5,
        hotspot_count: 2,
        grid_width: 7,
        grid_height: 7,
        target_visibility,
        ..Config::default()
    })
    .expect("legal sizes")
}

/// The hash of the last state of a flight.
fn fly(model: &Model<'_>, mut policy: Planned, hotspots: Option<&[Cell]>) -> String {
    let mut sim = Sim::new(model);
    let mut actions = vec![0.0; model.action_len()];
    sim.reset(SEED);
    policy.reset(model, SEED);
    if let Some(cells) = hotspots {
        sim.set_hotspots(cells).expect("cells without a depot");
    }
    loop {
        policy.act(model, &sim.state(), &mut actions);
        let outcome = sim.step(&actions).expect("finite actions");
        if outcome.terminated || outcome.truncated {
            return format!("0x{:016x}", sim.state_hash());
        }
    }
}

#[test]
fn plans_in_c_are_those_of_rust() {
    let go_on = &mut |_| ControlFlow::Continue(());
    let following = |plan: Plan| Planned::following(plan);
    let hidden = model(TargetVisibility::Hidden);
    let known = model(TargetVisibility::Known);
    let searched = search(&hidden, &SETTINGS, go_on).expect("a small fleet");
    let toured = tour(&known, &HOTSPOTS, &SETTINGS, go_on).expect("a small fleet");
    let mut expected = vec![
        fly(&hidden, following(searched), None),
        fly(&known, following(toured), Some(&HOTSPOTS)),
    ];
    for kind in PlannedKind::ALL {
        let policy = kind.build(&known).expect("a small fleet");
        expected.push(fly(&known, policy, None));
    }
    for compiler in c_compilers() {
        let source = root().join("tests/c/plans.c");
        let program = compile(compiler, "c11", "plans", &[source]);
        let output = run(&mut Command::new(program)).stdout;
        let text = String::from_utf8(output).expect("text");
        assert_eq!(text.lines().collect::<Vec<_>>(), expected, "{compiler}");
    }
}

#[test]
fn the_example_plans_and_flies() {
    for compiler in c_compilers() {
        let source = root().join("examples/c/plan.c");
        let program = compile(compiler, "c11", "plan", &[source]);
        let output = run(&mut Command::new(program)).stdout;
        let text = String::from_utf8(output).expect("text");
        assert!(text.contains("steps expected"), "{compiler}: {text}");
        assert!(
            text.contains("5 of 5 hotspots confirmed"),
            "{compiler}: {text}"
        );
    }
}
