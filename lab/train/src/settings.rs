//! Everything a training run can be told.

mod presets;

pub use presets::Preset;

use crate::ppo::schedule::Schedule;
use jcas_episode::card::Card;
use jcas_policy::head::Head;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Settings of one training run. A file may give any of them; the rest come from the preset.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Settings {
    /// Seed of everything random in the run.
    pub seed: u64,
    /// Where tensors live: `cpu`, or `cuda`, `wgpu` where built in.
    pub device: String,
    /// Action head.
    pub head: Head,
    /// How its motions are drawn.
    #[serde(default)]
    pub draws: Draws,
    /// Network of actor and critic.
    pub network: NetworkKind,
    /// Hidden layer widths of the actor.
    pub actor_hidden: Vec<usize>,
    /// The actor reads which hotspots a tour of all open ones may begin with (set network only).
    #[serde(default)]
    pub actor_tours: bool,
    /// Hidden layer widths of the critic.
    pub critic_hidden: Vec<usize>,

    /// Missions side by side.
    pub environments: usize,
    /// Parts that the missions are dealt to; fixed, so that results do not depend on the cores.
    pub workers: usize,
    /// Environment steps (over all missions) of one iteration.
    pub batch_steps: usize,
    /// Environment steps of the whole run.
    pub total_steps: u64,

    /// Passes over each batch.
    pub epochs: usize,
    /// Actor samples (one UAV in one step) of a minibatch.
    pub minibatch_rows: usize,
    /// Rows of a critic minibatch: environment steps, or UAVs' where it sees one of them.
    pub critic_minibatch_rows: usize,
    /// Rows that one core works on at a time.
    pub shard_rows: usize,
    /// Share of the UAVs' samples that each epoch visits: UAVs of one step resemble each other.
    pub sample_share: f64,

    /// Initial learning rate of the actor.
    pub learning_rate: f64,
    /// Initial learning rate of the critic.
    pub critic_learning_rate: f64,
    /// How both fall over the run.
    pub schedule: Schedule,
    /// Gradients longer than this are shortened.
    pub gradient_norm_max: f32,
    /// PPO's clip range ε.
    pub clip: f32,
    /// An action that was worse than expected counts at most so many times, however much likelier it has become
    /// (dual clip: Ye et al., AAAI 2020, who take 3); absent: without bound.
    #[serde(default)]
    pub dual_clip: Option<f32>,
    /// Weight of the entropy bonus at the start of the run.
    pub entropy_start: f64,
    /// Weight of the entropy bonus at the end.
    pub entropy_end: f64,
    /// After how many batches it is at its end, which it comes to linearly; absent: after all.
    #[serde(default)]
    pub entropy_batches: Option<u64>,
    /// Epochs stop once the policy has moved by this much (mean KL); absent: never.
    pub kl_max: Option<f64>,
    /// An epoch that moved the policy by more than this (mean KL) is taken back, and is the last; absent: none is.
    #[serde(default)]
    pub kl_undo: Option<f64>,
    /// Discount γ.
    pub discount: f32,
    /// λ of generalised advantage estimation.
    pub gae_lambda: f32,
    /// Scale observations and global states by running statistics (MLP only).
    pub normalise_inputs: bool,
    /// Scale value targets by running statistics.
    pub normalise_values: bool,
    /// Centre and scale advantages in each minibatch, those of each fleet and number of hotspots by themselves: where
    /// little is found yet they are small beside the others'.
    pub normalise_advantages: bool,

    /// Whose reward an action is judged by.
    pub credit: Credit,
    /// What the pilot density of an action is judged by.
    #[serde(default)]
    pub pilot_credit: PilotCredit,
    /// What the critic sees.
    pub critic_input: CriticInput,
    /// The critic sees besides where hotspots may still be, as `finding_reward` counts it, and where the UAVs are.
    #[serde(default)]
    pub critic_survey: bool,

    /// Pilot density held at this value, and motions alone judged; absent: the policy chooses it.
    pub constant_pilot: Option<f64>,
    /// Fields of the mission's configuration that are others while training.
    pub mission: BTreeMap<String, serde_json::Value>,
    /// Begins with a radar that detects more easily; absent: as configured from the start.
    pub curriculum: Option<Curriculum>,
    /// Factors on named reward components while training (1 where absent).
    pub reward_factors: BTreeMap<String, f64>,
    /// Subtracted from the reward of every step while training.
    pub step_cost: f64,
    /// Paid to each UAV while training for each cell that it comes nearer to the unconfirmed hotspot nearest
    /// to it; nothing in a step that confirms one.
    pub progress_reward: f64,
    /// Paid to each UAV while training for each confirmation that it is expected to add, wherever the hotspots
    /// are.
    #[serde(default)]
    pub finding_reward: f64,
    /// Paid to each UAV while training for each confirmed hotspot that it comes to know.
    #[serde(default)]
    pub informing_reward: f64,
    /// Paid to each UAV while training, once all hotspots are confirmed, for each cell that it comes nearer to
    /// the nearest UAV that knows others than it does; nothing in a step that tells somebody something.
    #[serde(default)]
    pub meeting_reward: f64,
    /// What fleets of few UAVs are paid instead; absent: what all are.
    #[serde(default)]
    pub small_fleets: Option<SmallFleets>,

    /// Iterations between evaluations; 0: only at the end.
    pub evaluate_every: usize,
    /// Missions of each evaluation.
    pub evaluation_episodes: usize,
    /// Iterations between checkpoints.
    pub checkpoint_every: usize,
}

/// Networks to choose from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum NetworkKind {
    /// Fully connected over the whole observation.
    Mlp,
    /// Shared encoders over hotspots and neighbours: one policy for any fleet and any number.
    Set,
}

/// Whose reward an action is judged by.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Credit {
    /// Every UAV's by the team's, as in the paper: one part in N of it is about what the UAV did.
    Team,
    /// Each UAV's by its own; their mean is the team's.
    Uav,
}

/// What the pilot density of an action is judged by.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum PilotCredit {
    /// As its motion: by the advantage.
    #[default]
    Return,
    /// By what it gained in its own step, beside a middling density: detections as `finding_reward` weighs them,
    /// as if the others sensed as well as they can where that makes them decide more, throughput and energy.
    Step,
}

/// How the motions of training missions are drawn.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Draws {
    /// Each UAV's for itself.
    #[default]
    Independent,
    /// Those of one cell share their distributions out: quantiles that lie apart, from a drawn start.
    Stratified,
}

/// What the critic sees.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum CriticInput {
    /// The global state: one value for the team, whatever the credit.
    State,
    /// The global state and the UAV's own observation: one value for each UAV.
    StateAndUav,
}

/// A radar that grows harder.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Curriculum {
    /// Detection threshold of the first batch, dB; 40·log10(a) dB lower sees as well from a times as far.
    pub threshold_db: f64,
    /// Batches after which it is the configuration's.
    pub batches: u64,
    /// Equal steps in which it gets there; missions start anew with each.
    pub stages: u64,
}

/// What fleets are paid that are too few to be done by haste and luck.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SmallFleets {
    /// UAVs of the largest of them.
    pub uavs_max: usize,
    /// In place of `step_cost`.
    pub step_cost: f64,
    /// In place of `finding_reward`.
    pub finding_reward: f64,
    /// In place of `discount`.
    pub discount: f32,
}

/// What a fleet of a given size is paid for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pay {
    /// Subtracted from the reward of every step.
    pub step_cost: f64,
    /// Paid to each UAV for each confirmation that it is expected to add.
    pub finding_reward: f64,
    /// Discount γ.
    pub discount: f32,
}

impl Settings {
    /// Says which setting cannot be, and what is allowed.
    pub fn validate(&self) -> Result<(), String> {
        let positive = [
            ("environments", self.environments),
            ("workers", self.workers),
            ("batch_steps", self.batch_steps),
            ("epochs", self.epochs),
            ("minibatch_rows", self.minibatch_rows),
            ("critic_minibatch_rows", self.critic_minibatch_rows),
            ("shard_rows", self.shard_rows),
            ("evaluation_episodes", self.evaluation_episodes),
            ("checkpoint_every", self.checkpoint_every),
            (
                "entropy_batches",
                self.entropy_batches.map_or(1, |batches| batches as usize),
            ),
        ];
        for (field, value) in positive {
            if value == 0 {
                return Err(format!("{field}: 0 is not allowed, it must be at least 1"));
            }
        }
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
        if self.draws == Draws::Stratified && self.head == Head::Gaussian {
            return Err(
                "draws: stratified shares out motions, which the head gaussian has none of; it must be independent"
                    .to_owned(),
            );
        }
        // Where no fleets are set apart, all are of the others.
        let small = self
            .small_fleets
            .map_or(self.pay(usize::MAX), |small| self.pay(small.uavs_max));
        let unit = [
            ("discount", f64::from(self.discount)),
            ("small_fleets.discount", f64::from(small.discount)),
            ("gae_lambda", f64::from(self.gae_lambda)),
            ("sample_share", self.sample_share),
        ];
        for (field, value) in unit {
            if !(value > 0.0 && value <= 1.0) {
                return Err(format!("{field}: {value} is not in (0, 1]"));
            }
        }
        let needs_finding = [
            (
                "pilot_credit: step weighs detections by",
                self.pilot_credit == PilotCredit::Step,
            ),
            (
                "critic_survey: shows what is counted by",
                self.critic_survey,
            ),
        ];
        let finding_rewards = [
            ("finding_reward", self.finding_reward),
            ("small_fleets.finding_reward", small.finding_reward),
        ];
        for (what, asked) in needs_finding {
            for (field, reward) in finding_rewards {
                if asked && reward <= 0.0 {
                    return Err(format!(
                        "{what} {field}, which is {reward}, it must be above 0"
                    ));
                }
            }
        }
        if let Some(Curriculum {
            batches, stages, ..
        }) = self.curriculum
            && !(1..=batches).contains(&stages)
        {
            return Err(format!(
                "curriculum.stages: {stages} is not allowed, it must be 1 to curriculum.batches ({batches})"
            ));
        }
        for (field, value) in [
            ("learning_rate", self.learning_rate),
            ("critic_learning_rate", self.critic_learning_rate),
            ("clip", f64::from(self.clip)),
            ("gradient_norm_max", f64::from(self.gradient_norm_max)),
            // Absent ones bound nothing.
            ("kl_max", self.kl_max.unwrap_or(1.0)),
            ("kl_undo", self.kl_undo.unwrap_or(1.0)),
        ] {
            if !(value > 0.0 && value.is_finite()) {
                return Err(format!("{field}: {value} is not a positive number"));
            }
        }
        if let Some(bound) = self.dual_clip
            && !(bound > 1.0 + self.clip && bound.is_finite())
        {
            return Err(format!(
                "dual_clip: {bound} is not above 1 + clip ({})",
                1.0 + self.clip
            ));
        }
        Ok(())
    }

    /// The settings on a card; none where they are those of another version or of another trainer.
    pub fn of_card(card: &Card) -> Option<Settings> {
        Settings::deserialize(card.settings.as_ref()?).ok()
    }

    /// What a fleet of so many UAVs is paid.
    pub fn pay(&self, uavs: usize) -> Pay {
        match self.small_fleets {
            Some(small) if uavs <= small.uavs_max => Pay {
                step_cost: small.step_cost,
                finding_reward: small.finding_reward,
                discount: small.discount,
            },
            _ => Pay {
                step_cost: self.step_cost,
                finding_reward: self.finding_reward,
                discount: self.discount,
            },
        }
    }

    /// Steps of each mission in one iteration.
    pub fn steps_per_batch(&self) -> usize {
        self.batch_steps / self.environments
    }

    /// Weight of the entropy bonus in this iteration, counted from 0.
    pub fn entropy(&self, iteration: u64) -> f64 {
        let batches = self.entropy_batches.unwrap_or(self.iterations()).max(1);
        let progress = (iteration as f64 / batches as f64).min(1.0);
        self.entropy_start + (self.entropy_end - self.entropy_start) * progress
    }

    /// Iterations of the run.
    pub fn iterations(&self) -> u64 {
        self.total_steps.div_ceil(self.batch_steps as u64)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_entropy_bonus_falls_over_the_run_or_over_so_many_batches() {
        let mut settings = Settings {
            entropy_start: 0.4,
            entropy_end: 0.2,
            total_steps: 100 * 5120,
            ..Settings::preset(Preset::Tuned)
        };
        let near = |weight: f64, expected: f64| assert!((weight - expected).abs() < 1e-12);
        near(settings.entropy(0), 0.4);
        near(settings.entropy(50), 0.3);
        settings.entropy_batches = Some(20);
        near(settings.entropy(5), 0.35);
        near(settings.entropy(50), 0.2);
    }

    #[test]
    fn bounds_on_what_a_batch_changes_are_checked_by_name() {
        let mission = || Settings::preset(Preset::Mission);
        let told = |settings: Settings| settings.validate().unwrap_err();
        let settings = Settings {
            dual_clip: Some(1.1),
            ..mission()
        };
        assert!(told(settings).contains("dual_clip: 1.1 is not above 1 + clip (1.2)"));
        let settings = Settings {
            entropy_batches: Some(0),
            ..mission()
        };
        assert!(told(settings).contains("entropy_batches: 0"));
        for kl in [0.0, -1.0, f64::NAN] {
            let settings = Settings {
                kl_max: Some(kl),
                ..mission()
            };
            assert!(told(settings).contains("kl_max"));
            let settings = Settings {
                kl_undo: Some(kl),
                ..mission()
            };
            assert!(told(settings).contains("kl_undo"));
        }
    }

    #[test]
    fn presets_are_legal_and_what_hangs_on_finding_asks_for_it() {
        for preset in [
            Preset::Paper,
            Preset::Tuned,
            Preset::Search,
            Preset::Mission,
        ] {
            Settings::preset(preset).validate().unwrap();
        }
        let refused = |settings: Settings, field: &str| {
            let told = settings.validate().unwrap_err();
            assert!(told.contains(field) && told.contains("finding_reward"));
        };
        let tuned = Settings::preset(Preset::Tuned);
        let settings = Settings {
            pilot_credit: PilotCredit::Step,
            ..tuned.clone()
        };
        refused(settings, "pilot_credit");
        let settings = Settings {
            critic_survey: true,
            ..tuned
        };
        refused(settings, "critic_survey");
        let settings = Settings {
            small_fleets: Some(FEW),
            ..Settings::preset(Preset::Search)
        };
        refused(settings, "small_fleets");
        let settings = Settings {
            draws: Draws::Stratified,
            ..Settings::preset(Preset::Paper)
        };
        let told = settings.validate().unwrap_err();
        assert!(told.contains("draws: stratified"), "{told}");
    }

    const FEW: SmallFleets = SmallFleets {
        uavs_max: 5,
        step_cost: 2.0,
        finding_reward: 0.0,
        discount: 0.985,
    };

    #[test]
    fn small_fleets_are_paid_what_is_set_for_them() {
        let mut settings = Settings {
            small_fleets: None,
            ..Settings::preset(Preset::Mission)
        };
        let all = settings.pay(5);
        assert_eq!(all, settings.pay(6));
        settings.pilot_credit = PilotCredit::Return;
        settings.small_fleets = Some(FEW);
        settings.validate().unwrap();
        assert_eq!(settings.pay(6), all);
        let few = settings.pay(5);
        assert_eq!(
            (few.step_cost, few.finding_reward, few.discount),
            (2.0, 0.0, 0.985)
        );
        settings.small_fleets = Some(SmallFleets {
            discount: 1.5,
            ..FEW
        });
        let told = settings.validate().unwrap_err();
        assert!(told.contains("small_fleets.discount: 1.5"), "{told}");
    }
}
