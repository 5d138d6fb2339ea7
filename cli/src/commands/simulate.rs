//! `jcas simulate`: many missions of one fleet.

use std::path::PathBuf;

use clap::Args;
use jcas_core::{Config, Model};
use jcas_episode::mission::{self, Campaign};
use jcas_episode::statistics::Summary;
use serde::Serialize;

use crate::error::{CliError, Outcome};
use crate::learned::PolicyFactory;
use crate::options::{MissionOptions, PolicyOptions, ThreadOptions};
use crate::{files, interrupt, learned, progress};

const EXAMPLES: &str = "\
Examples:
  jcas simulate
  jcas simulate --uavs 15 --hotspots 7 --policy swarm --pilot max --episodes 1000
  jcas simulate --set target_visibility=hidden --policy sweep --json
  jcas simulate --preset paper --config mine.toml --trace first.jsonl";

/// Fly many missions of one fleet and report success, time, energy, CO2 and throughput
///
/// Intervals are 95 %: Wilson for the success rate, bootstrap percentiles for the means. A mission
/// without success counts with its horizon in the mission time.
#[derive(Args)]
#[command(after_help = EXAMPLES)]
pub struct Simulate {
    #[command(flatten)]
    mission: MissionOptions,
    #[command(flatten)]
    policy: PolicyOptions,
    /// Missions to fly
    #[arg(long, value_name = "M", default_value_t = 1000, value_parser = clap::value_parser!(u64).range(1..))]
    episodes: u64,
    /// Seed; each mission's own seed follows from it
    #[arg(long, value_name = "S", default_value_t = 1)]
    seed: u64,
    #[command(flatten)]
    threads: ThreadOptions,
    /// Print JSON
    #[arg(long)]
    json: bool,
    /// Record the first mission
    #[arg(long, value_name = "FILE")]
    trace: Option<PathBuf>,
}

/// The report of a campaign, as `--json` prints it.
#[derive(Serialize)]
pub struct Report<'a> {
    /// Who flew.
    pub policy: &'a str,
    /// How the pilot density was chosen.
    pub pilot: &'a str,
    /// UAVs.
    pub uavs: u32,
    /// Hotspots.
    pub hotspots: u32,
    /// Seed of the campaign.
    pub seed: u64,
    /// Hash of the configuration.
    pub config_hash: String,
    /// What came out.
    #[serde(flatten)]
    pub summary: Summary,
    #[serde(skip)]
    horizon_steps: u32,
}

impl Simulate {
    /// Flies and reports.
    pub fn run(self) -> Result<Outcome, CliError> {
        let config = self.mission.load_for(&self.policy.policy)?;
        let model = Model::new(config)?;
        let factory = self.policy.factory(&model)?;
        let campaign = Campaign {
            episodes: self.episodes,
            seed: self.seed,
        };
        if let Some(path) = &self.trace {
            super::trace::record_to(path, &model, &factory, campaign.episode_seed(0))?;
        }
        let summary = self
            .threads
            .run(|| fly(&model, campaign, &factory, "missions"))??;
        let PolicyOptions { policy, pilot } = &self.policy;
        let who = (policy.as_str(), learned::pilot_rule(policy, pilot));
        Report::new(who, &config, self.seed, summary).print(self.json)?;
        Ok(Outcome::Done)
    }
}

/// Flies a campaign behind a progress bar.
pub fn fly(
    model: &Model<'_>,
    campaign: Campaign,
    factory: &PolicyFactory,
    what: &str,
) -> Result<Summary, CliError> {
    let bar = progress::bar(campaign.episodes, what);
    let missions = mission::fly(model, campaign, factory, &|| {
        bar.inc(1);
        interrupt::check()
    });
    bar.finish_and_clear();
    Ok(Summary::of(&missions?, model.config().horizon_steps))
}

impl<'a> Report<'a> {
    /// Of missions that a policy flew with a pilot rule.
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
            config_hash: format!("0x{:016x}", config.hash()),
            summary,
            horizon_steps: config.horizon_steps,
        }
    }

    /// Prints the report for people, or as JSON.
    pub fn print(&self, json: bool) -> Result<(), CliError> {
        if json {
            files::print_json(self)
        } else {
            files::print(&self.to_text())
        }
    }

    fn to_text(&self) -> String {
        let mut text = format!(
            "{} missions: {} UAVs, {} hotspots, policy {}, pilot {}, seed {}\n\n",
            self.summary.episodes, self.uavs, self.hotspots, self.policy, self.pilot, self.seed
        );
        for quantity in self.summary.quantities() {
            let estimate = quantity.estimate;
            let digits = decimals(estimate.value);
            text += &format!(
                "{:20} {:>10.digits$}  [{:.digits$}, {:.digits$}] {}\n",
                quantity.title, estimate.value, estimate.low, estimate.high, quantity.unit
            );
        }
        text += &format!(
            "\nIn brackets 95 % intervals. A mission without success counts as {} steps.\n",
            self.horizon_steps
        );
        text
    }
}

/// Decimals that leave about four significant digits.
fn decimals(value: f64) -> usize {
    match value.abs() {
        size if size >= 100.0 => 1,
        size if size >= 10.0 => 2,
        size if size >= 1.0 || size == 0.0 => 3,
        _ => 4,
    }
}
