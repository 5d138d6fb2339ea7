//! Everything a training run can be told, with the presets `paper` and `tuned`.

use crate::head::Head;
use crate::ppo::schedule::Schedule;
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
    /// Network of actor and critic.
    pub network: NetworkKind,
    /// Hidden layer widths of the actor.
    pub actor_hidden: Vec<usize>,
    /// Hidden layer widths of the critic.
    pub critic_hidden: Vec<usize>,

    /// Missions side by side.
    pub environments: usize,
    /// Parts that the missions are dealt to; fixed, so that results do not depend on the cores.
    pub workers: usize,
    /// Environment steps (over all missions) of one iteration.
    pub batch_steps: usize,
    /// Environment steps of the whole run, imitation left out.
    pub total_steps: u64,

    /// Passes over each batch.
    pub epochs: usize,
    /// Actor samples (one UAV in one step) of a minibatch.
    pub minibatch_rows: usize,
    /// Environment steps of a critic minibatch.
    pub critic_minibatch_rows: usize,
    /// Rows that one core works on at a time.
    pub shard_rows: usize,
    /// Share of the actor's samples that each epoch visits: UAVs of one step resemble each other.
    pub actor_sample_share: f64,

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
    /// Weight of the entropy bonus at the start of the run.
    pub entropy_start: f64,
    /// Weight of the entropy bonus at the end of the run.
    pub entropy_end: f64,
    /// Epochs stop once the policy has moved by this much (mean KL); absent: never.
    pub kl_max: Option<f64>,
    /// Discount γ.
    pub discount: f32,
    /// λ of generalised advantage estimation.
    pub gae_lambda: f32,
    /// Scale observations and global states by running statistics (MLP only).
    pub normalise_inputs: bool,
    /// Scale value targets by running statistics.
    pub normalise_values: bool,
    /// Centre and scale advantages in each minibatch.
    pub normalise_advantages: bool,

    /// Pilot density held at this value; absent: the policy chooses it.
    pub constant_pilot: Option<f64>,
    /// Factors on named reward components while training (1 where absent).
    pub reward_factors: BTreeMap<String, f64>,
    /// Subtracted from the reward of every step while training.
    pub step_cost: f64,
    /// Weight of a potential that rewards gathering at one hotspot; 0: none.
    pub gather_weight: f64,
    /// UAVs whose way counts in it: the nearest so many.
    pub gather_uavs: usize,
    /// Start from a teacher's actions; absent: from nothing.
    pub imitation: Option<Imitation>,
    /// Iterations in which only the critic learns, after imitation.
    pub critic_warmup_iterations: usize,

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

/// Imitation of a teacher before PPO begins.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Imitation {
    /// Baseline that teaches, with its pilot rule, such as `swarm:adaptive`.
    pub teacher: String,
    /// Batches flown and learnt from.
    pub iterations: usize,
    /// Passes over each.
    pub epochs: usize,
    /// Learning rate while imitating.
    pub learning_rate: f64,
    /// Share of missions that the teacher flies, at the start; falls evenly to none.
    pub teacher_share: f64,
    /// Chance of a random move of a UAV in a step.
    pub noise: f64,
    /// Factor on the motion logits once imitation is over. A copy of a teacher is unsure where its
    /// choices are arbitrary, and UAVs that each draw for themselves then scatter; above 1 they agree
    /// as the most likely motions do.
    pub sharpening: f32,
}

/// Named settings.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Preset {
    /// The paper's table; what it leaves open is RLlib's habit.
    Paper,
    /// What the measurements in `docs/training.md` kept.
    Tuned,
}

impl std::str::FromStr for Preset {
    type Err = String;

    fn from_str(name: &str) -> Result<Preset, String> {
        match name {
            "paper" => Ok(Preset::Paper),
            "tuned" => Ok(Preset::Tuned),
            _ => Err(format!(
                "training preset: {name:?} is not one of paper, tuned"
            )),
        }
    }
}

impl Settings {
    /// The settings of a preset.
    pub fn preset(preset: Preset) -> Settings {
        match preset {
            Preset::Paper => Settings::paper(),
            Preset::Tuned => Settings::tuned(),
        }
    }

    fn paper() -> Settings {
        Settings {
            seed: 0,
            device: "cpu".to_owned(),
            head: Head::Gaussian,
            network: NetworkKind::Mlp,
            actor_hidden: vec![512, 256, 128],
            critic_hidden: vec![512, 256, 128],
            environments: 64,
            workers: 8,
            batch_steps: 4096,
            total_steps: 250_000,
            epochs: 10,
            minibatch_rows: 4096,
            critic_minibatch_rows: 512,
            shard_rows: 512,
            actor_sample_share: 1.0,
            learning_rate: 3e-4,
            critic_learning_rate: 3e-4,
            schedule: Schedule::Constant,
            gradient_norm_max: 0.5,
            clip: 0.2,
            entropy_start: 0.0,
            entropy_end: 0.0,
            kl_max: None,
            discount: 0.95,
            gae_lambda: 0.95,
            normalise_inputs: false,
            normalise_values: false,
            normalise_advantages: true,
            constant_pilot: None,
            reward_factors: BTreeMap::new(),
            step_cost: 0.0,
            gather_weight: 0.0,
            gather_uavs: 3,
            imitation: None,
            critic_warmup_iterations: 0,
            evaluate_every: 0,
            evaluation_episodes: 100,
            checkpoint_every: 10,
        }
    }

    fn tuned() -> Settings {
        Settings {
            head: Head::Hybrid,
            network: NetworkKind::Set,
            actor_hidden: vec![128, 64],
            critic_hidden: vec![128, 64],
            environments: 160,
            workers: 20,
            batch_steps: 5120,
            total_steps: 80 * 5120,
            epochs: 2,
            minibatch_rows: 1024,
            critic_minibatch_rows: 256,
            shard_rows: 128,
            actor_sample_share: 0.3,
            learning_rate: 3e-4,
            critic_learning_rate: 1e-3,
            schedule: Schedule::Linear,
            clip: 0.15,
            kl_max: Some(0.015),
            discount: 0.99,
            normalise_values: true,
            reward_factors: BTreeMap::from([
                ("energy".to_owned(), 100.0),
                ("throughput".to_owned(), 0.2),
                ("shaping_goal".to_owned(), 0.0),
                ("shaping_charge".to_owned(), 0.0),
            ]),
            step_cost: 0.3,
            imitation: Some(Imitation {
                teacher: "teams:adaptive".to_owned(),
                iterations: 200,
                epochs: 2,
                learning_rate: 1.5e-3,
                teacher_share: 0.6,
                noise: 0.03,
                sharpening: 2.5,
            }),
            critic_warmup_iterations: 4,
            ..Settings::paper()
        }
    }

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
            ("gather_uavs", self.gather_uavs),
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
        let unit = [
            ("discount", f64::from(self.discount)),
            ("gae_lambda", f64::from(self.gae_lambda)),
            ("actor_sample_share", self.actor_sample_share),
        ];
        for (field, value) in unit {
            if !(value > 0.0 && value <= 1.0) {
                return Err(format!("{field}: {value} is not in (0, 1]"));
            }
        }
        if !(self.gather_weight >= 0.0 && self.gather_weight.is_finite()) {
            return Err(format!(
                "gather_weight: {} is not allowed, it must be a number of at least 0",
                self.gather_weight
            ));
        }
        for (field, value) in [
            ("learning_rate", self.learning_rate),
            ("critic_learning_rate", self.critic_learning_rate),
            ("clip", f64::from(self.clip)),
            ("gradient_norm_max", f64::from(self.gradient_norm_max)),
        ] {
            if !(value > 0.0 && value.is_finite()) {
                return Err(format!("{field}: {value} is not a positive number"));
            }
        }
        Ok(())
    }

    /// Steps of each mission in one iteration.
    pub fn steps_per_batch(&self) -> usize {
        self.batch_steps / self.environments
    }

    /// Iterations of PPO proper.
    pub fn iterations(&self) -> u64 {
        self.total_steps.div_ceil(self.batch_steps as u64)
    }

    /// Iterations before PPO proper: imitation, then the critic's warm-up.
    pub fn preparation(&self) -> u64 {
        let imitation = self
            .imitation
            .as_ref()
            .map_or(0, |imitation| imitation.iterations);
        (imitation + self.critic_warmup_iterations) as u64
    }
}
