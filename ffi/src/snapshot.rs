//! Save, load, fork, hash.

use std::ffi::c_void;
use std::ptr;

use jcas_core::{Error, hash};

use crate::handle::{Open, open, see};
use crate::memory::{bytes, output, place};
use crate::sim::jcas_sim;
use crate::status::guard;

/// Saves a simulation as bytes that mean the same on every platform.
///
/// `sim`, `snapshot`: not NULL. `size`: snapshot_size bytes. Threads: none changes `sim`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn jcas_sim_save(
    sim: *const jcas_sim,
    snapshot: *mut c_void,
    size: usize,
) -> i32 {
    guard(|| {
        // SAFETY: the caller's promise for `sim`.
        let sim = unsafe { see(sim.cast()) }?;
        // SAFETY: the caller's promise for `snapshot`.
        let out = unsafe { output::<u8>(snapshot.cast(), size, sim.model.save_len()) }?;
        Ok(sim.model.save(sim.words, out)?)
    })
}

/// Takes up a saved simulation of an equal configuration; it goes on exactly as the saved one would have.
/// JCAS_ERROR_CORRUPT or JCAS_ERROR_MODEL_MISMATCH for anything else, and nothing has changed then.
///
/// `sim`, `snapshot`: not NULL. `size`: in bytes, any. Threads: only this one uses `sim`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn jcas_sim_load(
    sim: *mut jcas_sim,
    snapshot: *const c_void,
    size: usize,
) -> i32 {
    guard(|| {
        // SAFETY: the caller's promise for `sim`.
        let sim = unsafe { open(sim.cast()) }?;
        // SAFETY: the caller's promise for `snapshot`.
        let saved = unsafe { bytes(snapshot.cast(), size) }?;
        let Open {
            model,
            words,
            spare,
            refusal,
            ..
        } = sim;
        let loaded = model.load(saved, words, spare);
        Ok(loaded.inspect_err(|error| *refusal = Some(*error))?)
    })
}

/// Makes `to` an independent twin of `from`, whose configuration must be equal.
///
/// `from`, `to`: not NULL; may be the same. Threads: none changes `from`, only this one uses `to`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn jcas_sim_fork(from: *const jcas_sim, to: *mut jcas_sim) -> i32 {
    guard(|| {
        // SAFETY: the caller's promise for `from`.
        let source = unsafe { see(from.cast()) }?;
        if ptr::eq(from, to) {
            return Ok(());
        }
        // SAFETY: the caller's promise for `to`, which is another simulation.
        let target = unsafe { open(to.cast()) }?;
        if source.model.config_hash() != target.model.config_hash() {
            return Err(Error::ModelMismatch.into());
        }
        target.words.copy_from_slice(source.words);
        Ok(())
    })
}

/// The fingerprint of a state: equal for equal states, on every platform (FNV-1a, 64 bits).
///
/// `sim`, `state_hash`: not NULL. Threads: none changes `sim`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn jcas_sim_hash(sim: *const jcas_sim, state_hash: *mut u64) -> i32 {
    guard(|| {
        // SAFETY: the caller's promise for `sim`.
        let sim = unsafe { see(sim.cast()) }?;
        // SAFETY: the caller's promise for `state_hash`.
        let out = unsafe { place(state_hash) }?;
        out.put(hash::words(sim.words));
        Ok(())
    })
}
