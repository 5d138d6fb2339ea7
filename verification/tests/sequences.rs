//! Random sequences of every public call on random models: a short run of `examples/soak.rs`.
//!
//! Catches a call that leaves an invalid state and a refused call that leaves a trace. Catches a
//! step whose result depends on the calls before it, and one that differs from the specification.

use jcas_verification::machine::{Counts, KINDS, play};
use proptest::prelude::*;
use std::cell::RefCell;

/// Sequences in one run of the test.
const SEQUENCES: u32 = 120;

#[test]
fn random_sequences_keep_every_promise() {
    let counts = RefCell::new(Counts::default());
    let config = ProptestConfig {
        cases: SEQUENCES,
        failure_persistence: None,
        ..ProptestConfig::default()
    };
    proptest!(config, |(seed: u64, calls in prop::collection::vec(any::<u64>(), 0..100))| {
        match play(seed, &calls) {
            Ok(one) => counts.borrow_mut().add(&one),
            Err(why) => prop_assert!(false, "{}", why),
        }
    });
    let counts = counts.into_inner();
    println!("{counts:?}");
    assert!(
        counts.agent_steps > 2_000 && counts.compared > 1_000,
        "{counts:?}"
    );
    for kind in 0..KINDS {
        let reached = counts.accepted[kind] + counts.refused[kind];
        assert!(reached > 100, "calls of kind {kind}: {counts:?}");
    }
}
