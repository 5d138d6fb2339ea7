//! `jcas config`: shows and checks configurations.

mod radar_table;

use std::path::{Path, PathBuf};

use clap::{Args, Subcommand, ValueEnum};
use comfy_table::presets::NOTHING;
use comfy_table::{ContentArrangement, Table};
use jcas_core::config::{FieldInfo, FieldValue};
use jcas_core::{Config, DetectionCurve, Model, Preset};
use serde::Serialize;

use crate::config_source::{ConfigSource, PresetName};
use crate::error::{CliError, Outcome};
use crate::fields::by_subject;
use crate::files;
use crate::options::ModelOptions;

const SHOW_EXAMPLES: &str = "\
Examples:
  jcas config show
  jcas config show --preset paper --set uav_count=15
  jcas config show --format toml > mine.toml";
const CHECK_EXAMPLES: &str = "\
Examples:
  jcas config check mine.toml";

/// Show the effective configuration, check a file, list the presets, check a detection table
#[derive(Subcommand)]
pub enum ConfigCommand {
    Show(Show),
    Check(Check),
    Presets(Presets),
    RadarTable(radar_table::Check),
}

/// Show every field of the effective configuration with its unit, legal range and meaning
#[derive(Args)]
#[command(after_help = SHOW_EXAMPLES)]
pub struct Show {
    #[command(flatten)]
    model: ModelOptions,
    /// Output format; toml and json can be read back with --config
    #[arg(long, value_enum, default_value_t = Format::Table)]
    format: Format,
    /// The same as --format json
    #[arg(long, conflicts_with = "format")]
    json: bool,
}

#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Format {
    Table,
    Toml,
    Json,
}

/// Check files: unknown fields, types, ranges, and fields that contradict each other
#[derive(Args)]
#[command(after_help = CHECK_EXAMPLES)]
pub struct Check {
    /// TOML or JSON files
    #[arg(required = true, value_name = "FILE")]
    files: Vec<PathBuf>,
    /// Values for the fields that a file does not name, unless the file names a preset
    #[arg(long, value_enum, default_value_t = PresetName::Mission)]
    preset: PresetName,
    /// Print JSON
    #[arg(long)]
    json: bool,
}

/// The result of `check --json` for one file.
#[derive(Serialize)]
struct Valid<'a> {
    file: &'a Path,
    config_hash: String,
}

/// List the presets and the fields in which they differ
#[derive(Args)]
pub struct Presets {
    /// Print JSON: every field of every preset
    #[arg(long)]
    json: bool,
}

impl ConfigCommand {
    /// Runs the subcommand.
    pub fn run(self) -> Result<Outcome, CliError> {
        match self {
            Self::Show(command) => command.run(),
            Self::Check(command) => command.run(),
            Self::Presets(command) => command.run(),
            Self::RadarTable(command) => command.run(),
        }
    }
}

impl Show {
    fn run(self) -> Result<Outcome, CliError> {
        let config = self.model.load()?;
        match if self.json { Format::Json } else { self.format } {
            Format::Json => files::print_json(&config)?,
            Format::Toml => {
                files::print(&toml::to_string(&config).map_err(CliError::input)?)?;
            }
            Format::Table => files::print(&table(&config)?)?,
        }
        Ok(Outcome::Done)
    }
}

/// The width of a table that is written to no terminal.
const PIPE_COLUMNS: u16 = 120;

/// Shows the effective value of each field that may be derived from others.
fn table(config: &Config) -> Result<String, CliError> {
    let model = Model::new(*config)?;
    let values = config.values();
    let mut text = String::new();
    for (subject, fields) in by_subject() {
        let mut table = Table::new();
        table
            .load_preset(NOTHING)
            .set_content_arrangement(ContentArrangement::Dynamic)
            .set_header([subject, "value", "unit", "legal", "meaning"]);
        if table.width().is_none() {
            table.set_width(PIPE_COLUMNS);
        }
        for index in fields {
            let (info, value) = (&Config::FIELDS[index], &values[index]);
            let legal = match value {
                FieldValue::Choice(..) => String::new(),
                _ => format!("{} to {}", info.low, info.high),
            };
            table.add_row([
                info.name.to_owned(),
                shown(info, value, &model),
                info.unit.to_owned(),
                legal,
                info.doc.trim().to_owned(),
            ]);
        }
        text += &format!("{table}\n\n");
    }
    Ok(format!(
        "{text}configuration hash 0x{:016x}\n",
        config.hash()
    ))
}

fn shown(info: &FieldInfo, value: &FieldValue<'_>, model: &Model<'_>) -> String {
    match value {
        FieldValue::Integer(number) => number.to_string(),
        FieldValue::Real(number) | FieldValue::Optional(Some(number)) => number.to_string(),
        FieldValue::Choice(name, _) => (*name).to_owned(),
        FieldValue::Optional(None) => match derived(info.name, model) {
            Some(number) => format!("{number} (derived)"),
            None => "none".to_owned(),
        },
        FieldValue::Cells(_) => {
            let cells: Vec<String> = model
                .depots()
                .iter()
                .map(|cell| format!("[{}, {}]", cell.x, cell.y))
                .collect();
            cells.join(" ")
        }
        FieldValue::Table(table) if table.is_empty() => "none".to_owned(),
        FieldValue::Table(_) => value.to_string(),
    }
}

/// The value that the model derives for a field that is absent, if it has one.
fn derived(field: &str, model: &Model<'_>) -> Option<f64> {
    let config = model.config();
    match field {
        "detection_threshold_db" => (config.detection_curve == DetectionCurve::Logistic)
            .then(|| model.detection_threshold_db()),
        "range_min_m" => Some(config.cell_size_m / 2.0),
        "range_resolution_m" => Some(SPEED_OF_LIGHT_M_PER_S / (2.0 * config.bandwidth_hz)),
        _ => None,
    }
}

const SPEED_OF_LIGHT_M_PER_S: f64 = 299_792_458.0;

impl Check {
    fn run(self) -> Result<Outcome, CliError> {
        let mut valid = Vec::new();
        for path in &self.files {
            let mut source = ConfigSource::preset(self.preset);
            source.overlay_file(path)?;
            let config = source
                .resolve()
                .map_err(|error| CliError::file(path, error))?;
            valid.push(Valid {
                file: path,
                config_hash: format!("0x{:016x}", config.hash()),
            });
        }
        if self.json {
            files::print_json(&valid)?;
        } else {
            for Valid { file, config_hash } in &valid {
                files::print(&format!(
                    "{}: valid, configuration hash {config_hash}\n",
                    file.display()
                ))?;
            }
        }
        Ok(Outcome::Done)
    }
}

impl Presets {
    fn run(self) -> Result<Outcome, CliError> {
        let presets = Preset::ALL
            .iter()
            .map(|&preset| (preset, Config::preset(preset)));
        if self.json {
            let all: serde_json::Map<_, _> = presets
                .map(|(preset, config)| (preset.name().to_owned(), serde_json::json!(config)))
                .collect();
            files::print_json(&all)?;
            return Ok(Outcome::Done);
        }
        let mut table = Table::new();
        let names = Preset::ALL.iter().map(|preset| preset.name());
        table
            .load_preset(NOTHING)
            .set_header(["field"].into_iter().chain(names));
        let model = Model::new(Config::default())?;
        let configs: Vec<_> = presets.map(|(_, config)| config).collect();
        let values: Vec<_> = configs.iter().map(Config::values).collect();
        for (index, info) in Config::FIELDS.iter().enumerate() {
            if values.iter().any(|of| of[index] != values[0][index]) {
                let cells = values.iter().map(|of| shown(info, &of[index], &model));
                table.add_row([info.name.to_owned()].into_iter().chain(cells));
            }
        }
        files::print(&format!(
            "mission  the paper with its billing and payment corrected (the default)\n\
             paper    the letter of every equation of the paper\n\
             search   hidden hotspots that radar reaches from afar, shared search maps\n\
             isac     search with coherent pilots, a fluctuating echo, false alarms and reports\n\n\
             They differ in:\n{table}\n"
        ))?;
        Ok(Outcome::Done)
    }
}
