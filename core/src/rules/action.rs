//! Actions of UAVs: a motion and a pilot density.

use crate::error::Error;
use crate::lanes::{self, Block, Lanes, at_width, ones};
use crate::model::Model;
use crate::rules::motion;
use crate::state::StateMut;
use crate::words::word::canonical_bits;

/// One of the five motions, in the order of the action's bins.
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
    /// All motions, in the order of the bins.
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

    /// The action component for this motion: the centre of its bin in [-1, 1].
    #[must_use]
    pub const fn to_action(self) -> f32 {
        match self {
            Self::Up => -0.8,
            Self::Down => -0.4,
            Self::Left => 0.0,
            Self::Right => 0.4,
            Self::Stay => 0.8,
        }
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

/// The motion with index k = min(4, floor((u + 1)/2 · 5)) in [`Motion::ALL`], for `u_dir` clipped
/// to [-1, 1].
#[inline(always)]
#[must_use]
pub fn motion(u_dir: f32) -> Motion {
    match direction(u_dir) {
        (0, 1) => Motion::Up,
        (0, -1) => Motion::Down,
        (-1, 0) => Motion::Left,
        (1, 0) => Motion::Right,
        _ => Motion::Stay,
    }
}

/// The offset (Δx, Δy) of [`motion`], computed without a branch.
#[inline(always)]
fn direction(u_dir: f32) -> (i32, i32) {
    // Halving is exact, so (u + 1)/2 · 5 = (u + 1) · 2.5 with one rounding.
    let bin = (f64::from(clip(u_dir)) + 1.0) * 2.5;
    let up = i32::from(bin < 1.0) - i32::from(bin >= 1.0 && bin < 2.0);
    let right = i32::from(bin >= 3.0 && bin < 4.0) - i32::from(bin >= 2.0 && bin < 3.0);
    (right, up)
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
        let (right, up) = direction(u_dir[lane]);
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
        for motion_of in Motion::ALL {
            assert_eq!(motion(motion_of.to_action()), motion_of);
        }
        assert_eq!(motion(-1.0), Motion::Up);
        assert_eq!(motion(-0.6), Motion::Up); // the f32 nearest to -0.6 lies below it
        assert_eq!(motion(-0.599_999_9), Motion::Down);
        assert_eq!(motion(1.0), Motion::Stay);
        assert_eq!(motion(f32::INFINITY), Motion::Stay);
        assert_eq!(motion(f32::NEG_INFINITY), Motion::Up);
    }

    #[test]
    fn pilot_density_spans_its_range() {
        assert_eq!(pilot_density(-1.0, 0.01, 0.30), 0.01);
        assert_eq!(pilot_density(1.0, 0.01, 0.30), 0.30);
        assert!((pilot_density(0.0, 0.01, 0.30) - 0.155).abs() < 1e-15);
        assert_eq!(pilot_density(9.0, 0.01, 0.30), 0.30);
    }
}
