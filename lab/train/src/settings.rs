//! Settings of a training run.

mod presets;

pub use presets::Preset;

use crate::error::SettingError;
use crate::ppo::schedule::Schedule;
use jcas_policy::head::Head;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// The settings of one training run. A file may give any of them; the preset gives the rest.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Settings {
    /// Seed of everything random in the run.
    pub seed: u64,
    /// Action head.
    pub head: Head,
    /// Network of actor and critic.
    pub network: NetworkKind,
    /// Hidden layer widths of the actor.
    pub actor_hidden: Vec<usize>,
    /// Hidden layer widths of the critic.
    pub critic_hidden: Vec<usize>,
    /// Scale value targets by running statistics.
    pub normalise_values: bool,

    /// Episodes side by side; a multiple of `workers`.
    pub environments: usize,
    /// Number of workers that share the episodes. Results depend on it, and not on the number of
    /// cores.
    pub workers: usize,
    /// Environment steps (over all episodes) of one batch; a multiple of `environments`.
    pub batch_steps: usize,
    /// Environment steps of the whole run.
    pub total_steps: u64,

    /// Passes over each batch.
    pub epochs: usize,
    /// Actor samples (one UAV in one step) of a minibatch.
    pub minibatch_rows: usize,
    /// Critic rows of a minibatch: environment steps.
    pub critic_minibatch_rows: usize,
    /// Fraction of the UAVs' samples that each epoch visits, in (0, 1].
    pub sample_fraction: f64,

    /// Initial learning rate of actor and critic.
    pub learning_rate: f64,
    /// How it falls over the run.
    pub schedule: Schedule,
    /// PPO's clip range ε.
    pub clip: f32,
    /// Discount γ, in (0, 1].
    pub discount: f32,
    /// λ of generalised advantage estimation, in (0, 1].
    pub gae_lambda: f32,

    /// What an action is judged by.
    pub credit: Credit,
    /// Pilot density that replaces the policy's; only motions are trained then. Absent: the policy
    /// chooses it.
    pub constant_pilot: Option<f64>,

    /// Fields of the configuration that training changes, with their values.
    pub config_overrides: BTreeMap<String, serde_json::Value>,
    /// Changes of the reward in training.
    pub shaping: Shaping,

    /// Episodes of the evaluation at the end, for each configuration and mode.
    pub evaluation_episodes: usize,
}

/// Changes of the reward in training. All rewards are in the configuration's units.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Shaping {
    /// Factors on named components of the configuration's reward; 1 where absent.
    pub factors: BTreeMap<String, f64>,
    /// Subtracted from the reward of every step.
    pub time_penalty: f64,
    /// For each confirmed hotspot that a UAV comes to know. Once all hotspots are confirmed, 0.6 of
    /// it is paid for each cell by which a UAV approaches the nearest UAV with other knowledge. A
    /// step in which a UAV is informed pays nothing for that.
    pub informing: f64,
}

/// Networks to choose from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum NetworkKind {
    /// Fully connected over the whole observation.
    Mlp,
    /// Shared encoders over hotspots and neighbours: one policy for any fleet and any number.
    Set,
    /// The same, and UAVs choose one after the other: each reads what its neighbours with lower
    /// indices have chosen.
    Turns,
}

/// What an action is judged by.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Credit {
    /// The team's reward judges every action, as in the paper. One part in N of it is about the UAV
    /// itself.
    Team,
    /// A teacher judges: the actor learns the actions that the baseline `squads:adaptive` chooses
    /// in the states that the actor visits. The method is DAgger (Ross, Gordon and Bagnell, "A
    /// reduction of imitation learning and structured prediction to no-regret online learning",
    /// 2011).
    Teacher,
    /// Each UAV's own reward judges its actions. The mean over the fleet is the team's.
    Uav,
}

impl Settings {
    /// Refuses settings that are out of range or incompatible. The message names the setting, its
    /// value and its range.
    pub fn validate(&self) -> Result<(), SettingError> {
        self.check_ranges()?;
        self.check_batches()?;
        if self.credit == Credit::Teacher && self.head != Head::Hybrid {
            let allowed = "team or uav where head is gaussian";
            return Err(SettingError::value("credit", "teacher", allowed));
        }
        Ok(())
    }

    fn check_ranges(&self) -> Result<(), SettingError> {
        let counts = [
            ("environments", self.environments as u64),
            ("workers", self.workers as u64),
            ("batch_steps", self.batch_steps as u64),
            ("epochs", self.epochs as u64),
            ("minibatch_rows", self.minibatch_rows as u64),
            ("critic_minibatch_rows", self.critic_minibatch_rows as u64),
            ("evaluation_episodes", self.evaluation_episodes as u64),
        ];
        for (field, value) in counts {
            if value == 0 {
                return Err(SettingError::value(field, 0, "at least 1"));
            }
        }
        let unit = [
            ("discount", f64::from(self.discount)),
            ("gae_lambda", f64::from(self.gae_lambda)),
            ("sample_fraction", self.sample_fraction),
        ];
        for (field, value) in unit {
            if !(value > 0.0 && value <= 1.0) {
                return Err(SettingError::value(field, value, "in (0, 1]"));
            }
        }
        let positive = [
            ("learning_rate", self.learning_rate),
            ("clip", f64::from(self.clip)),
        ];
        for (field, value) in positive {
            if !(value > 0.0 && value.is_finite()) {
                return Err(SettingError::value(field, value, "a positive number"));
            }
        }
        Ok(())
    }

    fn check_batches(&self) -> Result<(), SettingError> {
        if !self.environments.is_multiple_of(self.workers) {
            let allowed = format!("a multiple of workers ({})", self.workers);
            let environments = self.environments;
            return Err(SettingError::value("environments", environments, allowed));
        }
        if !self.batch_steps.is_multiple_of(self.environments) {
            let allowed = format!("a multiple of environments ({})", self.environments);
            return Err(SettingError::value(
                "batch_steps",
                self.batch_steps,
                allowed,
            ));
        }
        Ok(())
    }

    /// Steps of each mission in one iteration.
    pub fn steps_per_batch(&self) -> usize {
        self.batch_steps / self.environments
    }

    /// Actor rows that one core works on at a time. Intermediate tensors of so few stay in its
    /// cache.
    pub fn shard_rows(&self) -> usize {
        (self.minibatch_rows / 4).clamp(1, 512)
    }

    /// Iterations of the run.
    pub fn iterations(&self) -> u64 {
        self.total_steps.div_ceil(self.batch_steps as u64)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn told(settings: &Settings) -> String {
        settings.validate().unwrap_err().to_string()
    }

    #[test]
    fn numbers_out_of_range_are_refused_by_name() {
        for preset in [Preset::Paper, Preset::Tuned, Preset::Time, Preset::Mission] {
            Settings::preset(preset).validate().unwrap();
        }
        for clip in [0.0, -1.0, f32::NAN] {
            let settings = Settings {
                clip,
                ..Settings::preset(Preset::Mission)
            };
            assert!(told(&settings).contains("clip"));
        }
        let of_teacher = Settings {
            head: Head::Gaussian,
            ..Settings::preset(Preset::Mission)
        };
        assert!(told(&of_teacher).contains("credit: teacher"));
    }

    /// A setting that is added has to take the place of another.
    #[test]
    fn there_are_at_most_twenty_six_settings() {
        let json = serde_json::to_value(Settings::preset(Preset::Mission)).unwrap();
        let settings = json.as_object().unwrap();
        let shaping = settings["shaping"].as_object().unwrap();
        assert!(settings.len() - 1 + shaping.len() <= 26);
    }
}
