//! Policy files: the library refuses the bytes, or the policy gives actions that are numbers.

#![no_main]

use jcas_core::{Model, Sim};
use jcas_fuzz::{UAVS, small_model};
use jcas_policy::{Policy, Trained};
use libfuzzer_sys::fuzz_target;
use std::sync::LazyLock;

static MODEL: LazyLock<Model<'static>> = LazyLock::new(small_model);

fuzz_target!(|bytes: &[u8]| {
    let Ok(mut policy) = Trained::read("fuzzed", bytes) else {
        return;
    };
    if policy.check(&MODEL).is_err() {
        return;
    }
    let mut sim = Sim::new(&MODEL);
    sim.reset(1);
    let mut observations = vec![0.0; MODEL.observation_len() * UAVS];
    sim.observe(&mut observations).unwrap();
    let mut actions = [f32::NAN; 2 * UAVS];
    policy.reset(&MODEL, 1);
    policy.see(&observations);
    policy.act(&MODEL, &sim.state(), &mut actions);
    assert!(actions.iter().all(|action| action.is_finite()));
});
