//! `jcas simulate`: runs many episodes of one fleet.

use std::path::PathBuf;

use clap::Args;
use jcas_core::{Config, Metrics, Model};
use jcas_episode::campaign::{self, Campaign};
use jcas_episode::shard::Shard;
use jcas_episode::statistics::{Estimate, FALSE_CONFIRMATIONS, Summary};
use serde::Serialize;

use crate::command_line::command_line;
use crate::config_source::ConfigSource;
use crate::error::{CliError, Outcome};
use crate::idle::Idle;
use crate::learned::PolicyFactory;
use crate::options::{ModelOptions, PolicyOptions, ThreadOptions, policy_factory};
use crate::{files, interrupt, learned, numbers, progress};

const EXAMPLES: &str = "\
Examples:
  jcas simulate
  jcas simulate --uavs 15 --hotspots 7 --policy greedy --pilot max --episodes 1000
  jcas simulate --set target_visibility=hidden --policy line --json
  jcas simulate --preset paper --config mine.toml --trace first.jsonl";

/// Run many episodes of one fleet and report success, time, energy, CO2 and throughput
///
/// Intervals cover 95 %: Wilson for the success rate, bootstrap percentiles for the means. A failed
/// episode counts its horizon as its mission time.
#[derive(Args)]
#[command(after_help = EXAMPLES)]
pub struct Simulate {
    #[command(flatten)]
    model: ModelOptions,
    #[command(flatten)]
    policy: PolicyOptions,
    /// Episodes to run
    #[arg(long, value_name = "M", default_value_t = 1000, value_parser = numbers::above_zero)]
    episodes: u64,
    /// Seed; each episode's own seed follows from it
    #[arg(long, value_name = "S", default_value_t = 1, value_parser = numbers::whole)]
    seed: u64,
    #[command(flatten)]
    threads: ThreadOptions,
    /// Print JSON
    #[arg(long)]
    json: bool,
    /// Record the first episode
    #[arg(long, value_name = "FILE")]
    trace: Option<PathBuf>,
}

/// The report of a campaign, as `--json` prints it.
#[derive(Serialize)]
pub struct Report<'a> {
    /// Name of the policy or baseline.
    pub policy: &'a str,
    /// Pilot mode: how the pilot density was chosen.
    pub pilot: &'a str,
    /// Number of UAVs.
    pub uavs: u32,
    /// Number of hotspots.
    pub hotspots: u32,
    /// Seed of the campaign.
    pub seed: u64,
    /// The nearest preset and what differs from it.
    pub preset: String,
    /// Hash of the configuration.
    pub config_hash: String,
    /// Statistics of the campaign.
    #[serde(flatten)]
    pub summary: Summary,
    #[serde(skip)]
    horizon_steps: u32,
}

impl Simulate {
    /// The options that have no effect with the policy.
    pub fn idle(&self) -> Vec<Idle> {
        self.policy.idle()
    }

    /// Runs the campaign and prints the report.
    pub fn run(self) -> Result<Outcome, CliError> {
        let pilot = self.policy.pilot.as_str();
        let (policy, config) = self.policy.choose(&self.model)?;
        let model = Model::new(config)?;
        let factory = policy_factory(&policy, pilot, &model)?;
        let campaign = Campaign {
            episodes: self.episodes,
            seed: self.seed,
        };
        if let Some(path) = &self.trace {
            super::trace::record_to(path, &model, &factory, campaign.episode_seed(0))?;
        }
        let summary = self.threads.run_episodes(self.episodes, || {
            fly(&model, campaign, &factory, "episodes")
        })??;
        let rule = learned::pilot_rule(&policy, pilot)?;
        let who = (policy.as_str(), rule.as_str());
        Report::new(who, &config, self.seed, summary).print(self.json)?;
        Ok(Outcome::Done)
    }
}

/// Runs a campaign behind a progress bar.
pub fn fly(
    model: &Model<'_>,
    campaign: Campaign,
    factory: &PolicyFactory,
    what: &str,
) -> Result<Summary, CliError> {
    let episodes = fly_part(model, campaign, Shard::WHOLE, factory, what)?;
    Ok(Summary::of(&episodes, model.config().horizon_steps))
}

/// Runs a part of a campaign behind a progress bar.
pub fn fly_part(
    model: &Model<'_>,
    campaign: Campaign,
    part: Shard,
    factory: &PolicyFactory,
    what: &str,
) -> Result<Vec<Metrics>, CliError> {
    let own = part.cell_count(campaign.episodes as usize);
    let bar = progress::bar(own as u64, what);
    let episodes = campaign::fly_part(model, campaign, part, factory, &|| {
        bar.inc(1);
        interrupt::check()
    });
    bar.finish_and_clear();
    Ok(episodes?)
}

impl<'a> Report<'a> {
    /// Builds the report of a campaign of one policy with one pilot rule.
    pub fn new(
        (policy, pilot): (&'a str, &'a str),
        config: &Config,
        seed: u64,
        summary: Summary,
    ) -> Self {
        Self {
            policy,
            pilot,
            uavs: config.uav_count,
            hotspots: config.hotspot_count,
            seed,
            preset: ConfigSource::of(config).nearest_preset(),
            config_hash: format!("0x{:016x}", config.hash()),
            summary,
            horizon_steps: config.horizon_steps,
        }
    }

    /// Prints the report as text or as JSON.
    pub fn print(&self, json: bool) -> Result<(), CliError> {
        if json {
            files::print_json(self)
        } else {
            files::print(&self.to_text())
        }
    }

    fn to_text(&self) -> String {
        let mut text = format!(
            "{} episodes: {} UAVs, {} hotspots, policy {}, pilot {}, seed {}\n\n",
            self.summary.episodes, self.uavs, self.hotspots, self.policy, self.pilot, self.seed
        );
        for quantity in self.summary.quantities() {
            let estimate = quantity.estimate;
            if quantity.name == FALSE_CONFIRMATIONS && estimate == Estimate::default() {
                continue;
            }
            let digits = decimals(estimate.value);
            let line = format!(
                "{:20} {:>10.digits$}  [{:.digits$}, {:.digits$}] {}",
                quantity.title, estimate.value, estimate.low, estimate.high, quantity.unit
            );
            text += line.trim_end();
            text.push('\n');
        }
        text += &format!(
            "\nIn brackets 95 % intervals. An episode without success counts as {} steps.\n\
             Configuration {}: {}.\nCommand: {}\n",
            self.horizon_steps,
            self.config_hash,
            self.preset,
            command_line()
        );
        text
    }
}

/// Number of decimals that leaves about four significant digits.
fn decimals(value: f64) -> usize {
    match value.abs() {
        size if size >= 100.0 => 1,
        size if size >= 10.0 => 2,
        size if size >= 1.0 || size == 0.0 => 3,
        _ => 4,
    }
}
