//! Policies act through the C interface as they do in Rust, bit for bit.
//!
//! These tests catch an invalid handle or file that is accepted, and weights or observations in the
//! wrong order. They also catch a baseline that carries its plan into the next mission.

mod abi_support;

use std::fs;
use std::process::Command;

use abi_support::{c_compilers, compile, root, run};
use jcas_core::rng::derive_seed;
use jcas_core::{Config, Model, Sim};
use jcas_episode::campaign::fly_episode;
use jcas_policy::head::Mode;
use jcas_policy::network::{ActOptions, Network};
use jcas_policy::{BaselineKind, PilotMode};

const SEED: u64 = 4;

fn policy_file() -> std::path::PathBuf {
    root().join("policies/mission/policy.safetensors")
}

/// The hash of the last state of the network's mission.
fn fly_network(model: &Model<'_>, seed: u64, mode: Mode) -> u64 {
    let file = std::fs::read(policy_file()).expect("the shipped policy is there");
    let mut weights = vec![0.0; Network::read(&file).expect("it is whole").weights_len()];
    let network = Network::load(&file, &mut weights).expect("it is whole");
    let options = ActOptions {
        mode,
        ..network.act_options(model.config())
    };
    let mut sim = Sim::new(model);
    let mut observations = vec![0.0; model.uav_count() * model.observation_len()];
    let mut scratch = vec![0.0; network.scratch_len(model)];
    let mut actions = vec![0.0; model.action_len()];
    sim.reset(seed);
    loop {
        sim.observe(&mut observations).expect("of the right length");
        network
            .act(
                &weights,
                options,
                model,
                &sim.state(),
                &observations,
                &mut scratch,
                &mut actions,
            )
            .expect("it fits");
        let outcome = sim.step(&actions).expect("finite actions");
        if outcome.terminated || outcome.truncated {
            return sim.state_hash();
        }
    }
}

fn model(uav_count: u32, hotspot_count: u32) -> Model<'static> {
    Model::new(Config {
        uav_count,
        hotspot_count,
        ..Config::default()
    })
    .expect("legal sizes")
}

#[test]
fn policies_in_c_fly_what_they_fly_in_rust() {
    let model = model(10, 3);
    let mut expected = vec![
        fly_network(&model, SEED, Mode::Deterministic),
        fly_network(&model, SEED, Mode::Sampled),
    ];
    for kind in BaselineKind::ALL {
        let mut policy = kind
            .build(&model, PilotMode::Max)
            .expect("nothing is hidden");
        let mut sim = Sim::new(&model);
        fly_episode(&model, &mut sim, &mut policy, SEED).expect("it flies");
        expected.push(sim.state_hash());
    }
    let expected: Vec<String> = expected
        .iter()
        .map(|hash| format!("0x{hash:016x}"))
        .collect();
    for compiler in c_compilers() {
        let source = root().join("tests/c/policies.c");
        let program = compile(compiler, "c11", "policies", &[source]);
        let output = run(Command::new(program).arg(policy_file())).stdout;
        let text = String::from_utf8(output).expect("text");
        assert_eq!(text.lines().collect::<Vec<_>>(), expected, "{compiler}");
    }
}

#[test]
fn rollouts_make_what_simulations_alone_make() {
    for compiler in c_compilers() {
        let source = root().join("tests/c/futures.c");
        let program = compile(compiler, "c11", "futures", &[source]);
        run(Command::new(program).arg(policy_file()));
    }
}

#[test]
fn the_example_flies_the_shipped_policy() {
    let hash = fly_network(&model(15, 7), derive_seed(1, 0), Mode::Deterministic);
    for compiler in c_compilers() {
        let source = root().join("examples/c/fly_policy.c");
        let program = compile(compiler, "c11", "fly_policy", &[source]);
        let fly = |what: &std::ffi::OsStr| {
            let output = run(Command::new(&program).arg(what)).stdout;
            String::from_utf8(output).expect("text")
        };
        let text = fly(policy_file().as_os_str());
        assert!(
            text.contains(&format!("state 0x{hash:016x}")),
            "{compiler}: {text}, not 0x{hash:016x}"
        );
        assert!(fly("greedy".as_ref()).contains("7 of 7"));
        let head = fs::read_to_string(root().join("examples/c/fly_policy.c")).expect("it is there");
        let head = head.split("*/").next().unwrap_or_default();
        for kind in BaselineKind::ALL {
            assert!(head.contains(kind.name()), "{kind} is not listed");
            assert!(fly(kind.name().as_ref()).contains(" of 7"), "{kind}");
        }
    }
}
