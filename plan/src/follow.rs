//! The policy that follows a plan.

use alloc::sync::Arc;

use jcas_core::action::pilot_action;
use jcas_core::motion::toward;
use jcas_core::{Cell, Model, StateRef};

use crate::plan::Plan;

/// A follower of a plan: it flies the trajectories and reads nothing but the step.
///
/// Copies share the plan; copying and following take no memory.
#[derive(Clone, Debug)]
pub struct Follower {
    plan: Arc<Plan>,
}

impl Follower {
    /// Makes a follower of this plan.
    #[must_use]
    pub fn new(plan: impl Into<Arc<Plan>>) -> Self {
        Self { plan: plan.into() }
    }

    /// Returns the plan.
    #[must_use]
    pub fn plan(&self) -> &Plan {
        &self.plan
    }

    /// Writes (u_dir, u_pilot) of each UAV, each in [-1, 1].
    pub fn write(&self, model: &Model<'_>, state: &StateRef<'_>, actions: &mut [f32]) {
        let step = (state.t().saturating_sub(self.plan.first_step)) as usize + 1;
        for (uav, action) in actions.chunks_exact_mut(2).enumerate() {
            let (target, density) = (
                self.plan.cell(uav, step),
                self.plan.pilot_density(uav, step),
            );
            write(model, state.cell(uav), target, density, action);
        }
    }
}

/// Returns the action of a UAV that flies toward a cell and senses at a pilot density.
pub(crate) fn write(
    model: &Model<'_>,
    here: Cell,
    target: Cell,
    pilot_density: f64,
    action: &mut [f32],
) {
    let config = model.config();
    let (low, high) = (config.pilot_density_min, config.pilot_density_max);
    action[0] = toward(here, target).to_action(config.motion_map);
    action[1] = pilot_action(pilot_density, low, high);
}
