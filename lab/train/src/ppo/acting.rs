//! The choice of actions while experience is collected.

use super::rollout::Rollout;
use crate::head::LearningHead;
use crate::network::{Network, values};
use burn_tensor::{Device, Tensor};
use jcas_policy::head::Head;
use jcas_policy::network::choices::{RowLayout, read_choices};
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
    /// Chooses the actions of all UAVs in step `t` at once.
    pub(super) fn choose_together(
        &mut self,
        t: usize,
        policy: &ActingPolicy,
        weights: &[Tensor<2>],
        actions: &mut [f32],
        random: &mut ChaCha8Rng,
    ) {
        let (rows, len) = (self.shape.rows(), self.shape.observation_len);
        let observations = &self.observations[t * rows * len..][..rows * len];
        let features = policy.network.features(observations, &self.shape);
        self.actor_features.extend_from_slice(&features);
        let outputs = values(policy.network.forward(weights, features, &self.shape));
        for (row, output) in outputs.chunks_exact(policy.head.outputs()).enumerate() {
            self.draw(t, row, policy.head, output, actions, random);
        }
    }

    /// Chooses the actions of the UAVs in step `t` by their index, each in all missions at once.
    pub(super) fn choose_in_turn(
        &mut self,
        t: usize,
        policy: &ActingPolicy,
        weights: &[Tensor<2>],
        actions: &mut [f32],
        random: &mut ChaCha8Rng,
    ) {
        let shape = self.shape;
        let (uavs, len) = (shape.agents, shape.observation_len);
        let width = policy.network.features_len(&shape);
        let first = t * shape.rows();
        self.actor_features
            .resize((first + shape.rows()) * width, 0.0);
        let layout = RowLayout {
            observation_len: len,
            hotspots: shape.hotspots,
            slots: shape.neighbour_slots,
            cells: shape.position_cells(),
        };
        let mut seen = vec![0.0; shape.environments * len];
        for uav in 0..uavs {
            for (m, row) in seen.chunks_exact_mut(len).enumerate() {
                let fleet = &self.observations[(first + m * uavs) * len..][..uavs * len];
                read_choices(layout, fleet, &actions[2 * m * uavs..], uav, row);
            }
            let features = policy.network.features(&seen, &shape);
            for (m, features) in features.chunks_exact(width).enumerate() {
                let row = first + m * uavs + uav;
                self.actor_features[row * width..][..width].copy_from_slice(features);
            }
            let outputs = values(policy.network.forward(weights, features, &shape));
            for (m, output) in outputs.chunks_exact(policy.head.outputs()).enumerate() {
                self.draw(t, m * uavs + uav, policy.head, output, actions, random);
            }
        }
    }

    /// Draws the action of a row of step `t` and notes it.
    fn draw(
        &mut self,
        t: usize,
        row: usize,
        head: Head,
        output: &[f32],
        actions: &mut [f32],
        random: &mut ChaCha8Rng,
    ) {
        let (raw, log_probs) = head.draw(output, random);
        let place = t * self.shape.rows() + row;
        self.raw_actions[2 * place..2 * place + 2].copy_from_slice(&raw);
        self.log_probs[2 * place..2 * place + 2].copy_from_slice(&log_probs);
        actions[2 * row..2 * row + 2].copy_from_slice(&head.action(raw));
    }
}
