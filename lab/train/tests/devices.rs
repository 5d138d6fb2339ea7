//! A GPU computes what the processor computes, within what sums in another order allow. Runs for
//! each device that is built in, as by `cargo test -p jcas-train --features cuda --test devices`,
//! where one is at hand.

use burn_tensor::Device;
use jcas_core::Config;
use jcas_train::device;
use jcas_train::network::{flat_gradient, values};
use jcas_train::policy::files::Precision;
use jcas_train::run::RunSpec;
use jcas_train::settings::{NetworkKind, Preset, Settings};
use std::io::Write;

/// Devices besides the processor. What is missing is said past the harness, which keeps to itself
/// what a test prints.
fn gpus() -> Vec<(&'static str, Device)> {
    let mut found = Vec::new();
    for &name in device::NAMES.iter().filter(|&&name| name != "cpu") {
        match device::named(name) {
            Ok(gpu) => found.push((name, gpu)),
            Err(why) => {
                let _ = writeln!(std::io::stderr(), "skipped: {why}");
            }
        }
    }
    if device::NAMES.len() == 1 {
        let _ = writeln!(std::io::stderr(), "skipped: built without cuda and wgpu");
    }
    found
}

fn plan(network: NetworkKind, device: &str) -> RunSpec {
    RunSpec {
        settings: Settings {
            network,
            actor_hidden: vec![64, 32],
            critic_hidden: vec![64, 32],
            environments: 8,
            workers: 2,
            batch_steps: 128,
            total_steps: 128,
            epochs: 2,
            minibatch_rows: 128,
            critic_minibatch_rows: 64,
            ..Settings::preset(Preset::Paper)
        },
        configs: vec![Config {
            uav_count: 4,
            hotspot_count: 3,
            horizon_steps: 20,
            ..Config::default()
        }],
        drawn_around: None,
        out: std::env::temp_dir(),
        name: "device".into(),
        precision: Precision::Single,
        device: device.into(),
    }
}

/// Largest difference, as a part of the largest number.
fn difference(a: &[f32], b: &[f32]) -> f32 {
    assert_eq!(a.len(), b.len());
    let largest = a.iter().fold(0.0f32, |largest, x| largest.max(x.abs()));
    let differences = a.iter().zip(b).map(|(a, b)| (a - b).abs());
    differences.fold(0.0, f32::max) / largest.max(f32::MIN_POSITIVE)
}

#[test]
fn outputs_and_gradients_are_the_processor_s() {
    for (name, gpu) in gpus() {
        for kind in [NetworkKind::Mlp, NetworkKind::Set] {
            let trainer = plan(kind, "cpu").trainer().unwrap();
            let (actor, shape) = (&trainer.actor, trainer.workers[0].shape());
            let rows = 96;
            let observations: Vec<f32> = (0..rows * shape.observation_len)
                .map(|index| (index as f32 * 0.7).sin())
                .collect();
            let of = |device: &Device| {
                let weights = actor
                    .network
                    .tensors(&actor.parameters, &device.clone().autodiff());
                let outputs = actor.network.forward(
                    &weights,
                    actor.network.features(&observations, &shape),
                    &shape,
                );
                let loss = outputs.clone().square().sum();
                let gradient = flat_gradient(&actor.network, &weights, loss.backward());
                (values(outputs), gradient)
            };
            let (here, there) = (of(&Device::flex()), of(&gpu));
            let (outputs, gradients) =
                (difference(&here.0, &there.0), difference(&here.1, &there.1));
            println!("{name} {kind:?}: outputs {outputs:e}, gradients {gradients:e}");
            assert!(outputs < 1e-4 && gradients < 1e-3, "{name} {kind:?}");
        }
    }
}

#[test]
fn a_batch_is_learnt_on_each_device() {
    for (name, _) in gpus() {
        for kind in [NetworkKind::Mlp, NetworkKind::Set] {
            let mut trainer = plan(kind, name).trainer().unwrap();
            let before = trainer.actor.parameters.clone();
            trainer.iterate();
            let after = &trainer.actor.parameters;
            assert!(after.iter().all(|weight| weight.is_finite()), "{name}");
            assert_ne!(&before, after, "{name}");
        }
    }
}

#[test]
fn a_device_that_is_not_there_is_refused_by_name() {
    let told = device::named("abacus").unwrap_err().to_string();
    assert!(told.contains("device: abacus is not allowed"), "{told}");
    assert!(told.contains("one of those built in: cpu"), "{told}");
}
