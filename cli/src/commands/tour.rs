//! `jcas tour`: gives a first look at the project, in about a minute.

use std::path::{Path, PathBuf};
use std::time::Instant;

use clap::Args;
use jcas_core::Model;
use jcas_episode::campaign::Campaign;
use jcas_episode::trace;
use jcas_figures::report::{Report, Table};

use super::replay::fly_page;
use super::sweep::{INTERVALS, SHOWN, shown, title};
use super::trace::read_from;
use crate::config_source::{ConfigSource, PresetName};
use crate::error::{CliError, Outcome};
use crate::files;
use crate::numbers;
use crate::options::{DEFAULT_PILOT, ThreadOptions, policy_factory};
use crate::sweep::plan::{self, Axis, SweepCell};
use crate::sweep::store::{Frame, Store};
use crate::sweep::{self, charts};

const EXAMPLES: &str = "\
Examples:
  jcas tour
  jcas tour --episodes 1000 -o tour
  jcas tour --repository path/to/jcas";

/// Seed of the campaign, as in `jcas evaluate`.
const SEED: u64 = 1;

/// The paper's fleets and numbers of hotspots.
const UAVS: [u32; 4] = [5, 10, 15, 20];
const HOTSPOTS: [u32; 5] = [3, 5, 7, 9, 11];

/// A grid of fleets and hotspots that the tour runs.
struct Grid {
    /// Stem of the names of its files.
    name: &'static str,
    heading: &'static str,
    text: &'static str,
    preset: PresetName,
    baselines: &'static [&'static str],
    /// The shipped policy that runs besides, a folder in `policies/`.
    trained: Option<&'static str>,
    hotspots: &'static [u32],
}

const GRIDS: [Grid; 2] = [
    Grid {
        name: "paper",
        heading: "The paper's grid",
        text: "Every UAV knows where the hotspots are; three detections in one step confirm a \
               hotspot. `policies/paper` was trained with PPO, the others are baselines.",
        preset: PresetName::Paper,
        baselines: &["random", "greedy", "teams", "squads"],
        trained: Some("paper"),
        hotspots: &HOTSPOTS,
    },
    Grid {
        name: "search",
        heading: "The search for hidden hotspots",
        text: "No UAV knows where the hotspots are. `plan` flies the trajectories of least \
               expected time that the planner has found, `line` is a baseline.",
        preset: PresetName::Search,
        baselines: &["line", "plan"],
        trained: None,
        hotspots: &[7],
    },
];

/// Run a shipped policy, a plan and the baselines over the paper's grid; write a report
///
/// The tour also verifies the golden traces bit for bit. It writes into the folder of --out: a
/// table of each grid (CSV), figures (SVG and PNG) and replay pages. report.html shows all of them.
#[derive(Args)]
#[command(after_help = EXAMPLES)]
pub struct Tour {
    /// Episodes in each cell
    #[arg(
        long,
        value_name = "M",
        default_value_t = 100,
        value_parser = numbers::above_zero
    )]
    episodes: u64,
    /// Folder for the results
    #[arg(short, long, value_name = "DIR", default_value = "out/tour")]
    out: PathBuf,
    /// Clone of the repository, with policies/ and tests/golden/
    #[arg(long, value_name = "DIR", default_value = ".")]
    repository: PathBuf,
    #[command(flatten)]
    threads: ThreadOptions,
}

/// The results of a grid.
struct GridResults {
    axes: Vec<Axis>,
    cells: Vec<SweepCell>,
    store: Store,
}

impl Tour {
    /// Runs the grids and writes the report.
    pub fn run(self) -> Result<Outcome, CliError> {
        let started = Instant::now();
        let golden = self.golden()?;
        let Some(traces) = verify(&golden)? else {
            return Ok(Outcome::Different);
        };
        files::prepare_folder(&self.out)?;
        let mut report = Report::new(
            "A tour of jcas",
            "Fleets of UAVs search a grid for hotspots with a radar, and share what they find over \
             the same waveform.",
        );
        report.link(&page_of(&GRIDS[1]), "Watch a search for hidden hotspots");
        for grid in &GRIDS {
            let results = self.fly(grid)?;
            self.describe(grid, &results, &mut report)?;
        }
        report.section("Same bits everywhere").text(&format!(
            "This build has run {traces} recorded episodes again (`tests/golden`). Every number \
             of every step is equal to the recorded one, bit for bit."
        ));
        let path = self.out.join("report.html");
        files::write_bytes(&path, report.html().as_bytes())?;
        files::print(&format!(
            "{traces} golden traces reproduced bit for bit\n\
             {} episodes in each of the grid's cells; tables, figures and replay pages in {}\n\
             {:.0} s\n\nopen {}\n",
            self.episodes,
            self.out.display(),
            started.elapsed().as_secs_f64(),
            path.display()
        ))?;
        Ok(Outcome::Done)
    }

    /// The golden traces of the repository, in order of their names.
    fn golden(&self) -> Result<Vec<PathBuf>, CliError> {
        let folder = self.repository.join("tests/golden");
        let entries = std::fs::read_dir(&folder).map_err(|error| {
            CliError::file(
                &folder,
                format!(
                    "{error}; run this in a clone of the repository, or name it with --repository"
                ),
            )
        })?;
        let mut traces = Vec::new();
        for entry in entries {
            let path = entry.map_err(CliError::io(&folder))?.path();
            if path
                .extension()
                .is_some_and(|extension| extension == "jsonl")
            {
                traces.push(path);
            }
        }
        traces.sort();
        Ok(traces)
    }

    fn fly(&self, grid: &Grid) -> Result<GridResults, CliError> {
        let trained = grid.trained.map(|name| {
            let folder = self.repository.join("policies").join(name);
            let shown = folder.strip_prefix(".").unwrap_or(&folder).display();
            shown.to_string()
        });
        let policies = grid.baselines.iter().map(|&name| name.to_owned());
        let policies: Vec<String> = policies.chain(trained).collect();
        let axes = vec![
            Axis::new("policy", policies),
            Axis::new("pilot", [DEFAULT_PILOT]),
            Axis::new("uav_count", UAVS),
            Axis::new("hotspot_count", grid.hotspots),
        ];
        let cells = plan::cells(&ConfigSource::preset(grid.preset), &axes)?;
        let table = self.out.join(format!("{}.csv", grid.name));
        let frame = Frame::new(&axes, &cells, SEED, self.episodes)?;
        let mut store = Store::open(&table, frame, true)?;
        sweep::fly(&cells, &mut store, self.campaign(), &self.threads)?;
        Ok(GridResults { axes, cells, store })
    }

    fn campaign(&self) -> Campaign {
        Campaign {
            episodes: self.episodes,
            seed: SEED,
        }
    }

    /// Writes figures and a replay page of a grid, and adds its section to the report.
    fn describe(
        &self,
        grid: &Grid,
        results: &GridResults,
        report: &mut Report,
    ) -> Result<(), CliError> {
        let GridResults { axes, cells, store } = results;
        let page = page_of(grid);
        self.replay(cells, &self.out.join(&page))?;
        let folder = self.out.join(grid.name);
        files::prepare_folder(&folder)?;
        charts::draw(&folder, axes, cells, store, self.episodes)?;
        report.section(grid.heading).text(&format!(
            "{} {} episodes in each cell, seed {SEED}.",
            grid.text, self.episodes
        ));
        report.link(&page, "Watch an episode of the table's last policy");
        for (name, figure) in charts::figures(axes, cells, store, self.episodes) {
            if name == "success_over_uav_count" || name == "mission_time_over_uav_count" {
                report
                    .figure(figure.as_ref(), "")
                    .map_err(CliError::input)?;
            }
        }
        report.table(&table(axes, cells, store));
        Ok(())
    }

    /// Plays the first episode of the last cell: the last policy with the largest fleet.
    fn replay(&self, cells: &[SweepCell], path: &Path) -> Result<(), CliError> {
        let Some(cell) = cells.last() else {
            return Ok(());
        };
        let model = Model::new(cell.config)?;
        let factory = policy_factory(&cell.policy, &cell.pilot, &model)?;
        fly_page(path, &model, &factory, self.campaign().episode_seed(0))
    }
}

/// The page that plays an episode of a grid, beside the report.
fn page_of(grid: &Grid) -> String {
    format!("{}.html", grid.name)
}

/// Replays recorded episodes. Returns their number, or `None` after a message where one differs.
fn verify(golden: &[PathBuf]) -> Result<Option<usize>, CliError> {
    for path in golden {
        let recorded = read_from(path)?;
        let difference = trace::verify(&recorded).map_err(|error| CliError::trace(path, error))?;
        if let Some(difference) = difference {
            files::print(&format!("{}: differs at {difference}\n", path.display()))?;
            return Ok(None);
        }
    }
    Ok(Some(golden.len()))
}

/// A table with the main quantities of every cell of a grid.
fn table(axes: &[Axis], cells: &[SweepCell], store: &Store) -> Table {
    let columns: Vec<usize> = (0..axes.len())
        .filter(|&axis| axes[axis].values.len() > 1)
        .collect();
    let names = columns.iter().map(|&axis| title(&axes[axis].name));
    let rows = cells.iter().enumerate().map(|(index, cell)| {
        let values = columns.iter().map(|&axis| cell.values[axis].clone());
        let estimates = SHOWN.iter().map(|&(name, _, digits)| {
            let estimate = store.estimate(index, name);
            estimate.map_or(String::new(), |estimate| shown(name, estimate, digits))
        });
        values.chain(estimates).map(Into::into).collect()
    });
    Table {
        caption: INTERVALS.to_owned(),
        head: names
            .chain(SHOWN.map(|(_, title, _)| title))
            .map(str::to_owned)
            .collect(),
        rows: rows.collect(),
    }
}
