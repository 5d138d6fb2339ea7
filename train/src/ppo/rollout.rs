//! Collecting experience: each worker flies its missions for T steps, then the critic looks back.

use crate::environment::{Episode, Shape, StepOut, VectorEnvironment};
use crate::head::Head;
use crate::network::{Network, values};
use crate::ppo::normalise::Affine;
use burn_tensor::{Device, Tensor};
use rand::RngExt;
use rand_chacha::ChaCha8Rng;
use std::time::{Duration, Instant};

/// What one worker saw in T steps of its M missions, time-major.
#[derive(Clone, Debug)]
pub struct Rollout {
    /// Sizes of the worker's environment.
    pub shape: Shape,
    /// Steps (T).
    pub steps: usize,
    /// T × M·N × O.
    pub observations: Vec<f32>,
    /// T × M × S.
    pub global: Vec<f32>,
    /// Raw samples of the head, T × M·N × 2.
    pub raw_actions: Vec<f32>,
    /// What the teacher would have done, as raw samples; empty unless it was asked.
    pub teacher_actions: Vec<f32>,
    /// ln π of the samples, T × M·N.
    pub log_probs: Vec<f32>,
    /// T × M.
    pub rewards: Vec<f32>,
    /// T × M.
    pub terminated: Vec<bool>,
    /// T × M.
    pub truncated: Vec<bool>,
    /// Global states that steps led to where the next row does not hold them: (row, state).
    pub endings: Vec<(usize, Vec<f32>)>,
    /// Missions finished meanwhile.
    pub finished: Vec<Episode>,
    /// Advantages, T × M (by the learner).
    pub advantages: Vec<f32>,
    /// Value targets, T × M (by the learner).
    pub targets: Vec<f32>,
    /// Values at collection time, T × M (by the learner).
    pub values: Vec<f32>,
    /// Time spent in the simulator.
    pub simulation: Duration,
    /// Time spent in the actor.
    pub inference: Duration,
}

/// The actor as the workers use it: weights on a device without gradients.
pub struct ActingPolicy<'a> {
    /// Which distribution.
    pub head: Head,
    /// Actor network.
    pub network: &'a Network,
    /// Its parameters.
    pub parameters: &'a [f32],
    /// Normalisation of observations.
    pub inputs: &'a Affine,
    /// Where it runs.
    pub device: &'a Device,
}

/// How a worker chooses whom to follow while imitating.
#[derive(Clone, Copy, Debug)]
pub struct Tutelage {
    /// Share of missions (the first ones of each worker) that the teacher flies.
    pub teacher_share: f64,
    /// Chance that a UAV of the other missions acts at random in a step, to see strange states.
    pub noise: f64,
}

/// Flies `steps` steps of every mission of `environment`.
pub fn collect(
    environment: &mut dyn VectorEnvironment,
    policy: &ActingPolicy,
    steps: usize,
    tutelage: Option<Tutelage>,
    random: &mut ChaCha8Rng,
) -> Rollout {
    let shape = environment.shape();
    environment.begin_batch();
    let mut rollout = Rollout::new(shape, steps, tutelage.is_some());
    let weights = policy.network.tensors(policy.parameters, policy.device);
    let mut out = StepOut::new(shape);
    let mut actions = vec![0.0; shape.rows() * 2];
    let mut lessons = vec![0.0; shape.rows() * 2];
    for t in 0..steps {
        let rows = t * shape.rows()..(t + 1) * shape.rows();
        let started = Instant::now();
        {
            let observations = &mut rollout.observations
                [rows.start * shape.observation_len..rows.end * shape.observation_len];
            let states = t * shape.environments * shape.global_len
                ..(t + 1) * shape.environments * shape.global_len;
            environment.observe(observations, &mut rollout.global[states]);
            if tutelage.is_some() {
                environment.teacher_actions(&mut lessons);
            }
        }
        rollout.simulation += started.elapsed();

        let started = Instant::now();
        let outputs = {
            let observations = &rollout.observations
                [rows.start * shape.observation_len..rows.end * shape.observation_len];
            act(policy, &weights, observations, &shape)
        };
        let samples = outputs.chunks_exact(policy.head.output_len());
        for (row, output) in samples.enumerate() {
            let (raw, log_prob) = policy.head.sample(output, random);
            let place = rows.start + row;
            rollout.raw_actions[2 * place..2 * place + 2].copy_from_slice(&raw);
            rollout.log_probs[place] = log_prob;
            actions[2 * row..2 * row + 2].copy_from_slice(&policy.head.action(raw));
        }
        if let Some(tutelage) = tutelage {
            for (row, lesson) in lessons.chunks_exact(2).enumerate() {
                let raw = policy.head.raw_of_action([lesson[0], lesson[1]]);
                let place = 2 * (rows.start + row);
                rollout.teacher_actions[place..place + 2].copy_from_slice(&raw);
            }
            tutelage.take_over(&shape, &lessons, &mut actions, random);
        }
        rollout.inference += started.elapsed();

        let started = Instant::now();
        environment.step(&actions, &mut out);
        rollout.note(t, &out);
        rollout.simulation += started.elapsed();
    }
    rollout.note_last_states(environment);
    rollout
}

impl Tutelage {
    /// Replaces the learner's actions where the teacher or chance flies.
    fn take_over(
        &self,
        shape: &Shape,
        lessons: &[f32],
        actions: &mut [f32],
        random: &mut ChaCha8Rng,
    ) {
        let taught = (self.teacher_share * shape.environments as f64).round() as usize;
        let taught = taught.min(shape.environments) * shape.agents * 2;
        actions[..taught].copy_from_slice(&lessons[..taught]);
        for action in actions[taught..].chunks_exact_mut(2) {
            if random.random::<f64>() < self.noise {
                action[0] = random.random_range(-1.0..1.0);
            }
        }
    }
}

fn act(
    policy: &ActingPolicy,
    weights: &[Tensor<2>],
    observations: &[f32],
    shape: &Shape,
) -> Vec<f32> {
    let mut inputs = observations.to_vec();
    policy.inputs.apply(&mut inputs);
    values(policy.network.forward(weights, inputs, shape))
}

impl Rollout {
    fn new(shape: Shape, steps: usize, taught: bool) -> Rollout {
        let (rows, missions) = (steps * shape.rows(), steps * shape.environments);
        Rollout {
            shape,
            steps,
            observations: vec![0.0; rows * shape.observation_len],
            global: vec![0.0; missions * shape.global_len],
            raw_actions: vec![0.0; rows * 2],
            teacher_actions: vec![0.0; if taught { rows * 2 } else { 0 }],
            log_probs: vec![0.0; rows],
            rewards: vec![0.0; missions],
            terminated: vec![false; missions],
            truncated: vec![false; missions],
            endings: Vec::new(),
            finished: Vec::new(),
            advantages: Vec::new(),
            targets: Vec::new(),
            values: Vec::new(),
            simulation: Duration::ZERO,
            inference: Duration::ZERO,
        }
    }

    /// Mission-steps held.
    pub fn missions(&self) -> usize {
        self.steps * self.shape.environments
    }

    fn note(&mut self, t: usize, out: &StepOut) {
        let missions = self.shape.environments;
        let rows = t * missions..(t + 1) * missions;
        self.rewards[rows.clone()].copy_from_slice(&out.rewards);
        self.terminated[rows.clone()].copy_from_slice(&out.terminated);
        self.truncated[rows.clone()].copy_from_slice(&out.truncated);
        for (m, row) in rows.enumerate() {
            if out.truncated[m] && !out.terminated[m] {
                let global_len = self.shape.global_len;
                let state = &out.final_global[m * global_len..(m + 1) * global_len];
                self.endings.push((row, state.to_vec()));
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
        for (m, state) in global.chunks_exact(shape.global_len).enumerate() {
            let row = first + m;
            if !self.terminated[row] && !self.truncated[row] {
                self.endings.push((row, state.to_vec()));
            }
        }
    }

    /// V(s_{t+1}) of every row from the values of all rows and of the endings.
    pub fn next_values(&self, values: &[f32], ending_values: &[f32]) -> Vec<f32> {
        let missions = self.shape.environments;
        let mut next: Vec<f32> = (0..values.len())
            .map(|row| values.get(row + missions).copied().unwrap_or(0.0))
            .collect();
        for ((row, _), &value) in self.endings.iter().zip(ending_values) {
            next[*row] = value;
        }
        next
    }
}
