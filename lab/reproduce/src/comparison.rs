//! Scripts, plans and policies on the same missions, one cell after the other.
//!
//! Each script flies with an adaptive pilot density and with its best constant one. That constant,
//! and the best script of a cell, are chosen on other missions than those that are reported.

use crate::campaign::{ADAPTIVE, OURS};
use jcas_core::{Config, Metrics, Model, Preset, Sim, TargetVisibility};
use jcas_episode::card::{EVALUATION_SEED, StoredPolicy};
use jcas_episode::mission::{Campaign, fly};
use jcas_episode::statistics::{Estimate, mission_steps, paired_difference};
use jcas_plan::{PlannedKind, Problem, Situation, Targets, bound};
use jcas_policy::{BaselineKind, PilotMode, Policy};
use jcas_train::error::TrainError;
use serde::{Deserialize, Serialize};
use std::ops::ControlFlow;
use std::path::Path;

/// Name of the table.
pub const COMPARISON: &str = "comparison.csv";
/// Number of missions of a policy in a cell, where the scope has no fewer; the paper averages as
/// many.
pub const MISSIONS: u64 = 100;
/// The same for a policy that plans anew in each mission, which takes much longer than a script.
pub const PLANNED: u64 = 25;
/// Seed of the missions on which scripts are chosen.
pub const SELECTION_SEED: u64 = EVALUATION_SEED + 1;

/// One policy in one cell.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[allow(missing_docs)] // the names are those of the columns
pub struct ComparedRow {
    pub preset: String,
    pub uavs: u32,
    pub hotspots: u32,
    pub policy: String,
    pub pilot: String,
    pub config_hash: String,
    /// Whether it is the best script of the cell by the other missions.
    pub best_script: bool,
    /// A lower bound on the steps of every plan without feedback; beside the plan alone.
    pub bound_steps: Option<f64>,
    pub episodes: u64,
    pub successes: u64,
    pub energy_kwh: f64,
    pub throughput: f64,
    /// Steps of each mission, in the order of their seeds. A failed mission has its horizon.
    pub mission_steps: String,
}

impl ComparedRow {
    /// Steps of each mission, in the order of their seeds.
    pub fn steps(&self) -> Vec<u32> {
        let words = self.mission_steps.split(' ');
        words.filter_map(|word| word.parse().ok()).collect()
    }

    /// Whether another row is of the same policy in the same cell.
    pub(crate) fn is_again(&self, other: &ComparedRow) -> bool {
        let names = |row: &ComparedRow| [&row.preset, &row.policy, &row.pilot].map(String::clone);
        names(self) == names(other) && (self.uavs, self.hotspots) == (other.uavs, other.hotspots)
    }

    /// Steps beyond those of another policy, mean over the missions that both have flown.
    pub fn over(&self, other: &ComparedRow) -> Estimate {
        paired_difference(&self.steps(), &other.steps())
    }

    /// Share of missions that succeeded.
    pub fn success_rate(&self) -> f64 {
        self.successes as f64 / self.episodes as f64
    }
}

/// Reads the rows that a folder has.
pub fn open(out: &Path) -> Result<Vec<ComparedRow>, TrainError> {
    crate::scan::lines(&out.join(COMPARISON))
}

/// The scripts that can fly a mission with known hotspots, or with hidden ones. With known
/// ones, the decentralised `squads` joins the baselines of the grid.
fn scripts(config: &Config) -> Vec<BaselineKind> {
    if config.target_visibility == TargetVisibility::Known {
        let baselines = crate::flights::BASELINES.into_iter();
        return baselines.chain([BaselineKind::Squads]).collect();
    }
    let all = BaselineKind::ALL.into_iter();
    all.filter(|kind| !kind.reads_positions())
        .filter(|kind| config.report_levels > 0 || !kind.reads_reports())
        .collect()
}

/// What is flown at once.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Unit {
    /// All scripts.
    Scripts,
    /// A policy that plans.
    Planner(PlannedKind),
    /// The policy with our settings.
    Ours,
}

impl Unit {
    /// All of them in two passes; the second one takes most of the time.
    pub const PASSES: [&[Unit]; 2] = [
        &[Unit::Scripts, Unit::Ours, Unit::Planner(PlannedKind::Plan)],
        &[Unit::Planner(PlannedKind::Replan)],
    ];

    fn has(self, row: &ComparedRow) -> bool {
        match self {
            Unit::Scripts => crate::table::is_baseline(&row.policy),
            Unit::Planner(kind) => row.policy == kind.name(),
            Unit::Ours => row.policy == OURS,
        }
    }
}

/// A cell of the grid and its missions.
pub(crate) struct ComparedCell<'a> {
    pub preset: Preset,
    pub config: Config,
    pub missions: u64,
    /// Constant pilot densities that scripts may hold.
    pub densities: &'a [f64],
}

type Make<'a> = &'a (dyn Fn() -> Box<dyn Policy> + Sync);

fn refused(error: &dyn std::fmt::Display) -> TrainError {
    TrainError::Setting(error.to_string())
}

impl ComparedCell<'_> {
    fn missions(
        &self,
        model: &Model<'_>,
        (episodes, seed): (u64, u64),
        make: Make,
    ) -> Result<Vec<Metrics>, TrainError> {
        let go_on = || ControlFlow::Continue(());
        let campaign = Campaign { episodes, seed };
        fly(model, campaign, make, &go_on).map_err(|error| refused(&error))
    }

    /// Each script with its adaptive and with its best constant density, the best of them all
    /// first.
    fn chosen(&self, model: &Model<'_>) -> Result<Vec<(BaselineKind, PilotMode)>, TrainError> {
        let mut chosen = Vec::new();
        for kind in scripts(&self.config) {
            let of = |pilot| {
                let make = || -> Box<dyn Policy> { Box::new(kind.build_privileged(pilot)) };
                let missions = self.missions(model, (self.missions, SELECTION_SEED), &make)?;
                Ok((merit(&missions, self.config.horizon_steps), kind, pilot))
            };
            let held = self.densities.iter().map(|&rho| of(PilotMode::Fixed(rho)));
            let held: Vec<_> = held.collect::<Result<_, TrainError>>()?;
            chosen.extend(held.into_iter().max_by(|a, b| by_merit(&a.0, &b.0)));
            chosen.push(of(PilotMode::Adaptive)?);
        }
        chosen.sort_by(|a, b| by_merit(&b.0, &a.0));
        Ok(chosen
            .into_iter()
            .map(|(_, kind, pilot)| (kind, pilot))
            .collect())
    }

    /// Flies the policies of a unit.
    pub fn rows(
        &self,
        unit: Unit,
        ours: Option<&StoredPolicy>,
    ) -> Result<Vec<ComparedRow>, TrainError> {
        let model = Model::new(self.config).map_err(|error| refused(&error))?;
        let row = |policy: &str, pilot: &str, missions: u64, make: Make| -> Result<_, TrainError> {
            let flown = self.missions(&model, (missions, EVALUATION_SEED), make)?;
            Ok(self.row(policy, pilot, &flown))
        };
        match unit {
            Unit::Scripts => {
                let mut rows = Vec::new();
                for (kind, pilot) in self.chosen(&model)? {
                    let make = || -> Box<dyn Policy> { Box::new(kind.build_privileged(pilot)) };
                    rows.push(ComparedRow {
                        best_script: rows.is_empty(),
                        ..row(kind.name(), &pilot.name(), self.missions, &make)?
                    });
                }
                Ok(rows)
            }
            Unit::Planner(kind) => {
                let policy = kind.build(&model).map_err(|error| refused(&error))?;
                let make = || -> Box<dyn Policy> { Box::new(policy.clone()) };
                let is_plan = kind == PlannedKind::Plan;
                let once = is_plan && self.config.target_visibility == TargetVisibility::Hidden;
                let missions = if once {
                    self.missions
                } else {
                    self.missions.min(PLANNED)
                };
                let mut row = row(kind.name(), "planned", missions, &make)?;
                if is_plan {
                    row.bound_steps = Some(self.bound(&model, missions)?);
                }
                Ok(vec![row])
            }
            Unit::Ours => {
                let Some(ours) = ours else {
                    return Ok(Vec::new());
                };
                let make = || -> Box<dyn Policy> { Box::new(ours.policy(None)) };
                Ok(vec![row(OURS, ADAPTIVE, self.missions, &make)?])
            }
        }
    }

    /// Whether a unit of the cell is among these rows; refused where they are of another mission.
    pub fn is_there(&self, unit: Unit, rows: &[ComparedRow]) -> Result<bool, TrainError> {
        let cell = (self.config.uav_count, self.config.hotspot_count);
        let of = |row: &&ComparedRow| {
            row.preset == self.preset.name() && (row.uavs, row.hotspots) == cell && unit.has(row)
        };
        let Some(row) = rows.iter().find(of) else {
            return Ok(false);
        };
        let hash = format!("0x{:016x}", self.config.hash());
        if row.config_hash == hash {
            return Ok(true);
        }
        Err(TrainError::Setting(format!(
            "{COMPARISON}: {} at N = {}, n = {} has flown configuration {}, this reproduction \
                flies {hash}; give another folder",
            row.policy, cell.0, cell.1, row.config_hash
        )))
    }

    /// The mean over the missions of the bound on plans without feedback.
    fn bound(&self, model: &Model<'_>, missions: u64) -> Result<f64, TrainError> {
        let of = |targets: &Targets| {
            let problem = Problem::new(model, targets, Situation::at_reset(model));
            Ok(bound(&problem.map_err(|error| refused(&error))?))
        };
        if self.config.target_visibility == TargetVisibility::Hidden {
            return of(&Targets::hidden(model));
        }
        let campaign = Campaign {
            episodes: missions,
            seed: EVALUATION_SEED,
        };
        let mut sim = Sim::new(model);
        let mut sum = 0.0;
        for mission in 0..missions {
            sim.reset(campaign.episode_seed(mission));
            let state = sim.state();
            let hotspots = (0..state.hotspot_count()).map(|hotspot| state.hotspot_cell(hotspot));
            let hotspots: Vec<_> = hotspots.collect();
            let targets = Targets::known(model, &hotspots).map_err(|error| refused(&error))?;
            sum += of(&targets)?;
        }
        Ok(sum / missions as f64)
    }

    fn row(&self, policy: &str, pilot: &str, missions: &[Metrics]) -> ComparedRow {
        let episodes = missions.len() as f64;
        let mean = |of: fn(&Metrics) -> f64| missions.iter().map(of).sum::<f64>() / episodes;
        let steps = mission_steps(missions, self.config.horizon_steps).into_iter();
        let steps: Vec<String> = steps.map(|steps| steps.to_string()).collect();
        ComparedRow {
            preset: self.preset.name().to_owned(),
            uavs: self.config.uav_count,
            hotspots: self.config.hotspot_count,
            policy: policy.to_owned(),
            pilot: pilot.to_owned(),
            config_hash: format!("0x{:016x}", self.config.hash()),
            best_script: false,
            bound_steps: None,
            episodes: missions.len() as u64,
            successes: missions.iter().filter(|mission| mission.terminated).count() as u64,
            energy_kwh: mean(|mission| mission.energy_kwh),
            throughput: mean(|mission| mission.throughput_mean),
            mission_steps: steps.join(" "),
        }
    }
}

/// What decides between scripts: successes, then the shorter missions, then less energy.
type Merit = (usize, i64, f64);

fn merit(missions: &[Metrics], horizon_steps: u32) -> Merit {
    let successes = missions.iter().filter(|mission| mission.terminated).count();
    let steps = mission_steps(missions, horizon_steps).into_iter();
    let energy_kwh: f64 = missions.iter().map(|mission| mission.energy_kwh).sum();
    (successes, -steps.map(i64::from).sum::<i64>(), -energy_kwh)
}

fn by_merit(a: &Merit, b: &Merit) -> std::cmp::Ordering {
    (a.0, a.1).cmp(&(b.0, b.1)).then(a.2.total_cmp(&b.2))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn place(missions: u64) -> ComparedCell<'static> {
        ComparedCell {
            preset: Preset::Paper,
            config: Config {
                uav_count: 6,
                hotspot_count: 1,
                ..Config::preset(Preset::Paper)
            },
            missions,
            densities: &[0.1, 0.3],
        }
    }

    #[test]
    fn more_successes_come_before_fewer_steps_and_fewer_steps_before_less_energy() {
        let mission = |terminated, steps, energy_kwh| Metrics {
            terminated,
            steps,
            energy_kwh,
            ..Metrics::default()
        };
        let rising = [
            [mission(true, 1, 0.1), mission(false, 100, 0.1)],
            [mission(true, 60, 0.1), mission(true, 60, 0.1)],
            [mission(true, 50, 0.3), mission(true, 60, 0.1)],
            [mission(true, 60, 0.1), mission(true, 50, 0.2)],
        ];
        let merits = rising.map(|missions| merit(&missions, 100));
        assert!(
            merits.is_sorted_by(|a, b| by_merit(a, b).is_lt()),
            "{merits:?}"
        );
    }

    #[test]
    fn the_best_script_comes_first_and_pairs_differ_by_their_mean() {
        let place = place(20);
        let rows = place.rows(Unit::Scripts, None).unwrap();
        assert_eq!(rows.len(), 6 * 2);
        assert!(rows[0].best_script && rows[1..].iter().all(|row| !row.best_script));
        let plan = place.rows(Unit::Planner(PlannedKind::Plan), None).unwrap();
        assert!(plan[0].bound_steps.unwrap() > 1.0);
        assert_eq!(plan[0].steps().len(), 20);
        // A random walk needs many times the steps of a plan, in every pair of missions.
        let random = rows.iter().find(|row| row.policy == "random").unwrap();
        let over = random.over(&plan[0]);
        let sum = |row: &ComparedRow| row.steps().into_iter().map(f64::from).sum::<f64>();
        let mean = (sum(random) - sum(&plan[0])) / 20.0;
        assert!(
            (over.value - mean).abs() < 1e-9 && over.low > 0.0,
            "{over:?}"
        );
        assert!(place.rows(Unit::Ours, None).unwrap().is_empty());
    }

    #[test]
    fn a_cell_of_another_mission_is_refused() {
        let mut rows = place(2).rows(Unit::Scripts, None).unwrap();
        assert!(place(2).is_there(Unit::Scripts, &rows).unwrap());
        assert!(!place(2).is_there(Unit::Ours, &rows).unwrap());
        rows[0].config_hash = "0x0".to_owned();
        let told = place(2)
            .is_there(Unit::Scripts, &rows)
            .unwrap_err()
            .to_string();
        assert!(told.contains("has flown configuration 0x0"), "{told}");
    }
}
