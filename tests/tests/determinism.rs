//! One seed, one hash: on any number of threads and on each instruction set of this machine.

use std::thread;

use jcas_core::batch::BatchOut;
use jcas_core::{Config, Model, Motion, Scratch, hash};
use jcas_simd::InstructionSet;

/// FNV-1a hash of the sixteen final states.
const HASH: u64 = 0xcba4_439c_353a_2b74;

/// Runs 60 steps of episodes side by side; the seeds are consecutive, from `seed` on.
fn run(model: &Model<'_>, set: InstructionSet, seed: u64, states: &mut [u64]) {
    let count = model.batch_len(states).unwrap();
    let mut memory = vec![0; Scratch::words_for(model)];
    let mut scratch = Scratch::new(model, &mut memory).unwrap();
    let mut out = BatchOut {
        observations: &mut vec![0.0; count * model.uav_count() * model.observation_len()],
        rewards: &mut vec![0.0; count],
        terminated: &mut vec![0; count],
        truncated: &mut vec![0; count],
        ..BatchOut::default()
    };
    let seeds: Vec<u64> = (seed..).take(count).collect();
    let began = model.batch_reset(states, &mut scratch, &seeds, out.observations, &mut []);
    began.unwrap();
    for step in 0..60 {
        let motion = |uav: usize| Motion::ALL[(step / 4 + uav) % 5];
        let action = |uav: usize| [motion(uav).to_action(model.config().motion_map), 1.0];
        let actions: Vec<f32> = (0..model.uav_count()).flat_map(action).collect();
        let actions = actions.repeat(count);
        let stepped = set.batch_step(model, states, &mut scratch, &actions, true, &mut out);
        stepped.unwrap();
    }
}

#[test]
fn one_seed_gives_one_hash() {
    let model = Model::new(Config::default()).unwrap();
    let words = model.state_words();
    for set in InstructionSet::all() {
        for threads in 1..=16 {
            let mut states = vec![0; 16 * words];
            let share = 16usize.div_ceil(threads);
            thread::scope(|scope| {
                for (index, states) in states.chunks_mut(share * words).enumerate() {
                    let (model, seed) = (&model, 42 + (index * share) as u64);
                    scope.spawn(move || run(model, set, seed, states));
                }
            });
            let hash = hash::words(&states);
            assert_eq!(hash, HASH, "{threads} threads, {}", set.name());
        }
    }
}
