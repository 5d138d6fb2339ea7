//! Plans of a component that has lost the others.
//!
//! A component assumes that the others follow the plan that they shared. Where they do not, each
//! may wait for the other for ever. So once a plan has run out, its members assume nothing of the
//! others any more. They visit all hotspots that they do not know, by themselves. With all known,
//! or with fewer UAVs than a quorum, they fly to a meeting place that follows from the hotspots and
//! the depots. Each component gets there, so the fleet meets.

use alloc::vec::Vec;

use jcas_core::motion::nearest;
use jcas_core::{Cell, Model, StateRef};
use jcas_policy::geometry::meeting_cell;

use crate::anneal::Settings;
use crate::battery;
use crate::error::PlanError;
use crate::formation::{Recorder, hovering};
use crate::objective::Expectation;
use crate::plan::Plan;
use crate::problem::{Problem, Situation};
use crate::replan::hotspot_cells;
use crate::rounds;
use crate::targets::Targets;
use crate::view::View;

/// Plans for the members of a component, with known hotspots.
pub(crate) fn plan(
    model: &Model<'_>,
    state: &StateRef<'_>,
    members: &[usize],
    known: Vec<bool>,
    settings: &Settings,
) -> Result<View, PlanError> {
    let hotspots = hotspot_cells(state);
    let unknown = (0..known.len()).filter(|&hotspot| !known[hotspot]);
    let unknown: Vec<Cell> = unknown.map(|hotspot| hotspots[hotspot]).collect();
    let targets = Targets::known(model, &unknown)?;
    let problem = Problem::new(model, &targets, Situation::of(state))?.only(members);
    let initial = hovering(&problem);
    let planned = (members.len() >= model.config().quorum as usize)
        .then(|| rounds::plan(&problem, &hotspots, &known, &[], &initial, settings))
        .flatten();
    let (plan, rounds, ends_step) = match planned {
        Some(planned) => (
            Plan::fixed(&problem, planned.paths, planned.expected),
            Some(planned.rounds),
            state.t() + planned.longest,
        ),
        None => {
            let place = meeting_place(model, &hotspots);
            let mut recorder = Recorder::new(&problem, 0);
            while !recorder.is_full() {
                recorder.fly(|_| place);
            }
            let never = Expectation {
                steps: f64::from(problem.steps_left),
                ..Expectation::default()
            };
            (
                Plan::fixed(&problem, recorder.finish(), never),
                None,
                u32::MAX,
            )
        }
    };
    Ok(View {
        first_step: state.t(),
        ends_step,
        alone: true,
        plan,
        known,
        rounds,
        reports: Vec::new(),
        hidden: false,
        assumed: Vec::new(),
    })
}

/// Returns the middle of the hotspots. Where a battery may run low before the horizon, it is the
/// depot nearest to it: a UAV that waits there charges.
fn meeting_place(model: &Model<'_>, hotspots: &[Cell]) -> Cell {
    let config = model.config();
    let middle = meeting_cell(
        hotspots.iter().copied(),
        config.grid_width,
        config.grid_height,
    );
    let (capacity_uj, steps) = (model.energy().capacity_uj, config.horizon_steps as usize);
    if battery::never_low(model, capacity_uj, steps) {
        middle
    } else {
        model.depots()[nearest(middle, model.depots()).0]
    }
}
