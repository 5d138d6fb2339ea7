//! Training and acting on each device that is built in, with the processor beside it:
//!
//!     cargo bench -p jcas-train --features cuda              # or wgpu, or both
//!     cargo bench -p jcas-train --features cuda -- 2560      # environment steps of a batch
//!
//! Prints the name of the device and the UAV samples a second over a whole batch (the second of
//! two). It also prints the difference of one policy's outputs from the processor's. Without a GPU
//! it reports that and succeeds.

use burn_tensor::Device;
use jcas_core::Config;
use jcas_train::device;
use jcas_train::network::values;
use jcas_train::policy::files::Precision;
use jcas_train::run::RunSpec;
use jcas_train::settings::{NetworkKind, Preset, Settings};

fn main() {
    let numbers: Vec<usize> = std::env::args()
        .skip(1)
        .filter_map(|word| word.parse().ok())
        .collect();
    let steps = numbers.first().copied().unwrap_or(5120);
    if device::NAMES.len() == 1 {
        println!("only the processor is built in; --features cuda or wgpu adds a GPU\n");
    }
    println!("| device | network | samples/s | outputs differ by |");
    println!("| --- | --- | ---: | ---: |");
    for &name in device::NAMES {
        match device::named(name) {
            Ok(on) => measure(name, &on, steps),
            Err(why) => println!("\nskipped: {why}\n"),
        }
    }
}

fn measure(name: &str, on: &Device, steps: usize) {
    for preset in [Preset::Paper, Preset::Tuned] {
        let plan = plan(preset, name, steps);
        let mut trainer = plan.trainer().unwrap_or_else(|error| {
            eprintln!("{error}");
            std::process::exit(2);
        });
        let network = match trainer.settings.network {
            NetworkKind::Mlp => "MLP",
            NetworkKind::Set => "set",
            NetworkKind::Turns => "set in turn",
        };
        // The first batch also compiles kernels.
        trainer.iterate();
        let batch = trainer.iterate();
        let samples =
            (steps * plan.configs[0].uav_count as usize) as f64 / batch.wall.as_secs_f64();
        println!(
            "| {name}: {} | {network} | {samples:.0} | {:.1e} |",
            device::title(on),
            difference(&plan, on)
        );
    }
}

/// N = 10, n = 5 in the preset `paper`.
fn plan(preset: Preset, device: &str, steps: usize) -> RunSpec {
    RunSpec {
        settings: Settings {
            batch_steps: steps,
            total_steps: 2 * steps as u64,
            ..Settings::preset(preset)
        },
        configs: vec![Config {
            uav_count: 10,
            hotspot_count: 5,
            ..Config::preset(jcas_core::Preset::Paper)
        }],
        drawn_around: None,
        out: std::env::temp_dir(),
        name: "device".into(),
        precision: Precision::Single,
        device: device.into(),
    }
}

/// How far the outputs of fresh weights for a thousand observations are from the processor's.
fn difference(plan: &RunSpec, on: &Device) -> f32 {
    let trainer = plan.trainer().expect("a plan that is legal");
    let (actor, shape) = (&trainer.actor, trainer.workers[0].shape());
    let observations: Vec<f32> = (0..1000 * shape.observation_len)
        .map(|index| (index as f32 * 0.7).sin())
        .collect();
    let outputs = |device: &Device| {
        let weights = actor.network.tensors(&actor.parameters, device);
        values(actor.network.forward(
            &weights,
            actor.network.features(&observations, &shape),
            &shape,
        ))
    };
    let (here, there) = (outputs(&Device::flex()), outputs(on));
    here.iter()
        .zip(&there)
        .map(|(a, b)| (a - b).abs())
        .fold(0.0, f32::max)
}
