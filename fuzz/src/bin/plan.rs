//! Plan files: the planner refuses the text, or a fleet follows the plan to the end.

#![no_main]

use jcas_core::{Model, Sim};
use jcas_fuzz::{UAVS, small_model};
use jcas_plan::{PlanFile, Planned};
use jcas_policy::Policy;
use libfuzzer_sys::fuzz_target;
use std::sync::LazyLock;

static MODEL: LazyLock<Model<'static>> = LazyLock::new(small_model);

fuzz_target!(|text: &str| {
    let Ok(mut file) = PlanFile::parse(text) else {
        return;
    };
    let again = PlanFile::parse(&file.to_json().unwrap()).expect("a text that was written is read");
    assert_eq!(again, file);
    // A hash is hard to guess.
    file.config_hash = format!("0x{:016x}", MODEL.config_hash());
    let Ok(plan) = file.plan(&MODEL) else {
        return;
    };
    let mut policy = Planned::following(plan);
    let mut sim = Sim::new(&MODEL);
    sim.reset(1);
    policy.reset(&MODEL, 1);
    let mut actions = [f32::NAN; 2 * UAVS];
    while !(sim.state().terminated() || sim.state().truncated()) {
        policy.act(&MODEL, &sim.state(), &mut actions);
        assert!(actions.iter().all(|action| action.is_finite()));
        sim.step(&actions).unwrap();
    }
});
