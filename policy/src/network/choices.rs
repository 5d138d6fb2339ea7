//! Sequential choices: a UAV reads what its neighbours with lower indices have chosen.

use jcas_core::action::motion;

use super::row::{HOTSPOT_FIELDS, OWN_FIRST, RowLayout, SLOT_FIELDS};

/// The first field of the slot of a neighbour that has chosen. It is 1 before the choice, and 0 in
/// an empty slot.
pub(super) const CHOSEN: f32 = 2.0;

/// Returns the change of a position by a motion of `by` cells, which is 0 at the edge of the grid.
fn change(position: f32, by: i32, cells: f32) -> f32 {
    let to = position * cells + by as f32;
    if by == 0 || to < -0.5 || to > cells + 0.5 {
        0.0
    } else {
        by as f32 / cells
    }
}

/// Copies the observation of a UAV to `row` and adds the choices of the UAVs before it.
///
/// `observations` holds a row for each UAV of an episode, and `actions` at least the (u_dir,
/// u_pilot) of the UAVs before. The slot of a neighbour that has chosen holds the cell after its
/// motion, and 2 in its first field.
///
/// # Panics
/// It panics if the slices are too short for `uav`, or if `row` is not one observation long.
pub fn read_choices(
    layout: RowLayout,
    observations: &[f32],
    actions: &[f32],
    uav: usize,
    row: &mut [f32],
) {
    let len = layout.observation_len;
    let cells = layout.cells.map(|cells| cells as f32);
    row.copy_from_slice(&observations[uav * len..][..len]);
    let (own, rest) = row.split_at_mut(OWN_FIRST + HOTSPOT_FIELDS * layout.hotspots);
    let slots = &mut rest[..SLOT_FIELDS * layout.slots];
    let before = observations.chunks_exact(len).zip(actions.chunks_exact(2));
    for (other, action) in before.take(uav) {
        let offset = [other[0] - own[0], other[1] - own[1]];
        let same =
            |slot: &[f32], axis: usize| (slot[1 + axis] - offset[axis]).abs() * cells[axis] < 0.5;
        // Equal cells are in the order of the indices, so the first that fits is the neighbour.
        let mut waiting = slots.chunks_exact_mut(SLOT_FIELDS);
        let slot = waiting.find(|slot| slot[0] == 1.0 && same(slot, 0) && same(slot, 1));
        if let Some(slot) = slot {
            let (right, up) = motion(action[0], layout.motion_map).offset();
            slot[0] = CHOSEN;
            slot[1] += change(other[0], right, cells[0]);
            slot[2] += change(other[1], up, cells[1]);
        }
    }
}

#[cfg(test)]
mod tests {
    extern crate std;
    use std::vec;
    use std::vec::Vec;

    use jcas_core::{Config, Model, Motion, MotionMap, Preset, Sim};

    use super::*;

    /// The slots of neighbours with lower indices hold the cells that a copy reaches in a step.
    #[test]
    fn a_slot_holds_the_cell_after_the_motion_of_a_neighbour() {
        let model = Model::new(Config {
            uav_count: 12,
            grid_width: 9,
            motion_map: MotionMap::Symmetric,
            ..Config::preset(Preset::Paper)
        })
        .unwrap();
        let uavs = model.uav_count();
        let len = model.observation_len();
        let layout = RowLayout::of(&model);
        let (mut sim, mut moved) = (Sim::new(&model), Sim::new(&model));
        let mut rows = vec![0.0; uavs * len];
        let mut row = vec![0.0; len];
        let mut shown = 0;
        sim.reset(5);
        for step in 0..40 {
            sim.observe(&mut rows).unwrap();
            let motion = |uav: usize| (step * 7 + uav * 3 + step * uav) % 5;
            let action = |uav: usize| [Motion::ALL[motion(uav)].to_action(layout.motion_map), 0.0];
            let actions: Vec<f32> = (0..uavs).flat_map(action).collect();
            moved.clone_from(&sim);
            moved.step(&actions).unwrap();
            for uav in 0..uavs {
                read_choices(layout, &rows, &actions, uav, &mut row);
                let own = &rows[uav * len..][..len];
                let first = OWN_FIRST + HOTSPOT_FIELDS * layout.hotspots;
                let last = first + SLOT_FIELDS * layout.slots;
                assert_eq!(row[..first], own[..first]);
                assert_eq!(row[last..], own[last..]);
                let cell = sim.state().cell(uav);
                let mut expected: Vec<(i64, i64)> = (0..uav)
                    .filter(|&other| sim.state().linked(uav, other))
                    .map(|other| {
                        let to = moved.state().cell(other);
                        let apart = |to: u32, from: u32| i64::from(to) - i64::from(from);
                        (apart(to.x, cell.x), apart(to.y, cell.y))
                    })
                    .collect();
                let chosen = row[first..last].chunks_exact(SLOT_FIELDS);
                let chosen = chosen.filter(|slot| slot[0] == CHOSEN);
                let mut got: Vec<(i64, i64)> = chosen
                    .map(|slot| {
                        let cells = |axis: usize| slot[1 + axis] * layout.cells[axis] as f32;
                        (cells(0).round() as i64, cells(1).round() as i64)
                    })
                    .collect();
                expected.sort_unstable();
                got.sort_unstable();
                assert_eq!(got, expected, "UAV {uav}, step {step}");
                shown += got.len();
            }
            if sim.step(&actions).unwrap().terminated {
                break;
            }
        }
        assert!(shown > 100, "{shown}");
    }
}
