//! The choice of actions while experience is collected.

use super::rollout::Rollout;
use crate::head::LearningHead;
use crate::network::{Network, values};
use burn_tensor::{Device, Tensor};
use jcas_policy::head::Head;
use jcas_policy::network::choices::read_choices;
use rand_chacha::ChaCha8Rng;

/// The actor as the workers use it: weights on a device without gradients.
pub struct ActingPolicy<'a> {
    /// Action head.
    pub head: Head,
    /// Actor network.
    pub network: &'a Network,
    /// Its parameters.
    pub parameters: &'a [f32],
    /// Device of the weights.
    pub device: &'a Device,
}

impl Rollout {
    /// Chooses the actions of step `t`: of all UAVs at once, or in turn. A turn has the UAVs of one
    /// index in all missions.
    pub(super) fn choose(
        &mut self,
        t: usize,
        policy: &ActingPolicy,
        weights: &[Tensor<2>],
        actions: &mut [f32],
        random: &mut ChaCha8Rng,
    ) {
        let (shape, network) = (self.shape, policy.network);
        let (rows, uavs, len) = (shape.rows(), shape.agents, shape.observation_len);
        let (first, width) = (t * rows, network.features_len(&shape));
        self.actor_features.resize((first + rows) * width, 0.0);
        let in_turn = network.reads_choices();
        let turns = if in_turn { uavs } else { 1 };
        let mut seen = vec![0.0; rows / turns * len];
        for turn in 0..turns {
            let own = (turn..rows).step_by(turns);
            for (row, seen) in own.clone().zip(seen.chunks_exact_mut(len)) {
                let fleet = row - row % uavs;
                let observations = &self.observations[(first + fleet) * len..];
                if in_turn {
                    let actions = &actions[2 * fleet..];
                    read_choices(shape.row_layout(), observations, actions, turn, seen);
                } else {
                    seen.copy_from_slice(&observations[(row - fleet) * len..][..len]);
                }
            }
            let features = network.features(&seen, &shape);
            for (row, features) in own.clone().zip(features.chunks_exact(width)) {
                self.actor_features[(first + row) * width..][..width].copy_from_slice(features);
            }
            let outputs = values(network.forward(weights, features, &shape));
            for (row, output) in own.zip(outputs.chunks_exact(policy.head.outputs())) {
                let (raw, log_probs) = policy.head.draw(output, random);
                let place = 2 * (first + row);
                self.raw_actions[place..place + 2].copy_from_slice(&raw);
                self.log_probs[place..place + 2].copy_from_slice(&log_probs);
                actions[2 * row..][..2].copy_from_slice(&policy.head.action(raw));
            }
        }
    }
}
