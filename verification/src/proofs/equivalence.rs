//! X2: where the kernel and the specification decide by real numbers, they decide alike.

#[cfg(not(kani))]
use super::standin as kani;
use crate::specification;
use jcas_core::{Cell, MotionMap, action, motion};

/// An action means the same motion to both, seen from the middle of a grid.
fn moves_alike(u_dir: f32, map: MotionMap) {
    let from = Cell { x: 1, y: 1 };
    let to = motion::destination(from, action::motion(u_dir, map), 3, 3);
    let (dx, dy) = specification::motion(u_dir, map);
    assert!(i64::from(to.x) == 1 + dx && i64::from(to.y) == 1 + dy);
}

#[cfg_attr(kani, kani::proof)]
pub fn an_action_means_the_motion_of_the_specification() {
    let u_dir: f32 = kani::any();
    let symmetric: bool = kani::any();
    kani::assume(!u_dir.is_nan());
    kani::cover!(u_dir == 1.0, "the last bin's end");
    kani::cover!(u_dir > -0.61 && u_dir < -0.59, "between two bins");
    kani::cover!(symmetric, "the symmetric order");
    let map = if symmetric {
        MotionMap::Symmetric
    } else {
        MotionMap::Udlrs
    };
    moves_alike(u_dir, map);
}

#[cfg(not(kani))]
super::standin::twins! {
    an_action_means_the_motion_of_the_specification: 4000 cases, 3 covers;
}

#[cfg(test)]
mod dense {
    use jcas_core::MotionMap;

    /// Every f32 within 2000 steps of each edge of a bin.
    #[test]
    fn edges_of_bins_are_alike() {
        for edge in [-1.0f32, -0.6, -0.2, 0.2, 0.6, 1.0] {
            for step in -2000..=2000 {
                let u_dir = f32::from_bits(edge.to_bits().wrapping_add_signed(step));
                for &map in MotionMap::ALL {
                    super::moves_alike(u_dir, map);
                }
            }
        }
    }
}
