//! The PPO update: minibatches cut into shards, one gradient a shard, summed in a fixed order.
//!
//! A shard has the same number of rows on every machine, and the sum over shards has a fixed order.
//! So the number of cores changes the time of a gradient, and never its value.

use crate::environment::Shape;
use crate::head::LearningHead;
use crate::head::hybrid::label_losses;
use crate::network::{Network, flat_gradient, matrix, values};
use crate::ppo::adam::Adam;
use crate::ppo::rollout::Rollout;
use burn_tensor::{Device, Tensor};
use jcas_policy::head::Head;
use rand::seq::SliceRandom;
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;

/// A network with its weights and their optimiser.
#[derive(Clone, Debug, PartialEq)]
pub struct Trainable {
    /// Architecture and layout.
    pub network: Network,
    /// Its weights.
    pub parameters: Vec<f32>,
    /// Their optimiser.
    pub adam: Adam,
}

impl Trainable {
    /// Fresh weights.
    pub fn new(network: Network, output_gain: f64, random: &mut ChaCha8Rng) -> Trainable {
        let parameters = network.initial(output_gain, random);
        let adam = Adam::new(parameters.len());
        Trainable {
            network,
            parameters,
            adam,
        }
    }
}

/// Bound on the norm of a gradient.
const GRADIENT_NORM_MAX: f32 = 0.5;

/// A row of the batch: which rollout, which of its rows.
type Row = (u32, u32);

/// Rows of one shape that are worked on together.
type Shard = Vec<Row>;

/// Settings of the minibatches and the optimiser.
#[derive(Clone, Copy, Debug)]
pub struct MinibatchSettings {
    /// Rows of a minibatch.
    pub minibatch_rows: usize,
    /// Rows of a shard.
    pub shard_rows: usize,
    /// Adam's rate.
    pub learning_rate: f64,
}

/// The actor's objective.
#[derive(Clone, Copy, Debug)]
pub struct ActorObjective {
    /// Clip range ε.
    pub clip: f32,
    /// Share of rows to visit.
    pub sample_fraction: f64,
    /// Whether the pilot density is constant, so that motions alone are trained.
    pub motions_only: bool,
}

impl ActorObjective {
    /// The objective that PPO maximises: min(ratio · A, clipped ratio · A).
    fn gain(&self, ratio: Tensor<2>, advantages: Tensor<2>) -> Tensor<2> {
        let clipped = ratio.clone().clamp(1.0 - self.clip, 1.0 + self.clip);
        (ratio * advantages.clone()).min_pair(clipped * advantages)
    }
}

/// The critic's objective.
#[derive(Clone, Copy, Debug)]
pub struct CriticObjective {
    /// Value units (offset, scale): a value is the output times scale, plus offset.
    pub units: (f32, f32),
}

/// Statistics for the log, summed over rows.
#[derive(Clone, Copy, Debug, Default)]
pub struct UpdateStats {
    /// Rows.
    pub rows: f64,
    /// Loss.
    pub loss: f64,
    /// Entropy.
    pub entropy: f64,
    /// Estimated KL divergence from the policy that collected.
    pub kl: f64,
    /// Rows whose ratio was clipped.
    pub clipped: f64,
    /// Sum of the gradients' norms.
    pub gradient_norm: f64,
    /// Updates made.
    pub updates: f64,
}

impl UpdateStats {
    /// Adds the statistics of another update.
    pub fn merge(&mut self, other: &UpdateStats) {
        self.rows += other.rows;
        self.loss += other.loss;
        self.entropy += other.entropy;
        self.kl += other.kl;
        self.clipped += other.clipped;
        self.gradient_norm += other.gradient_norm;
        self.updates += other.updates;
    }
}

/// Shuffled shards over rows of equal shape; every minibatch is a run of whole shards.
fn shards(
    rollouts: &[Rollout],
    rows_of: impl Fn(&Rollout) -> usize,
    share: f64,
    shard_rows: usize,
    random: &mut ChaCha8Rng,
) -> Vec<Shard> {
    let mut shards = Vec::new();
    let mut first = 0;
    while first < rollouts.len() {
        let mut end = first + 1;
        while end < rollouts.len() && rollouts[end].shape == rollouts[first].shape {
            end += 1;
        }
        let mut rows: Vec<Row> = (first..end)
            .flat_map(|rollout| {
                (0..rows_of(&rollouts[rollout])).map(move |row| (rollout as u32, row as u32))
            })
            .collect();
        rows.shuffle(random);
        rows.truncate(((rows.len() as f64 * share).ceil() as usize).max(1));
        shards.extend(rows.chunks(shard_rows).map(<[Row]>::to_vec));
        first = end;
    }
    shards.shuffle(random);
    shards
}

/// Learner: the batch and the device that an update uses besides the network.
pub struct Learner<'a> {
    /// The batch.
    pub rollouts: &'a [Rollout],
    /// Where gradients are computed (an autodiff device).
    pub device: &'a Device,
}

impl Learner<'_> {
    fn gather(&self, shard: &[Row], columns: usize, of: impl Fn(&Rollout) -> &[f32]) -> Vec<f32> {
        let mut out = Vec::with_capacity(shard.len() * columns);
        for &(rollout, row) in shard {
            let row = row as usize;
            let source = of(&self.rollouts[rollout as usize]);
            out.extend_from_slice(&source[row * columns..(row + 1) * columns]);
        }
        out
    }

    fn shape(&self, shard: &[Row]) -> Shape {
        self.rollouts[shard[0].0 as usize].shape
    }

    /// The actor's rows of an epoch, in shards.
    fn actor_shards(
        &self,
        objective: &ActorObjective,
        step: &MinibatchSettings,
        random: &mut ChaCha8Rng,
    ) -> Vec<Shard> {
        let share = objective.sample_fraction;
        shards(self.rollouts, Rollout::rows, share, step.shard_rows, random)
    }

    /// One epoch of PPO's clipped objective.
    pub fn improve_actor(
        &self,
        actor: &mut Trainable,
        head: Head,
        objective: &ActorObjective,
        step: &MinibatchSettings,
        random: &mut ChaCha8Rng,
    ) -> UpdateStats {
        let shards = self.actor_shards(objective, step, random);
        run_minibatches(
            actor,
            &shards,
            step,
            self.device,
            |network, weights, minibatch, rows| {
                let scales = self.advantage_scales(minibatch);
                minibatch
                    .par_iter()
                    .zip(&scales)
                    .map(|(shard, &scale)| {
                        self.actor_gradient(network, weights, head, objective, shard, scale, rows)
                    })
                    .collect()
            },
        )
    }

    /// One epoch of cross-entropy against the teacher's actions, or its motions alone.
    pub fn imitate(
        &self,
        actor: &mut Trainable,
        objective: &ActorObjective,
        step: &MinibatchSettings,
        random: &mut ChaCha8Rng,
    ) -> UpdateStats {
        let shards = self.actor_shards(objective, step, random);
        self.run_minibatches_by_shard(actor, &shards, step, |network, weights, shard, rows| {
            let (weights, outputs) = self.outputs(network, weights, shard, |r| &r.actor_features);
            let losses = label_losses(outputs, &self.gather(shard, 2, |r| &r.labels));
            let taught = if objective.motions_only { 1 } else { 2 };
            let loss = losses.narrow(1, 0, taught).sum().div_scalar(rows as f64);
            finish(network, &weights, loss, shard.len(), rows)
        })
    }

    /// For each shard, mean and standard deviation of the advantages of all the minibatch's rows
    /// that come from missions like its own.
    fn advantage_scales(&self, minibatch: &[Shard]) -> Vec<(f32, f32)> {
        let mut scales: Vec<(f32, f32)> = Vec::with_capacity(minibatch.len());
        for shard in minibatch {
            let alike = |other: &&Shard| self.shape(other) == self.shape(shard);
            let first = minibatch.iter().position(|other| alike(&other));
            let known = first.and_then(|first| scales.get(first)).copied();
            let rows = minibatch.iter().filter(alike).flatten();
            scales.push(known.unwrap_or_else(|| self.scale_of(rows)));
        }
        scales
    }

    /// Mean and standard deviation of the advantages of these rows.
    fn scale_of<'r>(&self, rows: impl Iterator<Item = &'r Row>) -> (f32, f32) {
        let (mut count, mut sum, mut square) = (0.0, 0.0, 0.0);
        for &row in rows {
            let advantage = f64::from(self.advantage(row));
            count += 1.0;
            sum += advantage;
            square += advantage * advantage;
        }
        let mean = sum / count;
        let deviation = (square / count - mean * mean).max(0.0).sqrt();
        (mean as f32, deviation as f32 + 1e-8)
    }

    /// A UAV's advantage, or its team's where all share one.
    fn advantage(&self, (rollout, row): Row) -> f32 {
        let rollout = &self.rollouts[rollout as usize];
        let shared = rollout.rows() / rollout.advantages.len();
        rollout.advantages[row as usize / shared]
    }

    #[allow(clippy::too_many_arguments)] // one shard's share of one objective
    fn actor_gradient(
        &self,
        network: &Network,
        weights: &[Tensor<2>],
        head: Head,
        objective: &ActorObjective,
        shard: &Shard,
        (mean, deviation): (f32, f32),
        minibatch_rows: usize,
    ) -> (Vec<f32>, UpdateStats) {
        let (weights, outputs) = self.outputs(network, weights, shard, |r| &r.actor_features);
        let raw = self.gather(shard, 2, |r| &r.raw_actions);
        let old = matrix(self.gather(shard, 2, |r| &r.log_probs), 2, self.device);
        let advantages = shard
            .iter()
            .map(|&row| (self.advantage(row) - mean) / deviation)
            .collect();
        let advantages = matrix(advantages, 1, self.device);

        let (densities, old) = if objective.motions_only {
            (head.motion_densities(outputs, &raw), old.narrow(1, 0, 1))
        } else {
            (head.densities(outputs, &raw), old)
        };
        let log_ratio = (densities.log_probs - old).sum_dim(1);
        let ratio = log_ratio.clone().exp();
        let gain = objective.gain(ratio, advantages);
        let entropy = densities.entropies.sum_dim(1);
        let loss = gain.sum().neg().div_scalar(minibatch_rows as f64);

        let mut sums = UpdateStats {
            rows: shard.len() as f64,
            ..UpdateStats::default()
        };
        for log_ratio in values(log_ratio) {
            let ratio = log_ratio.exp();
            sums.kl += f64::from(ratio - 1.0 - log_ratio);
            let clipped = u8::from((ratio - 1.0).abs() > objective.clip);
            sums.clipped += f64::from(clipped);
        }
        sums.entropy += values(entropy).into_iter().map(f64::from).sum::<f64>();
        let gradients = loss.backward();
        sums.loss = f64::from(loss.into_scalar::<f32>()) * minibatch_rows as f64;
        (flat_gradient(network, &weights, gradients), sums)
    }

    /// One epoch of squared error against the value targets, in units of `scale` around `offset`.
    pub fn improve_critic(
        &self,
        critic: &mut Trainable,
        objective: &CriticObjective,
        step: &MinibatchSettings,
        random: &mut ChaCha8Rng,
    ) -> UpdateStats {
        let &CriticObjective {
            units: (offset, scale),
        } = objective;
        let shards = shards(
            self.rollouts,
            Rollout::missions,
            1.0,
            step.shard_rows,
            random,
        );
        self.run_minibatches_by_shard(critic, &shards, step, |network, weights, shard, rows| {
            let (weights, outputs) = self.outputs(network, weights, shard, |r| &r.critic_features);
            let mut targets = self.gather(shard, 1, |r| &r.targets);
            targets.iter_mut().for_each(|x| *x = (*x - offset) / scale);
            let targets = matrix(targets, 1, self.device);
            let loss = (outputs - targets)
                .square()
                .sum()
                .div_scalar(2.0 * rows as f64);
            finish(network, &weights, loss, shard.len(), rows)
        })
    }

    /// Descends where the gradient of a shard needs to know of no other shard.
    fn run_minibatches_by_shard(
        &self,
        model: &mut Trainable,
        shards: &[Shard],
        step: &MinibatchSettings,
        gradient: impl Fn(&Network, &[Tensor<2>], &Shard, usize) -> (Vec<f32>, UpdateStats) + Sync,
    ) -> UpdateStats {
        run_minibatches(
            model,
            shards,
            step,
            self.device,
            |network, weights, minibatch, rows| {
                minibatch
                    .par_iter()
                    .map(|shard| gradient(network, weights, shard, rows))
                    .collect()
            },
        )
    }

    fn outputs(
        &self,
        network: &Network,
        weights: &[Tensor<2>],
        shard: &[Row],
        features: impl Fn(&Rollout) -> &[f32],
    ) -> (Vec<Tensor<2>>, Tensor<2>) {
        // The same numbers for every shard, but a graph of its own.
        let weights: Vec<_> = weights.iter().map(|w| w.clone().detach()).collect();
        let shape = self.shape(shard);
        let features = self.gather(shard, network.features_len(&shape), features);
        let outputs = network.forward(&weights, features, &shape);
        (weights, outputs)
    }
}

/// The gradient of a shard's loss, with its sums.
fn finish(
    network: &Network,
    weights: &[Tensor<2>],
    loss: Tensor<1>,
    rows: usize,
    minibatch_rows: usize,
) -> (Vec<f32>, UpdateStats) {
    let gradients = loss.backward();
    let sums = UpdateStats {
        rows: rows as f64,
        loss: f64::from(loss.into_scalar::<f32>()) * minibatch_rows as f64,
        ..UpdateStats::default()
    };
    (flat_gradient(network, weights, gradients), sums)
}

/// Runs over minibatches of whole shards; each gives gradients that are summed in order.
fn run_minibatches(
    model: &mut Trainable,
    shards: &[Shard],
    step: &MinibatchSettings,
    device: &Device,
    gradients: impl Fn(&Network, &[Tensor<2>], &[Shard], usize) -> Vec<(Vec<f32>, UpdateStats)>,
) -> UpdateStats {
    let mut total = UpdateStats::default();
    let shards_per_minibatch = (step.minibatch_rows / step.shard_rows).max(1);
    for minibatch in shards.chunks(shards_per_minibatch) {
        let rows = minibatch.iter().map(Vec::len).sum();
        let weights = model.network.tensors(&model.parameters, device);
        let parts = gradients(&model.network, &weights, minibatch, rows);
        let mut sum = vec![0.0; model.parameters.len()];
        for (part, sums) in &parts {
            sum.iter_mut()
                .zip(part)
                .for_each(|(sum, part)| *sum += part);
            total.merge(sums);
        }
        let norm = model.adam.step(
            &mut model.parameters,
            &sum,
            step.learning_rate,
            GRADIENT_NORM_MAX,
        );
        total.gradient_norm += f64::from(norm);
        total.updates += 1.0;
    }
    total
}

/// Values of many rows of critic features, in the critic's own units, computed in parallel shards.
pub fn evaluate(critic: &Trainable, features: &[f32], shape: &Shape, device: &Device) -> Vec<f32> {
    const ROWS: usize = 1024;
    features
        .par_chunks(ROWS * critic.network.features_len(shape))
        .flat_map_iter(|features| {
            let weights = critic.network.tensors(&critic.parameters, device);
            values(critic.network.forward(&weights, features.to_vec(), shape))
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::environment::StepOut;
    use crate::settings::Credit;

    // Computed by hand: a ratio of 2 counts 1.2 for a good action and 2 for a bad one. A ratio of
    // 0.5 counts 0.5 for a good action and 0.8 for a bad one. Where the clip applies, the gradient
    // is 0.
    #[test]
    fn the_clip_bounds_the_gain_of_good_actions_and_no_loss_of_bad_ones() {
        let device = Device::flex().autodiff();
        let objective = ActorObjective {
            clip: 0.2,
            sample_fraction: 1.0,
            motions_only: false,
        };
        let row = |values: [f32; 4]| matrix(values.to_vec(), 4, &device);
        let ratio = row([2.0, 2.0, 0.5, 0.5]).require_grad();
        let gain = objective.gain(ratio.clone(), row([1.0, -1.0, 1.0, -1.0]));
        let gradients = gain.clone().sum().backward();
        assert_eq!(values(gain), [1.2, -2.0, 0.5, -0.8]);
        let slopes = values(ratio.grad(&gradients).unwrap());
        assert_eq!(slopes, [0.0, -1.0, 1.0, 0.0]);
    }

    /// Two steps of one mission.
    fn rollout(agents: usize, advantages: Vec<f32>) -> Rollout {
        let shape = Shape {
            environments: 1,
            agents,
            ..Shape::default()
        };
        let out = StepOut::new(shape, Credit::Uav);
        let mut rollout = Rollout::new(shape, 2, &out);
        rollout.advantages = advantages;
        rollout
    }

    #[test]
    fn advantages_are_scaled_among_missions_of_one_shape() {
        let rollouts = [
            rollout(1, vec![100.0, 300.0]),
            rollout(2, vec![1.0, 3.0, 1.0, 3.0]),
        ];
        let learner = Learner {
            rollouts: &rollouts,
            device: &Device::flex(),
        };
        let minibatch = [
            vec![(0, 0), (0, 1)],
            vec![(1, 0), (1, 2)],
            vec![(1, 1), (1, 3)],
        ];
        let scales = learner.advantage_scales(&minibatch);
        assert_eq!(scales, [(200.0, 100.0), (2.0, 1.0), (2.0, 1.0)]);
    }
}
