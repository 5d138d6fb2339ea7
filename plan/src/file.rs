//! Plans on file, as JSON.

use alloc::string::String;
use alloc::vec;
use alloc::vec::Vec;
use core::fmt;

use jcas_core::{Cell, Config, Model, Printable};
use serde::{Deserialize, Serialize};

use crate::objective::Expectation;
use crate::paths::Paths;
use crate::plan::Plan;

/// Version of the file that is written and read.
pub const FORMAT: u32 = 1;
/// The most bytes of memory that a byte of text takes while it becomes a plan. Two bytes of text
/// can be a number of eight bytes, in a list that grows by doubling and is copied.
pub const READ_BYTES_MAX: u64 = 64;

/// The relative rounding error that the bound may have beside the expected time.
const ROUNDING: f64 = 1e-9;

/// A plan together with the configuration that it was made for.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PlanFile {
    /// Version of the file, [`FORMAT`].
    pub format: u32,
    /// Hash of the configuration.
    pub config_hash: String,
    /// Seed of the annealing.
    pub seed: u64,
    /// Number of moves that the annealing tried.
    pub iterations: u64,
    /// Whether the annealing ended before the requested number of moves.
    pub stopped: bool,
    /// Expected number of steps until the end of the episode.
    pub expected_steps: f64,
    /// Expected number of steps until every hotspot is confirmed.
    pub expected_confirmed_steps: f64,
    /// Probability that the episode ends before the horizon.
    pub success: f64,
    /// Expected number of steps of the initial trajectories.
    pub start_steps: f64,
    /// Lower bound on the expected number of steps of every fixed plan.
    pub bound_steps: f64,
    /// Cells of the known hotspots; absent for a search.
    pub hotspots: Option<Vec<Cell>>,
    /// The trajectories, one for each UAV.
    pub uavs: Vec<Trajectory>,
    /// The configuration.
    pub config: Config,
}

/// The trajectory of one UAV.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Trajectory {
    /// Its cell before the first step, then after each step.
    pub cells: Vec<Cell>,
    /// Its pilot density in each step.
    pub pilot_density: Vec<f64>,
}

/// The reason why a file holds no plan for a model.
#[derive(Debug)]
pub enum PlanFileError {
    /// The text is no JSON of a plan.
    Json(serde_json::Error),
    /// The file does not hold a plan that this program can run.
    Content(&'static str),
    /// A figure that no plan can promise.
    Promise {
        /// Name of the field.
        field: &'static str,
        /// Its value.
        value: f64,
        /// The least value that the other figures allow.
        low: f64,
        /// The greatest one.
        high: f64,
    },
    /// The plan was made for another configuration.
    Configuration {
        /// Hash of the configuration that it was made for.
        planned: String,
        /// Hash of the configuration in use.
        given: String,
    },
}

impl fmt::Display for PlanFileError {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Json(error) => write!(out, "no plan: {}", Printable(error)),
            Self::Content(what) => write!(out, "no plan: {what}"),
            Self::Promise {
                field,
                value,
                low,
                high,
            } => write!(
                out,
                "no plan: {field} = {value}: must be from {low} to {high}"
            ),
            Self::Configuration { planned, given } => {
                let planned = Printable(planned);
                write!(out, "made for the configuration {planned}, not for {given}")
            }
        }
    }
}

impl core::error::Error for PlanFileError {}

fn hash_text(hash: u64) -> String {
    alloc::format!("0x{hash:016x}")
}

impl PlanFile {
    /// Builds the file's content from a plan.
    #[must_use]
    pub fn new(model: &Model<'_>, plan: &Plan, hotspots: Option<Vec<Cell>>) -> Self {
        let steps = plan.paths.steps();
        let uavs = (0..plan.paths.uav_count()).map(|uav| Trajectory {
            cells: (0..=steps).map(|step| plan.cell(uav, step)).collect(),
            pilot_density: (1..=steps)
                .map(|step| plan.pilot_density(uav, step))
                .collect(),
        });
        Self {
            format: FORMAT,
            config_hash: hash_text(plan.config_hash),
            seed: plan.seed,
            iterations: plan.iterations,
            stopped: plan.stopped,
            expected_steps: plan.expected.steps,
            expected_confirmed_steps: plan.expected.confirmed_steps,
            success: plan.expected.success,
            start_steps: plan.start_steps,
            bound_steps: plan.bound_steps,
            hotspots,
            uavs: uavs.collect(),
            config: *model.config(),
        }
    }

    /// Reads a plan from its text.
    ///
    /// # Errors
    /// [`PlanFileError::Json`] or [`PlanFileError::Content`].
    pub fn parse(text: &str) -> Result<Self, PlanFileError> {
        let file: Self = serde_json::from_str(text).map_err(PlanFileError::Json)?;
        if file.format == FORMAT {
            Ok(file)
        } else {
            Err(PlanFileError::Content("format: must be 1"))
        }
    }

    /// Writes the plan as text.
    ///
    /// # Errors
    /// [`PlanFileError::Json`] where memory runs out.
    pub fn to_json(&self) -> Result<String, PlanFileError> {
        serde_json::to_string(self).map_err(PlanFileError::Json)
    }

    /// Returns the plan for a model.
    ///
    /// # Errors
    /// [`PlanFileError::Configuration`] for another model than that of the plan;
    /// [`PlanFileError::Content`] where the trajectories do not fit the fleet of the model.
    pub fn plan(&self, model: &Model<'_>) -> Result<Plan, PlanFileError> {
        let given = hash_text(model.config_hash());
        if self.config_hash != given {
            return Err(PlanFileError::Configuration {
                planned: self.config_hash.clone(),
                given,
            });
        }
        let steps = self.steps(model)?;
        self.check_promises(model)?;
        let config = model.config();
        let mut densities: Vec<f64> = Vec::new();
        let start = config.grid_width * model.depots()[0].y + model.depots()[0].x;
        let mut paths = Paths::hovering(&vec![start; self.uavs.len()], steps, 0);
        for (uav, trajectory) in self.uavs.iter().enumerate() {
            for (step, &density) in trajectory.pilot_density.iter().enumerate() {
                if !(density >= config.pilot_density_min && density <= config.pilot_density_max) {
                    return Err(PlanFileError::Content(
                        "pilot_density: must lie between pilot_density_min and pilot_density_max",
                    ));
                }
                let known = densities.iter().position(|&other| other == density);
                let level = known.unwrap_or(densities.len());
                if known.is_none() {
                    densities.push(density);
                }
                let level = u8::try_from(level).map_err(|_| {
                    PlanFileError::Content("pilot_density: must have at most 256 values")
                })?;
                let cell = trajectory.cells[step + 1];
                paths.set(uav, step + 1, cell.y * config.grid_width + cell.x, level);
            }
        }
        Ok(Plan {
            config_hash: model.config_hash(),
            seed: self.seed,
            iterations: self.iterations,
            stopped: self.stopped,
            first_step: 0,
            paths,
            densities,
            grid_width: config.grid_width,
            expected: Expectation {
                steps: self.expected_steps,
                confirmed_steps: self.expected_confirmed_steps,
                success: self.success,
            },
            start_steps: self.start_steps,
            bound_steps: self.bound_steps,
        })
    }

    /// Checks that a plan can promise these figures, and that its hotspots are those of an episode.
    fn check_promises(&self, model: &Model<'_>) -> Result<(), PlanFileError> {
        let config = model.config();
        let horizon = f64::from(config.horizon_steps);
        // The bound is summed in another order than the expected time.
        let bound_max = self.expected_steps * (1.0 + ROUNDING);
        for (field, value, low, high) in [
            ("success", self.success, 0.0, 1.0),
            ("start_steps", self.start_steps, 0.0, horizon),
            ("expected_steps", self.expected_steps, 0.0, self.start_steps),
            (
                "expected_confirmed_steps",
                self.expected_confirmed_steps,
                0.0,
                self.expected_steps,
            ),
            ("bound_steps", self.bound_steps, 0.0, bound_max),
        ] {
            if !(value >= low && value <= high) {
                return Err(PlanFileError::Promise {
                    field,
                    value,
                    low,
                    high,
                });
            }
        }
        let fits = |cells: &Vec<Cell>| {
            let on_grid = |cell: &Cell| cell.x < config.grid_width && cell.y < config.grid_height;
            cells.len() == model.hotspot_count() && cells.iter().all(on_grid)
        };
        if self.hotspots.as_ref().is_some_and(|cells| !fits(cells)) {
            return Err(PlanFileError::Content(
                "hotspots: must be one cell of the grid for each hotspot of the mission",
            ));
        }
        Ok(())
    }

    /// Returns the number of steps, if the trajectories fit the fleet of a model.
    fn steps(&self, model: &Model<'_>) -> Result<usize, PlanFileError> {
        let config = model.config();
        let steps = self.uavs.first().map_or(0, |uav| uav.pilot_density.len());
        let fits = |uav: &Trajectory| {
            uav.cells.len() == steps + 1
                && uav.pilot_density.len() == steps
                && uav.cells[0] == model.depots()[0]
                && uav
                    .cells
                    .windows(2)
                    .all(|pair| pair[0].manhattan(pair[1]) <= 1)
                && uav
                    .cells
                    .iter()
                    .all(|cell| cell.x < config.grid_width && cell.y < config.grid_height)
        };
        if self.uavs.len() != model.uav_count() || !self.uavs.iter().all(fits) {
            return Err(PlanFileError::Content(
                "uavs: must be one trajectory for each UAV, from the depot, over cells of the grid \
                 that are neighbours",
            ));
        }
        if steps == 0 {
            return Err(PlanFileError::Content("uavs: must have at least one step"));
        }
        Ok(steps)
    }
}

#[cfg(test)]
mod tests {
    use alloc::string::ToString;
    use core::ops::ControlFlow;

    use jcas_core::Preset;

    use super::*;
    use crate::{Settings, search};

    #[test]
    fn a_file_gives_the_plan_back() {
        let config = Config {
            uav_count: 4,
            ..Config::preset(Preset::Search)
        };
        let model = Model::new(config).unwrap();
        let settings = Settings {
            iterations: 1_000,
            seed: 1,
        };
        let plan = search(&model, &settings, &mut |_| ControlFlow::Continue(())).unwrap();
        let file = PlanFile::new(&model, &plan, None);
        let text = file.to_json().unwrap();
        let read = PlanFile::parse(&text).unwrap();
        assert_eq!(read, file);
        let back = read.plan(&model).unwrap();
        for uav in 0..4 {
            for step in 1..=plan.paths.steps() {
                assert_eq!(back.cell(uav, step), plan.cell(uav, step));
                assert_eq!(back.pilot_density(uav, step), plan.pilot_density(uav, step));
            }
        }
        let other = Model::new(Config {
            uav_count: 5,
            ..config
        })
        .unwrap();
        assert!(matches!(
            read.plan(&other),
            Err(PlanFileError::Configuration { .. })
        ));
        let mut torn = file;
        torn.uavs[2].cells[7] = Cell { x: 0, y: 0 };
        assert!(matches!(torn.plan(&model), Err(PlanFileError::Content(_))));
    }

    #[test]
    fn figures_that_no_plan_promises_are_refused() {
        let model = Model::new(Config::preset(Preset::Search)).unwrap();
        let settings = Settings {
            iterations: 0,
            seed: 1,
        };
        let plan = search(&model, &settings, &mut |_| ControlFlow::Continue(())).unwrap();
        let file = PlanFile::new(&model, &plan, None);
        assert!(file.plan(&model).is_ok());
        let refused = |change: fn(&mut PlanFile)| {
            let mut changed = file.clone();
            change(&mut changed);
            changed.plan(&model).unwrap_err().to_string()
        };
        let wrong = refused(|file| file.success = 8.0);
        assert_eq!(wrong, "no plan: success = 8: must be from 0 to 1");
        for (field, change) in [
            ("success", (|file| file.success = -1.0) as fn(&mut PlanFile)),
            ("success", |file| file.success = f64::NAN),
            ("start_steps", |file| file.start_steps = 1e300),
            ("expected_steps", |file| file.expected_steps = -3.0),
            ("expected_steps", |file| file.expected_steps = 1e9),
            ("expected_confirmed_steps", |file| {
                file.expected_confirmed_steps = 1e9
            }),
            ("bound_steps", |file| file.bound_steps = f64::INFINITY),
            ("bound_steps", |file| {
                file.bound_steps = 2.0 * file.expected_steps
            }),
            ("hotspots", |file| {
                file.hotspots = Some(vec![Cell::default()])
            }),
        ] {
            let wrong = refused(change);
            assert!(
                wrong.starts_with(&alloc::format!("no plan: {field}")),
                "{wrong}"
            );
        }
    }

    #[test]
    fn trajectories_without_a_step_are_refused() {
        let model = Model::new(Config::preset(Preset::Search)).unwrap();
        let settings = Settings {
            iterations: 0,
            seed: 1,
        };
        let plan = search(&model, &settings, &mut |_| ControlFlow::Continue(())).unwrap();
        let mut file = PlanFile::new(&model, &plan, None);
        for uav in &mut file.uavs {
            uav.cells.truncate(1);
            uav.pilot_density.clear();
        }
        let error = file.plan(&model).unwrap_err().to_string();
        assert!(error.contains("at least one step"), "{error}");
    }
}
