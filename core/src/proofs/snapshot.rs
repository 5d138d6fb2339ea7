//! P11: loading judges any bytes, and accepts exactly the snapshots of valid states.
//!
//! Under Kani a stub makes the checksum a constant. The claims hold for any checksum, because a
//! checksum can only refuse more.

use super::inputs::between;
#[cfg(not(kani))]
use super::standin as kani;
use super::state::{STATE_WORDS, any_fleet, any_state, differ, view};
use crate::error::{Corruption, Error};
use crate::model::Model;
use crate::snapshot::put;
use crate::state::header::Phase;
use crate::words::hash::Fnv1a;

/// Bytes around a state: magic, version, fingerprint, checksum.
const FRAME_WORDS: usize = 4;
const SNAPSHOT_BYTES: usize = 8 * (STATE_WORDS + FRAME_WORDS);

/// Any bytes at all.
#[cfg(kani)]
fn any_bytes(_: &Model<'_>) -> [u8; SNAPSHOT_BYTES] {
    kani::any()
}

/// A snapshot with a byte changed, and in every other case the checksum made to match.
#[cfg(not(kani))]
fn any_bytes(model: &Model<'_>) -> [u8; SNAPSHOT_BYTES] {
    let words = any_state(model, Phase::Ready);
    let mut bytes = [0; SNAPSHOT_BYTES];
    let len = model.save_len();
    model
        .save(&words[..model.state_words()], &mut bytes[..len])
        .unwrap();
    if kani::any() {
        bytes[between(0, len as u64 - 1) as usize] ^= 1 << between(0, 7);
        if kani::any() {
            let mut hash = crate::words::hash::Fnv1a::new();
            hash.write(&bytes[..len - 8]);
            bytes[len - 8..len].copy_from_slice(&hash.finish().to_le_bytes());
        }
    }
    bytes
}

/// Some byte differs. Kani looks at any one of them, the stand-in at all.
fn bytes_differ(a: &[u8], b: &[u8]) -> bool {
    if cfg!(kani) {
        let index = between(0, a.len() as u64 - 1) as usize;
        return a[index] != b[index];
    }
    a != b
}

/// Any words at all.
#[cfg(kani)]
fn any_words(_: &Model<'_>) -> [u64; STATE_WORDS] {
    kani::any()
}

/// A state, in every other case with a bit of it changed.
#[cfg(not(kani))]
fn any_words(model: &Model<'_>) -> [u64; STATE_WORDS] {
    let mut words = any_state(model, Phase::Ready);
    if kani::any() {
        words[between(0, model.state_words() as u64 - 1) as usize] ^= 1 << between(0, 63);
    }
    words
}

/// Words from anywhere are judged without a fault of arithmetic, an index out of bounds or a panic.
#[cfg_attr(kani, kani::proof)]
#[cfg_attr(kani, kani::unwind(13))]
pub fn any_words_can_be_judged() {
    given!(model);
    let words = any_words(&model);
    let state = view(&model, &words);
    let valid = state.is_valid(&model);
    kani::cover!(valid, "a valid state");
    kani::cover!(!valid, "none");
    assert!(!valid || state.header.phase().is_some() && state.t() <= model.config().horizon_steps);
}

/// From any state of a checksum, writing a word and writing its bytes lead to the same state. So
/// saving and loading compute the same checksum for any length.
#[cfg_attr(kani, kani::proof)]
#[cfg_attr(kani, kani::unwind(10))]
#[cfg_attr(
    kani,
    kani::stub(crate::words::hash::Fnv1a::write, crate::proofs::stubs::keep_bytes)
)]
pub fn both_writers_of_the_checksum_agree() {
    let word: u64 = kani::any();
    let mut by_word = Fnv1a::resumed(kani::any());
    let mut by_bytes = by_word;
    by_word.write_u64(word);
    let mut bytes = [0; 8];
    put(&mut bytes, 0, word);
    by_bytes.write(&bytes);
    kani::cover!(word == 0, "nothing but zeros");
    assert!(by_word.finish() == by_bytes.finish());
}

#[cfg_attr(kani, kani::proof)]
#[cfg_attr(kani, kani::unwind(64))]
#[cfg_attr(kani, kani::solver(cadical))]
#[cfg_attr(
    kani,
    kani::stub(crate::words::hash::Fnv1a::write, crate::proofs::stubs::skip_bytes)
)]
#[cfg_attr(
    kani,
    kani::stub(crate::words::hash::Fnv1a::write_u64, crate::proofs::stubs::skip_word)
)]
pub fn loading_accepts_only_snapshots_of_valid_states() {
    given!(model);
    let (words, len) = (model.state_words(), model.save_len());
    let bytes = any_bytes(&model);
    let before: [u64; STATE_WORDS] = kani::any();
    let (mut after, mut spare) = (before, [0; STATE_WORDS]);
    let loaded = model.load(&bytes[..len], &mut after[..words], &mut spare[..words]);
    kani::cover!(loaded.is_ok(), "accepted");
    kani::cover!(loaded.is_err(), "refused");
    if loaded.is_ok() {
        let mut again = [0; SNAPSHOT_BYTES];
        assert!(view(&model, &after).is_valid(&model));
        assert!(model.save(&after[..words], &mut again[..len]).is_ok());
        assert!(!bytes_differ(&bytes[..len], &again[..len]));
    } else {
        assert!(!differ(&before, &after));
    }
}

#[cfg_attr(kani, kani::proof)]
#[cfg_attr(kani, kani::unwind(64))]
#[cfg_attr(kani, kani::solver(cadical))]
#[cfg_attr(
    kani,
    kani::stub(crate::words::hash::Fnv1a::write, crate::proofs::stubs::skip_bytes)
)]
#[cfg_attr(
    kani,
    kani::stub(crate::words::hash::Fnv1a::write_u64, crate::proofs::stubs::skip_word)
)]
pub fn loading_what_was_saved_is_the_identity() {
    given!(model);
    let (words, len) = (model.state_words(), model.save_len());
    let phase = if kani::any() {
        Phase::Ready
    } else {
        Phase::Sensed
    };
    let state = any_state(&model, phase);
    let mut bytes = [0; SNAPSHOT_BYTES];
    assert!(model.save(&state[..words], &mut bytes[..len]).is_ok());
    let (mut loaded, mut spare) = ([0; STATE_WORDS], [0; STATE_WORDS]);
    let done = model.load(&bytes[..len], &mut loaded[..words], &mut spare[..words]);
    kani::cover!(view(&model, &state).t() > 0, "after the reset");
    assert!(done.is_ok());
    assert!(!differ(&state, &loaded));
}

/// A frame around part of a state or none.
const SHORT_BYTES: usize = 8 * (FRAME_WORDS + 1);

/// Any bytes at all.
#[cfg(kani)]
fn any_short_bytes(_: &Model<'_>, _: usize) -> [u8; SHORT_BYTES] {
    kani::any()
}

/// Bytes of the given length that begin and end as a snapshot does.
#[cfg(not(kani))]
fn any_short_bytes(model: &Model<'_>, len: usize) -> [u8; SHORT_BYTES] {
    let mut bytes: [u8; SHORT_BYTES] = kani::any();
    bytes[..24].copy_from_slice(&any_bytes(model)[..24]);
    if len >= 8 {
        let mut hash = crate::words::hash::Fnv1a::new();
        hash.write(&bytes[..len - 8]);
        bytes[len - 8..len].copy_from_slice(&hash.finish().to_le_bytes());
    }
    bytes
}

#[cfg_attr(kani, kani::proof)]
#[cfg_attr(kani, kani::unwind(10))]
#[cfg_attr(
    kani,
    kani::stub(crate::words::hash::Fnv1a::write, crate::proofs::stubs::skip_bytes)
)]
pub fn bytes_of_another_length_are_refused() {
    given!(model);
    let words = model.state_words();
    let len = between(0, SHORT_BYTES as u64) as usize;
    let bytes = any_short_bytes(&model, len);
    let before = any_fleet(&model, Phase::Ready);
    let (mut after, mut spare) = (before, [0; STATE_WORDS]);
    let loaded = model.load(&bytes[..len], &mut after[..words], &mut spare[..words]);
    kani::cover!(len == 0, "nothing");
    kani::cover!(len == SHORT_BYTES, "a frame around one word");
    assert!(loaded.is_err());
    assert!(!matches!(
        loaded,
        Err(Error::Corrupt(Corruption::Checksum | Corruption::Content))
    ));
    assert!(!differ(&before, &after));
}

#[cfg(not(kani))]
super::standin::twins! {
    any_words_can_be_judged: 2000 cases, 2 covers;
    both_writers_of_the_checksum_agree: 1000 cases, 1 covers;
    loading_accepts_only_snapshots_of_valid_states: 1000 cases, 2 covers;
    loading_what_was_saved_is_the_identity: 500 cases, 1 covers;
    bytes_of_another_length_are_refused: 1000 cases, 2 covers;
}
