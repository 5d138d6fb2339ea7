//! Compares a state of the kernel with the specification's world.
//!
//! Integers, sets and flags have to be equal. Reals may differ by rounding, because the two sides
//! arrange the formulas differently. The tolerance is 1e-12, relative above one and absolute below
//! it, because differences of potentials cancel.

use crate::specification::{Position, Specification, World};
use jcas_core::{Cell, QuorumWindow, StateRef};

/// The text that describes the first difference.
pub type Outcome = Result<(), String>;

/// Compares every quantity of the state.
pub fn states(spec: &Specification, world: &World, state: &StateRef<'_>) -> Outcome {
    equal("t", world.t, state.t())?;
    equal("terminated", world.terminated, state.terminated())?;
    equal("truncated", world.truncated, state.truncated())?;
    for i in 0..world.position.len() {
        uav(world, state, i).map_err(|why| format!("UAV {i}: {why}"))?;
    }
    for j in 0..world.hotspot.len() {
        hotspot(world, state, j).map_err(|why| format!("hotspot {j}: {why}"))?;
    }
    for (y, row) in world.visited.iter().enumerate() {
        for (x, &visited) in row.iter().enumerate() {
            let index = y * spec.config.grid_width as usize + x;
            equal(
                format_args!("visited({x}, {y})"),
                visited,
                state.visited(index),
            )?;
            for i in 0..world.position.len() {
                equal(
                    format_args!("searched({x}, {y}) of UAV {i}"),
                    world.searched[i][y][x],
                    state.searched(i, index),
                )?;
            }
        }
    }
    equal(
        "coming intensity",
        world.coming_intensity_mg_per_kwh,
        state.carbon_intensity_mg_per_kwh(),
    )?;
    equal(
        "billed intensity",
        world.billed_intensity_mg_per_kwh,
        state.billed_intensity_mg_per_kwh(),
    )?;
    equal("grid_uj", world.grid_uj, state.grid_uj())?;
    equal("co2_ng", world.co2_ng, state.co2_ng())?;
    real(
        "mean throughput",
        world.mean_throughput,
        state.mean_throughput(),
    )?;
    let names = jcas_core::reward::NAMES;
    let terms = world.rewards.terms();
    for (index, (&ours, theirs)) in terms.iter().zip(state.rewards()).enumerate() {
        real(format_args!("reward {}", names[index]), ours, theirs)?;
    }
    alarms(spec, world, state)?;
    memory(spec, world, state)?;
    reports(spec, world, state)?;
    for (i, own) in world.uav_rewards.iter().enumerate() {
        for (index, (ours, theirs)) in own
            .terms()
            .into_iter()
            .zip(state.uav_rewards(i))
            .enumerate()
        {
            real(
                format_args!("reward {} of UAV {i}", names[index]),
                ours,
                theirs,
            )?;
        }
    }
    Ok(())
}

/// Compares false alarms and false confirmations.
fn alarms(spec: &Specification, world: &World, state: &StateRef<'_>) -> Outcome {
    let index = |cell: Position| (cell.y * i64::from(spec.config.grid_width) + cell.x) as usize;
    for (i, ours) in world.false_alarms.iter().enumerate() {
        let ours: Vec<usize> = ours.iter().copied().map(index).collect();
        let theirs: Vec<usize> = state.false_alarms_of(i).collect();
        equal(format_args!("false alarms of UAV {i}"), ours, theirs)?;
    }
    for (y, row) in world.falsely_confirmed.iter().enumerate() {
        for (x, &ours) in row.iter().enumerate() {
            let theirs = state.falsely_confirmed(y * spec.config.grid_width as usize + x);
            equal(
                format_args!("false confirmation of ({x}, {y})"),
                ours,
                theirs,
            )?;
        }
    }
    let theirs = state.new_false_confirmations();
    equal("new false confirmations", world.newly_false, theirs)
}

/// Compares the detections that UAVs remember, where the quorum counts them.
fn memory(spec: &Specification, world: &World, state: &StateRef<'_>) -> Outcome {
    let counts = spec.config.quorum_window == QuorumWindow::Episode;
    for (i, kept) in world.remembered.iter().enumerate() {
        for (j, &ours) in kept.iter().enumerate() {
            let theirs = state.remembered(i, j);
            equal(
                format_args!("UAV {i} remembers {j}"),
                ours && counts,
                theirs,
            )?;
        }
    }
    Ok(())
}

/// Compares sightings and reports.
fn reports(spec: &Specification, world: &World, state: &StateRef<'_>) -> Outcome {
    for (i, rows) in world.sightings.iter().enumerate() {
        for (y, row) in rows.iter().enumerate() {
            for (x, &sightings) in row.iter().enumerate() {
                let index = y * spec.config.grid_width as usize + x;
                equal(
                    format_args!("sightings at ({x}, {y}) of UAV {i}"),
                    spec.report_level(sightings),
                    state.sighting_level(i, index),
                )?;
                equal(
                    format_args!("report of ({x}, {y}) of UAV {i}"),
                    world.reported[i][y][x],
                    state.report_level(i, index),
                )?;
            }
        }
    }
    Ok(())
}

fn uav(world: &World, state: &StateRef<'_>, i: usize) -> Outcome {
    equal("cell", cell(world.position[i]), state.cell(i))?;
    equal("initial_uj", world.initial_uj[i], state.initial_uj(i))?;
    equal("battery_uj", world.battery_uj[i], state.battery_uj(i))?;
    equal("spent_uj", world.spent_uj[i], state.spent_uj(i))?;
    equal("accepted_uj", world.accepted_uj[i], state.accepted_uj(i))?;
    equal("given_uj", world.given_uj[i], state.given_uj(i))?;
    equal("shortfall_uj", world.shortfall_uj[i], state.shortfall_uj(i))?;
    real("pilot density", world.pilot[i], state.pilot_density(i))?;
    real("throughput", world.throughput[i], state.throughput(i))?;
    equal("grounded", world.grounded[i], state.grounded(i))?;
    equal("returning", world.returning[i], state.returning(i))?;
    equal("moved", world.moved[i], state.moved(i))?;
    for k in 0..world.linked.len() {
        equal(
            format_args!("link to {k}"),
            world.linked[i][k],
            state.linked(i, k),
        )?;
    }
    for j in 0..world.hotspot.len() {
        equal(
            format_args!("knows {j}"),
            world.knows[i][j],
            state.knows(i, j),
        )?;
        let (ours, theirs) = (world.detected[i][j], state.detected(i, j));
        equal(format_args!("detected {j}"), ours, theirs)?;
    }
    Ok(())
}

fn hotspot(world: &World, state: &StateRef<'_>, j: usize) -> Outcome {
    equal("cell", cell(world.hotspot[j]), state.hotspot_cell(j))?;
    equal(
        "confirmed",
        world.confirmed_at[j].is_some(),
        state.confirmed(j),
    )?;
    equal(
        "informed",
        world.informed_at[j].is_some(),
        state.informed(j),
    )?;
    equal("detected at", world.confirmed_at[j], state.confirmed_at(j))?;
    equal("informed at", world.informed_at[j], state.informed_at(j))
}

fn cell(position: crate::specification::Position) -> Cell {
    Cell {
        x: position.x as u32,
        y: position.y as u32,
    }
}

/// Compares two observations, which must be equal to within one unit in the last place.
pub fn observations(what: impl core::fmt::Display, ours: &[f32], theirs: &[f32]) -> Outcome {
    equal(format_args!("length of {what}"), ours.len(), theirs.len())?;
    for (index, (&a, &b)) in ours.iter().zip(theirs).enumerate() {
        if (ordinal(a) - ordinal(b)).abs() > 1 {
            return Err(format!(
                "{what}[{index}]: specification {a:?}, kernel {b:?}"
            ));
        }
    }
    Ok(())
}

/// Returns the rank of a number among all `f32`; both zeros have the same rank.
fn ordinal(x: f32) -> i64 {
    let magnitude = i64::from(x.to_bits() & 0x7FFF_FFFF);
    if x.is_sign_negative() {
        -magnitude
    } else {
        magnitude
    }
}

/// Compares two reals.
pub fn real(what: impl core::fmt::Display, ours: f64, theirs: f64) -> Outcome {
    let scale = ours.abs().max(theirs.abs()).max(1.0);
    if (ours - theirs).abs() <= 1e-12 * scale {
        Ok(())
    } else {
        Err(format!("{what}: specification {ours:?}, kernel {theirs:?}"))
    }
}

/// Compares two values that must be the same.
pub fn equal<T: PartialEq + core::fmt::Debug>(
    what: impl core::fmt::Display,
    ours: T,
    theirs: T,
) -> Outcome {
    if ours == theirs {
        Ok(())
    } else {
        Err(format!("{what}: specification {ours:?}, kernel {theirs:?}"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_unit_in_the_last_place_is_equal_and_two_are_not() {
        let up = f32::from_bits(1.0f32.to_bits() + 1);
        let further = f32::from_bits(1.0f32.to_bits() + 2);
        assert!(observations("x", &[1.0, 0.0], &[up, -0.0]).is_ok());
        assert!(observations("x", &[1.0], &[further]).is_err());
        assert!(observations("x", &[1.0], &[-1.0]).is_err());
        assert!(observations("x", &[1.0], &[f32::NAN]).is_err());
        assert!(observations("x", &[1.0], &[1.0, 1.0]).is_err());
    }

    #[test]
    fn reals_beside_the_tolerance_differ() {
        assert!(real("x", 1e6, 1e6 + 1e-7).is_ok());
        assert!(real("x", 1e6, 1e6 + 1e-5).is_err());
        assert!(real("x", 0.0, 1e-11).is_err());
        assert!(real("x", 0.0, f64::NAN).is_err());
    }
}
