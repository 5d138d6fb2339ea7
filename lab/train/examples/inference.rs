//! Our side of `python/benchmarks/inference.py`: inference of a policy by jcas-policy and by the
//! trainer's forward pass.
//!
//!     inference POLICY UAVS HOTSPOTS OBSERVATIONS
//!
//! Writes the observations of 64 episodes, f32, to the file OBSERVATIONS. Then it reads lines `ours
//! ROWS CALLS` or `trainer ROWS CALLS`, makes the calls and answers each line. The answer to a
//! single call is the outputs for these rows.

use std::hint::black_box;
use std::io::{BufRead, Write};
use std::path::Path;

use burn_tensor::{Device, Tensor};
use jcas_core::rng::derive_seed;
use jcas_core::{Config, Model, Sim};
use jcas_episode::card;
use jcas_policy::{BaselineKind, PilotMode, Policy};
use jcas_train::network::values;
use jcas_train::policy::{Actor, files, shape_of};

const MISSIONS: u64 = 64;
/// Into the mission by which the fleet has spread out.
const STEPS: u32 = 8;

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [folder, uavs, hotspots, to] = &arguments[..] else {
        panic!("inference POLICY UAVS HOTSPOTS OBSERVATIONS");
    };
    let folder = Path::new(folder);
    let stored = card::load(folder).expect("the folder of a policy");
    let model = Model::new(Config {
        uav_count: uavs.parse().expect("a number of UAVs"),
        hotspot_count: hotspots.parse().expect("a number of hotspots"),
        ..stored.card.config
    })
    .expect("a legal fleet");
    stored.check(&model).expect("a policy for this fleet");
    let observations = observe(&model);
    let bytes: Vec<u8> = observations.iter().flat_map(|x| x.to_le_bytes()).collect();
    std::fs::write(to, bytes).expect("a file that can be written");
    let mut ours = stored.policy(None);
    let (_, actor) = files::load(folder).expect("the network of a policy");
    let trainer = Trainer::new(&actor);
    for line in std::io::stdin().lock().lines() {
        let line = line.expect("text");
        let words: Vec<&str> = line.split_whitespace().collect();
        let [who, rows, calls] = words[..] else {
            panic!("WHO ROWS CALLS");
        };
        let rows: usize = rows.parse().expect("a number of rows");
        let calls: u64 = calls.parse().expect("a number of calls");
        let seen = &observations[..rows * model.observation_len()];
        let mut outputs = Vec::new();
        for _ in 0..calls {
            let seen = black_box(seen);
            outputs = match who {
                "ours" => ours.outputs(&model, seen).expect("a mission that fits"),
                _ => trainer.outputs(&model, seen),
            };
            black_box(&outputs);
        }
        let told = if calls == 1 { &outputs[..] } else { &[] };
        let words: Vec<String> = told.iter().map(f32::to_string).collect();
        println!("{}", words.join(" "));
        std::io::stdout().flush().expect("a reader");
    }
}

/// What the UAVs of missions under way observe, one row for each.
fn observe(model: &Model<'_>) -> Vec<f32> {
    let len = model.uav_count() * model.observation_len();
    let mut observations = vec![0.0; MISSIONS as usize * len];
    let mut sim = Sim::new(model);
    let mut actions = vec![0.0; model.action_len()];
    for (mission, row) in observations.chunks_exact_mut(len).enumerate() {
        let seed = derive_seed(1, mission as u64);
        let mut policy = BaselineKind::Random.build_privileged(PilotMode::Mid);
        sim.reset(seed);
        policy.reset(model, seed);
        for _ in 0..STEPS {
            policy.act(model, &sim.state(), &mut actions);
            sim.step(&actions).expect("finite actions");
        }
        sim.observe(row).expect("of the right length");
    }
    observations
}

/// The actor as rollouts use it.
struct Trainer<'a> {
    actor: &'a Actor,
    weights: Vec<Tensor<2>>,
}

impl<'a> Trainer<'a> {
    fn new(actor: &'a Actor) -> Self {
        let weights = actor.network.tensors(&actor.parameters, &Device::flex());
        Self { actor, weights }
    }

    fn outputs(&self, model: &Model<'_>, observations: &[f32]) -> Vec<f32> {
        let mut inputs = observations.to_vec();
        self.actor.inputs.apply(&mut inputs);
        let shape = shape_of(model);
        let features = self.actor.network.features(&inputs, &shape);
        values(self.actor.network.forward(&self.weights, features, &shape))
    }
}
