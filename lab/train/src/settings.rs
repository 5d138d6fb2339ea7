//! Settings of a training run.

mod presets;

pub use presets::Preset;

use crate::ppo::schedule::Schedule;
use crate::ppo::update::PilotObjective;
use jcas_episode::card::Card;
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
    /// Input of the critic. The paper's text allows both readings; `reproduce` trains both.
    pub critic_input: CriticInput,
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
    /// Critic rows of a minibatch: environment steps, or UAV samples if the critic reads a UAV's
    /// observation.
    pub critic_minibatch_rows: usize,
    /// Fraction of the UAVs' samples that each epoch visits, in (0, 1].
    pub sample_fraction: f64,

    /// Initial learning rate of actor and critic.
    pub learning_rate: f64,
    /// How it falls over the run.
    pub schedule: Schedule,
    /// PPO's clip range ε.
    pub clip: f32,
    /// Mean KL divergence of a batch's policy change after which no further epoch runs. Absent: no
    /// bound.
    pub kl_target: Option<f64>,
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
    /// A radar that detects more easily in the first batches. Absent: as configured.
    pub curriculum: Option<Curriculum>,
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
    /// For each confirmation that a UAV is expected to add, at least 0. Above 0, each pilot density
    /// is judged by its gain in its own step: detections, throughput and energy, relative to the
    /// middle of the range. At 0 the advantage judges it, as it does the motion.
    pub detection: f64,
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
    /// The same, with the advantage freed of the luck of confirmations: a control variate takes out
    /// what the drawn detections confirmed beyond expectation. For a reward that counts time. It
    /// has no price for a pilot density, so the actor learns the densities of the rule `adaptive`.
    Expected,
    /// A teacher judges: the actor learns the actions that the baseline `squads:adaptive` chooses
    /// in the states that the actor visits. The method is DAgger (Ross, Gordon and Bagnell, "A
    /// reduction of imitation learning and structured prediction to no-regret online learning",
    /// 2011).
    Teacher,
    /// Each UAV's own reward judges its actions. The mean over the fleet is the team's.
    Uav,
}

impl Credit {
    /// Whether a teacher chooses an action, or a pilot density, in each state.
    pub fn has_lessons(self) -> bool {
        matches!(self, Credit::Expected | Credit::Teacher)
    }
}

/// What the critic sees.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum CriticInput {
    /// The global state: one value for the team, under either credit.
    State,
    /// The global state and the UAV's own observation: one value for each UAV.
    StateAndUav,
}

/// Radar curriculum: the detection threshold rises over the first batches.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Curriculum {
    /// Detection threshold of the first batch, dB. A threshold 40·log10(a) dB lower gives the same
    /// odds at a times the distance.
    pub threshold_db: f64,
    /// Batches after which the threshold is the configuration's.
    pub batches: u64,
    /// Number of equal steps of the threshold. Each step restarts all episodes.
    pub stages: u64,
}

impl Settings {
    /// Refuses settings that are out of range or incompatible. The message names the setting, its
    /// value and its range.
    pub fn validate(&self) -> Result<(), String> {
        self.check_ranges()?;
        self.check_batches()?;
        if self.credit.has_lessons() && self.head != Head::Hybrid {
            return Err(
                "credit: expected and teacher are allowed with head = hybrid, and head is gaussian"
                    .into(),
            );
        }
        match self.curriculum {
            Some(Curriculum {
                batches, stages, ..
            }) if !(1..=batches).contains(&stages) => Err(format!(
                "curriculum.stages: {stages} is not allowed, it must be 1 to curriculum.batches \
                 ({batches})"
            )),
            _ => Ok(()),
        }
    }

    fn check_ranges(&self) -> Result<(), String> {
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
                return Err(format!("{field}: 0 is not allowed, it must be at least 1"));
            }
        }
        let unit = [
            ("discount", f64::from(self.discount)),
            ("gae_lambda", f64::from(self.gae_lambda)),
            ("sample_fraction", self.sample_fraction),
        ];
        for (field, value) in unit {
            if !(value > 0.0 && value <= 1.0) {
                return Err(format!("{field}: {value} is not in (0, 1]"));
            }
        }
        let positive = [
            ("learning_rate", self.learning_rate),
            ("clip", f64::from(self.clip)),
            // An absent one bounds nothing.
            ("kl_target", self.kl_target.unwrap_or(1.0)),
        ];
        for (field, value) in positive {
            if !(value > 0.0 && value.is_finite()) {
                return Err(format!("{field}: {value} is not a positive number"));
            }
        }
        let detection = self.shaping.detection;
        if !(detection >= 0.0 && detection.is_finite()) {
            return Err(format!(
                "shaping.detection: {detection} is not a number of at least 0"
            ));
        }
        Ok(())
    }

    fn check_batches(&self) -> Result<(), String> {
        if !self.environments.is_multiple_of(self.workers) {
            return Err(format!(
                "environments: {} is not a multiple of workers ({})",
                self.environments, self.workers
            ));
        }
        if !self.batch_steps.is_multiple_of(self.environments) {
            return Err(format!(
                "batch_steps: {} is not a multiple of environments ({})",
                self.batch_steps, self.environments
            ));
        }
        Ok(())
    }

    /// The settings on a card; none where they are those of another version or of another trainer.
    pub fn of_card(card: &Card) -> Option<Settings> {
        Settings::deserialize(card.settings.as_ref()?).ok()
    }

    /// Whether each pilot density is judged by its gain in its own step.
    pub fn pilot_by_step(&self) -> bool {
        self.shaping.detection > 0.0 && self.constant_pilot.is_none()
    }

    /// What trains pilot densities.
    pub(crate) fn pilot_objective(&self) -> PilotObjective {
        if self.constant_pilot.is_some() {
            PilotObjective::Held
        } else if self.credit.has_lessons() && !self.pilot_by_step() {
            PilotObjective::Taught
        } else {
            PilotObjective::Judged
        }
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
        settings.validate().unwrap_err()
    }

    #[test]
    fn numbers_out_of_range_are_refused_by_name() {
        for preset in [Preset::Paper, Preset::Tuned, Preset::Mission] {
            Settings::preset(preset).validate().unwrap();
        }
        let mission = || Settings::preset(Preset::Mission);
        for kl in [0.0, -1.0, f64::NAN] {
            let settings = Settings {
                kl_target: Some(kl),
                ..mission()
            };
            assert!(told(&settings).contains("kl_target"));
        }
        for credit in [Credit::Expected, Credit::Teacher] {
            let taught = Settings {
                head: Head::Gaussian,
                credit,
                ..mission()
            };
            assert!(told(&taught).contains("credit: expected and teacher"));
        }
        for detection in [-1.0, f64::NAN, f64::INFINITY] {
            let mut settings = mission();
            settings.shaping.detection = detection;
            assert!(told(&settings).contains("shaping.detection"));
        }
    }

    #[test]
    fn a_pilot_density_is_judged_by_its_step_where_detection_is_paid() {
        assert!(!Settings::preset(Preset::Tuned).pilot_by_step());
        let mut settings = Settings::preset(Preset::Mission);
        assert!(settings.pilot_by_step());
        settings.constant_pilot = Some(0.1);
        assert!(!settings.pilot_by_step());
    }

    /// A setting that is added has to take the place of another.
    #[test]
    fn there_are_at_most_thirty_settings() {
        let json = serde_json::to_value(Settings::preset(Preset::Mission)).unwrap();
        let settings = json.as_object().unwrap();
        let shaping = settings["shaping"].as_object().unwrap();
        assert!(settings.len() - 1 + shaping.len() <= 30);
    }
}
