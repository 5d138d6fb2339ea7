//! The planned trajectories of an episode, for the page to draw.

use jcas_plan::{Plan, Planned};

/// The trajectory of a UAV from a step on, as planned in that step.
struct Trajectory {
    first_step: u32,
    /// Row-major indices of the cells, the first before the step.
    cells: Vec<u32>,
}

/// The trajectories of each UAV, one for each plan that it followed.
pub(crate) struct Lines {
    lines_of_uav: Vec<Vec<Trajectory>>,
    /// The plan that each UAV followed last.
    followed: Vec<*const Plan>,
    horizon_steps: u32,
}

impl Lines {
    pub(crate) fn new(uavs: usize, horizon_steps: u32) -> Self {
        Self {
            lines_of_uav: (0..uavs).map(|_| Vec::new()).collect(),
            followed: vec![std::ptr::null(); uavs],
            horizon_steps,
        }
    }

    /// Records the plans that are new, once the policy has decided the step after `t` steps.
    pub(crate) fn record(&mut self, planned: &Planned, t: u32) {
        for (uav, lines) in self.lines_of_uav.iter_mut().enumerate() {
            let Some(plan) = planned.plan_of(uav) else {
                continue;
            };
            if std::ptr::eq(plan, self.followed[uav]) {
                continue;
            }
            self.followed[uav] = plan;
            let flown = t.saturating_sub(plan.first_step) as usize;
            let steps = flown..=flown + (self.horizon_steps - t) as usize;
            lines.push(Trajectory {
                first_step: t,
                cells: steps.map(|step| plan.paths.cell(uav, step)).collect(),
            });
        }
    }

    /// Returns the trajectories as JSON: for each UAV pairs of the first step and the cells. The
    /// cells end with the episode.
    pub(crate) fn to_json(&self, last_step: usize) -> String {
        let uavs = self.lines_of_uav.iter().map(|lines| {
            let lines = lines.iter().map(|line| {
                let left = last_step.saturating_sub(line.first_step as usize);
                let cells = &line.cells[..line.cells.len().min(left + 1)];
                serde_json::json!([line.first_step, cells])
            });
            lines.collect::<serde_json::Value>()
        });
        uavs.collect::<serde_json::Value>().to_string()
    }
}
