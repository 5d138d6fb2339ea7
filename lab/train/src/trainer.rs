//! The training loop: collect a batch, compute its advantages, learn from it.

use crate::device;
use crate::environment::{Episode, Shape, VectorEnvironment};
use crate::error::SettingError;
use crate::network::{Architecture, Network, set};
use crate::ppo::acting::ActingPolicy;
use crate::ppo::gae::{self, Trajectories};
use crate::ppo::normalise::Running;
use crate::ppo::rollout::{Rollout, collect};
use crate::ppo::update::{
    ActorObjective, CriticObjective, Learner, MinibatchSettings, Trainable, UpdateStats, evaluate,
};
use crate::random::{Purpose, stream_for};
use crate::settings::{Credit, NetworkKind, Settings};
use burn_tensor::Device;
use rayon::prelude::*;
use std::time::{Duration, Instant};

/// Report of one iteration.
#[derive(Clone, Debug)]
pub struct Iteration {
    /// Number of the iteration in the whole run, from 1.
    pub index: u64,
    /// Environment steps of the run so far.
    pub environment_steps: u64,
    /// Episodes that ended in this iteration.
    pub finished: Vec<Episode>,
    /// Statistics of the actor's last epoch.
    pub actor: UpdateStats,
    /// Sums over the critic's epochs.
    pub critic: UpdateStats,
    /// 1 − Var(target − value)/Var(target).
    pub explained_variance: f64,
    /// Learning rate of the actor.
    pub learning_rate: f64,
    /// Wall time of the whole iteration.
    pub wall: Duration,
    /// Wall time of collecting.
    pub collecting: Duration,
    /// Share of the simulator in collecting, in [0, 1], summed over workers.
    pub simulation_share: f64,
    /// Wall time of learning.
    pub learning: Duration,
}

/// A run in progress.
pub struct Trainer {
    /// Settings of the run.
    pub settings: Settings,
    /// The workers, each with its share of the episodes. Workers of equal shape are adjacent.
    pub workers: Vec<Box<dyn VectorEnvironment>>,
    /// The policy.
    pub actor: Trainable,
    /// The value function.
    pub critic: Trainable,
    /// Statistics of value targets.
    pub value_statistics: Running,
    /// Iterations done.
    pub iterations: u64,
    /// Environment steps done.
    pub environment_steps: u64,
    /// Batches at the start of the run in which only the critic learns.
    pub critic_only_batches: u64,
    device: Device,
}

/// Actor and critic networks of the settings. With fleets of several sizes, the set network also
/// reads the number of UAVs.
fn networks(settings: &Settings, shape: &Shape, fleets: bool) -> (Network, Network) {
    let sizes = |input: usize, hidden: &[usize], output: usize| {
        let mut sizes = vec![input];
        sizes.extend_from_slice(hidden);
        sizes.push(output);
        sizes
    };
    let outputs = settings.head.outputs();
    match settings.network {
        NetworkKind::Mlp => (
            Network::new(Architecture::Mlp {
                sizes: sizes(shape.observation_len, &settings.actor_hidden, outputs),
            }),
            Network::new(Architecture::Mlp {
                sizes: sizes(shape.global_len, &settings.critic_hidden, 1),
            }),
        ),
        NetworkKind::Set | NetworkKind::Turns => (
            Network::new(Architecture::SetActor {
                hidden: settings.actor_hidden.clone(),
                outputs,
                added: set::added(shape),
                fleet_size: fleets,
                choices: settings.network == NetworkKind::Turns,
            }),
            Network::new(Architecture::SetCritic {
                hidden: settings.critic_hidden.clone(),
                cover: settings.network == NetworkKind::Turns,
            }),
        ),
    }
}

impl Trainer {
    /// Starts a run on a device, whose tensors are `cpu`, or `cuda`, `wgpu` where built in. Workers
    /// are reset; those of equal shape must be adjacent.
    pub fn new(
        settings: Settings,
        mut workers: Vec<Box<dyn VectorEnvironment>>,
        device: &str,
    ) -> Result<Trainer, SettingError> {
        settings.validate()?;
        let device = device::named(device)?;
        let shape = workers
            .first()
            .ok_or_else(|| SettingError::value("workers", 0, "at least 1"))?
            .shape();
        let fleets = workers
            .iter()
            .any(|worker| worker.shape().agents != shape.agents);
        let (actor, critic) = networks(&settings, &shape, fleets);
        let mut random = stream_for(settings.seed, Purpose::Weights, 0, 0);
        let actor = Trainable::new(actor, 0.01, &mut random);
        let critic = Trainable::new(critic, 1.0, &mut random);
        for (index, worker) in workers.iter_mut().enumerate() {
            // The episodes of a worker have consecutive seeds, so seeds of workers are far apart.
            worker.reset(settings.seed.wrapping_add((index as u64 + 1) << 40));
        }
        if settings.network != NetworkKind::Mlp
            && workers
                .iter()
                .any(|worker| set::added(&worker.shape()) != set::added(&shape))
        {
            let allowed = "for configurations whose maps and tags have one size";
            return Err(SettingError::value("network", "set", allowed));
        }
        let mixed = workers.iter().any(|worker| worker.shape() != shape);
        if mixed && settings.network == NetworkKind::Mlp {
            let allowed = "set or turns for configurations of several sizes";
            return Err(SettingError::value("network", "mlp", allowed));
        }
        Ok(Trainer {
            value_statistics: Running::new(1),
            settings,
            workers,
            actor,
            critic,
            iterations: 0,
            environment_steps: 0,
            critic_only_batches: 0,
            device,
        })
    }

    /// Iterations of the whole run.
    pub fn total_iterations(&self) -> u64 {
        self.settings.iterations()
    }

    /// Whether every iteration has been done.
    pub fn finished(&self) -> bool {
        self.iterations >= self.total_iterations()
    }

    /// Collects one batch and learns from it.
    pub fn iterate(&mut self) -> Iteration {
        let started = Instant::now();
        let mut rollouts = self.collect();
        let collecting = started.elapsed();

        let started_learning = Instant::now();
        self.compute_advantages(&mut rollouts);
        let explained_variance = explained_variance(&rollouts);
        let (actor, critic, learning_rate) = self.learn(&rollouts);
        let learning = started_learning.elapsed();

        self.iterations += 1;
        self.environment_steps += rollouts.iter().map(|r| r.missions() as u64).sum::<u64>();
        let simulation: Duration = rollouts.iter().map(|r| r.simulation).sum();
        let inference: Duration = rollouts.iter().map(|r| r.inference).sum();
        Iteration {
            index: self.iterations,
            environment_steps: self.environment_steps,
            finished: rollouts
                .iter()
                .flat_map(|r| r.finished.iter().copied())
                .collect(),
            actor,
            critic,
            explained_variance,
            learning_rate,
            wall: started.elapsed(),
            collecting,
            simulation_share: simulation.as_secs_f64()
                / (simulation + inference).as_secs_f64().max(1e-9),
            learning,
        }
    }

    fn collect(&mut self) -> Vec<Rollout> {
        let policy = ActingPolicy {
            head: self.settings.head,
            network: &self.actor.network,
            parameters: &self.actor.parameters,
            device: &self.device,
            half_deterministic: self.settings.credit == Credit::Teacher,
        };
        let steps = self.settings.steps_per_batch();
        let &Settings { seed, credit, .. } = &self.settings;
        let iteration = self.iterations;
        self.workers
            .par_iter_mut()
            .enumerate()
            .map(|(index, worker)| {
                let mut random = stream_for(seed, Purpose::Actions, iteration, index as u64);
                let worker = worker.as_mut();
                collect(worker, &policy, steps, credit, &mut random)
            })
            .collect()
    }

    /// Value units (offset, scale): a value is the critic's output times scale, plus offset.
    fn value_units(&self) -> (f32, f32) {
        if self.settings.normalise_values && self.value_statistics.count > 0.0 {
            (
                self.value_statistics.offset()[0],
                self.value_statistics.scale()[0],
            )
        } else {
            (0.0, 1.0)
        }
    }

    /// Computes values, advantages and targets of every row.
    fn compute_advantages(&self, rollouts: &mut [Rollout]) {
        let (offset, scale) = self.value_units();
        for rollout in rollouts {
            let shape = rollout.shape;
            let features = |seen: &[f32]| self.critic.network.features(seen, &shape);
            let value = |features: &[f32]| -> Vec<f32> {
                evaluate(&self.critic, features, &shape, &self.device)
                    .iter()
                    .map(|value| value * scale + offset)
                    .collect()
            };
            rollout.critic_features = features(&rollout.global);
            let values = value(&rollout.critic_features);
            let final_values = value(&features(&rollout.final_inputs()));
            let next_values = rollout.next_values(&values, &final_values);
            let (advantages, targets) = gae::advantages(
                &Trajectories {
                    environments: rollout.shape.environments,
                    rewards: &rollout.rewards,
                    values: &values,
                    next_values: &next_values,
                    terminated: &rollout.terminated,
                    truncated: &rollout.truncated,
                },
                self.settings.discount,
                self.settings.gae_lambda,
            );
            rollout.values = values;
            rollout.advantages = advantages;
            rollout.targets = targets;
        }
    }

    fn learn(&mut self, rollouts: &[Rollout]) -> (UpdateStats, UpdateStats, f64) {
        if self.settings.normalise_values {
            rollouts
                .iter()
                .for_each(|rollout| self.value_statistics.update(&rollout.targets));
        }
        let settings = &self.settings;
        let autodiff = self.device.clone().autodiff();
        let learner = Learner {
            rollouts,
            device: &autodiff,
        };

        let [actor_step, critic_step] = self.minibatches();
        let objective = ActorObjective {
            clip: settings.clip,
            sample_fraction: settings.sample_fraction,
            motions_only: settings.constant_pilot.is_some(),
        };

        let critic_objective = CriticObjective {
            units: self.value_units(),
        };

        let (mut actor_sums, mut critic_sums) = (UpdateStats::default(), UpdateStats::default());
        for epoch in 0..settings.epochs as u64 {
            let mut random =
                stream_for(settings.seed, Purpose::Minibatches, self.iterations, epoch);
            let critic = learner.improve_critic(
                &mut self.critic,
                &critic_objective,
                &critic_step,
                &mut random,
            );
            critic_sums.merge(&critic);
            if self.iterations < self.critic_only_batches {
                continue;
            }
            // The log shows the last epoch, which produced the policy.
            let (actor, head) = (&mut self.actor, settings.head);
            actor_sums = if settings.credit == Credit::Teacher {
                learner.imitate(actor, &objective, &actor_step, &mut random)
            } else {
                learner.improve_actor(actor, head, &objective, &actor_step, &mut random)
            };
        }
        (actor_sums, critic_sums, actor_step.learning_rate)
    }

    /// Minibatches of the actor and of the critic in this iteration.
    fn minibatches(&self) -> [MinibatchSettings; 2] {
        let settings = &self.settings;
        let progress = self.iterations as f64 / settings.iterations().max(1) as f64;
        let actor = MinibatchSettings {
            minibatch_rows: settings.minibatch_rows,
            shard_rows: settings.shard_rows(),
            learning_rate: settings.learning_rate * settings.schedule.factor(progress),
        };
        let critic = MinibatchSettings {
            minibatch_rows: settings.critic_minibatch_rows,
            shard_rows: settings.shard_rows().min(settings.critic_minibatch_rows),
            ..actor
        };
        [actor, critic]
    }
}

/// 1 − Var(target − value)/Var(target) over the batch; 1 is a perfect critic, 0 a constant.
fn explained_variance(rollouts: &[Rollout]) -> f64 {
    let variance = |numbers: &mut dyn Iterator<Item = f64>| {
        let (mut count, mut sum, mut square) = (0.0, 0.0, 0.0);
        for x in numbers {
            count += 1.0;
            sum += x;
            square += x * x;
        }
        square / count - (sum / count) * (sum / count)
    };
    let targets = || {
        rollouts
            .iter()
            .flat_map(|r| r.targets.iter().map(|&x| f64::from(x)))
    };
    let errors = rollouts.iter().flat_map(|r| {
        r.targets
            .iter()
            .zip(&r.values)
            .map(|(&t, &v)| f64::from(t - v))
    });
    let total = variance(&mut targets());
    if total < 1e-12 {
        0.0
    } else {
        1.0 - variance(&mut { errors }) / total
    }
}
