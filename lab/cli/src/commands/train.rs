//! `jcas-lab train`: trains a policy from random weights.

use std::num::NonZeroUsize;
use std::path::PathBuf;

use clap::{Args, ValueEnum};
use indicatif::ProgressBar;
use jcas_cli::error::{CliError, Outcome};
use jcas_cli::options::{ConfigOptions, ThreadOptions};
use jcas_cli::{files, interrupt};
use jcas_core::{Config, Model, TargetVisibility};
use jcas_episode::card::Card;
use jcas_train::draw::draw;
use jcas_train::metrics::Row;
use jcas_train::policy::files::Precision;
use jcas_train::run::{Observer, RunOutcome, RunSpec, Start};
use jcas_train::settings::{Preset, Settings};
use toml::Table;

use super::failed;

const EXAMPLES: &str = "\
Examples:
  jcas-lab train --uavs 10 --hotspots 5 --out run
  jcas-lab train --train-preset paper --preset paper --uavs 15 --hotspots 3,5,7 --out runs
  jcas-lab train --uavs 5,10 --hotspots 3,5 --out run
  jcas-lab train --preset paper --set uav_tag=index --draw 20 --out any-fleet
  jcas-lab train --out run --resume
  jcas-lab train --out tuned --from run --train-set learning_rate=0.0001
  jcas-lab train --preset paper --set uav_tag=index --draw 100 --train-preset time \
    --train-set constant_pilot=0.05 --train-set workers=100 --from policies/paper --out mine
  jcas evaluate run";

/// Settings to start from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum TrainingPreset {
    /// What the measurements kept
    Tuned,
    /// Imitation of the baseline squads, for a radar that detects in the own cell only
    Mission,
    /// The paper's table
    Paper,
    /// A step costs one and nothing else counts; for a policy that ends its episodes already
    Time,
}

/// Train a policy with PPO and write it as safetensors and a JSON card
///
/// Metrics go to metrics.csv in the run's folder. Ctrl-C saves; a run
/// that was stopped or killed goes on with --resume, bit for bit. Several fleet sizes or numbers of
/// hotspots, and drawn configurations, train one policy for all of them. That needs the network
/// `set` or `turns`.
#[derive(Args)]
#[command(after_help = EXAMPLES)]
pub struct Train {
    #[command(flatten)]
    config: ConfigOptions,
    /// UAVs in the fleet; several with commas
    #[arg(
        long,
        value_name = "N",
        value_delimiter = ',',
        help_heading = "Configuration"
    )]
    uavs: Vec<u32>,
    /// Hotspots to find; several with commas
    #[arg(
        long,
        value_name = "n",
        value_delimiter = ',',
        help_heading = "Configuration"
    )]
    hotspots: Vec<u32>,
    /// Draw this many configurations from the seed. Each has its own fleet (up to 24 UAVs),
    /// hotspots (1 to 11), grid (8 to 16 cells a side) and depot. The sensing range is 0.75 to 1.25
    /// of the configured one. Where the fleet cannot expect to confirm all hotspots within the
    /// horizon, it draws again
    #[arg(
        long,
        value_name = "COUNT",
        conflicts_with_all = ["uavs", "hotspots"],
        help_heading = "Configuration"
    )]
    draw: Option<NonZeroUsize>,
    /// Training settings to start from, none of which is for hidden hotspots [default: mission
    /// where no UAV detects one from a neighbouring cell, else tuned]
    #[arg(long, value_enum, help_heading = "Training")]
    train_preset: Option<TrainingPreset>,
    /// TOML or JSON file whose settings replace those of the preset
    #[arg(long, value_name = "FILE", help_heading = "Training")]
    train_file: Option<PathBuf>,
    /// One setting; may be repeated; comes after the file
    #[arg(long, value_name = "SETTING=VALUE", help_heading = "Training")]
    train_set: Vec<String>,
    /// Environment steps to train for
    #[arg(long, value_name = "STEPS", help_heading = "Training")]
    steps: Option<u64>,
    /// Seed of the run
    #[arg(long, value_name = "S", help_heading = "Training")]
    seed: Option<u64>,
    /// Print the settings as TOML and stop
    #[arg(long, help_heading = "Training")]
    show_settings: bool,
    /// Folder of the run
    #[arg(long, short, value_name = "DIR", default_value = "run")]
    out: PathBuf,
    /// Name of the policy in reports [default: the folder's]
    #[arg(long, value_name = "NAME")]
    name: Option<String>,
    /// Device of the tensors: cpu, or cuda, wgpu where built in
    #[arg(
        long,
        value_name = "DEVICE",
        default_value = "cpu",
        help_heading = "Training"
    )]
    device: String,
    /// Store weights in half precision
    #[arg(long)]
    half: bool,
    /// Go on with the run in the folder, if there is one
    #[arg(long)]
    resume: bool,
    /// Folder of a run or of a policy whose weights this run starts from, in place of random
    /// weights; the settings are this run's
    #[arg(long, value_name = "RUN", conflicts_with = "resume")]
    from: Option<PathBuf>,
    #[command(flatten)]
    threads: ThreadOptions,
}

impl Train {
    /// Trains and reports.
    pub fn run(self) -> Result<Outcome, CliError> {
        let settings = self.settings()?;
        if self.show_settings {
            let text = toml::to_string(&settings).map_err(CliError::input)?;
            files::print(&text)?;
            return Ok(Outcome::Done);
        }
        let plan = self.plan(settings)?;
        let mut watcher = Watcher::new(plan.settings.iterations());
        let ending = self
            .threads
            .run(|| plan.train(&self.origin(), &mut watcher))?
            .map_err(failed)?;
        watcher.bar.finish_and_clear();
        match ending {
            RunOutcome::Finished(card) => {
                files::print(&summary(&card, &plan))?;
                Ok(Outcome::Done)
            }
            RunOutcome::Stopped => Err(CliError::Interrupted(format!(
                "stopped; the run is saved in {}, go on with --resume",
                plan.out.display()
            ))),
        }
    }

    fn origin(&self) -> Start {
        match &self.from {
            Some(folder) => Start::Run(folder.clone()),
            None if self.resume => Start::Resume,
            None => Start::Fresh,
        }
    }

    fn plan(&self, settings: Settings) -> Result<RunSpec, CliError> {
        let name = self
            .name
            .clone()
            .or_else(|| Some(self.out.file_name()?.to_string_lossy().into_owned()));
        let (configs, drawn_around) = match self.draw {
            Some(count) => {
                let base = self.config.source()?.resolve()?;
                let drawn = draw(&base, count.get(), settings.seed).map_err(CliError::input)?;
                (drawn, Some(base))
            }
            None => (self.configs()?, None),
        };
        Ok(RunSpec {
            settings,
            configs,
            drawn_around,
            out: self.out.clone(),
            name: name.unwrap_or_else(|| "policy".to_owned()),
            precision: if self.half {
                Precision::Half
            } else {
                Precision::Single
            },
            device: self.device.clone(),
        })
    }

    fn configs(&self) -> Result<Vec<Config>, CliError> {
        let source = self.config.source()?;
        let base = source.resolve()?;
        let or = |given: &[u32], configured: u32| {
            if given.is_empty() {
                vec![configured]
            } else {
                given.to_vec()
            }
        };
        let mut configs = Vec::new();
        for uavs in or(&self.uavs, base.uav_count) {
            for hotspots in or(&self.hotspots, base.hotspot_count) {
                let mut source = source.clone();
                source.set("uav_count", uavs)?;
                source.set("hotspot_count", hotspots)?;
                configs.push(source.resolve()?);
            }
        }
        Ok(configs)
    }

    fn settings(&self) -> Result<Settings, CliError> {
        let preset = match self.train_preset {
            Some(TrainingPreset::Tuned) => Preset::Tuned,
            Some(TrainingPreset::Mission) => Preset::Mission,
            Some(TrainingPreset::Paper) => Preset::Paper,
            Some(TrainingPreset::Time) => Preset::Time,
            None => fitting(&self.config.source()?.resolve()?)?,
        };
        let mut table = Table::try_from(Settings::preset(preset)).map_err(CliError::input)?;
        if let Some(path) = &self.train_file {
            let text = files::read_text(path)?;
            let json = path
                .extension()
                .is_some_and(|extension| extension == "json");
            let fields: Table = if json {
                serde_json::from_str(&text).map_err(|error| CliError::file(path, error))?
            } else {
                toml::from_str(&text).map_err(|error| CliError::file(path, error))?
            };
            merge(&mut table, fields);
        }
        for assignment in &self.train_set {
            assign(&mut table, assignment)?;
        }
        let mut settings: Settings = table.try_into().map_err(|error: toml::de::Error| {
            CliError::input(format!("training settings: {}", error.message()))
        })?;
        settings.total_steps = self.steps.unwrap_or(settings.total_steps);
        settings.seed = self.seed.unwrap_or(settings.seed);
        settings.validate().map_err(CliError::input)?;
        Ok(settings)
    }
}

/// The settings that were kept for missions like this one.
fn fitting(config: &Config) -> Result<Preset, CliError> {
    let model = Model::new(*config).map_err(CliError::input)?;
    let from_next_cell = model.detection_probability(1, 0, config.pilot_density_max);
    match config.target_visibility {
        TargetVisibility::Hidden => Err(CliError::input(
            "target_visibility: hidden has no training preset; `jcas plan` plans the search, \
             --train-preset trains nevertheless",
        )),
        TargetVisibility::Known if from_next_cell < 0.01 => Ok(Preset::Mission),
        TargetVisibility::Known => Ok(Preset::Tuned),
    }
}

/// Replaces the values of a table that another one names, in groups too.
fn merge(table: &mut Table, others: Table) {
    for (name, value) in others {
        match (table.get_mut(&name), value) {
            (Some(toml::Value::Table(group)), toml::Value::Table(others)) => merge(group, others),
            (_, value) => {
                table.insert(name, value);
            }
        }
    }
}

/// Puts `setting=value` into a table; `none` removes a setting, a dot reaches into a group.
fn assign(table: &mut Table, assignment: &str) -> Result<(), CliError> {
    let refused = |what: &str| CliError::input(format!("--train-set {assignment}: {what}"));
    let (path, text) = assignment
        .split_once('=')
        .ok_or_else(|| refused("must be of the form setting=value"))?;
    let (path, text) = (path.trim(), text.trim());
    let (groups, setting) = match path.rsplit_once('.') {
        None => (None, path),
        Some((groups, setting)) => (Some(groups), setting),
    };
    let mut group = table;
    for name in groups.iter().flat_map(|groups| groups.split('.')) {
        let entry = group
            .entry(name)
            .or_insert_with(|| toml::Value::Table(Table::new()));
        group = entry
            .as_table_mut()
            .ok_or_else(|| refused(&format!("{name} is no group of settings")))?;
    }
    if text == "none" {
        group.remove(setting);
        return Ok(());
    }
    let value = toml::from_str::<Table>(&format!("value = {text}"))
        .ok()
        .and_then(|mut table| table.remove("value"))
        .unwrap_or_else(|| toml::Value::String(text.to_owned()));
    group.insert(setting.to_owned(), value);
    Ok(())
}

/// The summary of a run, as text.
fn summary(card: &Card, plan: &RunSpec) -> String {
    let mut text = format!(
        "{}: trained for {} environment steps; flown {:?} from now on\n\n",
        plan.out.display(),
        card.environment_steps.unwrap_or_default(),
        card.mode
    )
    .to_lowercase();
    for e in &card.evaluations {
        text += &format!(
            "N = {:2}, n = {:2}, {:13}  success {:.3}  steps {:6.2}  energy {:.4} kWh  \
             throughput {:.3}\n",
            e.uav_count,
            e.hotspot_count,
            format!("{:?}", e.mode).to_lowercase(),
            e.success_rate,
            e.mission_steps_mean,
            e.energy_kwh_mean,
            e.throughput_mean
        );
    }
    text + "\nMissions of seed 1, as in `jcas simulate`; a failed one counts with its horizon.\n"
}

/// Shows each iteration on one line, and stops at Ctrl-C.
struct Watcher {
    bar: ProgressBar,
}

impl Watcher {
    fn new(iterations: u64) -> Watcher {
        let style = indicatif::ProgressStyle::with_template("[{bar:24}] {pos}/{len} {msg}")
            .expect("the template is valid")
            .progress_chars("=> ");
        Watcher {
            bar: ProgressBar::new(iterations).with_style(style),
        }
    }
}

impl Observer for Watcher {
    fn iteration(&mut self, row: &Row, _total: u64, left_s: f64) {
        let number = |value: Option<f64>, digits: usize| {
            value.map_or("-".to_owned(), |value| format!("{value:.digits$}"))
        };
        self.bar.set_position(row.iteration);
        self.bar.set_message(format!(
            "return {} success {} steps {} entropy {:.2} KL {:.4} clip {:.2} EV {:.2} \
             {:.0} steps/s, {left_s:.0} s left",
            number(row.return_mean, 1),
            row.success(),
            number(row.mission_steps_mean, 1),
            row.entropy,
            row.kl,
            row.clip_fraction,
            row.explained_variance,
            row.steps_per_s,
        ));
    }

    fn stop(&mut self) -> bool {
        interrupt::requested()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parsed(text: &str) -> Table {
        toml::from_str(text).unwrap()
    }

    #[test]
    fn a_setting_in_a_group_leaves_the_others() {
        let mut table =
            parsed("clip = 0.2\n[shaping]\ntime_penalty = 0.3\n[shaping.factors]\nenergy = 100.0");
        assign(&mut table, "shaping.factors.energy=10.0").unwrap();
        assign(&mut table, "shaping.factors.throughput=0.5").unwrap();
        assign(&mut table, "clip=none").unwrap();
        merge(&mut table, parsed("[shaping]\ninforming = 20.0"));
        let expected = "[shaping]\ntime_penalty = 0.3\ninforming = 20.0\n\
                        [shaping.factors]\nenergy = 10.0\nthroughput = 0.5";
        assert_eq!(table, parsed(expected));
        let refused = assign(&mut table, "shaping.time_penalty.low=1").unwrap_err();
        assert!(refused.to_string().contains("time_penalty is no group"));
    }
}
