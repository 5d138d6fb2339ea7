//! Forks: one state, with what a policy remembers of it, in every environment of a batch.

use ::jcas_policy::memory::LastStep;

use crate::batch::jcas_batch;
use crate::batch_block::Batch;
use crate::batch_step::change;
use crate::memory::Buffer;
use crate::policy::jcas_policy;
use crate::policy_block::PolicyBlock;
use crate::scripted::{Place, Whom};
use crate::sim::jcas_sim;
use crate::sim_block::see;
use crate::status::{Fault, JCAS_ERROR_MODEL_MISMATCH, jcas_status};

/// Copies the state of a simulation of an equal configuration into every environment of a batch,
/// where jcas_batch_rollout can continue it.
///
/// `batch`, `sim`: not NULL. `seeds`: M, or NULL with a count of 0. NULL keeps the seed, so that
/// equal actions give equal futures. Otherwise all later draws of environment m follow from
/// `seeds[m]`; what was drawn before stays, such as the hotspots. jcas_derive_seed gives seeds.
/// `policy`: NULL, or a policy of the same configuration; what it remembers of `sim` is copied for
/// every environment. JCAS_ERROR_MEMORY means that it remembers another state than the one of `sim`
/// or the one before it. After JCAS_ERROR_RESOURCES the states are copied, but not all memory is:
/// call jcas_policy_forget.
/// Threads: only this one uses `batch` and `policy`, none changes `sim`.
/// Statuses: NULL, ALIGNMENT, LENGTH, HANDLE, MODEL_MISMATCH, MEMORY, RESOURCES.
#[must_use]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn jcas_batch_fork(
    batch: *mut jcas_batch,
    sim: *const jcas_sim,
    policy: *mut jcas_policy,
    seeds: *const u64,
    seed_count: usize,
) -> jcas_status {
    let act = |batch: &mut Batch| {
        // SAFETY: the caller's promise for `sim`.
        let sim = unsafe { see(sim.cast()) }?;
        let (model, count) = (batch.model(), batch.sizes().count);
        if model.config_hash() != sim.model.config_hash() {
            return Err(Fault::Status(JCAS_ERROR_MODEL_MISMATCH));
        }
        let seeds = Buffer::optional("seeds", seeds, seed_count, count)?;
        // SAFETY: the caller's promise for `seeds`.
        let seeds = unsafe { seeds.read() };
        let place = Place::of(sim.timeline, &model.state(sim.words)?);
        if policy.is_null() {
            return batch.fork(sim.words, seeds);
        }
        // SAFETY: the caller's promise for `policy`.
        let _mark = unsafe { PolicyBlock::hold(policy.cast()) }?;
        // SAFETY: this call holds the policy.
        let Some(scripted) = (unsafe { PolicyBlock::scripted(policy.cast(), model) })? else {
            return batch.fork(sim.words, seeds);
        };
        let mut memory = scripted.remembered(Whom::Sim, place)?;
        batch.fork(sim.words, seeds)?;
        for index in 0..count {
            let state = model.state(batch.state(index)?)?;
            LastStep::reseed(&mut memory, state.seed());
            let place = Place::of(batch.timeline(index), &state);
            scripted.load(Whom::Environment(index), place, model, &memory)?;
        }
        Ok(())
    };
    // SAFETY: the caller's promise for `batch`.
    unsafe { change(batch, act) }
}
