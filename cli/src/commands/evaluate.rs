//! `jcas evaluate`: runs a policy or baseline on fixed seeds.

use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};
use jcas_core::Model;
use jcas_episode::campaign::Campaign;
use jcas_episode::card::EVALUATION_SEED;
use jcas_episode::shard::Shard;
use jcas_policy::BaselineKind;
use jcas_policy::head::Mode;

use super::simulate::{Report, fly};
use crate::error::{CliError, Outcome};
use crate::evaluation::{self, Evaluation};
use crate::idle::Idle;
use crate::learned;
use crate::numbers;
use crate::options::{self, ModelOptions, ThreadOptions, policy_factory};
use crate::planned;

const EXAMPLES: &str = "\
Examples:
  jcas evaluate run --uavs 10 --hotspots 5
  jcas evaluate run --uavs 10 --hotspots 5 --mode sampled --json
  jcas evaluate teams --pilot adaptive --uavs 15 --hotspots 7
  jcas evaluate run --episodes 100000 --out parts --shard 2/8";

/// The way in which a learned policy turns its outputs into actions.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum ModeName {
    /// The mode on the policy's card
    Card,
    /// The most likely motion and the mean pilot density
    Deterministic,
    /// A draw that follows from the episode's seed
    Sampled,
}

/// Evaluate a trained policy or a baseline on the published seeds
///
/// The episodes and the report are those of `jcas simulate` with the same seed. A trained policy
/// runs with the configuration on its card. Options change single fields of that configuration;
/// --preset or --config replaces all fields. Standard error lists what the options change. A policy
/// whose dimensions do not fit is refused.
#[derive(Args)]
#[command(after_help = EXAMPLES)]
pub struct Evaluate {
    /// Folder of a trained policy, or a baseline's name
    policy: String,
    /// Pilot density: a number such as 0.15, min, mid, max or adaptive; adaptive uses a trained
    /// policy's own density
    #[arg(long, value_name = "MODE", default_value = crate::options::DEFAULT_PILOT)]
    pilot: String,
    /// How a learned policy turns its outputs into actions
    #[arg(long, value_enum, default_value_t = ModeName::Card)]
    mode: ModeName,
    #[command(flatten)]
    model: ModelOptions,
    /// Episodes to fly
    #[arg(long, value_name = "M", default_value_t = 1000, value_parser = numbers::above_zero)]
    episodes: u64,
    /// Seed; each episode's own seed follows from it
    #[arg(long, value_name = "S", default_value_t = EVALUATION_SEED, value_parser = numbers::whole)]
    seed: u64,
    #[command(flatten)]
    threads: ThreadOptions,
    /// Fly only the i-th of n parts of the episodes and write them; `jcas merge` joins the parts
    #[arg(long, value_name = "i/n")]
    shard: Option<Shard>,
    /// Folder for the part
    #[arg(short, long, value_name = "DIR", default_value = "out")]
    out: PathBuf,
    /// Replace a part of another evaluation in that folder
    #[arg(long)]
    overwrite: bool,
    /// Print JSON
    #[arg(long)]
    json: bool,
}

impl Evaluate {
    /// The options that have no effect with the policy.
    pub fn idle(&self) -> Vec<Idle> {
        let mut idle = options::idle_for(&self.policy);
        // A name that is neither is refused later, since --mode may suit the folder that was meant.
        if planned::is_plan(&self.policy) || BaselineKind::named(&self.policy).is_ok() {
            let applies = "where POLICY is the folder of a trained policy";
            idle.push(Idle::options(&["mode"], applies));
        }
        idle.push(match self.shard {
            None => Idle::options(&["out", "overwrite"], "with --shard"),
            Some(_) => Idle::options(&["json"], "without --shard"),
        });
        idle
    }

    /// Runs the campaign and prints the report.
    pub fn run(self) -> Result<Outcome, CliError> {
        let learned = learned::is_policy(&self.policy);
        let config = self.model.load_for(&self.policy)?;
        let model = Model::new(config)?;
        let mode = match self.mode {
            ModeName::Card => None,
            ModeName::Deterministic => Some(Mode::Deterministic),
            ModeName::Sampled => Some(Mode::Sampled),
        };
        let factory = if learned {
            learned::factory(Path::new(&self.policy), &self.pilot, &model, mode)?
        } else {
            policy_factory(&self.policy, &self.pilot, &model)?
        };
        let campaign = Campaign {
            episodes: self.episodes,
            seed: self.seed,
        };
        let rule = learned::pilot_rule(&self.policy, &self.pilot)?;
        let who = (self.policy.as_str(), rule.as_str());
        if let Some(shard) = self.shard {
            let mode = mode.map_or("card", Mode::name);
            let evaluation = Evaluation::new(who, mode, config, campaign)?;
            let place = (self.out.as_path(), self.overwrite);
            evaluation::fly_shard(evaluation, shard, &factory, &self.threads, place)?;
            return Ok(Outcome::Done);
        }
        let summary = self.threads.run_episodes(self.episodes, || {
            fly(&model, campaign, &factory, "episodes")
        })??;
        Report::new(who, &config, self.seed, summary).print(self.json)?;
        Ok(Outcome::Done)
    }
}
