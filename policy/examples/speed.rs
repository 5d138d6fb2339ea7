//! How long the shipped policy's network takes, on one core: N = 15 and n = 7, then N = 5 and n = 3, the sizes
//! that its ONNX graph is written for.
//!
//!     cargo run --release -p jcas-policy --example speed
//!
//! Prints a line for each number of observations that are handed over at once.

use std::hint::black_box;
use std::time::Instant;

use jcas_core::{Config, Model, Sim};
use jcas_policy::network::Network;

const FLEET: &[u8] = include_bytes!("../../policies/fleet/policy.safetensors");
/// Each measurement is repeated, and the shortest counts.
const REPEATS: usize = 20;
/// Observations of one measurement.
const OBSERVATIONS: usize = 4_000;

fn main() {
    measure(15, 7);
    measure(5, 3);
}

fn measure(uav_count: u32, hotspot_count: u32) {
    println!("N = {uav_count}, n = {hotspot_count}");
    let model = Model::new(Config {
        uav_count,
        hotspot_count,
        ..Config::default()
    })
    .expect("legal sizes");
    let mut weights = vec![0.0; Network::read(FLEET).expect("it is whole").weights_len()];
    let network = Network::load(FLEET, &mut weights).expect("it is whole");
    let mut sim = Sim::new(&model);
    sim.reset(1);
    // The fleet spread out, as it is for most of a mission.
    for step in 0..6 {
        let motion = |k: usize| 0.4 * ((k + step) % 5) as f32 - 0.8;
        let actions: Vec<f32> = (0..model.action_len())
            .map(|k| if k % 2 == 0 { motion(k) } else { 0.5 })
            .collect();
        sim.step(&actions).expect("finite actions");
    }
    let len = model.observation_len();
    let mut seen = vec![0.0; model.uav_count() * len];
    sim.observe(&mut seen).expect("of the right length");
    let mut scratch = vec![0.0; network.scratch_len(&model)];
    for rows in [1, 15, 64] {
        let observations: Vec<f32> = seen.iter().copied().cycle().take(rows * len).collect();
        let mut outputs = vec![0.0; rows * network.head().outputs()];
        let mut best = f64::INFINITY;
        for _ in 0..REPEATS {
            let calls = OBSERVATIONS / rows;
            let started = Instant::now();
            for _ in 0..calls {
                let observations = black_box(&observations);
                network
                    .outputs(&weights, &model, observations, &mut scratch, &mut outputs)
                    .expect("it fits");
                black_box(&outputs);
            }
            best = best.min(started.elapsed().as_secs_f64() / calls as f64);
        }
        let each = best * 1e6 / rows as f64;
        println!(
            "{rows:3} observations: {:8.2} us, {each:6.2} us each",
            best * 1e6
        );
    }
}
