//! P5: a position stays on the grid.

use super::inputs::between;
#[cfg(not(kani))]
use super::standin as kani;
use crate::config::Cell;
use crate::rules::action::Motion;
use crate::rules::motion::{destination, toward};

/// Longest side of a legal grid.
const SIDE_MAX: u64 = 1024;

fn any_cell(width: u32, height: u32) -> Cell {
    Cell {
        x: between(0, u64::from(width) - 1) as u32,
        y: between(0, u64::from(height) - 1) as u32,
    }
}

fn any_motion() -> Motion {
    Motion::ALL[between(0, 4) as usize]
}

/// A motion ends on the grid, at most one cell away.
fn ends_on_the_grid(from: Cell, motion: Motion, width: u32, height: u32) {
    let to = destination(from, motion, width, height);
    assert!(to.x < width && to.y < height);
    assert!(from.manhattan(to) <= 1);
}

#[cfg_attr(kani, kani::proof)]
pub fn every_motion_ends_on_the_grid() {
    let width = between(1, SIDE_MAX) as u32;
    let height = between(1, SIDE_MAX) as u32;
    let from = any_cell(width, height);
    let motion = any_motion();
    let to = destination(from, motion, width, height);
    kani::cover!(
        to.x + 1 == width && to.x != from.x,
        "reaches the last column"
    );
    kani::cover!(
        motion as u32 == 1 && from.y == 0,
        "held back at the first row"
    );
    kani::cover!(width == 1 && height == 1, "a grid of one cell");
    ends_on_the_grid(from, motion, width, height);
}

/// Flying home brings a UAV one cell nearer each step, on the grid, and stays there.
fn nears_its_depot(from: Cell, depot: Cell, width: u32, height: u32) {
    let to = destination(from, toward(from, depot), width, height);
    let before = from.manhattan(depot);
    let after = to.manhattan(depot);
    assert!(to.x < width && to.y < height);
    assert!(after == before.saturating_sub(1));
}

#[cfg_attr(kani, kani::proof)]
pub fn returning_nears_the_depot() {
    let width = between(1, SIDE_MAX) as u32;
    let height = between(1, SIDE_MAX) as u32;
    let from = any_cell(width, height);
    let depot = any_cell(width, height);
    kani::cover!(from.x == depot.x && from.y == depot.y, "already there");
    kani::cover!(from.x != depot.x && from.y != depot.y, "a corner to fly");
    nears_its_depot(from, depot, width, height);
}

#[cfg(not(kani))]
super::standin::twins! {
    every_motion_ends_on_the_grid: 4000 cases, 3 covers;
    returning_nears_the_depot: 2000 cases, 2 covers;
}
