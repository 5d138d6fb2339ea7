//! Stepping by parts, and what a host simulator may own: positions, detections, links, hotspots,
//! batteries.

use std::mem::offset_of;
use std::slice;

use jcas_core::Cell;
use jcas_core::host::Call;

use crate::config::jcas_cell;
use crate::memory::{input, record};
use crate::records::jcas_outcome;
use crate::sim::jcas_sim;
use crate::sim_block::{SimMut, change};
use crate::status::jcas_status;

/// Part 1 of a step: actions, return to base, move. Next: jcas_sim_set_positions (optional), then
/// jcas_sim_step_sense.
///
/// `sim`, `actions`: as for jcas_sim_step.
/// Threads: only this one uses `sim`.
/// Statuses: NULL, ALIGNMENT, LENGTH, HANDLE, NAN, OUT_OF_ORDER, EPISODE_OVER.
#[must_use]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn jcas_sim_step_begin(
    sim: *mut jcas_sim,
    actions: *const f32,
    action_count: usize,
) -> jcas_status {
    let act = |sim: &mut SimMut<'_>| {
        // SAFETY: the caller's promise for `actions`.
        let actions = unsafe { input(actions, action_count, sim.model.action_len()) }?;
        sim.act(|model, state, _| model.step_begin(state, actions))?;
        sim.tell_actions(actions);
        Ok(())
    };
    // SAFETY: the caller's promise for `sim`.
    unsafe { change(sim.cast(), act) }
}

/// Sets the positions of the UAVs, in place of the kernel's own motion. A UAV has moved if its cell
/// differs from the one before the step, at any distance.
///
/// `sim`, `cells`: not NULL. `count`: uav_count.
/// Threads: only this one uses `sim`.
/// Statuses: NULL, ALIGNMENT, LENGTH, HANDLE, ARGUMENT, OUT_OF_ORDER, EPISODE_OVER.
#[must_use]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn jcas_sim_set_positions(
    sim: *mut jcas_sim,
    cells: *const jcas_cell,
    count: usize,
) -> jcas_status {
    let act = |sim: &mut SimMut<'_>| {
        // SAFETY: the caller's promise for `cells`.
        let cells = unsafe { input(cells, count, sim.model.uav_count()) }?;
        let cells = kernel_cells(cells);
        sim.own(&Call::SetPositions { cells })
    };
    // SAFETY: the caller's promise for `sim`.
    unsafe { change(sim.cast(), act) }
}

/// Part 2 of a step: sense and learn. Next: jcas_sim_step_communicate or
/// jcas_sim_step_communicate_with.
///
/// `sim`: not NULL.
/// Threads: only this one uses `sim`.
/// Statuses: NULL, ALIGNMENT, HANDLE, OUT_OF_ORDER, EPISODE_OVER.
#[must_use]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn jcas_sim_step_sense(sim: *mut jcas_sim) -> jcas_status {
    let act =
        |sim: &mut SimMut<'_>| sim.act(|model, state, scratch| model.step_sense(state, scratch));
    // SAFETY: the caller's promise for `sim`.
    unsafe { change(sim.cast(), act) }
}

/// Keeps a UAV from flying, sensing and communicating in this step, at any charge of its battery.
/// It stays in its cell of before the step and uses no energy. Call it between jcas_sim_step_begin
/// and jcas_sim_step_sense; if jcas_sim_set_positions is called too, call that first.
///
/// `sim`: not NULL. `uav`: below uav_count, or JCAS_ERROR_ARGUMENT.
/// Threads: only this one uses `sim`.
/// Statuses: NULL, ALIGNMENT, HANDLE, ARGUMENT, OUT_OF_ORDER, EPISODE_OVER.
#[must_use]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn jcas_sim_ground(sim: *mut jcas_sim, uav: u32) -> jcas_status {
    let uav = uav as usize;
    let act = |sim: &mut SimMut<'_>| sim.own(&Call::Ground { uav });
    // SAFETY: the caller's promise for `sim`.
    unsafe { change(sim.cast(), act) }
}

/// Confirms a hotspot in this step without a quorum of detections. Call it between
/// jcas_sim_step_begin and jcas_sim_step_sense. UAVs that then detect the hotspot know it. Nothing
/// changes if it was already confirmed.
///
/// `sim`: not NULL. `hotspot`: below hotspot_count, or JCAS_ERROR_ARGUMENT.
/// Threads: only this one uses `sim`.
/// Statuses: NULL, ALIGNMENT, HANDLE, ARGUMENT, OUT_OF_ORDER, EPISODE_OVER.
#[must_use]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn jcas_sim_confirm_hotspot(sim: *mut jcas_sim, hotspot: u32) -> jcas_status {
    let hotspot = hotspot as usize;
    let act = |sim: &mut SimMut<'_>| sim.own(&Call::ConfirmHotspot { hotspot });
    // SAFETY: the caller's promise for `sim`.
    unsafe { change(sim.cast(), act) }
}

/// Part 2 of a step with the host's detections, in place of jcas_sim_step_sense.
///
/// `sim`, `detections`: not NULL. `count`: uav_count * hotspot_count, a row for each UAV; any value
/// but 0 is a detection. Detections by grounded UAVs are ignored, and those of confirmed hotspots
/// that the UAV knows, as the kernel makes no draw for them.
/// Threads: only this one uses `sim`.
/// Statuses: NULL, ALIGNMENT, LENGTH, HANDLE, OUT_OF_ORDER, EPISODE_OVER.
#[must_use]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn jcas_sim_step_sense_with(
    sim: *mut jcas_sim,
    detections: *const u8,
    count: usize,
) -> jcas_status {
    let act = |sim: &mut SimMut<'_>| {
        let expected = sim.model.uav_count() * sim.model.hotspot_count();
        // SAFETY: the caller's promise for `detections`.
        let detections = unsafe { input(detections, count, expected) }?;
        sim.own(&Call::StepSenseWith { detections })
    };
    // SAFETY: the caller's promise for `sim`.
    unsafe { change(sim.cast(), act) }
}

/// Part 3 of a step: communicate over the graph of the kernel's link budget. Next:
/// jcas_sim_step_end.
///
/// `sim`: not NULL.
/// Threads: only this one uses `sim`.
/// Statuses: NULL, ALIGNMENT, HANDLE, OUT_OF_ORDER, EPISODE_OVER.
#[must_use]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn jcas_sim_step_communicate(sim: *mut jcas_sim) -> jcas_status {
    let act = |sim: &mut SimMut<'_>| {
        sim.act(|model, state, scratch| model.step_communicate(state, scratch))
    };
    // SAFETY: the caller's promise for `sim`.
    unsafe { change(sim.cast(), act) }
}

/// Part 3 of a step over the host's graph, in place of jcas_sim_step_communicate.
///
/// `links`: a uav_count * uav_count matrix, row by row; any value but 0 is a link; not NULL. It
/// must be symmetric; the diagonal and links of grounded UAVs are ignored. `throughput`: uav_count
/// numbers from 0 to 1e9, the mean normalised throughput of each UAV toward its neighbours. NULL
/// with a count of 0 takes it from the kernel's link budget. A UAV without neighbours has 0 in
/// either case.
/// Threads: only this one uses `sim`.
/// Statuses: NULL, ALIGNMENT, LENGTH, HANDLE, ARGUMENT, OUT_OF_ORDER, EPISODE_OVER.
#[must_use]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn jcas_sim_step_communicate_with(
    sim: *mut jcas_sim,
    links: *const u8,
    link_count: usize,
    throughput: *const f64,
    throughput_count: usize,
) -> jcas_status {
    let act = |sim: &mut SimMut<'_>| {
        let uavs = sim.model.uav_count();
        // SAFETY: the caller's promise for `links`.
        let links = unsafe { input(links, link_count, uavs * uavs) }?;
        let throughput = if throughput.is_null() && throughput_count == 0 {
            None
        } else {
            // SAFETY: the caller's promise for `throughput`.
            Some(unsafe { input(throughput, throughput_count, uavs) }?)
        };
        sim.own(&Call::StepCommunicateWith { links, throughput })
    };
    // SAFETY: the caller's promise for `sim`.
    unsafe { change(sim.cast(), act) }
}

/// Part 4 of a step: account for energy, charge, carbon and reward, and end the episode if it is
/// over.
///
/// `sim`, `outcome`: not NULL, struct_size set.
/// Threads: only this one uses `sim`.
/// Statuses: NULL, ALIGNMENT, STRUCT_SIZE, HANDLE, OUT_OF_ORDER, EPISODE_OVER.
#[must_use]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn jcas_sim_step_end(
    sim: *mut jcas_sim,
    outcome: *mut jcas_outcome,
) -> jcas_status {
    let act = |sim: &mut SimMut<'_>| {
        // SAFETY: the caller's promise for `outcome`.
        let out = unsafe { record(outcome) }?;
        out.put(jcas_outcome::of(
            sim.act(|model, state, scratch| model.step_end(state, scratch))?,
        ));
        sim.tell_step()
    };
    // SAFETY: the caller's promise for `sim`.
    unsafe { change(sim.cast(), act) }
}

/// Sets the cells of the hotspots, in place of the drawn ones. The cells must be distinct and
/// without a depot. Allowed at t = 0 only.
///
/// `sim`, `cells`: not NULL. `count`: hotspot_count.
/// Threads: only this one uses `sim`.
/// Statuses: NULL, ALIGNMENT, LENGTH, HANDLE, ARGUMENT, OUT_OF_ORDER, EPISODE_OVER.
#[must_use]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn jcas_sim_set_hotspots(
    sim: *mut jcas_sim,
    cells: *const jcas_cell,
    count: usize,
) -> jcas_status {
    let act = |sim: &mut SimMut<'_>| {
        // SAFETY: the caller's promise for `cells`.
        let cells = unsafe { input(cells, count, sim.model.hotspot_count()) }?;
        let cells = kernel_cells(cells);
        sim.own(&Call::SetHotspots { cells })
    };
    // SAFETY: the caller's promise for `sim`.
    unsafe { change(sim.cast(), act) }
}

/// Moves a hotspot between steps. Its confirmation and the UAVs that know it do not change.
///
/// `sim`: not NULL. `hotspot`: below hotspot_count. `x`, `y`: a cell of the grid without a depot or
/// another hotspot. Anything else is JCAS_ERROR_ARGUMENT.
/// Threads: only this one uses `sim`.
/// Statuses: NULL, ALIGNMENT, HANDLE, ARGUMENT, OUT_OF_ORDER, EPISODE_OVER.
#[must_use]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn jcas_sim_move_hotspot(
    sim: *mut jcas_sim,
    hotspot: u32,
    x: u32,
    y: u32,
) -> jcas_status {
    let (hotspot, cell) = (hotspot as usize, Cell { x, y });
    let act = |sim: &mut SimMut<'_>| sim.own(&Call::MoveHotspot { hotspot, cell });
    // SAFETY: the caller's promise for `sim`.
    unsafe { change(sim.cast(), act) }
}

/// Sets the cells in which the UAVs start, in place of the first depot. Allowed at t = 0 only.
///
/// `sim`, `cells`: not NULL. `count`: uav_count.
/// Threads: only this one uses `sim`.
/// Statuses: NULL, ALIGNMENT, LENGTH, HANDLE, ARGUMENT, OUT_OF_ORDER, EPISODE_OVER.
#[must_use]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn jcas_sim_set_starts(
    sim: *mut jcas_sim,
    cells: *const jcas_cell,
    count: usize,
) -> jcas_status {
    let act = |sim: &mut SimMut<'_>| {
        // SAFETY: the caller's promise for `cells`.
        let cells = unsafe { input(cells, count, sim.model.uav_count()) }?;
        let cells = kernel_cells(cells);
        sim.own(&Call::SetStarts { cells })
    };
    // SAFETY: the caller's promise for `sim`.
    unsafe { change(sim.cast(), act) }
}

/// Sets the present charge of a battery, in microjoules, between steps. 0 grounds the UAV from the
/// next step on. The difference is added to given_uj of jcas_uav.
///
/// `sim`: not NULL. `uav`: below uav_count, `charge_uj`: at most battery_capacity_uj, or
/// JCAS_ERROR_ARGUMENT.
/// Threads: only this one uses `sim`.
/// Statuses: NULL, ALIGNMENT, HANDLE, ARGUMENT, OUT_OF_ORDER, EPISODE_OVER.
#[must_use]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn jcas_sim_set_battery(
    sim: *mut jcas_sim,
    uav: u32,
    charge_uj: u64,
) -> jcas_status {
    let uav = uav as usize;
    let act = |sim: &mut SimMut<'_>| sim.own(&Call::SetBattery { uav, charge_uj });
    // SAFETY: the caller's promise for `sim`.
    unsafe { change(sim.cast(), act) }
}

/// Sets the initial charge of each battery, in microjoules, in place of the drawn one. Allowed at t
/// = 0 only.
///
/// `sim`, `charges_uj`: not NULL. `count`: uav_count.
/// Threads: only this one uses `sim`.
/// Statuses: NULL, ALIGNMENT, LENGTH, HANDLE, ARGUMENT, OUT_OF_ORDER, EPISODE_OVER.
#[must_use]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn jcas_sim_set_batteries(
    sim: *mut jcas_sim,
    charges_uj: *const u64,
    count: usize,
) -> jcas_status {
    let act = |sim: &mut SimMut<'_>| {
        // SAFETY: the caller's promise for `charges_uj`.
        let charges_uj = unsafe { input(charges_uj, count, sim.model.uav_count()) }?;
        sim.own(&Call::SetBatteries { charges_uj })
    };
    // SAFETY: the caller's promise for `sim`.
    unsafe { change(sim.cast(), act) }
}

const _: () = assert!(size_of::<jcas_cell>() == size_of::<Cell>());
const _: () = assert!(align_of::<jcas_cell>() == align_of::<Cell>());
const _: () = assert!(offset_of!(jcas_cell, x) == offset_of!(Cell, x));
const _: () = assert!(offset_of!(jcas_cell, y) == offset_of!(Cell, y));

/// Views C cells as the kernel's cells, without a copy.
pub(crate) fn kernel_cells(cells: &[jcas_cell]) -> &[Cell] {
    // SAFETY: both types are two integers at the same places, as asserted above.
    unsafe { slice::from_raw_parts(cells.as_ptr().cast(), cells.len()) }
}
