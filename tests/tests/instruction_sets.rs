//! The steps of each instruction set of this machine reproduce the golden traces.

use std::fs;
use std::path::Path;

use jcas_core::batch::BatchOut;
use jcas_core::{Model, Scratch, hash};
use jcas_episode::trace::{self, Trace};
use jcas_simd::InstructionSet;

/// Runs a trace's actions as a batch of one and compares every state and observation with the
/// trace.
fn reproduce(name: &str, trace: &Trace, set: InstructionSet) {
    let model = Model::new(trace.header.config).expect("a legal configuration");
    let mut states = vec![0; model.state_words()];
    let mut words = vec![0; Scratch::words_for(&model)];
    let mut scratch = Scratch::new(&model, &mut words).expect("sized for the model");
    let mut observations = vec![0.0; model.uav_count() * model.observation_len()];
    let seeds = [trace.header.seed.0];
    model
        .batch_reset(
            &mut states,
            &mut scratch,
            &seeds,
            &mut observations,
            &mut [],
        )
        .expect("buffers of the right lengths");
    let mut alone = states.clone();
    for (index, step) in trace.steps.iter().enumerate() {
        let (mut reward, mut terminated, mut truncated) = ([0.0], [0], [0]);
        let mut out = BatchOut {
            observations: &mut observations,
            rewards: &mut reward,
            terminated: &mut terminated,
            truncated: &mut truncated,
            ..BatchOut::default()
        };
        let actions = step.actions.as_flattened();
        set.batch_step(&model, &mut states, &mut scratch, actions, false, &mut out)
            .expect("a legal step");
        let at = || format!("{name}, step {}, {}", index + 1, set.name());
        assert_eq!(hash::words(&states), step.state_hash.0, "{}", at());
        let mut state = model.state_mut(&mut alone).expect("a state of the model");
        set.step(&model, &mut state, &mut scratch, actions)
            .expect("a legal step");
        assert_eq!(alone, states, "without observations, {}", at());
        let seen = hash::reals(&observations);
        assert_eq!(seen, step.observation_hash.0, "{}", at());
    }
}

#[test]
fn golden_traces_are_the_same_on_every_instruction_set() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("golden");
    let mut flown = 0;
    for entry in fs::read_dir(folder).expect("the folder of golden traces") {
        let path = entry.expect("an entry").path();
        if path.extension().is_none_or(|kind| kind != "jsonl") {
            continue;
        }
        let name = path.display().to_string();
        let bytes = fs::read(&path).expect("a trace");
        let trace = trace::read(bytes.as_slice()).expect("a trace as it was recorded");
        for set in InstructionSet::all() {
            reproduce(&name, &trace, set);
        }
        flown += 1;
    }
    assert!(flown >= 21, "{flown} traces");
}
