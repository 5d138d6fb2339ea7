//! A stand-in for the crate `kani` where Kani is not installed.
//!
//! A harness asks for inputs (`any`), narrows them (`assume`), marks the cases it
//! must reach (`cover!`) and asserts. Kani answers for all inputs at once. The
//! stand-in answers for one random tape of words at a time. It runs under proptest,
//! which shrinks a failing tape. So every harness body compiles and runs in `cargo test`,
//! and a cover that no tape reaches fails the test, as it fails `cargo xtask prove`.

extern crate std;

use proptest::collection::vec;
use proptest::prelude::*;
use proptest::test_runner::{Config, TestCaseError, TestRunner};
use std::boxed::Box;
use std::cell::RefCell;
use std::collections::BTreeMap;
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::string::String;
use std::vec::Vec;

/// Words of a tape that proptest chooses, with edge values, and shrinks.
const TAPE_WORDS: usize = 16;

/// What a harness reads: the chosen words, then a random stream.
struct Tape {
    words: Vec<u64>,
    next: usize,
    stream: u64,
}

std::thread_local! {
    static TAPE: RefCell<Tape> =
        const { RefCell::new(Tape { words: Vec::new(), next: 0, stream: 0 }) };
    static COVERS: RefCell<BTreeMap<&'static str, bool>> = const { RefCell::new(BTreeMap::new()) };
}

/// Thrown by `assume(false)`: the tape is outside the harness's assumptions.
struct Rejected;

/// The next word of the tape.
fn next_word() -> u64 {
    TAPE.with_borrow_mut(|tape| {
        let word = tape.words.get(tape.next).copied();
        tape.next += 1;
        word.unwrap_or_else(|| split_mix(&mut tape.stream))
    })
}

/// The next number of SplitMix64 (G. L. Steele, D. Lea, C. H. Flood, OOPSLA 2014).
fn split_mix(state: &mut u64) -> u64 {
    *state = state.wrapping_add(0x9E37_79B9_7F4A_7C15);
    let mut word = *state;
    word = (word ^ (word >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    word = (word ^ (word >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    word ^ (word >> 31)
}

/// Returns the word itself in four cases of seven. The others are small numbers, single bits and
/// the largest number.
///
/// A `prop_oneof!` of these would seed a generator for each word, which takes longer than most
/// harnesses.
fn with_edges(word: u64) -> u64 {
    match split_mix(&mut word.clone()) % 7 {
        0 => word % 20,
        1 => 1 << (word % 64),
        2 => u64::MAX,
        _ => word,
    }
}

/// A type of which the tape can give any value.
pub trait Arbitrary {
    /// The value that the next words of the tape stand for.
    fn any() -> Self;
}

macro_rules! integers {
    ($($type:ty),+) => { $(
        impl Arbitrary for $type {
            fn any() -> Self {
                next_word() as $type
            }
        }
    )+ };
}
integers!(u8, u16, u32, u64, usize, i32, i64);

impl Arbitrary for bool {
    fn any() -> Self {
        next_word() % 2 == 1
    }
}

/// Three quarters of the reals are small and finite, the rest are any bits.
impl Arbitrary for f64 {
    fn any() -> Self {
        let word = next_word();
        match word % 8 {
            0 => f64::from_bits(next_word()),
            1 => [
                1.0,
                -1.0,
                f64::NAN,
                f64::INFINITY,
                f64::NEG_INFINITY,
                -0.0,
                f64::MIN_POSITIVE,
            ][(word / 8 % 7) as usize],
            _ => (word >> 11) as f64 / (1u64 << 51) as f64 - 2.0,
        }
    }
}

impl Arbitrary for f32 {
    fn any() -> Self {
        let word = next_word();
        match word % 8 {
            0 => f32::from_bits(next_word() as u32),
            1 => [
                1.0,
                -1.0,
                f32::NAN,
                f32::INFINITY,
                f32::NEG_INFINITY,
                -0.0,
                f32::MIN_POSITIVE,
            ][(word / 8 % 7) as usize],
            _ => (word >> 40) as f32 / (1u32 << 22) as f32 - 2.0,
        }
    }
}

impl<T: Arbitrary, const N: usize> Arbitrary for [T; N] {
    fn any() -> Self {
        core::array::from_fn(|_| T::any())
    }
}

/// Any value of the type.
pub fn any<T: Arbitrary>() -> T {
    T::any()
}

/// Ends the case without a verdict unless the condition holds.
pub fn assume(condition: bool) {
    if !condition {
        resume_unwind(Box::new(Rejected));
    }
}

/// Records whether a case that has to be reachable was reached.
pub fn record_cover(label: &'static str, reached: bool) {
    COVERS.with_borrow_mut(|covers| *covers.entry(label).or_insert(false) |= reached);
}

/// `kani::cover!(condition, "label")`.
macro_rules! cover {
    ($condition:expr, $label:literal) => {
        kani::record_cover($label, $condition)
    };
}
pub(crate) use cover;

/// A case that one input in thousands reaches is missed now and then: only what all these rounds
/// miss is out of reach.
const ROUNDS: usize = 50;

/// Runs a harness on many tapes; all its covers, `covers` in number, must be reached.
pub fn check(harness: fn(), cases: u32, covers: usize) {
    let config = Config {
        cases,
        max_global_rejects: 1 << 20,
        failure_persistence: None,
        ..Config::default()
    };
    let word = proptest::num::u64::ANY.prop_map(with_edges);
    let tapes = (vec(word, TAPE_WORDS), proptest::num::u64::ANY);
    COVERS.take();
    for _ in 0..ROUNDS {
        // A runner counts its cases over all of its runs.
        let outcome = TestRunner::new(config.clone()).run(&tapes, |(words, stream)| {
            let tape = Tape {
                words,
                next: 0,
                stream,
            };
            run_once(harness, tape)
        });
        if let Err(failure) = outcome {
            panic!("{failure}");
        }
        if COVERS.with_borrow(|covers| covers.iter().all(|(_, hit)| *hit)) {
            break;
        }
    }
    let reached = COVERS.take();
    let missed: Vec<_> = reached.iter().filter(|(_, hit)| !**hit).collect();
    assert!(
        missed.is_empty(),
        "never reached in {ROUNDS} times {cases} cases: {missed:?}"
    );
    assert_eq!(reached.len(), covers, "covers seen: {reached:?}");
}

fn run_once(harness: fn(), tape: Tape) -> Result<(), TestCaseError> {
    TAPE.set(tape);
    match catch_unwind(AssertUnwindSafe(harness)) {
        Ok(()) => Ok(()),
        Err(payload) if payload.is::<Rejected>() => {
            Err(TestCaseError::reject("outside the harness's assumptions"))
        }
        Err(payload) => Err(TestCaseError::fail(message(&*payload))),
    }
}

fn message(payload: &(dyn core::any::Any + Send)) -> String {
    if let Some(text) = payload.downcast_ref::<String>() {
        text.clone()
    } else if let Some(text) = payload.downcast_ref::<&str>() {
        String::from(*text)
    } else {
        String::from("panicked")
    }
}

/// One `#[test]` for each harness: `twins! { name: 256 cases, 2 covers; }`.
macro_rules! twins {
    ($($harness:ident: $cases:literal cases, $covers:literal covers;)+) => {
        #[cfg(test)]
        mod twins {
            $(
                #[test]
                fn $harness() {
                    crate::proofs::standin::check(super::$harness, $cases, $covers);
                }
            )+
        }
    };
}
pub(crate) use twins;
