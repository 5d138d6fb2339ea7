//! Queries that copy each quantity of a state into the caller's buffers.

use std::ffi::c_char;

use jcas_core::{StateRef, reward};

use crate::memory::{output, record};
use crate::names::{joined, joined_len, name_at};
use crate::records::{jcas_episode, jcas_hotspot, jcas_metrics, jcas_uav};
use crate::sim::jcas_sim;
use crate::sim_block::{SimRef, see};
use crate::status::{Fault, JCAS_ERROR_STRUCT_SIZE, guard, jcas_status};

impl SimRef<'_> {
    fn state(&self) -> Result<StateRef<'_>, Fault> {
        Ok(self.model.state(self.words)?)
    }
}

/// Writes the time, the phase and the totals of the episode.
///
/// `sim`, `episode`: not NULL; episode->struct_size set.
/// Threads: none changes `sim`.
/// Statuses: NULL, ALIGNMENT, STRUCT_SIZE, HANDLE.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn jcas_sim_get_episode(
    sim: *const jcas_sim,
    episode: *mut jcas_episode,
) -> jcas_status {
    guard(|| {
        // SAFETY: the caller's promise for `sim`.
        let sim = unsafe { see(sim.cast()) }?;
        // SAFETY: the caller's promise for `episode`.
        let out = unsafe { record(episode) }?;
        out.put(jcas_episode::of(&sim.state()?));
        Ok(())
    })
}

/// Writes the metrics of the episode so far.
///
/// `sim`, `metrics`: not NULL; metrics->struct_size set.
/// Threads: none changes `sim`.
/// Statuses: NULL, ALIGNMENT, STRUCT_SIZE, HANDLE.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn jcas_sim_get_metrics(
    sim: *const jcas_sim,
    metrics: *mut jcas_metrics,
) -> jcas_status {
    guard(|| {
        // SAFETY: the caller's promise for `sim`.
        let sim = unsafe { see(sim.cast()) }?;
        // SAFETY: the caller's promise for `metrics`.
        let out = unsafe { record(metrics) }?;
        out.put(jcas_metrics::of(&sim.state()?.metrics()));
        Ok(())
    })
}

/// Writes the components of the last reward. The reward is their sum, from the first to the last.
///
/// `sim`, `components`: not NULL. `count`: reward_len.
/// Threads: none changes `sim`.
/// Statuses: NULL, ALIGNMENT, LENGTH, HANDLE.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn jcas_sim_get_rewards(
    sim: *const jcas_sim,
    components: *mut f64,
    count: usize,
) -> jcas_status {
    guard(|| {
        // SAFETY: the caller's promise for `sim`.
        let sim = unsafe { see(sim.cast()) }?;
        // SAFETY: the caller's promise for `components`.
        let out = unsafe { output(components, count, reward::COMPONENTS) }?;
        out.copy_from_slice(&sim.state()?.rewards());
        Ok(())
    })
}

/// Writes the reward of each UAV in the last step, or 0 before the first. The mean of these rewards
/// is the team reward. Detections, informing, completion, truncation and the spread of knowledge
/// are shared. Coverage, energy, carbon and revisits are the UAV's own, times N. Throughput and
/// potentials are the UAV's own in place of the fleet's means.
///
/// `sim`, `rewards`: not NULL. `count`: uav_count.
/// Threads: none changes `sim`.
/// Statuses: NULL, ALIGNMENT, LENGTH, HANDLE.
#[must_use]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn jcas_sim_uav_rewards(
    sim: *const jcas_sim,
    rewards: *mut f64,
    count: usize,
) -> jcas_status {
    guard(|| {
        // SAFETY: the caller's promise for `sim`.
        let sim = unsafe { see(sim.cast()) }?;
        // SAFETY: the caller's promise for `rewards`.
        let out = unsafe { output(rewards, count, sim.model.uav_count()) }?;
        let state = sim.state()?;
        for (i, reward) in out.iter_mut().enumerate() {
            *reward = state.uav_reward(i);
        }
        Ok(())
    })
}

/// Writes the components of jcas_sim_uav_rewards: a row of reward_len for each UAV, named by
/// jcas_reward_name. The sum of a row, from left to right, is the UAV's reward.
///
/// `sim`, `components`: not NULL. `count`: uav_count * reward_len.
/// Threads: none changes `sim`.
/// Statuses: NULL, ALIGNMENT, LENGTH, HANDLE.
#[must_use]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn jcas_sim_uav_reward_components(
    sim: *const jcas_sim,
    components: *mut f64,
    count: usize,
) -> jcas_status {
    guard(|| {
        // SAFETY: the caller's promise for `sim`.
        let sim = unsafe { see(sim.cast()) }?;
        let expected = sim.model.uav_count() * reward::COMPONENTS;
        // SAFETY: the caller's promise for `components`.
        let out = unsafe { output(components, count, expected) }?;
        let state = sim.state()?;
        for (i, row) in out.chunks_exact_mut(reward::COMPONENTS).enumerate() {
            row.copy_from_slice(&state.uav_rewards(i));
        }
        Ok(())
    })
}

/// Returns the name of a component of the reward: a static string, or NULL for an index of
/// reward_len or more.
/// Threads: any.
#[unsafe(no_mangle)]
pub extern "C" fn jcas_reward_name(index: u32) -> *const c_char {
    static NAMES: [u8; joined_len(&reward::NAMES)] = joined(&reward::NAMES);
    name_at(&NAMES, index)
}

/// Writes the state of every UAV.
///
/// `sim`, `uavs`: not NULL. `count`: uav_count. `struct_size`: sizeof(jcas_uav).
/// Threads: none changes `sim`.
/// Statuses: NULL, ALIGNMENT, LENGTH, STRUCT_SIZE, HANDLE.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn jcas_sim_get_uavs(
    sim: *const jcas_sim,
    uavs: *mut jcas_uav,
    count: usize,
    struct_size: usize,
) -> jcas_status {
    guard(|| {
        // SAFETY: the caller's promise for `sim`.
        let sim = unsafe { see(sim.cast()) }?;
        is_size_of::<jcas_uav>(struct_size)?;
        // SAFETY: the caller's promise for `uavs`.
        let out = unsafe { output(uavs, count, sim.model.uav_count()) }?;
        let state = sim.state()?;
        for (i, uav) in out.iter_mut().enumerate() {
            *uav = jcas_uav::of(&state, i);
        }
        Ok(())
    })
}

/// Writes the state of every hotspot.
///
/// `sim`, `hotspots`: not NULL. `count`: hotspot_count. `struct_size`: sizeof(jcas_hotspot).
/// Threads: none changes `sim`.
/// Statuses: NULL, ALIGNMENT, LENGTH, STRUCT_SIZE, HANDLE.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn jcas_sim_get_hotspots(
    sim: *const jcas_sim,
    hotspots: *mut jcas_hotspot,
    count: usize,
    struct_size: usize,
) -> jcas_status {
    guard(|| {
        // SAFETY: the caller's promise for `sim`.
        let sim = unsafe { see(sim.cast()) }?;
        is_size_of::<jcas_hotspot>(struct_size)?;
        // SAFETY: the caller's promise for `hotspots`.
        let out = unsafe { output(hotspots, count, sim.model.hotspot_count()) }?;
        let state = sim.state()?;
        for (j, hotspot) in out.iter_mut().enumerate() {
            *hotspot = jcas_hotspot::of(&state, j);
        }
        Ok(())
    })
}

/// Writes the radio graph as a symmetric matrix, row by row: 1 where two UAVs are neighbours, else
/// 0.
///
/// `sim`, `links`: not NULL. `count`: uav_count * uav_count.
/// Threads: none changes `sim`.
/// Statuses: NULL, ALIGNMENT, LENGTH, HANDLE.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn jcas_sim_get_links(
    sim: *const jcas_sim,
    links: *mut u8,
    count: usize,
) -> jcas_status {
    guard(|| {
        // SAFETY: the caller's promise for `sim`.
        let sim = unsafe { see(sim.cast()) }?;
        let uavs = sim.model.uav_count();
        // SAFETY: the caller's promise for `links`.
        let out = unsafe { output(links, count, uavs * uavs) }?;
        let state = sim.state()?;
        fill_rows(out, uavs, |i, k| state.linked(i, k));
        Ok(())
    })
}

/// Writes the knowledge matrix: 1 where a UAV (row) knows a hotspot (column), else 0.
///
/// `sim`, `knowledge`: not NULL. `count`: uav_count * hotspot_count.
/// Threads: none changes `sim`.
/// Statuses: NULL, ALIGNMENT, LENGTH, HANDLE.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn jcas_sim_get_knowledge(
    sim: *const jcas_sim,
    knowledge: *mut u8,
    count: usize,
) -> jcas_status {
    guard(|| {
        // SAFETY: the caller's promise for `sim`.
        let sim = unsafe { see(sim.cast()) }?;
        let (uavs, hotspots) = (sim.model.uav_count(), sim.model.hotspot_count());
        // SAFETY: the caller's promise for `knowledge`.
        let out = unsafe { output(knowledge, count, uavs * hotspots) }?;
        let state = sim.state()?;
        fill_rows(out, hotspots, |i, j| state.knows(i, j));
        Ok(())
    })
}

/// Writes the detections of the last sensing: 1 where a UAV (row) detected a hotspot (column), else
/// 0. A UAV does not sense hotspots that it already knows.
///
/// `sim`, `detections`: not NULL. `count`: uav_count * hotspot_count.
/// Threads: none changes `sim`.
/// Statuses: NULL, ALIGNMENT, LENGTH, HANDLE.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn jcas_sim_get_detections(
    sim: *const jcas_sim,
    detections: *mut u8,
    count: usize,
) -> jcas_status {
    guard(|| {
        // SAFETY: the caller's promise for `sim`.
        let sim = unsafe { see(sim.cast()) }?;
        let (uavs, hotspots) = (sim.model.uav_count(), sim.model.hotspot_count());
        // SAFETY: the caller's promise for `detections`.
        let out = unsafe { output(detections, count, uavs * hotspots) }?;
        let state = sim.state()?;
        fill_rows(out, hotspots, |i, j| state.detected(i, j));
        Ok(())
    })
}

/// Writes the normalised throughput of each pair by the kernel's link budget: from a UAV (row)
/// toward another (column). It is 0 where the two are not neighbours.
///
/// `sim`, `throughputs`: not NULL. `count`: uav_count * uav_count.
/// Threads: none changes `sim`.
/// Statuses: NULL, ALIGNMENT, LENGTH, HANDLE.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn jcas_sim_get_throughputs(
    sim: *const jcas_sim,
    throughputs: *mut f64,
    count: usize,
) -> jcas_status {
    guard(|| {
        // SAFETY: the caller's promise for `sim`.
        let sim = unsafe { see(sim.cast()) }?;
        let uavs = sim.model.uav_count();
        // SAFETY: the caller's promise for `throughputs`.
        let out = unsafe { output(throughputs, count, uavs * uavs) }?;
        let state = sim.state()?;
        for (index, value) in out.iter_mut().enumerate() {
            *value = sim
                .model
                .pair_throughput(&state, index / uavs, index % uavs);
        }
        Ok(())
    })
}

/// Writes the visited cells, row (y) by row: 1 where any UAV has been, else 0.
///
/// `sim`, `visited`: not NULL. `count`: grid_width * grid_height.
/// Threads: none changes `sim`.
/// Statuses: NULL, ALIGNMENT, LENGTH, HANDLE.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn jcas_sim_get_visited(
    sim: *const jcas_sim,
    visited: *mut u8,
    count: usize,
) -> jcas_status {
    guard(|| {
        // SAFETY: the caller's promise for `sim`.
        let sim = unsafe { see(sim.cast()) }?;
        let cells = sim.model.config().cell_count();
        // SAFETY: the caller's promise for `visited`.
        let out = unsafe { output(visited, count, cells) }?;
        let state = sim.state()?;
        fill_rows(out, cells, |_, index| state.visited(index));
        Ok(())
    })
}

/// Writes the search maps: 1 where a UAV knows a cell to be searched, else 0. There is one grid for
/// each UAV in turn, row (y) by row.
///
/// `sim`, `maps`: not NULL. `count`: uav_count * grid_width * grid_height, or 0 without search
/// maps.
/// Threads: none changes `sim`.
/// Statuses: NULL, ALIGNMENT, LENGTH, HANDLE.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn jcas_sim_get_search_maps(
    sim: *const jcas_sim,
    maps: *mut u8,
    count: usize,
) -> jcas_status {
    guard(|| {
        // SAFETY: the caller's promise for `sim`.
        let sim = unsafe { see(sim.cast()) }?;
        let maps_kept = sim.model.map_words() > 0;
        let cells = sim.model.config().cell_count();
        let expected = if maps_kept {
            sim.model.uav_count() * cells
        } else {
            0
        };
        // SAFETY: the caller's promise for `maps`.
        let out = unsafe { output(maps, count, expected) }?;
        let state = sim.state()?;
        fill_rows(out, cells, |i, index| state.searched(i, index));
        Ok(())
    })
}

/// Writes the false alarms of the last sensing: 1 where a UAV saw a hotspot in a cell that held
/// none, else 0. There is one grid for each UAV in turn, row (y) by row.
///
/// `sim`, `alarms`: not NULL. `count`: uav_count * grid_width * grid_height, or 0 without false
/// alarms.
/// Threads: none changes `sim`.
/// Statuses: NULL, ALIGNMENT, LENGTH, HANDLE.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn jcas_sim_get_false_alarms(
    sim: *const jcas_sim,
    alarms: *mut u8,
    count: usize,
) -> jcas_status {
    guard(|| {
        // SAFETY: the caller's promise for `sim`.
        let sim = unsafe { see(sim.cast()) }?;
        let cells = sim.model.config().cell_count();
        let expected = if has_false_alarms(&sim) {
            sim.model.uav_count() * cells
        } else {
            0
        };
        // SAFETY: the caller's promise for `alarms`.
        let out = unsafe { output(alarms, count, expected) }?;
        let state = sim.state()?;
        for (i, row) in out.chunks_exact_mut(cells).enumerate() {
            row.fill(0);
            state.false_alarms_of(i).for_each(|cell| row[cell] = 1);
        }
        Ok(())
    })
}

/// Writes the false confirmations, row (y) by row: 1 where a quorum has confirmed a cell that held
/// no hotspot, else 0.
///
/// `sim`, `cells`: not NULL. `count`: grid_width * grid_height, or 0 without false alarms.
/// Threads: none changes `sim`.
/// Statuses: NULL, ALIGNMENT, LENGTH, HANDLE.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn jcas_sim_get_false_confirmations(
    sim: *const jcas_sim,
    cells: *mut u8,
    count: usize,
) -> jcas_status {
    guard(|| {
        // SAFETY: the caller's promise for `sim`.
        let sim = unsafe { see(sim.cast()) }?;
        let grid = sim.model.config().cell_count();
        let expected = if has_false_alarms(&sim) { grid } else { 0 };
        // SAFETY: the caller's promise for `cells`.
        let out = unsafe { output(cells, count, expected) }?;
        let state = sim.state()?;
        fill_rows(out, grid, |_, index| state.falsely_confirmed(index));
        Ok(())
    })
}

/// Writes the reports that each UAV knows: the level of each cell, or 0. There is one grid for each
/// UAV in turn, row (y) by row.
///
/// `sim`, `levels`: not NULL. `count`: uav_count * grid_width * grid_height, or 0 without reports.
/// Threads: none changes `sim`.
/// Statuses: NULL, ALIGNMENT, LENGTH, HANDLE.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn jcas_sim_get_reports(
    sim: *const jcas_sim,
    levels: *mut u8,
    count: usize,
) -> jcas_status {
    guard(|| {
        // SAFETY: the caller's promise for `sim`.
        let sim = unsafe { see(sim.cast()) }?;
        let cells = sim.model.config().cell_count();
        let uavs = if sim.model.config().report_levels > 0 {
            sim.model.uav_count()
        } else {
            0
        };
        // SAFETY: the caller's promise for `levels`.
        let out = unsafe { output(levels, count, uavs * cells) }?;
        let state = sim.state()?;
        for (index, level) in out.iter_mut().enumerate() {
            *level = state.report_level(index / cells, index % cells) as u8;
        }
        Ok(())
    })
}

fn has_false_alarms(sim: &SimRef<'_>) -> bool {
    sim.model.config().false_alarm_per_cell > 0.0
}

fn fill_rows(out: &mut [u8], row_len: usize, is_set: impl Fn(usize, usize) -> bool) {
    for (i, row) in out.chunks_exact_mut(row_len).enumerate() {
        for (k, value) in row.iter_mut().enumerate() {
            *value = is_set(i, k).into();
        }
    }
}

fn is_size_of<T>(struct_size: usize) -> Result<(), Fault> {
    if struct_size == size_of::<T>() {
        Ok(())
    } else {
        Err(Fault::Status(JCAS_ERROR_STRUCT_SIZE))
    }
}
