//! `jcas plan`: plans an episode and states its expected duration.

use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use clap::Args;
use jcas_core::{Cell, Config, Model, Sim, TargetVisibility};
use jcas_plan::{Plan as Flights, PlanFile, Planned, Progress, Settings, search, tour};

use super::replay::fly_page;
use crate::command_line::command_line;
use crate::config_source::ConfigSource;
use crate::error::{CliError, Outcome};
use crate::export::{GeoPosition, geojson, mission_of, picture};
use crate::idle::Idle;
use crate::learned::PolicyFactory;
use crate::options::{EpisodeOptions, ModelOptions};
use crate::{files, interrupt, numbers, progress};

const EXAMPLES: &str = "\
Examples:
  jcas plan --preset search --uavs 10
  jcas plan --preset search --uavs 10 --time-limit 10 -o plan.json --picture plan.svg
  jcas plan --preset paper --episode 3 --page flight.html
  jcas plan --preset search --depot 48.137,11.575 --geojson plan.geojson --qgroundcontrol flights
  jcas simulate --policy plan:plan.json";

/// Plan an episode: trajectories of least expected time, by simulated annealing
///
/// The fleet searches all cells for hidden hotspots. Known hotspots are those of --hotspot, or else
/// those of the episode. The fleet follows the plan without feedback. The plan therefore ends in a
/// single radio component. It depends only on the configuration, the seed and the iterations. A
/// time limit or Ctrl-C ends the annealing early and keeps the best plan so far.
#[derive(Args)]
#[command(after_help = EXAMPLES)]
pub struct Plan {
    #[command(flatten)]
    model: ModelOptions,
    /// Moves that the annealing tries
    #[arg(long, value_name = "COUNT", default_value_t = 1_000_000, value_parser = numbers::whole)]
    iterations: u64,
    /// Seed of the annealing
    #[arg(long, value_name = "S", default_value_t = 1, value_parser = numbers::whole)]
    plan_seed: u64,
    /// Seconds after which the annealing ends early
    #[arg(long, value_name = "SECONDS", value_parser = numbers::positive)]
    time_limit: Option<f64>,
    /// Cell of a known hotspot, x,y; repeat the option for each hotspot
    #[arg(long, value_name = "X,Y", value_parser = numbers::cell, allow_hyphen_values = true)]
    hotspot: Vec<Cell>,
    #[command(flatten)]
    episode: EpisodeOptions,
    /// Plan to write, as JSON
    #[arg(
        short,
        long,
        value_name = "FILE",
        default_value = "plan.json",
        help_heading = "Output"
    )]
    out: PathBuf,
    /// Picture of the trajectories to write, as SVG
    #[arg(long, value_name = "FILE", help_heading = "Output")]
    picture: Option<PathBuf>,
    /// HTML page to write that plays the episode of the plan
    #[arg(long, value_name = "FILE", help_heading = "Output")]
    page: Option<PathBuf>,
    /// Trajectories to write, as GeoJSON; requires --depot
    #[arg(long, value_name = "FILE", requires = "depot", help_heading = "Output")]
    geojson: Option<PathBuf>,
    /// Folder for a QGroundControl plan of each UAV; requires --depot
    #[arg(long, value_name = "DIR", requires = "depot", help_heading = "Output")]
    qgroundcontrol: Option<PathBuf>,
    /// Latitude and longitude of the first depot, in degrees; x points east, y north
    #[arg(
        long,
        value_name = "LAT,LON",
        value_parser = numbers::place,
        allow_hyphen_values = true,
        help_heading = "Output"
    )]
    depot: Option<(f64, f64)>,
    /// Altitude of the UAVs above the depot
    #[arg(
        long,
        value_name = "M",
        default_value_t = 50.0,
        value_parser = numbers::positive,
        help_heading = "Output"
    )]
    altitude_m: f64,
    /// Print JSON
    #[arg(long)]
    json: bool,
}

impl Plan {
    /// The options that have no effect with the outputs and the hotspots.
    pub fn idle(&self) -> Vec<Idle> {
        let mut idle = Vec::new();
        if self.geojson.is_none() && self.qgroundcontrol.is_none() {
            let applies = "with --geojson or --qgroundcontrol";
            idle.push(Idle::options(&["depot", "altitude_m"], applies));
        }
        if !self.hotspot.is_empty() && self.page.is_none() {
            let applies = "with --page, or without --hotspot";
            idle.push(Idle::group::<EpisodeOptions>(applies));
        }
        idle
    }

    /// Makes the plan, writes the files and prints the report.
    pub fn run(self) -> Result<Outcome, CliError> {
        let model = Model::new(self.model.load()?)?;
        let hotspots = self.hotspots(&model)?;
        let plan = self.anneal(&model, hotspots.as_deref())?;
        let file = PlanFile::new(&model, &plan, hotspots);
        files::write_atomically(&self.out, |out| {
            serde_json::to_writer(&mut *out, &file).map_err(CliError::input)
        })?;
        self.export(&model, &file, &plan)?;
        if self.json {
            files::print_json(&Report::of(&file))?;
        } else {
            files::print(&self.text(&file))?;
        }
        Ok(Outcome::Done)
    }

    /// The cells of known hotspots, or `None` where hotspots are hidden.
    fn hotspots(&self, model: &Model<'_>) -> Result<Option<Vec<Cell>>, CliError> {
        if !self.hotspot.is_empty() {
            let Config {
                grid_width: width,
                grid_height: height,
                ..
            } = *model.config();
            let off = |cell: &&Cell| cell.x >= width || cell.y >= height;
            if let Some(Cell { x, y }) = self.hotspot.iter().find(off) {
                return Err(CliError::input(format!(
                    "--hotspot {x},{y}: must be a cell from 0,0 to {},{}",
                    width - 1,
                    height - 1
                )));
            }
            if self.hotspot.len() == model.hotspot_count() {
                return Ok(Some(self.hotspot.clone()));
            }
            return Err(CliError::input(format!(
                "hotspot: {} cells are given for {} hotspots (hotspot_count)",
                self.hotspot.len(),
                model.hotspot_count()
            )));
        }
        if model.config().target_visibility == TargetVisibility::Hidden {
            return Ok(None);
        }
        let mut sim = Sim::new(model);
        sim.reset(self.episode.seed());
        let state = sim.state();
        let cells = (0..model.hotspot_count()).map(|hotspot| state.hotspot_cell(hotspot));
        Ok(Some(cells.collect()))
    }

    fn anneal(&self, model: &Model<'_>, hotspots: Option<&[Cell]>) -> Result<Flights, CliError> {
        let settings = Settings {
            iterations: self.iterations,
            seed: self.plan_seed,
        };
        let bar = progress::bar(self.iterations, "moves");
        let limit = self.time_limit.map(Duration::from_secs_f64);
        let start = Instant::now();
        let mut report = |now: Progress| {
            bar.set_position(now.iterations);
            if limit.is_some_and(|limit| start.elapsed() >= limit) {
                return ControlFlow::Break(());
            }
            interrupt::check()
        };
        let plan = match hotspots {
            Some(cells) => tour(model, cells, &settings, &mut report),
            None => search(model, &settings, &mut report),
        };
        bar.finish_and_clear();
        plan.map_err(CliError::input)
    }

    fn export(&self, model: &Model<'_>, file: &PlanFile, plan: &Flights) -> Result<(), CliError> {
        if let Some(path) = &self.picture {
            files::write_bytes(path, picture(file).as_bytes())?;
        }
        if let Some(path) = &self.page {
            let plan = plan.clone();
            let factory: PolicyFactory =
                Box::new(move || Box::new(Planned::following(plan.clone())));
            fly_page(path, model, &factory, self.episode.seed())?;
        }
        let Some((latitude, longitude)) = self.depot else {
            return Ok(());
        };
        let place = GeoPosition {
            latitude,
            longitude,
            altitude_m: self.altitude_m,
        };
        if let Some(path) = &self.geojson {
            write_json(path, &geojson(file, model.depots()[0], place))?;
        }
        if let Some(folder) = &self.qgroundcontrol {
            files::prepare_folder(folder)?;
            for uav in 0..file.uavs.len() {
                let path = folder.join(format!("uav-{}.plan", uav + 1));
                write_json(&path, &mission_of(file, uav, model.depots()[0], place))?;
            }
        }
        Ok(())
    }

    fn text(&self, file: &PlanFile) -> String {
        let mut text = format!(
            "{} UAVs, {} hotspots, {} moves, seed {}\n\n\
             expected mission time {:8.2} steps\n\
             until all confirmed   {:8.2} steps\n\
             success               {:8.4}\n\
             before the annealing  {:8.2} steps\n\
             no fixed plan below   {:8.2} steps\n\n\
             Configuration {}: {}.\nCommand: {}\n\n\
             written:\n",
            file.uavs.len(),
            file.config.hotspot_count,
            file.iterations,
            file.seed,
            file.expected_steps,
            file.expected_confirmed_steps,
            file.success,
            file.start_steps,
            file.bound_steps,
            file.config_hash,
            ConfigSource::of(&file.config).nearest_preset(),
            command_line(),
        );
        let optional = [
            &self.picture,
            &self.page,
            &self.geojson,
            &self.qgroundcontrol,
        ];
        for path in [&self.out]
            .into_iter()
            .chain(optional.into_iter().flatten())
        {
            text += &format!("  {}\n", path.display());
        }
        if file.stopped {
            text += &format!(
                "\nThe annealing was ended after {} of {} moves; the plan depends on when.\n",
                file.iterations, self.iterations
            );
        }
        text
    }
}

fn write_json(path: &Path, value: &serde_json::Value) -> Result<(), CliError> {
    files::write_bytes(path, format!("{value:#}\n").as_bytes())
}

/// The output of `--json`: the plan without its trajectories.
#[derive(serde::Serialize)]
struct Report<'a> {
    preset: String,
    config_hash: &'a str,
    seed: u64,
    iterations: u64,
    stopped: bool,
    expected_steps: f64,
    expected_confirmed_steps: f64,
    success: f64,
    start_steps: f64,
    bound_steps: f64,
}

impl<'a> Report<'a> {
    fn of(file: &'a PlanFile) -> Self {
        Self {
            preset: ConfigSource::of(&file.config).nearest_preset(),
            config_hash: &file.config_hash,
            seed: file.seed,
            iterations: file.iterations,
            stopped: file.stopped,
            expected_steps: file.expected_steps,
            expected_confirmed_steps: file.expected_confirmed_steps,
            success: file.success,
            start_steps: file.start_steps,
            bound_steps: file.bound_steps,
        }
    }
}
