//! Training and acting on each device that is built in, with the processor beside it:
//!
//!     cargo bench -p jcas-train --features cuda              # or wgpu, or both
//!     cargo bench -p jcas-train --features cuda -- 2560 512  # environment steps of a batch, side of plain products
//!
//! Tells what the device is called, UAV samples a second over whole batches (the second of two), the rate of matrix
//! products in learning and in plain large products, and how far the outputs of one policy are from the processor's.
//! Without a GPU it says so and ends well.

use burn_tensor::Device;
use jcas_core::{Config, Preset as World};
use jcas_train::device;
use jcas_train::network::{matrix, values};
use jcas_train::policy::files::Precision;
use jcas_train::run::Plan;
use jcas_train::settings::{NetworkKind, Preset, Settings};
use std::time::Instant;

fn main() {
    let numbers: Vec<usize> = std::env::args()
        .skip(1)
        .filter_map(|word| word.parse().ok())
        .collect();
    let steps = numbers.first().copied().unwrap_or(5120);
    let side = numbers.get(1).copied().unwrap_or(4096);
    if device::NAMES.len() == 1 {
        println!("only the processor is built in; --features cuda or wgpu adds a GPU\n");
    }
    println!(
        "| device | network | samples/s | learning, GFLOP/s | plain {side}³ | share | outputs differ by |"
    );
    println!("| --- | --- | ---: | ---: | ---: | ---: | ---: |");
    for &name in device::NAMES {
        match device::named(name) {
            Ok(on) => measure(name, &on, steps, side),
            Err(why) => println!("\nskipped: {why}\n"),
        }
    }
}

fn measure(name: &str, on: &Device, steps: usize, side: usize) {
    let plain = plain_products_gflops(on, side);
    for preset in [Preset::Paper, Preset::Tuned] {
        let plan = plan(preset, name, steps);
        let mut trainer = plan.trainer().unwrap_or_else(|error| {
            eprintln!("{error}");
            std::process::exit(2);
        });
        let network = match trainer.settings.network {
            NetworkKind::Mlp => "MLP",
            NetworkKind::Set => "set",
        };
        // The first batch also compiles kernels.
        trainer.iterate();
        let batch = trainer.iterate();
        let samples =
            (steps * plan.configs[0].uav_count as usize) as f64 / batch.wall.as_secs_f64();
        let operations = batch.actor.operations + batch.critic.operations;
        let learning = operations / batch.learning.as_secs_f64() / 1e9;
        println!(
            "| {name}: {} | {network} | {samples:.0} | {learning:.1} | {plain:.1} | {:.0} % | {:.1e} |",
            device::title(on),
            100.0 * learning / plain,
            difference(&plan, on)
        );
    }
}

/// N = 10, n = 5 in the paper's world.
fn plan(preset: Preset, device: &str, steps: usize) -> Plan {
    Plan {
        settings: Settings {
            device: device.into(),
            batch_steps: steps,
            total_steps: 2 * steps as u64,
            ..Settings::preset(preset)
        },
        configs: vec![Config {
            uav_count: 10,
            hotspot_count: 5,
            ..Config::preset(World::Paper)
        }],
        out: std::env::temp_dir(),
        name: "device".into(),
        precision: Precision::Single,
    }
}

/// Rate of a chain of large f32 products, whose numbers stay as they are.
fn plain_products_gflops(on: &Device, side: usize) -> f64 {
    const PRODUCTS: usize = 8;
    let factor = matrix(vec![1.0 / side as f32; side * side], side, on);
    let chain = |products: usize| {
        let product =
            (0..products).fold(factor.clone(), |product, _| product.matmul(factor.clone()));
        values(product.slice([0..1, 0..1]))
    };
    chain(1);
    let started = Instant::now();
    let number = chain(PRODUCTS)[0];
    let spent = started.elapsed().as_secs_f64();
    assert!((number * side as f32 - 1.0).abs() < 1e-3, "{number}");
    PRODUCTS as f64 * 2.0 * (side as f64).powi(3) / spent / 1e9
}

/// How far the outputs of fresh weights for a thousand observations are from the processor's.
fn difference(plan: &Plan, on: &Device) -> f32 {
    let trainer = plan.trainer().expect("a plan that is legal");
    let (actor, shape) = (&trainer.actor, trainer.workers[0].shape());
    let observations: Vec<f32> = (0..1000 * shape.observation_len)
        .map(|index| (index as f32 * 0.7).sin())
        .collect();
    let outputs = |device: &Device| {
        let weights = actor.network.tensors(&actor.parameters, device);
        values(
            actor
                .network
                .forward(&weights, observations.clone(), &shape),
        )
    };
    let (here, there) = (outputs(&Device::flex()), outputs(on));
    here.iter()
        .zip(&there)
        .map(|(a, b)| (a - b).abs())
        .fold(0.0, f32::max)
}
