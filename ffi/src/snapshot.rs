//! Save, load, fork, hash.

use std::ffi::c_void;
use std::ptr;

use jcas_core::{Error, hash};

use crate::memory::{bytes, output, place};
use crate::sim::jcas_sim;
use crate::sim_block::{SimMut, change, see};
use crate::status::{Fault, JCAS_OK, guard, jcas_status};

/// Saves a simulation as bytes that are portable across platforms.
///
/// `sim`, `snapshot`: not NULL. `size`: snapshot_size bytes.
/// Threads: none changes `sim`.
/// Statuses: NULL, ALIGNMENT, LENGTH, HANDLE.
#[must_use]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn jcas_sim_save(
    sim: *const jcas_sim,
    snapshot: *mut c_void,
    size: usize,
) -> jcas_status {
    guard(|| {
        // SAFETY: the caller's promise for `sim`.
        let sim = unsafe { see(sim.cast()) }?;
        // SAFETY: the caller's promise for `snapshot`.
        let out = unsafe { output::<u8>(snapshot.cast(), size, sim.model.save_len()) }?;
        Ok(sim.model.save(sim.words, out)?)
    })
}

/// Loads a saved simulation of an equal configuration, which continues exactly as the saved one
/// would have. Anything else is JCAS_ERROR_CORRUPT or JCAS_ERROR_MODEL_MISMATCH and changes
/// nothing.
///
/// `sim`, `snapshot`: not NULL. `size`: in bytes, any.
/// Threads: only this one uses `sim`.
/// Statuses: NULL, ALIGNMENT, LENGTH, HANDLE, MODEL_MISMATCH, CORRUPT.
#[must_use]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn jcas_sim_load(
    sim: *mut jcas_sim,
    snapshot: *const c_void,
    size: usize,
) -> jcas_status {
    let act = |sim: &mut SimMut<'_>| {
        // SAFETY: the caller's promise for `snapshot`.
        let saved = unsafe { bytes(snapshot.cast(), size) }?;
        sim.load(saved)
    };
    // SAFETY: the caller's promise for `sim`.
    unsafe { change(sim.cast(), act) }
}

/// Copies the state of `from` to `to`, whose configuration must be equal. The two are then
/// independent.
///
/// `from`, `to`: not NULL; may be the same.
/// Threads: none changes `from`, only this one uses `to`.
/// Statuses: NULL, ALIGNMENT, HANDLE, MODEL_MISMATCH.
#[must_use]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn jcas_sim_fork(from: *const jcas_sim, to: *mut jcas_sim) -> jcas_status {
    guard(|| {
        // SAFETY: the caller's promise for `from`.
        let source = unsafe { see(from.cast()) }?;
        if ptr::eq(from, to) {
            return Ok(());
        }
        let copy = |target: &mut SimMut<'_>| {
            if source.model.config_hash() != target.model.config_hash() {
                return Err(Error::ModelMismatch.into());
            }
            target.replace(source.words);
            Ok(())
        };
        // SAFETY: the caller's promise for `to`, which is another simulation.
        match unsafe { change(to.cast(), copy) } {
            JCAS_OK => Ok(()),
            status => Err(Fault::Status(status)),
        }
    })
}

/// Writes the fingerprint of a state, which is equal for equal states on every platform (FNV-1a, 64
/// bits).
///
/// `sim`, `state_hash`: not NULL.
/// Threads: none changes `sim`.
/// Statuses: NULL, ALIGNMENT, HANDLE.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn jcas_sim_hash(sim: *const jcas_sim, state_hash: *mut u64) -> jcas_status {
    guard(|| {
        // SAFETY: the caller's promise for `sim`.
        let sim = unsafe { see(sim.cast()) }?;
        // SAFETY: the caller's promise for `state_hash`.
        let out = unsafe { place(state_hash) }?;
        out.put(hash::words(sim.words));
        Ok(())
    })
}
