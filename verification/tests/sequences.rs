//! Random sequences of every public call on random models: a short run of `examples/soak.rs`.
//!
//! Catches a call that leaves an invalid state and a refused call that leaves a trace. Catches a
//! step whose result depends on the calls before it, and one that differs from the specification.

use jcas_verification::machine::{KINDS, Tally, play};
use proptest::prelude::*;
use std::cell::RefCell;

/// Sequences in one run of the test.
const SEQUENCES: u32 = 120;

#[test]
fn random_sequences_keep_every_promise() {
    let tally = RefCell::new(Tally::default());
    let config = ProptestConfig {
        cases: SEQUENCES,
        failure_persistence: None,
        ..ProptestConfig::default()
    };
    proptest!(config, |(seed: u64, calls in prop::collection::vec(any::<u64>(), 0..100))| {
        match play(seed, &calls) {
            Ok(one) => tally.borrow_mut().add(&one),
            Err(why) => prop_assert!(false, "{}", why),
        }
    });
    let tally = tally.into_inner();
    println!("{tally:?}");
    assert!(
        tally.agent_steps > 2_000 && tally.compared > 1_000,
        "{tally:?}"
    );
    for kind in 0..KINDS {
        let reached = tally.accepted[kind] + tally.refused[kind];
        assert!(reached > 100, "calls of kind {kind}: {tally:?}");
    }
}
