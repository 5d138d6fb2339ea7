//! Actions of UAVs: a motion and a pilot density.

use crate::config::MotionMap;
use crate::error::Error;
use crate::lanes::{self, Block, Lanes, at_width, ones};
use crate::model::Model;
use crate::rules::motion;
use crate::state::StateMut;
use crate::words::word::canonical_bits;

/// One of the five motions.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Motion {
    /// +y
    Up = 0,
    /// -y
    Down = 1,
    /// -x
    Left = 2,
    /// +x
    Right = 3,
    /// The UAV stays in its cell.
    Stay = 4,
}

impl Motion {
    /// All motions, in the order of their indices.
    pub const ALL: [Self; 5] = [Self::Up, Self::Down, Self::Left, Self::Right, Self::Stay];

    /// The offset (Δx, Δy) of the motion, in cells.
    #[inline(always)]
    #[must_use]
    pub const fn offset(self) -> (i32, i32) {
        match self {
            Self::Up => (0, 1),
            Self::Down => (0, -1),
            Self::Left => (-1, 0),
            Self::Right => (1, 0),
            Self::Stay => (0, 0),
        }
    }

    /// The index of the motion's bin, from 0 to 4.
    #[inline(always)]
    #[must_use]
    pub const fn bin(self, map: MotionMap) -> usize {
        match map {
            MotionMap::Udlrs => self as usize,
            MotionMap::Symmetric => match self {
                Self::Up => 0,
                Self::Left => 1,
                Self::Stay => 2,
                Self::Right => 3,
                Self::Down => 4,
            },
        }
    }

    /// The action component u_dir for this motion: the centre of its bin in [-1, 1].
    #[must_use]
    pub const fn to_action(self, map: MotionMap) -> f32 {
        const CENTRES: [f32; 5] = [-0.8, -0.4, 0.0, 0.4, 0.8];
        CENTRES[self.bin(map)]
    }
}

/// Clips a value to [-1, 1]. NaN becomes -1, but callers refuse NaN before.
// Proof: proofs/action.rs, clip_is_total
#[inline(always)]
#[must_use]
pub fn clip(value: f32) -> f32 {
    if value >= 1.0 {
        1.0
    } else if value >= -1.0 {
        value
    } else {
        -1.0
    }
}

/// The motion whose bin has the index k = min(4, floor((u + 1)/2 · 5)), for `u_dir` clipped to
/// [-1, 1].
#[inline(always)]
#[must_use]
pub fn motion(u_dir: f32, map: MotionMap) -> Motion {
    match Bins::of(map).direction(u_dir) {
        (0, 1) => Motion::Up,
        (0, -1) => Motion::Down,
        (-1, 0) => Motion::Left,
        (1, 0) => Motion::Right,
        _ => Motion::Stay,
    }
}

/// The bins that depend on the map, by their bounds on the scale from 0 to 5. Up always has the
/// first bin and right the fourth.
#[derive(Clone, Copy)]
struct Bins {
    down: (f64, f64),
    left: (f64, f64),
}

impl Bins {
    #[inline(always)]
    const fn of(map: MotionMap) -> Self {
        match map {
            MotionMap::Udlrs => Self {
                down: (1.0, 2.0),
                left: (2.0, 3.0),
            },
            // u_dir = 1 belongs to the last bin.
            MotionMap::Symmetric => Self {
                down: (4.0, 6.0),
                left: (1.0, 2.0),
            },
        }
    }

    /// The offset (Δx, Δy) of [`motion`], computed without a branch.
    #[inline(always)]
    fn direction(self, u_dir: f32) -> (i32, i32) {
        // Halving is exact, so (u + 1)/2 · 5 = (u + 1) · 2.5 with one rounding.
        let bin = (f64::from(clip(u_dir)) + 1.0) * 2.5;
        let down = bin >= self.down.0 && bin < self.down.1;
        let left = bin >= self.left.0 && bin < self.left.1;
        let up = i32::from(bin < 1.0) - i32::from(down);
        let right = i32::from(bin >= 3.0 && bin < 4.0) - i32::from(left);
        (right, up)
    }
}

/// The pilot density ρ = ρ_min + (u + 1)/2 · (ρ_max - ρ_min), for `u_pilot` clipped to [-1, 1]. The
/// result is clipped to [ρ_min, ρ_max].
// Proof: proofs/action.rs, pilot_density_stays_in_range
#[inline(always)]
#[must_use]
pub fn pilot_density(u_pilot: f32, min: f64, max: f64) -> f64 {
    let density = min + (f64::from(clip(u_pilot)) + 1.0) * 0.5 * (max - min);
    if density > max {
        max
    } else if density >= min {
        density
    } else {
        min
    }
}

/// [`pilot_density`] of each lane of a block, as bits of f64.
// Proof: proofs/fleet.rs, a_blocks_pilot_densities_stay_in_range
#[inline(always)]
pub(crate) fn densities<const W: usize>(
    u_pilot: &Lanes<f32, W>,
    min: f64,
    max: f64,
) -> Lanes<u64, W> {
    let mut pilot = [0; W];
    for lane in 0..W {
        pilot[lane] = canonical_bits(pilot_density(u_pilot[lane], min, max));
    }
    pilot
}

/// Applies every UAV's action: its pilot density, then its motion. A UAV with an empty battery
/// stays, and one with a low battery moves toward a depot.
// Proof: proofs/step.rs, beginning_a_step_keeps_the_state_valid
#[inline(always)]
pub(crate) fn act(model: &Model<'_>, state: &mut StateMut<'_>, actions: &[f32]) {
    at_width!(model, act_in_blocks(model, state, actions));
}

#[inline(always)]
fn act_in_blocks<const W: usize>(model: &Model<'_>, state: &mut StateMut<'_>, actions: &[f32]) {
    for block in lanes::blocks::<W>(model.uav_count()) {
        act_in(model, state, block, actions);
    }
}

#[inline(always)]
fn act_in<const W: usize>(
    model: &Model<'_>,
    state: &mut StateMut<'_>,
    block: Block<W>,
    actions: &[f32],
) {
    let config = model.config();
    let (low, high) = (config.pilot_density_min, config.pilot_density_max);
    let bins = Bins::of(config.motion_map);
    let (mut u_dir, mut u_pilot) = ([0.0; W], [0.0; W]);
    let pairs = actions[2 * block.first..].chunks_exact(2);
    for (lane, pair) in block.lanes().zip(pairs) {
        (u_dir[lane], u_pilot[lane]) = (pair[0], pair[1]);
    }
    lanes::force_vector(&mut u_dir);
    lanes::force_vector(&mut u_pilot);
    let battery = block.load(state.battery);
    let pilot = densities(&u_pilot, low, high);
    let (mut grounded, mut returning) = ([0; W], [0; W]);
    for lane in 0..W {
        grounded[lane] = ones(battery[lane] == 0);
        returning[lane] = ones(battery[lane] < model.energy().rtb_uj) & !grounded[lane];
    }
    block.store(&pilot, state.pilot);
    block.put_bits(lanes::gather_bits(&grounded), state.grounded);
    let home = lanes::gather_bits(&returning) & block.mask();
    block.put_bits(home, state.returning);

    let mut offsets = [(0, 0); W];
    for lane in 0..W {
        let (right, up) = bins.direction(u_dir[lane]);
        let flies = !(grounded[lane] as i32);
        offsets[lane] = (right & flies, up & flies);
    }
    motion::fly(model, state, block, &offsets);
    motion::fly_home(model, state, block.first, block.uavs_in(home));
}

/// The action component that asks for a pilot density; the inverse of [`pilot_density`].
#[must_use]
pub fn pilot_action(density: f64, min: f64, max: f64) -> f32 {
    if max > min {
        clip(((density - min) / (max - min) * 2.0 - 1.0) as f32)
    } else {
        -1.0
    }
}

/// Refuses actions that contain NaN.
///
/// # Errors
/// [`Error::ActionNan`] with the position of the first NaN.
#[inline(always)]
pub fn refuse_nan(actions: &[f32]) -> Result<(), Error> {
    // A loop over all values without an early exit compiles to a few vector instructions.
    let mut any = false;
    for value in actions {
        any |= value.is_nan();
    }
    if any {
        let index = actions.iter().position(|value| value.is_nan()).unwrap_or(0);
        return Err(Error::ActionNan {
            uav: index / 2,
            component: index % 2,
        });
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn five_equal_bins() {
        use Motion::{Down, Left, Right, Stay, Up};
        let orders = [
            (MotionMap::Udlrs, [Up, Down, Left, Right, Stay]),
            (MotionMap::Symmetric, [Up, Left, Stay, Right, Down]),
        ];
        for (map, order) in orders {
            for (bin, expected) in order.into_iter().enumerate() {
                assert_eq!(expected.bin(map), bin);
                assert_eq!(motion(expected.to_action(map), map), expected);
            }
            assert_eq!(motion(-1.0, map), order[0]);
            assert_eq!(motion(-0.6, map), order[0]); // the f32 nearest to -0.6 lies below it
            assert_eq!(motion(-0.599_999_9, map), order[1]);
            assert_eq!(motion(1.0, map), order[4]);
            assert_eq!(motion(f32::INFINITY, map), order[4]);
            assert_eq!(motion(f32::NEG_INFINITY, map), order[0]);
        }
    }

    #[test]
    fn pilot_density_spans_its_range() {
        assert_eq!(pilot_density(-1.0, 0.01, 0.30), 0.01);
        assert_eq!(pilot_density(1.0, 0.01, 0.30), 0.30);
        assert!((pilot_density(0.0, 0.01, 0.30) - 0.155).abs() < 1e-15);
        assert_eq!(pilot_density(9.0, 0.01, 0.30), 0.30);
    }
}
