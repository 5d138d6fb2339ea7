//! `random` and `untrained`: baselines that read nothing but draw their actions.

use jcas_core::rng::{self, Purpose};
use jcas_core::{Model, Motion, MotionMap, StateRef};

use super::memory::OutOfMemory;
use super::steering::Steering;
use crate::head::{Draw, Head};

/// The policy `random`, a pure random walk: each UAV takes each of the five motions with equal
/// probability, also when all hotspots are confirmed. Its draws are a function of the episode's
/// seed, the step and the UAV. They have a purpose of their own, so they share no draw with the
/// kernel.
#[derive(Clone, Copy, Debug, Default)]
pub struct Random;

impl Steering for Random {
    fn steer(
        &mut self,
        _model: &Model<'_>,
        state: &StateRef<'_>,
        motions: &mut [Motion],
    ) -> Result<(), OutOfMemory> {
        for (uav, motion) in motions.iter_mut().enumerate() {
            let bits = rng::bits64(state.seed(), state.t(), uav as u32, 0, Purpose::Policy);
            *motion = Motion::ALL[rng::below(bits, 5) as usize];
        }
        Ok(())
    }
}

/// The policy `untrained`: a network with a Gaussian head before its training, whose weights are
/// all zero.
///
/// Both components of an action are draws of N(0, 1), clipped to [-1, 1]. Of the five bins of u_dir
/// the first and the last thus have a probability of 0.274 each, and those between about 0.15.
#[derive(Clone, Copy, Debug, Default)]
pub struct Untrained;

impl Untrained {
    /// The action (u_dir, u_pilot) of a UAV.
    pub(super) fn action(state: &StateRef<'_>, uav: usize) -> [f32; 2] {
        let draw = Draw {
            seed: state.seed(),
            t: state.t(),
            uav: uav as u32,
        };
        // The order of motions is of no account: u_dir itself is drawn.
        Head::Gaussian.sample(&[0.0; 4], MotionMap::default(), draw)
    }
}
