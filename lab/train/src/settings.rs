//! Settings of a training run.

mod presets;

pub use presets::Preset;

use crate::ppo::schedule::Schedule;
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
    /// Device of the tensors: `cpu`, or `cuda`, `wgpu` where built in.
    pub device: String,
    /// Action head.
    pub head: Head,
    /// Network of actor and critic.
    pub network: NetworkKind,
    /// Hidden layer widths of the actor.
    pub actor_hidden: Vec<usize>,
    /// The actor reads which hotspots can begin a tour of all unconfirmed ones (set network only).
    pub actor_tours: bool,
    /// Hidden layer widths of the critic.
    pub critic_hidden: Vec<usize>,
    /// Input of the critic. The paper's text allows both readings; `reproduce` trains both.
    pub critic_input: CriticInput,
    /// The critic also sees a map of where hotspots may still be and of where the UAVs are.
    pub critic_survey: bool,
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
    /// Bound on the norm of a gradient.
    pub gradient_norm_max: f32,
    /// PPO's clip range ε.
    pub clip: f32,
    /// Dual-clip bound c (Ye et al., AAAI 2020, take 3): for negative advantages the surrogate is
    /// at least −c·|A|. Absent: no bound.
    pub dual_clip: Option<f32>,
    /// Entropy bonus. Absent: none.
    pub entropy: Option<Entropy>,
    /// Mean KL divergence of a batch's policy change after which no further epoch runs. Absent: no
    /// bound.
    pub kl_target: Option<f64>,
    /// Mean KL divergence above which an epoch is undone, and is the last. Absent: none is undone.
    pub kl_rollback: Option<f64>,
    /// Discount γ, in (0, 1].
    pub discount: f32,
    /// λ of generalised advantage estimation, in (0, 1].
    pub gae_lambda: f32,

    /// Whose reward an action is judged by.
    pub credit: Credit,
    /// What the pilot density of an action is judged by.
    pub pilot_credit: PilotCredit,
    /// Pilot density that replaces the policy's; only motions are trained then. Absent: the policy
    /// chooses it.
    pub constant_pilot: Option<f64>,

    /// Fields of the configuration that training changes, with their values.
    pub config_overrides: BTreeMap<String, serde_json::Value>,
    /// A radar that detects more easily in the first batches. Absent: as configured.
    pub curriculum: Option<Curriculum>,
    /// Changes of the reward in training.
    pub shaping: Shaping,

    /// Batches between evaluations; 0: only at the end.
    pub evaluate_every: usize,
    /// Episodes of each evaluation.
    pub evaluation_episodes: usize,
    /// Batches between checkpoints.
    pub checkpoint_every: usize,
}

/// An entropy bonus that falls linearly to 0.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Entropy {
    /// Weight in the first batch.
    pub start: f64,
    /// Batches after which it is 0.
    pub batches: u64,
}

/// Changes of the reward in training. All rewards are in the configuration's units.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Shaping {
    /// Factors on named components of the configuration's reward; 1 where absent.
    pub factors: BTreeMap<String, f64>,
    /// Subtracted from the reward of every step.
    pub time_penalty: f64,
    /// For each confirmation that a UAV is expected to add, with known and with hidden hotspots.
    pub detection: f64,
    /// For each confirmed hotspot that a UAV comes to know.
    pub informing: f64,
    /// For each cell by which a UAV approaches the nearest UAV with other knowledge, once all
    /// hotspots are confirmed. A step in which a UAV is informed pays nothing.
    pub meeting: f64,
    /// Other weights for small fleets.
    pub small_fleets: Option<SmallFleets>,
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
    /// The team's reward judges every action, as in the paper. One part in N of it is about the UAV
    /// itself.
    Team,
    /// Each UAV's own reward judges its actions. The mean over the fleet is the team's.
    Uav,
}

/// What the pilot density of an action is judged by.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum PilotCredit {
    /// The advantage judges it, as it does the motion.
    #[default]
    Return,
    /// Its gain in its own step judges it, relative to the middle of the range: detections,
    /// throughput and energy. Detections have the weight `shaping.detection`. The other UAVs count
    /// with the highest density where that gives the UAV more.
    Step,
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

/// Reward weights that replace those of [`Shaping`] for small fleets.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SmallFleets {
    /// UAVs of the largest small fleet.
    pub uavs_max: usize,
    /// In place of `shaping.time_penalty`.
    pub time_penalty: f64,
    /// In place of `shaping.detection`.
    pub detection: f64,
    /// In place of `discount`.
    pub discount: f32,
}

/// Reward weights and discount of a fleet of a given size.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShapingWeights {
    /// Subtracted from the reward of every step.
    pub time_penalty: f64,
    /// For each confirmation that a UAV is expected to add.
    pub detection: f64,
    /// Discount γ.
    pub discount: f32,
}

impl Settings {
    /// Refuses settings that are out of range or incompatible. The message names the setting, its
    /// value and its range.
    pub fn validate(&self) -> Result<(), String> {
        self.check_ranges()?;
        self.check_batches()?;
        self.check_detection()?;
        match self.curriculum {
            Some(Curriculum {
                batches, stages, ..
            }) if !(1..=batches).contains(&stages) => Err(format!(
                "curriculum.stages: {stages} is not allowed, it must be 1 to curriculum.batches ({batches})"
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
            ("checkpoint_every", self.checkpoint_every as u64),
            (
                "entropy.batches",
                self.entropy.map_or(1, |entropy| entropy.batches),
            ),
        ];
        for (field, value) in counts {
            if value == 0 {
                return Err(format!("{field}: 0 is not allowed, it must be at least 1"));
            }
        }
        let small = self.small();
        let unit = [
            ("discount", f64::from(self.discount)),
            ("shaping.small_fleets.discount", f64::from(small.discount)),
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
            ("gradient_norm_max", f64::from(self.gradient_norm_max)),
            // Absent ones bound nothing.
            ("kl_target", self.kl_target.unwrap_or(1.0)),
            ("kl_rollback", self.kl_rollback.unwrap_or(1.0)),
        ];
        for (field, value) in positive {
            if !(value > 0.0 && value.is_finite()) {
                return Err(format!("{field}: {value} is not a positive number"));
            }
        }
        let least = 1.0 + self.clip;
        match self.dual_clip {
            Some(bound) if !(bound > least && bound.is_finite()) => Err(format!(
                "dual_clip: {bound} is not above 1 + clip ({least})"
            )),
            _ => Ok(()),
        }
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

    /// Settings that use expected confirmations need a weight on detection.
    fn check_detection(&self) -> Result<(), String> {
        let needs = [
            ("pilot_credit: step", self.pilot_credit == PilotCredit::Step),
            ("critic_survey", self.critic_survey),
        ];
        let weights = [
            ("shaping.detection", self.shaping.detection),
            ("shaping.small_fleets.detection", self.small().detection),
        ];
        for (what, _) in needs.into_iter().filter(|&(_, asked)| asked) {
            for (field, weight) in weights {
                if weight <= 0.0 {
                    return Err(format!(
                        "{what} needs {field}, which is {weight}, it must be above 0"
                    ));
                }
            }
        }
        Ok(())
    }

    /// Weights of the smallest fleets.
    fn small(&self) -> ShapingWeights {
        let small = self.shaping.small_fleets;
        self.shaping_weights(small.map_or(usize::MAX, |small| small.uavs_max))
    }

    /// The settings on a card; none where they are those of another version or of another trainer.
    pub fn of_card(card: &Card) -> Option<Settings> {
        Settings::deserialize(card.settings.as_ref()?).ok()
    }

    /// Reward weights and discount of a fleet of `uavs` UAVs.
    pub fn shaping_weights(&self, uavs: usize) -> ShapingWeights {
        match self.shaping.small_fleets {
            Some(small) if uavs <= small.uavs_max => ShapingWeights {
                time_penalty: small.time_penalty,
                detection: small.detection,
                discount: small.discount,
            },
            _ => ShapingWeights {
                time_penalty: self.shaping.time_penalty,
                detection: self.shaping.detection,
                discount: self.discount,
            },
        }
    }

    /// Steps of each mission in one iteration.
    pub fn steps_per_batch(&self) -> usize {
        self.batch_steps / self.environments
    }

    /// Weight of the entropy bonus in this iteration, counted from 0.
    pub fn entropy_weight(&self, iteration: u64) -> f64 {
        self.entropy.map_or(0.0, |Entropy { start, batches }| {
            start * (1.0 - (iteration as f64 / batches as f64).min(1.0))
        })
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

    const ALL: [Preset; 4] = [
        Preset::Paper,
        Preset::Tuned,
        Preset::Search,
        Preset::Mission,
    ];

    const FEW: SmallFleets = SmallFleets {
        uavs_max: 5,
        time_penalty: 2.0,
        detection: 0.0,
        discount: 0.985,
    };

    fn told(settings: &Settings) -> String {
        settings.validate().unwrap_err()
    }

    #[test]
    fn the_entropy_bonus_falls_to_nothing() {
        let settings = Settings {
            entropy: Some(Entropy {
                start: 0.4,
                batches: 20,
            }),
            ..Settings::preset(Preset::Tuned)
        };
        for (iteration, weight) in [(0, 0.4), (5, 0.3), (20, 0.0), (50, 0.0)] {
            assert!((settings.entropy_weight(iteration) - weight).abs() < 1e-12);
        }
        assert_eq!(Settings::preset(Preset::Tuned).entropy_weight(0), 0.0);
    }

    #[test]
    fn bounds_on_what_a_batch_changes_are_checked_by_name() {
        let mission = || Settings::preset(Preset::Mission);
        let settings = Settings {
            dual_clip: Some(1.1),
            ..mission()
        };
        assert!(told(&settings).contains("dual_clip: 1.1 is not above 1 + clip (1.2)"));
        let settings = Settings {
            entropy: Some(Entropy {
                start: 0.1,
                batches: 0,
            }),
            ..mission()
        };
        assert!(told(&settings).contains("entropy.batches: 0"));
        for kl in [0.0, -1.0, f64::NAN] {
            let settings = Settings {
                kl_target: Some(kl),
                ..mission()
            };
            assert!(told(&settings).contains("kl_target"));
            let settings = Settings {
                kl_rollback: Some(kl),
                ..mission()
            };
            assert!(told(&settings).contains("kl_rollback"));
        }
    }

    #[test]
    fn presets_are_legal_and_what_needs_a_detection_weight_says_so() {
        for preset in ALL {
            Settings::preset(preset).validate().unwrap();
        }
        let tuned = Settings::preset(Preset::Tuned);
        let mut settings = Settings {
            pilot_credit: PilotCredit::Step,
            ..tuned.clone()
        };
        assert!(told(&settings).contains("pilot_credit: step needs shaping.detection"));
        settings = Settings {
            critic_survey: true,
            ..tuned
        };
        assert!(told(&settings).contains("critic_survey needs shaping.detection"));
        settings = Settings::preset(Preset::Search);
        settings.shaping.small_fleets = Some(FEW);
        assert!(told(&settings).contains("shaping.small_fleets.detection"));
    }

    #[test]
    fn small_fleets_have_weights_of_their_own() {
        let mut settings = Settings::preset(Preset::Mission);
        settings.shaping.small_fleets = None;
        let all = settings.shaping_weights(5);
        assert_eq!(all, settings.shaping_weights(6));
        settings.pilot_credit = PilotCredit::Return;
        settings.shaping.small_fleets = Some(FEW);
        settings.validate().unwrap();
        assert_eq!(settings.shaping_weights(6), all);
        let few = settings.shaping_weights(5);
        assert_eq!(
            (few.time_penalty, few.detection, few.discount),
            (2.0, 0.0, 0.985)
        );
        settings.shaping.small_fleets = Some(SmallFleets {
            discount: 1.5,
            ..FEW
        });
        assert!(told(&settings).contains("shaping.small_fleets.discount: 1.5"));
    }
}
