//! Collection of experience: each worker steps its episodes T times.

use super::acting::ActingPolicy;
use crate::environment::{Episode, Shape, StepOut, VectorEnvironment};
use crate::settings::Credit;
use rand_chacha::ChaCha8Rng;
use std::time::{Duration, Instant};

/// Experience of one worker in T steps of its M episodes, time-major.
#[derive(Clone, Debug)]
pub struct Rollout {
    /// Sizes of the worker's environment.
    pub shape: Shape,
    /// Steps (T).
    pub steps: usize,
    /// T × M·N × O.
    pub observations: Vec<f32>,
    /// The actor's features of the observations, T × M·N × `Network::features_len`.
    pub actor_features: Vec<f32>,
    /// The critic's features of its rows (by the learner).
    pub critic_features: Vec<f32>,
    /// T × M × S.
    pub global: Vec<f32>,
    /// Raw samples of the head, T × M·N × 2.
    pub raw_actions: Vec<f32>,
    /// ln π of the samples' motion and pilot, T × M·N × 2.
    pub log_probs: Vec<f32>,
    /// T × M, or T × M·N where each UAV is paid its own.
    pub rewards: Vec<f32>,
    /// The teacher's raw actions, T × M·N × 2; empty if not requested.
    pub labels: Vec<f32>,
    /// T × M.
    pub terminated: Vec<bool>,
    /// T × M.
    pub truncated: Vec<bool>,
    /// States after a step that the next row does not hold.
    pub final_states: Vec<FinalState>,
    /// Episodes that ended.
    pub finished: Vec<Episode>,
    /// Advantages, T × M or T × M·N (by the learner).
    pub advantages: Vec<f32>,
    /// Value targets, as many as values (by the learner).
    pub targets: Vec<f32>,
    /// Values at collection time, one for each row of the critic (by the learner).
    pub values: Vec<f32>,
    /// Time spent in the simulator.
    pub simulation: Duration,
    /// Time spent in the actor.
    pub inference: Duration,
}

/// The state after an episode's step.
#[derive(Clone, Debug)]
pub struct FinalState {
    /// Mission and step, a row of T × M.
    pub row: usize,
    /// The global state, S.
    pub global: Vec<f32>,
}

/// Steps every episode of `environment` `steps` times.
pub fn collect(
    environment: &mut dyn VectorEnvironment,
    policy: &ActingPolicy,
    steps: usize,
    credit: Credit,
    random: &mut ChaCha8Rng,
) -> Rollout {
    let shape = environment.shape();
    let mut out = StepOut::new(shape, credit);
    let mut rollout = Rollout::new(shape, steps, &out);
    let weights = policy.network.tensors(policy.parameters, policy.device);
    let mut actions = vec![0.0; shape.rows() * 2];
    for t in 0..steps {
        let rows = t * shape.rows()..(t + 1) * shape.rows();
        let started = Instant::now();
        {
            let observations = &mut rollout.observations
                [rows.start * shape.observation_len..rows.end * shape.observation_len];
            let states = t * shape.environments * shape.global_len
                ..(t + 1) * shape.environments * shape.global_len;
            environment.observe(observations, &mut rollout.global[states]);
        }
        rollout.simulation += started.elapsed();

        let started = Instant::now();
        rollout.choose(t, policy, &weights, &mut actions, random);
        rollout.inference += started.elapsed();

        let started = Instant::now();
        environment.step(&actions, &mut out);
        rollout.note(t, &out);
        if credit == Credit::Teacher && policy.network.reads_choices() {
            rollout.show_labels(t, policy.network);
        }
        rollout.simulation += started.elapsed();
    }
    rollout.note_last_states(environment);
    rollout
}

impl Rollout {
    pub(super) fn new(shape: Shape, steps: usize, out: &StepOut) -> Rollout {
        let (rows, missions) = (steps * shape.rows(), steps * shape.environments);
        Rollout {
            shape,
            steps,
            observations: vec![0.0; rows * shape.observation_len],
            actor_features: Vec::new(),
            critic_features: Vec::new(),
            global: vec![0.0; missions * shape.global_len],
            raw_actions: vec![0.0; rows * 2],
            log_probs: vec![0.0; rows * 2],
            rewards: vec![0.0; steps * out.rewards.len()],
            labels: Vec::with_capacity(steps * out.labels.len()),
            terminated: vec![false; missions],
            truncated: vec![false; missions],
            final_states: Vec::new(),
            finished: Vec::new(),
            advantages: Vec::new(),
            targets: Vec::new(),
            values: Vec::new(),
            simulation: Duration::ZERO,
            inference: Duration::ZERO,
        }
    }

    /// Actions held, T × M·N.
    pub fn rows(&self) -> usize {
        self.steps * self.shape.rows()
    }

    /// Mission-steps held.
    pub fn missions(&self) -> usize {
        self.steps * self.shape.environments
    }

    fn note(&mut self, t: usize, out: &StepOut) {
        let missions = self.shape.environments;
        let rows = t * missions..(t + 1) * missions;
        let rewards = out.rewards.len();
        self.rewards[t * rewards..(t + 1) * rewards].copy_from_slice(&out.rewards);
        self.labels.extend_from_slice(&out.labels);
        self.terminated[rows.clone()].copy_from_slice(&out.terminated);
        self.truncated[rows.clone()].copy_from_slice(&out.truncated);
        for (m, row) in rows.enumerate() {
            if out.truncated[m] && !out.terminated[m] {
                let last = FinalState::of(&self.shape, row, &out.final_global);
                self.final_states.push(last);
            }
        }
        self.finished.extend_from_slice(&out.finished);
    }

    /// The states after the last step, which no later row holds.
    fn note_last_states(&mut self, environment: &mut dyn VectorEnvironment) {
        let shape = self.shape;
        let mut observations = vec![0.0; shape.rows() * shape.observation_len];
        let mut global = vec![0.0; shape.environments * shape.global_len];
        environment.observe(&mut observations, &mut global);
        let first = (self.steps - 1) * shape.environments;
        for row in first..first + shape.environments {
            if !self.terminated[row] && !self.truncated[row] {
                self.final_states.push(FinalState::of(&shape, row, &global));
            }
        }
    }

    /// The global states of the final states, one after the other.
    pub fn final_inputs(&self) -> Vec<f32> {
        let states = self.final_states.iter();
        states.flat_map(|last| &last.global).copied().collect()
    }

    /// V(s_{t+1}) of every row, from the values of all rows and of the final states.
    pub fn next_values(&self, values: &[f32], final_values: &[f32]) -> Vec<f32> {
        let later = self.shape.environments;
        let mut next: Vec<f32> = (0..values.len())
            .map(|row| values.get(row + later).copied().unwrap_or(0.0))
            .collect();
        for (last, &value) in self.final_states.iter().zip(final_values) {
            next[last.row] = value;
        }
        next
    }
}

impl FinalState {
    /// From the states of all missions in the step that `row` belongs to.
    fn of(shape: &Shape, row: usize, global: &[f32]) -> FinalState {
        let m = row % shape.environments;
        FinalState {
            row,
            global: global[m * shape.global_len..(m + 1) * shape.global_len].to_vec(),
        }
    }
}
