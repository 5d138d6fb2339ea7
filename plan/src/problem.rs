//! A problem: the fleet as it is, the prior of the hotspots, and the number of steps left.

use alloc::vec;
use alloc::vec::Vec;
use core::ops::Range;

use jcas_core::energy::round_half_up;
use jcas_core::{Cell, LearnedDetections, Model, QuorumWindow, StartCells, StateRef};

use crate::battery;
use crate::error::PlanError;
use crate::gather::UAVS_MAX;
use crate::odds::{LANES, Odds};
use crate::paths::Paths;
use crate::targets::{Placement, Targets};

/// The maximum number of steps of a plan; the fleet stays in its last cells after them.
pub(crate) const STEPS_MAX: usize = 512;
/// The maximum number of entries of a table over steps and sites.
const ENTRIES_MAX: usize = 1 << 25;
/// The maximum number of hotspots of a plan: the changes of routes grow with its square.
const HOTSPOTS_MAX: usize = 512;
/// The maximum number of steps times sites of one evaluation, which takes some seconds.
const EVALUATION_MAX: usize = 1 << 31;

/// The situation of a fleet: its cells, its charges and the step of the episode.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Situation {
    /// Cell of each UAV.
    pub cells: Vec<Cell>,
    /// Charge of each UAV in µJ.
    pub charges_uj: Vec<u64>,
    /// Number of steps of the episode so far.
    pub step: u32,
}

impl Situation {
    /// Returns the situation before the first step. All UAVs are at depot 0, each with the least
    /// charge that the configuration allows.
    #[must_use]
    pub fn at_reset(model: &Model<'_>) -> Self {
        let capacity_uj = model.energy().capacity_uj;
        let least = round_half_up(model.config().initial_soc_min * capacity_uj as f64);
        Self {
            cells: vec![model.depots()[0]; model.uav_count()],
            charges_uj: vec![least.min(capacity_uj); model.uav_count()],
            step: 0,
        }
    }

    /// Takes the situation from a state.
    #[must_use]
    pub fn of(state: &StateRef<'_>) -> Self {
        let uavs = 0..state.uav_count();
        Self {
            cells: uavs.clone().map(|uav| state.cell(uav)).collect(),
            charges_uj: uavs.map(|uav| state.battery_uj(uav)).collect(),
            step: state.t(),
        }
    }
}

/// A group of hotspots over its own part of the sites of a problem.
#[derive(Clone, Debug)]
pub(crate) struct Hidden {
    pub(crate) count: u32,
    /// The part of the sites: cells of positive weight, then padding.
    pub(crate) sites: Range<usize>,
    /// Number of sites without the padding.
    pub(crate) cells: usize,
    /// One weight for each site of the part; zero for the padding.
    pub(crate) weights: Vec<f64>,
    pub(crate) placement: Placement,
}

/// An episode to plan, or the rest of one.
#[derive(Clone, Debug)]
pub struct Problem<'m> {
    pub(crate) model: &'m Model<'m>,
    pub(crate) odds: Odds,
    pub(crate) draws: Vec<Hidden>,
    /// The cells of the hotspots whose prior is one cell.
    pub(crate) known: Vec<Cell>,
    pub(crate) situation: Situation,
    pub(crate) steps_left: u32,
    pub(crate) steps: usize,
    pub(crate) movers: Vec<usize>,
    pub(crate) together: bool,
}

impl<'m> Problem<'m> {
    /// Makes a problem from the tables of a model, the prior of the hotspots and a situation.
    ///
    /// # Errors
    /// [`PlanError`] if the fleet or the grid is too large, or if the situation does not fit the
    /// model. So it is if plans do not cover the model's quorum or knowledge.
    pub fn new(
        model: &'m Model<'m>,
        targets: &Targets,
        situation: Situation,
    ) -> Result<Self, PlanError> {
        check_model(model)?;
        let config = model.config();
        let lengths = [
            ("cells", model.uav_count(), situation.cells.len()),
            ("charges_uj", model.uav_count(), situation.charges_uj.len()),
        ];
        for (what, expected, got) in lengths {
            if expected != got {
                return Err(PlanError::Length {
                    what,
                    expected,
                    got,
                });
            }
        }
        for cell in &situation.cells {
            if cell.x >= config.grid_width || cell.y >= config.grid_height {
                return Err(PlanError::OffGrid {
                    x: cell.x,
                    y: cell.y,
                });
            }
        }
        let steps_left = config.horizon_steps.saturating_sub(situation.step);
        let steps = STEPS_MAX.min(steps_left as usize);
        let (draws, sites) = draws(targets, config.grid_width);
        check_sizes(model, sites.len(), steps)?;
        let known = draws.iter().filter(|draw| draw.cells == 1);
        let known = known.map(|draw| sites[draw.sites.start]).collect();
        Ok(Self {
            model,
            odds: Odds::new(model, sites),
            draws,
            known,
            situation,
            steps_left,
            steps,
            movers: (0..model.uav_count()).collect(),
            together: false,
        })
    }

    /// Restricts the planning to these UAVs; the others keep their initial trajectories.
    ///
    /// Indices beyond the fleet are ignored.
    #[must_use]
    pub fn only(mut self, uavs: &[usize]) -> Self {
        let fleet = self.model.uav_count();
        self.movers = uavs.iter().copied().filter(|&uav| uav < fleet).collect();
        self
    }

    /// Says whether the fleet has to stay one radio component in each step in which it is one. What
    /// one UAV sees then reaches all others at once.
    #[must_use]
    pub fn together(mut self, together: bool) -> Self {
        self.together = together;
        self
    }

    /// Returns the products that the chance of all confirmations takes in a step.
    pub(crate) fn products(&self) -> usize {
        let draws = self.draws.iter().map(|draw| match draw.placement {
            Placement::Distinct => draw.cells * (draw.count as usize + 1),
            Placement::Drawn | Placement::EachCell => draw.cells,
        });
        draws.sum()
    }

    /// Returns the tables of detection and links.
    #[must_use]
    pub fn odds(&self) -> &Odds {
        &self.odds
    }

    /// Returns the number of steps of a plan.
    #[must_use]
    pub fn steps(&self) -> usize {
        self.steps
    }

    /// Returns the situation that the plan begins in.
    #[must_use]
    pub fn situation(&self) -> &Situation {
        &self.situation
    }

    /// Returns whether the batteries of all planned UAVs last for their trajectories.
    #[must_use]
    pub fn allows(&self, paths: &Paths) -> bool {
        self.movers.iter().all(|&uav| {
            battery::allows(
                self.model,
                &self.odds,
                self.situation.charges_uj[uav],
                paths.cells_of(uav),
                paths.levels_of(uav),
            )
        })
    }
}

/// Checks that the objective of a plan covers the model: the detections of one step confirm a
/// hotspot, and UAVs know it from then on.
pub(crate) fn check_model(model: &Model<'_>) -> Result<(), PlanError> {
    let config = model.config();
    let (window, learned) = (config.quorum_window, config.learned_detections);
    if window != QuorumWindow::Step {
        return Err(uncovered("quorum_window", window.name(), "step"));
    }
    if learned != LearnedDetections::Confirmed {
        return Err(uncovered("learned_detections", learned.name(), "confirmed"));
    }
    Ok(())
}

/// Checks that the fleet starts in cells that are known before an episode.
pub(crate) fn check_start(model: &Model<'_>) -> Result<(), PlanError> {
    let start = model.config().start_cells;
    if start == StartCells::Depot {
        Ok(())
    } else {
        let allowed = "depot, or the cells of a state (`replan` with known hotspots)";
        Err(uncovered("start_cells", start.name(), allowed))
    }
}

const fn uncovered(field: &'static str, value: &'static str, allowed: &'static str) -> PlanError {
    PlanError::Configuration {
        field,
        value,
        allowed,
    }
}

/// Checks that a fleet and its tables over sites and steps are not too large for a plan.
pub(crate) fn check_sizes(model: &Model<'_>, sites: usize, steps: usize) -> Result<(), PlanError> {
    if model.uav_count() > UAVS_MAX {
        return Err(PlanError::TooManyUavs {
            uavs: model.uav_count(),
            most: UAVS_MAX,
        });
    }
    if model.hotspot_count() > HOTSPOTS_MAX {
        return Err(PlanError::TooManyHotspots {
            hotspots: model.hotspot_count(),
            most: HOTSPOTS_MAX,
        });
    }
    let horizon_steps = model.config().horizon_steps;
    if sites.saturating_mul(horizon_steps as usize) > EVALUATION_MAX {
        return Err(PlanError::TooLong {
            horizon_steps,
            most: EVALUATION_MAX / sites,
        });
    }
    let entries = sites.saturating_mul(steps + 1);
    if entries > ENTRIES_MAX {
        return Err(PlanError::TooLarge {
            entries,
            most: ENTRIES_MAX,
        });
    }
    Ok(())
}

/// Returns each group with its sites, padded to whole lanes.
fn draws(targets: &Targets, width: u32) -> (Vec<Hidden>, Vec<Cell>) {
    let (mut draws, mut sites) = (Vec::new(), Vec::new());
    for group in targets.groups().iter().filter(|group| group.count > 0) {
        let first = sites.len();
        let mut weights = Vec::new();
        for (index, &weight) in group.weights.iter().enumerate() {
            if weight > 0.0 {
                weights.push(weight);
                let index = index as u32;
                sites.push(Cell {
                    x: index % width,
                    y: index / width,
                });
            }
        }
        let cells = weights.len();
        weights.resize(cells.next_multiple_of(LANES), 0.0);
        sites.resize(first + weights.len(), Cell::default());
        draws.push(Hidden {
            count: group.count,
            sites: first..sites.len(),
            cells,
            weights,
            placement: group.placement,
        });
    }
    (draws, sites)
}

/// Raises a chance to a small power, in a fixed order of multiplications.
pub(crate) fn power(base: f64, exponent: u32) -> f64 {
    let (mut result, mut square, mut rest) = (1.0, base, exponent);
    while rest > 0 {
        if rest & 1 == 1 {
            result *= square;
        }
        square *= square;
        rest >>= 1;
    }
    result
}
