//! The policy that follows a plan.

use alloc::sync::Arc;

use jcas_core::action::pilot_action;
use jcas_core::motion::toward;
use jcas_core::{Cell, Model, StateRef};

use crate::gather::meeting_cell;
use crate::plan::Plan;

/// A follower of a plan. It follows the trajectories until every hotspot is confirmed, then flies
/// to the meeting cell at the least pilot density.
///
/// It reads which hotspots are confirmed, as every baseline does. The trajectories use no feedback.
/// Copies share the plan; copying and following take no memory.
#[derive(Clone, Debug)]
pub struct Follower {
    plan: Arc<Plan>,
    meeting: Option<Cell>,
}

impl Follower {
    /// Makes a follower of this plan.
    #[must_use]
    pub fn new(plan: impl Into<Arc<Plan>>) -> Self {
        Self {
            plan: plan.into(),
            meeting: None,
        }
    }

    /// Returns the plan.
    #[must_use]
    pub fn plan(&self) -> &Plan {
        &self.plan
    }

    /// Called before the first step of an episode.
    pub fn reset(&mut self) {
        self.meeting = None;
    }

    /// Looks whether every hotspot is confirmed, and then chooses the meeting cell.
    pub fn see(&mut self, model: &Model<'_>, state: &StateRef<'_>) {
        let config = model.config();
        if self.meeting.is_none() && (0..state.hotspot_count()).all(|j| state.confirmed(j)) {
            let cells = (0..state.uav_count()).map(|uav| state.cell(uav));
            self.meeting = Some(meeting_cell(cells, config.grid_width, config.grid_height));
        }
    }

    /// Writes (u_dir, u_pilot) of each UAV, each in [-1, 1], for the state that the follower has
    /// just seen.
    pub fn write(&self, model: &Model<'_>, state: &StateRef<'_>, actions: &mut [f32]) {
        let config = model.config();
        let step = (state.t().saturating_sub(self.plan.first_step)) as usize + 1;
        for (uav, action) in actions.chunks_exact_mut(2).enumerate() {
            let (target, density) = match self.meeting {
                Some(cell) => (cell, config.pilot_density_min),
                None => (
                    self.plan.cell(uav, step),
                    self.plan.pilot_density(uav, step),
                ),
            };
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
    action[0] = toward(here, target).to_action();
    action[1] = pilot_action(pilot_density, low, high);
}
