//! Simulations: lifecycle, whole steps, observations.

use std::alloc::Layout;
use std::ffi::{c_char, c_void};

use jcas_core::Scratch;
use jcas_core::observation;

use crate::handle::Memory;
use crate::memory::{Words, input, output, place, put_layout, record, text_out};
use crate::model::jcas_model;
use crate::model_block::model;
use crate::records::jcas_outcome;
use crate::sim_block::{SimBlock, SimMut, change, see};
use crate::status::{Fault, JCAS_OK, guard, jcas_status};

/// One state of a model, with its working memory. One thread at a time may use it, except that
/// functions that take it as const may run concurrently.
pub struct jcas_sim(());

/// Motion up, +y, as the first component of an action with JCAS_MOTIONS_UDLRS, like the four below.
/// With JCAS_MOTIONS_SYMMETRIC these values mean up, left, stay, right, down in ascending order.
pub const JCAS_MOVE_UP: f32 = -0.8;
/// Motion down, -y.
pub const JCAS_MOVE_DOWN: f32 = -0.4;
/// Motion left, -x.
pub const JCAS_MOVE_LEFT: f32 = 0.0;
/// Motion right, +x.
pub const JCAS_MOVE_RIGHT: f32 = 0.4;
/// No motion.
pub const JCAS_MOVE_STAY: f32 = 0.8;

/// Writes the size and alignment of the memory that jcas_sim_init needs.
///
/// `model`, `size`, `alignment`: not NULL. `size` in bytes.
/// Threads: any.
/// Statuses: NULL, ALIGNMENT, HANDLE, RESOURCES.
#[must_use]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn jcas_sim_layout(
    model: *const jcas_model,
    size: *mut usize,
    alignment: *mut usize,
) -> jcas_status {
    guard(|| {
        // SAFETY: the caller's promise for `model`.
        let model = unsafe { self::model(model.cast()) }?;
        let layout = || SimBlock::layout(model.get());
        // SAFETY: the caller's promises for `size` and `alignment`.
        unsafe { put_layout(size, alignment, layout) }
    })
}

/// Builds a simulation in the caller's memory, which must not move until jcas_sim_free. It is at t
/// = 0 of seed 0.
///
/// `memory`: at least the size and alignment of jcas_sim_layout; not NULL; the caller's. `model`:
/// not NULL; must not be freed before the simulation. `sim`: not NULL; receives the handle.
/// Threads: any.
/// Statuses: NULL, ALIGNMENT, LENGTH, HANDLE, IN_USE, RESOURCES.
#[must_use]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn jcas_sim_init(
    memory: *mut c_void,
    size: usize,
    model: *const jcas_model,
    sim: *mut *mut jcas_sim,
) -> jcas_status {
    // SAFETY: the caller's promises for `model`, `sim` and `memory`.
    unsafe {
        build(model, sim, |layout| {
            Memory::lent(memory.cast(), size, layout)
        })
    }
}

/// Builds a simulation in memory from the system, at t = 0 of seed 0. jcas_sim_free ends it.
///
/// `model`: not NULL; must not be freed before the simulation. `sim`: not NULL; receives the
/// handle.
/// Threads: any.
/// Statuses: NULL, ALIGNMENT, HANDLE, RESOURCES.
#[must_use]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn jcas_sim_new(
    model: *const jcas_model,
    sim: *mut *mut jcas_sim,
) -> jcas_status {
    // SAFETY: the caller's promises for `model` and `sim`.
    unsafe { build(model, sim, Memory::allocate) }
}

/// Builds a simulation in the memory that `memory` gives for its layout.
///
/// # Safety
/// `model` and `sim` are as for [`jcas_sim_init`]. The memory stays valid until the simulation is
/// freed.
unsafe fn build(
    model: *const jcas_model,
    sim: *mut *mut jcas_sim,
    memory: impl FnOnce(Layout) -> Result<(*mut u8, Memory), Fault>,
) -> jcas_status {
    guard(|| {
        // SAFETY: the caller's promise for `model`.
        let model = unsafe { self::model(model.cast()) }?;
        // SAFETY: the caller's promise for `sim`.
        let out = unsafe { place(sim) }?;
        let memory = memory(SimBlock::layout(model.get())?)?;
        // SAFETY: the memory has this layout and lives as long as the simulation.
        let block = unsafe { SimBlock::build(model, memory) }?;
        out.put(block.cast());
        Ok(())
    })
}

/// Ends a simulation. Memory of jcas_sim_init belongs to the caller again. NULL is allowed and does
/// nothing.
///
/// Threads: none may be using the simulation.
/// Statuses: NULL, ALIGNMENT, HANDLE.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn jcas_sim_free(sim: *mut jcas_sim) -> jcas_status {
    if sim.is_null() {
        return JCAS_OK;
    }
    // SAFETY: the caller's promise for `sim`.
    guard(|| unsafe { SimBlock::free(sim.cast()) })
}

/// Begins the episode of a seed, which determines every random draw of the episode.
///
/// `sim`: not NULL.
/// Threads: only this one uses `sim`.
/// Statuses: NULL, ALIGNMENT, HANDLE.
#[must_use]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn jcas_sim_reset(sim: *mut jcas_sim, seed: u64) -> jcas_status {
    // SAFETY: the caller's promise for `sim`.
    unsafe { change(sim.cast(), |sim| sim.reset(seed)) }
}

/// Derives the seed with the given index from a seed. Episode k of a campaign of the command line
/// has the seed jcas_derive_seed(seed, k). An automatic reset uses index 0.
///
/// Threads: any.
#[unsafe(no_mangle)]
pub extern "C" fn jcas_derive_seed(seed: u64, index: u64) -> u64 {
    jcas_core::rng::derive_seed(seed, index)
}

/// Performs one whole step.
///
/// `actions`: a pair per UAV, action_len floats; not NULL. The first of a pair chooses the motion
/// by five equal bins of -1 to 1, in the order of motion_map. The second chooses the pilot density,
/// from its minimum at -1 to its maximum at 1. Both are clipped; NaN is refused. `outcome`: not
/// NULL, struct_size set.
/// Threads: only this one uses `sim`.
/// Statuses: NULL, ALIGNMENT, LENGTH, STRUCT_SIZE, HANDLE, NAN, OUT_OF_ORDER, EPISODE_OVER.
#[must_use]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn jcas_sim_step(
    sim: *mut jcas_sim,
    actions: *const f32,
    action_count: usize,
    outcome: *mut jcas_outcome,
) -> jcas_status {
    let act = |sim: &mut SimMut<'_>| {
        // SAFETY: the caller's promise for `actions`.
        let actions = unsafe { input(actions, action_count, sim.model.action_len()) }?;
        // SAFETY: the caller's promise for `outcome`.
        let out = unsafe { record(outcome) }?;
        out.put(jcas_outcome::of(sim.act(|model, state, scratch| {
            model.step(state, scratch, actions)
        })?));
        sim.tell_actions(actions);
        sim.tell_step()
    };
    // SAFETY: the caller's promise for `sim`.
    unsafe { change(sim.cast(), act) }
}

/// Writes the observation of each UAV: uav_count rows of observation_len floats.
///
/// Each row begins with the UAV itself: x/(W-1), y/(H-1), state of charge, pilot density scaled to
/// 0 to 1, mean throughput. For each hotspot follow dx/(W-1), dy/(H-1), confirmed, known. For each
/// neighbour slot, nearest first, follow present, dx/(W-1), dy/(H-1). Then follow neighbours/(N-1),
/// carbon intensity from 0 to 1, depot distance/(W+H-2), confirmed/n, informed/n, t/T_max. Fields
/// that the configuration adds come last: jcas_model_observation_fields lists all of them.
///
/// `sim`, `observations`: not NULL. `count`: uav_count * observation_len.
/// Threads: only this one uses `sim`.
/// Statuses: NULL, ALIGNMENT, LENGTH, HANDLE.
#[must_use]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn jcas_sim_observe(
    sim: *mut jcas_sim,
    observations: *mut f32,
    count: usize,
) -> jcas_status {
    let act = |sim: &mut SimMut<'_>| {
        let expected = sim.model.uav_count() * sim.model.observation_len();
        // SAFETY: the caller's promise for `observations`.
        let out = unsafe { output(observations, count, expected) }?;
        let state = sim.model.state(sim.words)?;
        let mut scratch = Scratch::new(sim.model, sim.scratch)?;
        Ok(observation::observe(sim.model, &state, &mut scratch, out)?)
    };
    // SAFETY: the caller's promise for `sim`.
    unsafe { change(sim.cast(), act) }
}

/// Writes the global state, for a centralised critic: global_len floats.
///
/// For each UAV: x/(W-1), y/(H-1), state of charge, pilot density, mean throughput, fraction of
/// hotspots known. For each hotspot: x/(W-1), y/(H-1), confirmed, fraction of UAVs that know it.
/// The last four are carbon intensity, confirmed/n, informed/n, t/T_max.
///
/// `sim`, `global`: not NULL.
/// Threads: none changes `sim`.
/// Statuses: NULL, ALIGNMENT, LENGTH, HANDLE.
#[must_use]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn jcas_sim_observe_global(
    sim: *const jcas_sim,
    global: *mut f32,
    count: usize,
) -> jcas_status {
    guard(|| {
        // SAFETY: the caller's promise for `sim`.
        let sim = unsafe { see(sim.cast()) }?;
        // SAFETY: the caller's promise for `global`.
        let out = unsafe { output(global, count, sim.model.global_len()) }?;
        Ok(observation::observe_global(
            sim.model,
            &sim.model.state(sim.words)?,
            out,
        )?)
    })
}

/// Writes why the last call that took this simulation without const was refused. The text names the
/// value and what is allowed; it is empty if that call succeeded.
///
/// `text`, `capacity`, `length`: as for jcas_config_to_json.
/// Threads: none changes `sim`.
/// Statuses: NULL, ALIGNMENT, LENGTH, HANDLE.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn jcas_sim_message(
    sim: *const jcas_sim,
    text: *mut c_char,
    capacity: usize,
    length: *mut usize,
) -> jcas_status {
    guard(|| {
        // SAFETY: the caller's promise for `sim`.
        let sim = unsafe { see(sim.cast()) }?;
        // SAFETY: the caller's promises for `text` and `length`.
        unsafe { text_out(&Words(*sim.refusal), text, capacity, length) }
    })
}
