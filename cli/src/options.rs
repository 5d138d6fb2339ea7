//! Options that several commands share.

use std::path::{Path, PathBuf};

use clap::Args;
use jcas_core::rng::derive_seed;
use jcas_core::{Config, Model};
use jcas_policy::{BaselineKind, PilotMode};

use crate::config_source::{ConfigSource, PresetName};
use crate::error::CliError;
use crate::idle::Idle;
use crate::learned::{self, PolicyFactory};
use crate::numbers;
use crate::planned;
use crate::radar_table::RadarTable;

/// Sources of the configuration.
#[derive(Args, Clone, Debug)]
pub struct ConfigOptions {
    /// Preset to start from; a preset that the file names replaces it [default: the configuration
    /// on a trained policy's card, or mission]
    #[arg(long, value_enum, help_heading = "Configuration")]
    pub preset: Option<PresetName>,
    /// TOML or JSON file whose fields replace those of the preset
    #[arg(long, value_name = "FILE", help_heading = "Configuration")]
    pub config: Option<PathBuf>,
    /// One field; may be repeated; overrides the file (`jcas config show` lists the fields)
    #[arg(long, value_name = "FIELD=VALUE", help_heading = "Configuration")]
    pub set: Vec<String>,
    /// CSV file with a table of P_d over the range, which replaces the detection curve (`jcas
    /// config radar-table --help` says what it holds)
    #[arg(long, value_name = "FILE", help_heading = "Configuration")]
    pub radar_table: Option<PathBuf>,
}

impl ConfigOptions {
    /// The values before the check of rules between fields.
    pub fn source(&self) -> Result<ConfigSource, CliError> {
        self.source_over(ConfigSource::preset(PresetName::Mission))
    }

    /// The values over a configuration that applies where neither preset nor file is given.
    fn source_over(&self, unless_given: ConfigSource) -> Result<ConfigSource, CliError> {
        let mut source = match (self.preset, &self.config) {
            (Some(preset), _) => ConfigSource::preset(preset),
            (None, Some(_)) => ConfigSource::preset(PresetName::Mission),
            (None, None) => unless_given,
        };
        if let Some(path) = &self.config {
            source.overlay_file(path)?;
        }
        for assignment in &self.set {
            source.assign(assignment)?;
        }
        if let Some(path) = &self.radar_table {
            source.set_radar_table(&RadarTable::read(path)?)?;
        }
        Ok(source)
    }
}

/// Options for a configuration and the two sizes that change most often.
#[derive(Args, Clone, Debug)]
pub struct ModelOptions {
    /// Sources of the configuration.
    #[command(flatten)]
    pub config: ConfigOptions,
    /// UAVs in the fleet [default: as configured]
    #[arg(long, value_name = "N", value_parser = numbers::uavs, help_heading = "Configuration")]
    pub uavs: Option<u32>,
    /// Hotspots to find [default: as configured]
    #[arg(long, value_name = "n", value_parser = numbers::hotspots, help_heading = "Configuration")]
    pub hotspots: Option<u32>,
}

impl ModelOptions {
    /// Returns the checked configuration.
    pub fn load(&self) -> Result<Config, CliError> {
        self.over(self.config.source()?)
    }

    /// The configuration for a policy. A trained policy keeps the configuration of its training
    /// unless the options change it; standard error lists the changes.
    pub fn load_for(&self, policy: &str) -> Result<Config, CliError> {
        if let Some(path) = planned::file_of(policy) {
            let planned_for = planned::read(path)?.config;
            return self.over(self.config.source_over(ConfigSource::of(&planned_for))?);
        }
        if !learned::is_policy(policy) {
            return self.load();
        }
        let trained_on = learned::card(Path::new(policy))?.config;
        let config = self.over(self.config.source_over(ConfigSource::of(&trained_on))?)?;
        let changes = ConfigSource::of(&config).changes_from(&ConfigSource::of(&trained_on));
        learned::say_changes(policy, &changes);
        Ok(config)
    }

    fn over(&self, mut source: ConfigSource) -> Result<Config, CliError> {
        if let Some(uavs) = self.uavs {
            source.set("uav_count", uavs)?;
        }
        if let Some(hotspots) = self.hotspots {
            source.set("hotspot_count", hotspots)?;
        }
        let config = source.resolve()?;
        if config.quorum > config.uav_count {
            eprintln!(
                "warning: quorum = {} is above uav_count = {}: no hotspot can be confirmed",
                config.quorum, config.uav_count
            );
        }
        Ok(config)
    }
}

/// Options for the policy and its pilot density.
#[derive(Args, Clone, Debug)]
pub struct PolicyOptions {
    /// A policy by name, plan:FILE for a file of `jcas plan`, or the folder of a trained policy.
    /// `jcas policies` lists the names [default: teams; where hotspots are hidden line, with
    /// reports answer]
    #[arg(long, value_name = "POLICY", help_heading = "Policy")]
    pub policy: Option<String>,
    /// Pilot density: a number such as 0.15, min, mid, max or adaptive. With adaptive, a
    /// baseline takes max near an unconfirmed hotspot and min elsewhere, and a trained policy its
    /// own density
    #[arg(long, value_name = "MODE", default_value = DEFAULT_PILOT, help_heading = "Policy")]
    pub pilot: String,
}

/// This density senses as well as `max` and communicates better.
pub const DEFAULT_PILOT: &str = "adaptive";

/// Finds a policy by its name on the command line.
pub fn policy_factory(
    policy: &str,
    pilot: &str,
    model: &Model<'_>,
) -> Result<PolicyFactory, CliError> {
    if learned::is_policy(policy) {
        return learned::factory(Path::new(policy), pilot, model, None);
    }
    if let Some(factory) = planned::factory(policy, model)? {
        return Ok(factory);
    }
    let kind = BaselineKind::named(policy).map_err(|_| learned::absent(policy))?;
    let pilot = PilotMode::named(pilot)?;
    // A baseline that reads what the model withholds is refused here, once.
    kind.build(model, pilot)?;
    Ok(Box::new(move || Box::new(kind.build_privileged(pilot))))
}

/// The options that have no effect with a policy: a plan holds its own pilot densities.
#[must_use]
pub fn idle_for(policy: &str) -> Vec<Idle> {
    if planned::is_plan(policy) {
        let applies = "to baselines and trained policies; a plan sets its own pilot density";
        return vec![Idle::options(&["pilot"], applies)];
    }
    Vec::new()
}

impl PolicyOptions {
    /// The options that have no effect with the requested policy.
    #[must_use]
    pub fn idle(&self) -> Vec<Idle> {
        self.policy.as_deref().map_or_else(Vec::new, idle_for)
    }

    /// The name of the policy that flies, and the configuration. Without a name it is the default
    /// policy of the configuration.
    pub fn choose(&self, model: &ModelOptions) -> Result<(String, Config), CliError> {
        if let Some(policy) = &self.policy {
            return Ok((policy.clone(), model.load_for(policy)?));
        }
        let config = model.load()?;
        Ok((BaselineKind::default_for(&config).name().to_owned(), config))
    }
}

/// Options that select one episode of a campaign.
#[derive(Args, Clone, Copy, Debug)]
pub struct EpisodeOptions {
    /// Seed of the campaign, as in `jcas simulate`
    #[arg(
        long,
        value_name = "S",
        default_value_t = 1,
        value_parser = numbers::whole,
        help_heading = "Episode"
    )]
    pub seed: u64,
    /// Index of the episode in the campaign, from 0
    #[arg(
        long,
        value_name = "K",
        default_value_t = 0,
        value_parser = numbers::whole,
        help_heading = "Episode"
    )]
    pub episode: u64,
    /// Seed of the episode itself, as in a trace's header (0x and hexadecimal digits, or decimal)
    #[arg(
        long,
        value_name = "S",
        value_parser = numbers::seed,
        conflicts_with_all = ["seed", "episode"],
        help_heading = "Episode"
    )]
    pub episode_seed: Option<u64>,
}

impl EpisodeOptions {
    /// The seed of the episode.
    pub fn seed(&self) -> u64 {
        self.episode_seed
            .unwrap_or_else(|| derive_seed(self.seed, self.episode))
    }
}

/// Option for the number of threads.
#[derive(Args, Clone, Copy, Debug)]
pub struct ThreadOptions {
    /// Threads, at most 1024; 0 for one on each core. Results do not depend on it
    #[arg(
        long,
        value_name = "COUNT",
        default_value_t = 0,
        value_parser = clap::value_parser!(u16).range(..=1024)
    )]
    pub threads: u16,
}

impl ThreadOptions {
    /// Runs a function in a pool of that number of threads.
    pub fn run<T: Send>(&self, work: impl FnOnce() -> T + Send) -> Result<T, CliError> {
        self.run_episodes(u64::MAX, work)
    }

    /// Runs a function that flies episodes, in a pool of at most one thread for each.
    pub fn run_episodes<T: Send>(
        &self,
        episodes: u64,
        work: impl FnOnce() -> T + Send,
    ) -> Result<T, CliError> {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(u64::from(self.threads).min(episodes) as usize)
            .build()
            .map_err(|error| CliError::input(format!("threads = {}: {error}", self.threads)))?;
        Ok(pool.install(work))
    }
}

#[cfg(test)]
mod tests {
    use super::ThreadOptions;

    #[test]
    fn no_thread_is_without_a_mission() {
        let threads = |threads: u16, episodes: u64| {
            let options = ThreadOptions { threads };
            options
                .run_episodes(episodes, rayon::current_num_threads)
                .unwrap()
        };
        assert_eq!(threads(64, 2), 2);
        assert_eq!(threads(2, 64), 2);
        assert_eq!(threads(0, 1 << 40), threads(0, 1));
    }
}
