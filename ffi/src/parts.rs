//! Stepping by parts, and what a host simulator may own: positions, links, hotspots, batteries.

use std::mem::offset_of;
use std::slice;

use jcas_core::Cell;

use crate::config::jcas_cell;
use crate::handle::open;
use crate::memory::{input, record};
use crate::records::jcas_outcome;
use crate::sim::jcas_sim;
use crate::status::guard;

/// Part 1 of a step: actions, return to base, move. Next: jcas_sim_set_positions (optional), then
/// jcas_sim_step_sense.
///
/// `sim`, `actions`: as for jcas_sim_step.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn jcas_sim_step_begin(
    sim: *mut jcas_sim,
    actions: *const f32,
    action_count: usize,
) -> i32 {
    guard(|| {
        // SAFETY: the caller's promise for `sim`.
        let mut sim = unsafe { open(sim.cast()) }?;
        // SAFETY: the caller's promise for `actions`.
        let actions = unsafe { input(actions, action_count, sim.model.action_len()) }?;
        sim.act(|model, state, _| model.step_begin(state, actions))
    })
}

/// Puts the UAVs where the host has moved them, in place of the kernel's own motion. A UAV whose cell
/// differs from the one before the step has moved, however far.
///
/// `sim`, `cells`: not NULL. `count`: uav_count. Threads: only this one uses `sim`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn jcas_sim_set_positions(
    sim: *mut jcas_sim,
    cells: *const jcas_cell,
    count: usize,
) -> i32 {
    guard(|| {
        // SAFETY: the caller's promise for `sim`.
        let mut sim = unsafe { open(sim.cast()) }?;
        // SAFETY: the caller's promise for `cells`.
        let cells = unsafe { input(cells, count, sim.model.uav_count()) }?;
        sim.act(|model, state, _| model.set_positions(state, kernel_cells(cells)))
    })
}

/// Part 2 of a step: sense and learn. Next: jcas_sim_step_communicate or jcas_sim_step_communicate_over.
///
/// `sim`: not NULL. Threads: only this one uses `sim`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn jcas_sim_step_sense(sim: *mut jcas_sim) -> i32 {
    guard(|| {
        // SAFETY: the caller's promise for `sim`.
        let mut sim = unsafe { open(sim.cast()) }?;
        sim.act(|model, state, scratch| model.step_sense(state, scratch))
    })
}

/// Part 3 of a step: communicate over the graph that the kernel's link budget gives. Next:
/// jcas_sim_step_end.
///
/// `sim`: not NULL. Threads: only this one uses `sim`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn jcas_sim_step_communicate(sim: *mut jcas_sim) -> i32 {
    guard(|| {
        // SAFETY: the caller's promise for `sim`.
        let mut sim = unsafe { open(sim.cast()) }?;
        sim.act(|model, state, scratch| model.step_communicate(state, scratch))
    })
}

/// Part 3 of a step over the host's graph, in place of jcas_sim_step_communicate.
///
/// `links`: a uav_count * uav_count matrix, row by row, any value but 0 is a link; not NULL. It must be
/// symmetric; the diagonal and links of grounded UAVs are ignored. `throughput`: the mean normalised
/// throughput of each UAV toward its neighbours as the host measured it, uav_count numbers from 0 to 1e9;
/// or NULL with a count of 0 to take it from the kernel's link budget. Threads: only this one uses `sim`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn jcas_sim_step_communicate_over(
    sim: *mut jcas_sim,
    links: *const u8,
    link_count: usize,
    throughput: *const f64,
    throughput_count: usize,
) -> i32 {
    guard(|| {
        // SAFETY: the caller's promise for `sim`.
        let mut sim = unsafe { open(sim.cast()) }?;
        let uavs = sim.model.uav_count();
        // SAFETY: the caller's promise for `links`.
        let links = unsafe { input(links, link_count, uavs * uavs) }?;
        let throughput = if throughput.is_null() && throughput_count == 0 {
            None
        } else {
            // SAFETY: the caller's promise for `throughput`.
            Some(unsafe { input(throughput, throughput_count, uavs) }?)
        };
        sim.act(|model, state, scratch| {
            model.step_communicate_over(state, scratch, links, throughput)
        })
    })
}

/// Part 4 of a step: energy, charge, carbon, reward, termination.
///
/// `sim`, `outcome`: not NULL, struct_size set. Threads: only this one uses `sim`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn jcas_sim_step_end(sim: *mut jcas_sim, outcome: *mut jcas_outcome) -> i32 {
    guard(|| {
        // SAFETY: the caller's promise for `sim`.
        let mut sim = unsafe { open(sim.cast()) }?;
        // SAFETY: the caller's promise for `outcome`.
        let out = unsafe { record(outcome) }?;
        out.put(jcas_outcome::of(
            sim.act(|model, state, scratch| model.step_end(state, scratch))?,
        ));
        Ok(())
    })
}

/// Places the hotspots, in place of the drawn ones: distinct cells without a depot. At t = 0 only.
///
/// `sim`, `cells`: not NULL. `count`: hotspot_count. Threads: only this one uses `sim`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn jcas_sim_set_hotspots(
    sim: *mut jcas_sim,
    cells: *const jcas_cell,
    count: usize,
) -> i32 {
    guard(|| {
        // SAFETY: the caller's promise for `sim`.
        let mut sim = unsafe { open(sim.cast()) }?;
        // SAFETY: the caller's promise for `cells`.
        let cells = unsafe { input(cells, count, sim.model.hotspot_count()) }?;
        sim.act(|model, state, scratch| model.set_hotspots(state, scratch, kernel_cells(cells)))
    })
}

/// Sets what each battery holds at the start, in microjoules, in place of the drawn charge. At t = 0 only.
///
/// `sim`, `charges_uj`: not NULL. `count`: uav_count. Threads: only this one uses `sim`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn jcas_sim_set_batteries(
    sim: *mut jcas_sim,
    charges_uj: *const u64,
    count: usize,
) -> i32 {
    guard(|| {
        // SAFETY: the caller's promise for `sim`.
        let mut sim = unsafe { open(sim.cast()) }?;
        // SAFETY: the caller's promise for `charges_uj`.
        let charges = unsafe { input(charges_uj, count, sim.model.uav_count()) }?;
        sim.act(|model, state, scratch| model.set_batteries(state, scratch, charges))
    })
}

const _: () = assert!(size_of::<jcas_cell>() == size_of::<Cell>());
const _: () = assert!(align_of::<jcas_cell>() == align_of::<Cell>());
const _: () = assert!(offset_of!(jcas_cell, x) == offset_of!(Cell, x));
const _: () = assert!(offset_of!(jcas_cell, y) == offset_of!(Cell, y));

/// The same cells as the kernel's type, without a copy.
fn kernel_cells(cells: &[jcas_cell]) -> &[Cell] {
    // SAFETY: both types are two integers at the same places, as asserted above.
    unsafe { slice::from_raw_parts(cells.as_ptr().cast(), cells.len()) }
}
