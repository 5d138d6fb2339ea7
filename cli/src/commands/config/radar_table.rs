//! `jcas config radar-table`: checks a detection table and plots it.

use std::ffi::OsStr;
use std::path::{Path, PathBuf};

use clap::Args;
use comfy_table::Table;
use comfy_table::presets::NOTHING;
use jcas_core::config::Depots;
use jcas_core::{Config, Model};
use jcas_figures::{Axis, Draw, Figure, Interval, Mark, Point, Series};

use crate::config_source::{ConfigSource, PresetName};
use crate::error::{CliError, Outcome};
use crate::files;
use crate::radar_table::RadarTable;

const EXAMPLES: &str = "\
The file is a CSV with names in its first line. It has the columns
  range_m        distance between UAV and hotspot in metres, from 0 to 1e6, ascending
  p_d            probability of detection, above 0 and below 1, not rising with the range; the
                 last one is at most 0.1, since it holds at longer ranges
  pilot_density  optional; the table is made of the lines with pilot_density_max
At most 64 lines make a table. Other columns are not read.

Examples:
  jcas config radar-table p_d.csv
  jcas config radar-table p_d.csv --set pilot_gain=coherent --figure p_d.svg
  jcas simulate --radar-table p_d.csv --set pilot_gain=coherent";

/// Ranges at which the figure has the curve that flies.
const STEPS: u32 = 400;

/// Check a table of P_d over the range in a CSV file, and plot it as it flies
#[derive(Args)]
#[command(after_help = EXAMPLES)]
pub struct Check {
    /// CSV file
    #[arg(value_name = "FILE")]
    file: PathBuf,
    /// One field of the configuration, such as pilot_gain=coherent; may be repeated
    #[arg(long, value_name = "FIELD=VALUE")]
    set: Vec<String>,
    /// Figure to write, by its name an SVG or a PNG: P_d of the file and P_d as it flies
    #[arg(long, value_name = "FIGURE")]
    figure: Option<PathBuf>,
}

impl Check {
    /// Runs the subcommand.
    pub fn run(self) -> Result<Outcome, CliError> {
        let table = RadarTable::read(&self.file)?;
        let mut source = ConfigSource::preset(PresetName::Mission);
        for assignment in &self.set {
            source.assign(assignment)?;
        }
        source.set_radar_table(&table)?;
        let curve = TableCurve::of(&source.resolve()?, &table)?;
        if let Some(path) = &self.figure {
            curve.draw(&table, path)?;
        }
        files::print(&format!(
            "{}: valid, {} points at pilot density {}\n\n{}\n",
            self.file.display(),
            curve.config.detection_table.len(),
            curve.config.pilot_density_max,
            curve.summary()
        ))?;
        Ok(Outcome::Done)
    }
}

/// The kernel's P_d on a grid that is finer than that of an episode.
struct TableCurve {
    config: Config,
    model: Model<'static>,
    densities: Vec<f64>,
}

impl TableCurve {
    fn of(config: &Config, table: &RadarTable) -> Result<Self, CliError> {
        let points = config.detection_table.as_slice();
        let longest_m = points.last().map_or(0.0, |last| last.range_m);
        let fine = Config {
            grid_width: STEPS + 1,
            cell_size_m: (longest_m / f64::from(STEPS)).max(0.001),
            depots: Depots::CENTRE,
            ..*config
        };
        let mut densities = table.densities();
        if densities.is_empty() {
            densities = vec![config.pilot_density_max, config.pilot_density_min];
        }
        Ok(Self {
            config: *config,
            model: Model::new(fine)?,
            densities,
        })
    }

    /// P_d at each step of range.
    fn curve(&self, density: f64) -> impl Iterator<Item = (f64, f64)> {
        let step_m = self.model.config().cell_size_m;
        (0..=STEPS).map(move |step| {
            let p_d = self.model.detection_probability(step, 0, density);
            (f64::from(step) * step_m, p_d)
        })
    }

    /// For each pilot density the longest range, in steps, at which P_d is at least 0.5.
    fn summary(&self) -> Table {
        let mut rows = Table::new();
        rows.load_preset(NOTHING)
            .set_header(["pilot density", "range at P_d = 0.5"]);
        for &density in &self.densities {
            rows.add_row([density.to_string(), self.range_at_half(density)]);
        }
        rows
    }

    fn range_at_half(&self, density: f64) -> String {
        let within = self.curve(density).take_while(|&(_, p_d)| p_d >= 0.5);
        match within.enumerate().last() {
            None => "none".to_owned(),
            // A lower density can have a higher P_d where the pilots' load costs more than they
            // gain.
            Some((step, _)) if step == STEPS as usize => "not reached within the table".to_owned(),
            Some((_, (range_m, _))) => format!("{range_m:.1} m"),
        }
    }

    fn draw(&self, table: &RadarTable, path: &Path) -> Result<(), CliError> {
        let mut figure = Figure::new(
            "Probability of detection over the range",
            Axis::new("range", "m"),
            Axis::new("probability of detection", "").span(0.0, 1.0),
        )
        .note(format!(
            "Points: the file. Lines: as they fly, with pilot_gain = {} and a slope of {} per dB.",
            self.config.pilot_gain.name(),
            self.config.logistic_slope_per_db
        ));
        for (index, &density) in self.densities.iter().enumerate() {
            let line = self.curve(density).map(|(x, y)| Point::new(x, y)).collect();
            let name = format!("pilot density {density}");
            figure = figure.with(
                Series::line(name, line)
                    .styled(Mark::PlainLine, Interval::Whiskers)
                    .palette(index),
            );
        }
        // A file without densities has points at the highest alone.
        let in_file = table.densities().len().max(1);
        for (index, &density) in self.densities.iter().take(in_file).enumerate() {
            let points = table.points(density);
            let points = points.map(|point| Point::new(point.range_m, point.probability));
            let name = format!("{density} in the file");
            figure = figure.with(Series::points(name, points.collect()).palette(index));
        }
        let bytes = match path.extension().and_then(OsStr::to_str) {
            Some("svg") => figure.svg().map_err(CliError::input)?.into_bytes(),
            Some("png") => figure.png().map_err(CliError::input)?,
            _ => {
                return Err(CliError::input(format!(
                    "--figure {}: must end in .svg or .png",
                    path.display()
                )));
            }
        };
        files::write_bytes(path, &bytes)
    }
}
