//! `random`: each UAV takes each of the five motions with equal probability.

use jcas_core::rng::{self, Purpose};
use jcas_core::{Model, Motion, StateRef};

use super::memory::OutOfMemory;
use super::steering::Steering;

/// A random walk. Its draws are a pure function of the episode's seed, the step and the UAV. They
/// have a purpose of their own, so they share no draw with the kernel.
#[derive(Clone, Debug, Default)]
pub struct Random {
    seed: u64,
}

impl Steering for Random {
    fn reset(&mut self, _model: &Model<'_>, seed: u64) -> Result<(), OutOfMemory> {
        self.seed = seed;
        Ok(())
    }

    fn steer(
        &mut self,
        _model: &Model<'_>,
        state: &StateRef<'_>,
        motions: &mut [Motion],
    ) -> Result<(), OutOfMemory> {
        for (uav, motion) in motions.iter_mut().enumerate() {
            let bits = rng::bits64(self.seed, state.t(), uav as u32, 0, Purpose::Policy);
            *motion = Motion::ALL[rng::below(bits, 5) as usize];
        }
        Ok(())
    }
}
