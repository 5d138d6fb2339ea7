//! What policies remember, saved and loaded.

use std::ffi::c_void;

use ::jcas_policy::MemoryError;
use jcas_core::hash::{Fnv1a, words as hash_of};
use jcas_core::{Model, StateRef};

use crate::batch::jcas_batch;
use crate::batch_block::{Batch, BatchBlock};
use crate::memory::{bytes, place};
use crate::policy::jcas_policy;
use crate::policy_block::PolicyBlock;
use crate::scripted::{Place, Whom};
use crate::sim::jcas_sim;
use crate::sim_block::{SimRef, see};
use crate::status::{
    Fault, JCAS_ERROR_CORRUPT, JCAS_ERROR_LENGTH, JCAS_ERROR_MEMORY, JCAS_ERROR_MODEL_MISMATCH,
    JCAS_ERROR_NULL, JCAS_ERROR_RESOURCES, guard, jcas_status,
};
use crate::timeline::Timeline;

/// The first word of a saved memory: JCASMEM1 in ASCII.
const MAGIC: u64 = u64::from_le_bytes(*b"JCASMEM1");
/// Words before what the policy remembers: the magic, the configuration's hash, the policy's
/// fingerprint and the state's hash.
const HEADER: usize = 4;
/// Bytes of a word.
const WORD: usize = 8;

/// A state that a policy acts in, and where it stands.
struct Given<'a> {
    whom: Whom,
    timeline: Timeline,
    model: &'a Model<'static>,
    words: &'a [u64],
}

impl<'a> Given<'a> {
    fn sim(sim: &SimRef<'a>) -> Self {
        Self {
            whom: Whom::Sim,
            timeline: sim.timeline,
            model: sim.model,
            words: sim.words,
        }
    }

    fn environment(batch: &'a Batch, index: u32) -> Result<Self, Fault> {
        let index = index as usize;
        let words = batch.state(index)?;
        Ok(Self {
            whom: Whom::Environment(index),
            timeline: batch.timeline(index),
            model: batch.model(),
            words,
        })
    }

    fn place(&self) -> Result<Place, Fault> {
        let state: StateRef<'_> = self.model.state(self.words)?;
        Ok(Place::of(self.timeline, &state))
    }

    fn header(&self, fingerprint: u64) -> [u64; HEADER] {
        let (config, state) = (self.model.config_hash(), hash_of(self.words));
        [MAGIC, config, fingerprint, state]
    }
}

/// Writes the words of a memory to the caller's buffer, or only their length.
///
/// # Safety
/// `policy` is a handle, `capacity` bytes can be written at `memory` if it is not null, and
/// `length` can be written.
unsafe fn save(
    policy: *mut jcas_policy,
    given: &Given<'_>,
    memory: *mut c_void,
    capacity: usize,
    length: *mut usize,
) -> Result<(), Fault> {
    // SAFETY: the caller's promise for `length`.
    let length = unsafe { place(length) }?;
    if memory.is_null() && capacity != 0 {
        return Err(Fault::Status(JCAS_ERROR_NULL));
    }
    // SAFETY: the caller's promise for `policy`.
    let _mark = unsafe { PolicyBlock::hold(policy.cast()) }?;
    // SAFETY: this call holds the policy.
    let scripted = unsafe { PolicyBlock::scripted(policy.cast(), given.model) }?;
    let now = given.place()?;
    let all = |write: &mut dyn FnMut(u64)| {
        let fingerprint = scripted
            .as_deref()
            .map_or(0, |scripted| scripted.fingerprint());
        given.header(fingerprint).into_iter().for_each(&mut *write);
        match scripted.as_deref() {
            Some(scripted) => scripted.save(given.whom, now, write),
            None => Ok(()),
        }
    };
    let mut count = 0;
    all(&mut |_| count += 1)?;
    let needed = (count + 1) * WORD;
    length.put(needed);
    if memory.is_null() {
        return Ok(());
    }
    if capacity < needed {
        return Err(Fault::Status(JCAS_ERROR_LENGTH));
    }
    let mut at = memory.cast::<u8>();
    let mut hash = Fnv1a::new();
    let mut put = |bytes: [u8; WORD]| {
        // SAFETY: as many words are written as were counted, and they fit.
        unsafe { at.copy_from_nonoverlapping(bytes.as_ptr(), WORD) };
        at = at.wrapping_add(WORD);
    };
    all(&mut |word| {
        hash.write(&word.to_le_bytes());
        put(word.to_le_bytes());
    })?;
    put(hash.finish().to_le_bytes());
    Ok(())
}

/// Reads the words of a memory, without their checksum.
fn read(memory: &[u8]) -> Result<Vec<u64>, Fault> {
    let corrupt = Fault::Status(JCAS_ERROR_CORRUPT);
    let count = memory.len() / WORD;
    if !memory.len().is_multiple_of(WORD) || count <= HEADER {
        return Err(corrupt);
    }
    let (content, checksum) = memory.split_at(memory.len() - WORD);
    let mut hash = Fnv1a::new();
    hash.write(content);
    if checksum != hash.finish().to_le_bytes() {
        return Err(corrupt);
    }
    let mut words = Vec::new();
    words
        .try_reserve_exact(count - 1)
        .map_err(|_| Fault::Status(JCAS_ERROR_RESOURCES))?;
    let read = content.chunks_exact(WORD).map(|word| {
        let mut bytes = [0; WORD];
        bytes.copy_from_slice(word);
        u64::from_le_bytes(bytes)
    });
    words.extend(read);
    Ok(words)
}

/// Loads a memory for a state that it was saved for.
///
/// # Safety
/// As for [`save`]; `size` bytes can be read at `memory`.
unsafe fn load(
    policy: *mut jcas_policy,
    given: &Given<'_>,
    memory: *const c_void,
    size: usize,
) -> Result<(), Fault> {
    // SAFETY: the caller's promise for `memory`.
    let words = read(unsafe { bytes(memory.cast(), size) }?)?;
    // SAFETY: the caller's promise for `policy`.
    let _mark = unsafe { PolicyBlock::hold(policy.cast()) }?;
    // SAFETY: this call holds the policy.
    let scripted = unsafe { PolicyBlock::scripted(policy.cast(), given.model) }?;
    let fingerprint = scripted
        .as_deref()
        .map_or(0, |scripted| scripted.fingerprint());
    let (header, content) = words.split_at(HEADER);
    let expected = given.header(fingerprint);
    if header[0] != MAGIC {
        return Err(Fault::Status(JCAS_ERROR_CORRUPT));
    }
    if header[1] != expected[1] {
        return Err(Fault::Status(JCAS_ERROR_MODEL_MISMATCH));
    }
    if header[2..] != expected[2..] {
        return Err(Fault::Status(JCAS_ERROR_MEMORY));
    }
    match scripted {
        Some(scripted) => scripted.load(given.whom, given.place()?, given.model, content),
        None if content.is_empty() => Ok(()),
        None => Err(MemoryError::Corrupt.into()),
    }
}

/// Saves what a policy remembers of the simulation that it acts for, as bytes that are portable
/// across platforms. With the simulation's own snapshot they give the same future.
///
/// `policy`, `sim`, `length`: not NULL. `length` receives the number of bytes. `memory`: `capacity`
/// bytes, or NULL with a capacity of 0 to ask for the length. A capacity below the length is
/// JCAS_ERROR_LENGTH. JCAS_ERROR_MEMORY means that the policy remembers another state than the one
/// of `sim` or the one before it.
/// Threads: only this one uses `policy`, none changes `sim`.
/// Statuses: NULL, ALIGNMENT, LENGTH, HANDLE, MODEL_MISMATCH, MEMORY.
#[must_use]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn jcas_policy_memory_save(
    policy: *mut jcas_policy,
    sim: *const jcas_sim,
    memory: *mut c_void,
    capacity: usize,
    length: *mut usize,
) -> jcas_status {
    guard(|| {
        // SAFETY: the caller's promise for `sim`.
        let sim = unsafe { see(sim.cast()) }?;
        // SAFETY: the caller's promises, passed on.
        unsafe { save(policy, &Given::sim(&sim), memory, capacity, length) }
    })
}

/// Loads what a policy remembered when it acted for a simulation, into this or an equal policy. The
/// policy then goes on for `sim` as it did for the simulation that was saved.
///
/// `policy`, `sim`: not NULL. `memory`: `size` bytes of jcas_policy_memory_save. JCAS_ERROR_MEMORY
/// means that they belong to another policy, or to another state than the one of `sim`. An error
/// changes nothing.
/// Threads: only this one uses `policy`, none changes `sim`.
/// Statuses: NULL, ALIGNMENT, LENGTH, HANDLE, MODEL_MISMATCH, CORRUPT, MEMORY, RESOURCES.
#[must_use]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn jcas_policy_memory_load(
    policy: *mut jcas_policy,
    sim: *const jcas_sim,
    memory: *const c_void,
    size: usize,
) -> jcas_status {
    guard(|| {
        // SAFETY: the caller's promise for `sim`.
        let sim = unsafe { see(sim.cast()) }?;
        // SAFETY: the caller's promises, passed on.
        unsafe { load(policy, &Given::sim(&sim), memory, size) }
    })
}

/// Saves what a policy remembers of an environment of a batch, as jcas_policy_memory_save does of a
/// simulation. The bytes can be loaded for a simulation with the same state, and the other way
/// round.
///
/// `policy`, `batch`, `memory`, `length`: as for jcas_policy_memory_save. `index`: below M, or
/// JCAS_ERROR_ARGUMENT.
/// Threads: only this one uses `policy`, none changes `batch`.
/// Statuses: NULL, ALIGNMENT, LENGTH, HANDLE, ARGUMENT, MODEL_MISMATCH, MEMORY.
#[must_use]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn jcas_policy_memory_save_member(
    policy: *mut jcas_policy,
    batch: *const jcas_batch,
    index: u32,
    memory: *mut c_void,
    capacity: usize,
    length: *mut usize,
) -> jcas_status {
    guard(|| {
        // SAFETY: the caller's promise for `batch`.
        let (batch, _mark) = unsafe { BatchBlock::see(batch.cast()) }?;
        let given = Given::environment(batch, index)?;
        // SAFETY: the caller's promises, passed on.
        unsafe { save(policy, &given, memory, capacity, length) }
    })
}

/// Loads what a policy remembered, for an environment of a batch, as jcas_policy_memory_load does
/// for a simulation.
///
/// `policy`, `batch`, `memory`: as for jcas_policy_memory_load. `index`: below M, or
/// JCAS_ERROR_ARGUMENT.
/// Threads: only this one uses `policy`, none changes `batch`.
/// Statuses: NULL, ALIGNMENT, LENGTH, HANDLE, ARGUMENT, MODEL_MISMATCH, CORRUPT, MEMORY, RESOURCES.
#[must_use]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn jcas_policy_memory_load_member(
    policy: *mut jcas_policy,
    batch: *const jcas_batch,
    index: u32,
    memory: *const c_void,
    size: usize,
) -> jcas_status {
    guard(|| {
        // SAFETY: the caller's promise for `batch`.
        let (batch, _mark) = unsafe { BatchBlock::see(batch.cast()) }?;
        let given = Given::environment(batch, index)?;
        // SAFETY: the caller's promises, passed on.
        unsafe { load(policy, &given, memory, size) }
    })
}

/// Makes a policy forget what it remembers of all simulations and environments. It begins anew in
/// the next state that it acts in, whichever that is.
///
/// `policy`: not NULL.
/// Threads: only this one uses `policy`.
/// Statuses: NULL, ALIGNMENT, HANDLE.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn jcas_policy_forget(policy: *mut jcas_policy) -> jcas_status {
    guard(|| {
        // SAFETY: the caller's promise for `policy`.
        let _mark = unsafe { PolicyBlock::hold(policy.cast()) }?;
        // SAFETY: this call holds the policy.
        unsafe { PolicyBlock::forget(policy.cast()) };
        Ok(())
    })
}
