//! Snapshots whose state was changed and whose checksum is right: the library refuses the bytes, or
//! flies on from them without a fault.

#![no_main]

use jcas_core::{Model, Sim};
use jcas_fuzz::{checksum, small_model};
use libfuzzer_sys::fuzz_target;
use std::sync::LazyLock;

static MODEL: LazyLock<Model<'static>> = LazyLock::new(small_model);
const STEPS: usize = 4;

fuzz_target!(|data: &[u8]| {
    let mut sim = Sim::new(&MODEL);
    sim.reset(1);
    let mut snapshot = sim.save();
    let content = snapshot.len() - 8;
    // The first three words name the format and the configuration, and stay.
    for (byte, change) in snapshot[24..content].iter_mut().zip(data) {
        *byte ^= change;
    }
    let repaired = checksum(&snapshot[..content]);
    snapshot[content..].copy_from_slice(&repaired.to_le_bytes());
    let before = sim.words().to_vec();
    if sim.load(&snapshot).is_err() {
        assert_eq!(sim.words(), before);
        return;
    }
    assert_eq!(sim.save(), snapshot);
    for _ in 0..STEPS {
        if sim
            .step(&[0.8, 1.0, -0.8, -1.0, 0.4, 0.0, -0.4, 0.5])
            .is_err()
        {
            break;
        }
        let saved = sim.save();
        sim.load(&saved).expect("a state that was reached is valid");
    }
});
