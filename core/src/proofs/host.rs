//! P10 and P3 for the calls of a host. A call leaves a valid state, and a refused call changes no
//! word. The ledger balances after a host sets a battery.

use super::energy::ROOM_UJ;
use super::inputs::{between, real_between};
#[cfg(not(kani))]
use super::standin as kani;
use super::state::{
    STATE_WORDS, any_fleet, any_state, carries_scalars, confirms_by_quorum, differ,
    nothing_is_forgotten, open, view,
};
use crate::config::Cell;
use crate::host::given_after;
use crate::model::Model;
use crate::state::header::Phase;

/// UAVs of the smallest model, and of any that the stand-in makes; no model has more hotspots.
#[cfg(kani)]
const MOST: usize = 2;
/// UAVs of the smallest model, and of any that the stand-in makes; no model has more hotspots.
#[cfg(not(kani))]
const MOST: usize = crate::model::any_model::UAVS_MAX;

/// Checks a call within a step. If it succeeds, it leads to the phase with a valid fleet and
/// carries the scalars. If it is refused, it changes no word.
fn keeps_the_fleet_valid(
    model: &Model<'_>,
    before: &[u64; STATE_WORDS],
    after: &[u64; STATE_WORDS],
    done: bool,
    phase: Phase,
) {
    if !done {
        assert!(!differ(before, after));
        return;
    }
    let (old, new) = (view(model, before), view(model, after));
    nothing_is_forgotten(model, &old, &new);
    carries_scalars(&old, &new);
    assert!(new.header.phase() == Some(phase));
    assert!(new.fleet_is_valid(model, phase));
}

/// Checks a call between steps. It leaves a valid state, or is refused and changes no word.
fn keeps_the_state_valid(
    model: &Model<'_>,
    before: &[u64; STATE_WORDS],
    after: &[u64; STATE_WORDS],
    done: bool,
) {
    if !done {
        assert!(!differ(before, after));
        return;
    }
    let new = view(model, after);
    nothing_is_forgotten(model, &view(model, before), &new);
    assert!(new.header.phase() == Some(Phase::Ready));
    assert!(new.is_valid(model));
}

/// A cell on the grid of any model here or just beside it.
fn any_cell() -> Cell {
    Cell {
        x: between(0, if cfg!(kani) { 2 } else { 4 }) as u32,
        y: between(0, 2) as u32,
    }
}

/// As many as there are UAVs, or hotspots, at most.
fn any_cells() -> [Cell; MOST] {
    let mut cells = [Cell { x: 0, y: 0 }; MOST];
    for index in 0..MOST {
        cells[index] = any_cell();
    }
    cells
}

/// An index below the count, or the count itself.
fn any_index(count: usize) -> usize {
    between(0, count as u64) as usize
}

#[cfg_attr(kani, kani::proof)]
#[cfg_attr(kani, kani::unwind(4))]
pub fn setting_positions_keeps_the_state_valid() {
    given!(model);
    let before = any_fleet(&model, Phase::Moved);
    let mut after = before;
    let cells = any_cells();
    let cells = &cells[..model.uav_count()];
    let done = model.set_positions(&mut open(&model, &mut after), cells);
    let (old, new) = (view(&model, &before), view(&model, &after));
    kani::cover!(done.is_ok() && old.cell(0) != new.cell(0), "a UAV is moved");
    kani::cover!(done.is_err(), "a cell off the grid");
    keeps_the_fleet_valid(&model, &before, &after, done.is_ok(), Phase::Moved);
}

#[cfg_attr(kani, kani::proof)]
#[cfg_attr(kani, kani::unwind(4))]
pub fn grounding_keeps_the_state_valid() {
    given!(model);
    let before = any_fleet(&model, Phase::Moved);
    let mut after = before;
    let uav = any_index(model.uav_count());
    let done = model.ground(&mut open(&model, &mut after), uav);
    let (old, new) = (view(&model, &before), view(&model, &after));
    kani::cover!(old.moved(0) && !new.moved(0), "a UAV stays after all");
    kani::cover!(old.returning(0) && !new.returning(0), "one on its way home");
    kani::cover!(done.is_err(), "no such UAV");
    assert!(done.is_err() == (uav == model.uav_count()));
    assert!(done.is_err() || new.grounded(uav) && !new.moved(uav));
    keeps_the_fleet_valid(&model, &before, &after, done.is_ok(), Phase::Moved);
}

#[cfg_attr(kani, kani::proof)]
#[cfg_attr(kani, kani::unwind(4))]
pub fn confirming_a_hotspot_keeps_the_state_valid() {
    given!(model);
    let before = any_fleet(&model, Phase::Moved);
    let mut after = before;
    let hotspot = any_index(model.hotspot_count());
    let done = model.confirm_hotspot(&mut open(&model, &mut after), hotspot);
    let (old, new) = (view(&model, &before), view(&model, &after));
    kani::cover!(!old.confirmed(0) && new.confirmed(0), "a confirmation");
    kani::cover!(done.is_ok() && old.confirmed(0), "confirmed before");
    kani::cover!(done.is_err(), "no such hotspot");
    assert!(done.is_err() == (hotspot == model.hotspot_count()));
    assert!(done.is_err() || new.confirmed(hotspot));
    keeps_the_fleet_valid(&model, &before, &after, done.is_ok(), Phase::Moved);
}

#[cfg_attr(kani, kani::proof)]
#[cfg_attr(kani, kani::unwind(4))]
pub fn sensing_over_detections_keeps_the_state_valid() {
    given!(model);
    let before = any_fleet(&model, Phase::Moved);
    let mut after = before;
    given!(scratch for model);
    let detections: [u8; MOST * MOST] = kani::any();
    let detections = &detections[..model.uav_count() * model.hotspot_count()];
    let done = model.step_sense_with(&mut open(&model, &mut after), &mut scratch, detections);
    let (old, new) = (view(&model, &before), view(&model, &after));
    kani::cover!(!old.confirmed(0) && new.confirmed(0), "a confirmation");
    kani::cover!(!old.knows(0, 0) && new.knows(0, 0), "a UAV learns");
    kani::cover!(
        old.grounded(0) && detections[0] != 0,
        "one on the ground does not"
    );
    assert!(done.is_ok());
    assert!(!new.detected(0, 0) || detections[0] != 0 && !old.grounded(0));
    confirms_by_quorum(&model, &old, &new);
    keeps_the_fleet_valid(&model, &before, &after, true, Phase::Sensed);
}

/// Any matrix.
#[cfg(kani)]
fn any_links(_: &Model<'_>) -> [u8; MOST * MOST] {
    kani::any()
}

/// A matrix with the same links both ways but in some cases.
#[cfg(not(kani))]
fn any_links(model: &Model<'_>) -> [u8; MOST * MOST] {
    let (uavs, lopsided): (_, bool) = (model.uav_count(), between(0, 3) == 0);
    let mut links = [0; MOST * MOST];
    for i in 0..uavs {
        for k in 0..=i {
            links[i * uavs + k] = u8::from(kani::any::<bool>());
            links[k * uavs + i] = links[i * uavs + k];
        }
    }
    if lopsided && uavs > 1 {
        links[1] ^= 1;
    }
    links
}

/// Throughputs that a host measured, now and then one that is none.
fn any_throughputs() -> [f64; MOST] {
    let mut measured = [0.0; MOST];
    for index in 0..MOST {
        measured[index] = if between(0, 9) > 0 {
            real_between(0.0, 1e9)
        } else {
            kani::any()
        };
    }
    measured
}

#[cfg_attr(kani, kani::proof)]
#[cfg_attr(kani, kani::unwind(4))]
#[cfg_attr(
    kani,
    kani::stub(
        crate::rules::graph::measure_throughput,
        crate::proofs::stubs::any_measured_throughput
    )
)]
pub fn communicating_over_links_keeps_the_state_valid() {
    given!(model);
    let before = any_fleet(&model, Phase::Sensed);
    let mut after = before;
    given!(scratch for model);
    let (links, uavs) = (any_links(&model), model.uav_count());
    let links = &links[..uavs * uavs];
    let mut state = open(&model, &mut after);
    let done = model.step_communicate_with(&mut state, &mut scratch, links, None);
    let new = view(&model, &after);
    kani::cover!(done.is_ok() && uavs > 1 && new.linked(0, 1), "a link");
    kani::cover!(done.is_err(), "a link one way");
    keeps_the_fleet_valid(&model, &before, &after, done.is_ok(), Phase::Communicated);
}

#[cfg_attr(kani, kani::proof)]
#[cfg_attr(kani, kani::unwind(4))]
pub fn communicating_over_measured_links_keeps_the_state_valid() {
    given!(model);
    let before = any_fleet(&model, Phase::Sensed);
    let mut after = before;
    given!(scratch for model);
    let (links, measured) = (any_links(&model), any_throughputs());
    let uavs = model.uav_count();
    let (links, measured) = (&links[..uavs * uavs], Some(&measured[..uavs]));
    let mut state = open(&model, &mut after);
    let done = model.step_communicate_with(&mut state, &mut scratch, links, measured);
    let new = view(&model, &after);
    kani::cover!(done.is_ok() && new.throughput(0) > 0.0, "a throughput");
    kani::cover!(done.is_err(), "a link one way or a throughput that is none");
    keeps_the_fleet_valid(&model, &before, &after, done.is_ok(), Phase::Communicated);
}

#[cfg_attr(kani, kani::proof)]
#[cfg_attr(kani, kani::unwind(13))]
#[cfg_attr(
    kani,
    kani::stub(crate::rules::potential::update, crate::proofs::stubs::any_potentials)
)]
pub fn setting_hotspots_keeps_the_state_valid() {
    given!(model);
    let before = any_state(&model, Phase::Ready);
    let mut after = before;
    given!(scratch for model);
    let cells = any_cells();
    let cells = &cells[..model.hotspot_count()];
    let done = model.set_hotspots(&mut open(&model, &mut after), &mut scratch, cells);
    let t = view(&model, &before).t();
    kani::cover!(done.is_ok(), "hotspots are set");
    kani::cover!(done.is_err() && t == 0, "a cell that is none for a hotspot");
    kani::cover!(done.is_err() && t > 0, "after the start");
    keeps_the_state_valid(&model, &before, &after, done.is_ok());
}

#[cfg_attr(kani, kani::proof)]
#[cfg_attr(kani, kani::unwind(13))]
#[cfg_attr(
    kani,
    kani::stub(crate::rules::potential::update, crate::proofs::stubs::any_potentials)
)]
pub fn moving_a_hotspot_keeps_the_state_valid() {
    given!(model);
    let before = any_state(&model, Phase::Ready);
    let mut after = before;
    given!(scratch for model);
    let (hotspot, cell) = (any_index(model.hotspot_count()), any_cell());
    let mut state = open(&model, &mut after);
    let done = model.move_hotspot(&mut state, &mut scratch, hotspot, cell);
    let old = view(&model, &before);
    kani::cover!(done.is_ok() && old.t() > 0, "moved during a mission");
    kani::cover!(done.is_ok() && old.confirmed(0), "a confirmed hotspot");
    kani::cover!(
        done.is_err() && hotspot == 0,
        "a cell that is none for a hotspot"
    );
    keeps_the_state_valid(&model, &before, &after, done.is_ok());
}

#[cfg_attr(kani, kani::proof)]
#[cfg_attr(kani, kani::unwind(13))]
#[cfg_attr(
    kani,
    kani::stub(crate::rules::graph::build_graph, crate::proofs::stubs::any_graph)
)]
#[cfg_attr(
    kani,
    kani::stub(crate::rules::potential::update, crate::proofs::stubs::any_potentials)
)]
pub fn setting_starts_keeps_the_state_valid() {
    given!(model);
    let before = any_state(&model, Phase::Ready);
    let mut after = before;
    given!(scratch for model);
    let cells = any_cells();
    let cells = &cells[..model.uav_count()];
    let done = model.set_starts(&mut open(&model, &mut after), &mut scratch, cells);
    let (old, new) = (view(&model, &before), view(&model, &after));
    kani::cover!(done.is_ok() && old.cell(0) != new.cell(0), "another start");
    kani::cover!(done.is_err() && old.t() == 0, "a cell off the grid");
    kani::cover!(done.is_err() && old.t() > 0, "after the start");
    keeps_the_state_valid(&model, &before, &after, done.is_ok());
}

/// Any charge, and one more than the battery holds.
fn any_charge(model: &Model<'_>) -> u64 {
    between(0, model.energy().capacity_uj + 1)
}

#[cfg_attr(kani, kani::proof)]
#[cfg_attr(kani, kani::unwind(13))]
#[cfg_attr(
    kani,
    kani::stub(crate::rules::graph::build_graph, crate::proofs::stubs::any_graph)
)]
#[cfg_attr(
    kani,
    kani::stub(crate::rules::potential::update, crate::proofs::stubs::any_potentials)
)]
pub fn setting_a_battery_keeps_the_state_valid() {
    given!(model);
    let before = any_state(&model, Phase::Ready);
    let mut after = before;
    given!(scratch for model);
    let (uav, charge) = (any_index(model.uav_count()), any_charge(&model));
    let mut state = open(&model, &mut after);
    let done = model.set_battery(&mut state, &mut scratch, uav, charge);
    let (old, new) = (view(&model, &before), view(&model, &after));
    kani::cover!(done.is_ok() && old.t() > 0, "during a mission");
    kani::cover!(!old.grounded(0) && new.grounded(0), "emptied at the start");
    kani::cover!(done.is_err() && uav == 0, "more than the battery holds");
    assert!(done.is_err() || new.battery_uj(uav) == charge);
    keeps_the_state_valid(&model, &before, &after, done.is_ok());
}

#[cfg_attr(kani, kani::proof)]
#[cfg_attr(kani, kani::unwind(13))]
#[cfg_attr(
    kani,
    kani::stub(crate::rules::graph::build_graph, crate::proofs::stubs::any_graph)
)]
#[cfg_attr(
    kani,
    kani::stub(crate::rules::potential::update, crate::proofs::stubs::any_potentials)
)]
pub fn setting_batteries_keeps_the_state_valid() {
    given!(model);
    let before = any_state(&model, Phase::Ready);
    let mut after = before;
    given!(scratch for model);
    let mut charges = [0; MOST];
    for index in 0..MOST {
        charges[index] = any_charge(&model);
    }
    let charges = &charges[..model.uav_count()];
    let done = model.set_batteries(&mut open(&model, &mut after), &mut scratch, charges);
    let (old, new) = (view(&model, &before), view(&model, &after));
    kani::cover!(done.is_ok() && new.grounded(0), "an empty battery");
    kani::cover!(done.is_err() && old.t() == 0, "more than a battery holds");
    kani::cover!(done.is_err() && old.t() > 0, "after the start");
    assert!(done.is_err() || new.initial_uj(0) == charges[0] && new.given_uj(0) == 0);
    keeps_the_state_valid(&model, &before, &after, done.is_ok());
}

/// A battery's ledger balances: what was there, came in and was given is what is there and went
/// out.
fn balances(initial: u64, accepted: u64, given: u64, battery: u64, spent: u64) -> bool {
    let given = i128::from(given as i64);
    i128::from(initial) + i128::from(accepted) + given == i128::from(battery) + i128::from(spent)
}

/// For any entries, the host's adjustment balances the ledger over the integers, not only modulo
/// 2^64.
#[cfg_attr(kani, kani::proof)]
pub fn a_charge_set_by_a_host_balances_the_ledger() {
    let (initial, battery) = (between(0, ROOM_UJ), between(0, ROOM_UJ));
    let accepted = between(0, ROOM_UJ - initial);
    let spent = between(0, ROOM_UJ - battery);
    let given = battery
        .wrapping_add(spent)
        .wrapping_sub(initial)
        .wrapping_sub(accepted);
    assert!(balances(initial, accepted, given, battery, spent));
    let charge = between(0, ROOM_UJ - spent);
    let after = given_after(given, battery, charge);
    kani::cover!(after as i64 > given as i64, "charge is put in");
    kani::cover!((after as i64) < 0, "charge has been taken out");
    assert!(balances(initial, accepted, after, charge, spent));
}

#[cfg(not(kani))]
super::standin::twins! {
    setting_positions_keeps_the_state_valid: 2000 cases, 2 covers;
    grounding_keeps_the_state_valid: 2000 cases, 3 covers;
    confirming_a_hotspot_keeps_the_state_valid: 2000 cases, 3 covers;
    sensing_over_detections_keeps_the_state_valid: 2000 cases, 3 covers;
    communicating_over_links_keeps_the_state_valid: 2000 cases, 2 covers;
    communicating_over_measured_links_keeps_the_state_valid: 2000 cases, 2 covers;
    setting_hotspots_keeps_the_state_valid: 2000 cases, 3 covers;
    moving_a_hotspot_keeps_the_state_valid: 2000 cases, 3 covers;
    setting_starts_keeps_the_state_valid: 2000 cases, 3 covers;
    setting_a_battery_keeps_the_state_valid: 2000 cases, 3 covers;
    setting_batteries_keeps_the_state_valid: 2000 cases, 3 covers;
    a_charge_set_by_a_host_balances_the_ledger: 4000 cases, 2 covers;
}
