//! The way back: where a sequential policy draws a motion.
//!
//! A network reads no more than the present state. Its most likely motions could take a fleet that
//! is undecided between two hotspots to and fro between two cells for ever.

use jcas_core::action::motion;
use jcas_core::{MotionMap, StateRef};

/// Returns whether an action takes a UAV back to its cell before the last step, and no new
/// confirmation permits that.
///
/// A confirmation in that step of a hotspot that the UAV knows permits the reversal. A UAV that
/// hovered in that step does not reverse.
pub fn turns_round(state: &StateRef<'_>, uav: usize, direction: f32, map: MotionMap) -> bool {
    let confirmed_now = |j: usize| state.knows(uav, j) && state.confirmed_at(j) == Some(state.t());
    let (here, before) = (state.cell(uav), state.previous_cell(uav));
    let apart = |to: u32, from: u32| to as i32 - from as i32;
    let back = (apart(before.x, here.x), apart(before.y, here.y));
    let turns = motion(direction, map).offset() == back;
    state.moved(uav) && turns && !(0..state.hotspot_count()).any(confirmed_now)
}

#[cfg(test)]
mod tests {
    use jcas_core::{Cell, Config, Model, Motion, MotionMap, Preset, Sim};

    use super::*;

    const MAP: MotionMap = MotionMap::Symmetric;

    // Ten UAVs fly up from the depot to a hotspot, and one far away flies up as well. Unless the
    // ten confirm it at once, they stay over it and then fly to the right.
    #[test]
    fn a_uav_may_turn_back_after_rest_and_after_a_confirmation_that_it_knows() {
        let model = Model::new(Config {
            uav_count: 11,
            hotspot_count: 1,
            link_throughput_min: 4.0,
            motion_map: MAP,
            ..Config::preset(Preset::Mission)
        })
        .unwrap();
        let mut sim = Sim::new(&model);
        let (mut found, mut missed) = (0, 0);
        for seed in 0..20 {
            sim.reset(seed);
            sim.set_hotspots(&[Cell { x: 6, y: 7 }]).unwrap();
            let mut cells = [Cell { x: 6, y: 6 }; 11];
            cells[10] = Cell { x: 0, y: 0 };
            sim.set_starts(&cells).unwrap();
            // The ways back of a near UAV and of the far one, and whether the near one knows.
            let mut back_after = |motion: Motion| {
                let action = [motion.to_action(MAP), 1.0];
                sim.step([action; 11].as_flattened()).unwrap();
                let state = sim.state();
                assert!(!state.knows(10, 0));
                let back = |uav: usize| {
                    let turns =
                        |motion: &Motion| turns_round(&state, uav, motion.to_action(MAP), MAP);
                    Motion::ALL.into_iter().find(turns)
                };
                (back(0), back(10), state.knows(0, 0))
            };
            let (near, far, found_at_once) = back_after(Motion::Up);
            assert_eq!(far, Some(Motion::Down));
            if found_at_once {
                found += 1;
                assert_eq!(near, None);
                continue;
            }
            missed += 1;
            assert_eq!(near, Some(Motion::Down));
            let (near, far, found_later) = back_after(Motion::Stay);
            assert_eq!((near, far), (None, None));
            if !found_later {
                let (_, far, _) = back_after(Motion::Right);
                assert_eq!(far, Some(Motion::Left));
            }
        }
        assert!(found > 0 && missed > 0, "{found} {missed}");
    }
}
