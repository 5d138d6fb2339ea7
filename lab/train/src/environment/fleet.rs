//! Episodes of jcas for the trainer: one slab of states that the kernel steps in batch.

use super::knowledge_credit::{Informed, KnowledgeCredit};
use super::task::TrainingTask;
use super::teacher::Teacher;
use super::{Episode, Shape, StepOut, VectorEnvironment};
use crate::error::{FormatError, SettingError};
use crate::policy::shape_of;
use crate::settings::{Credit, Settings};
use jcas_core::batch::BatchOut;
use jcas_core::reward::{COMPONENTS, NAMES};
use jcas_core::rng::derive_seed;
use jcas_core::{Metrics, Model, Scratch};
use jcas_simd::InstructionSet;
use std::sync::Arc;

/// Reward for a cell nearer to a UAV with other knowledge, as a share of that for informing.
const MEETING: f64 = 0.6;

/// Changes that training makes to the reward and the actions.
#[derive(Clone, Debug, PartialEq)]
pub struct RewardShaping {
    /// Factor on each reward component.
    pub factors: [f64; COMPONENTS],
    /// Subtracted in every step.
    pub time_penalty: f64,
    /// Paid to each UAV for each confirmed hotspot that it comes to know.
    pub informing: f64,
    /// Paid to each UAV, once all hotspots are confirmed, for each cell nearer to a UAV with other
    /// knowledge.
    pub meeting: f64,
    /// What an action is judged by.
    credit: Credit,
    /// Pilot action that replaces the policy's.
    pub constant_pilot: Option<f32>,
}

impl RewardShaping {
    /// The shaping of the settings. An unknown component is an error.
    pub fn new(
        settings: &Settings,
        constant_pilot: Option<f32>,
    ) -> Result<RewardShaping, SettingError> {
        let shaping = &settings.shaping;
        let mut treatment = RewardShaping {
            factors: [1.0; COMPONENTS],
            time_penalty: shaping.time_penalty,
            informing: shaping.informing,
            meeting: MEETING * shaping.informing,
            credit: settings.credit,
            constant_pilot,
        };
        for (name, &factor) in &settings.shaping.factors {
            let index = NAMES
                .iter()
                .position(|known| known == name)
                .ok_or_else(|| SettingError::Name {
                    group: "shaping.factors",
                    name: name.clone(),
                    allowed: NAMES.join(", "),
                })?;
            treatment.factors[index] = factor;
        }
        Ok(treatment)
    }

    /// The reward for these components.
    fn reward(&self, components: &[f64]) -> f64 {
        paid(components, &self.factors) - self.time_penalty
    }
}

/// The sum of the components times their factors.
fn paid(components: &[f64], factors: &[f64; COMPONENTS]) -> f64 {
    let each = components.iter().zip(factors);
    each.map(|(component, factor)| component * factor).sum()
}

/// Episodes of one configuration side by side.
pub struct Fleet {
    model: Arc<Model<'static>>,
    treatment: RewardShaping,
    environments: usize,
    states: Vec<u64>,
    scratch: Vec<u64>,
    observations: Vec<f32>,
    global: Vec<f32>,
    components: Vec<f64>,
    uav_components: Vec<f64>,
    informing: KnowledgeCredit,
    informed: Informed,
    /// The teacher, if its actions are asked for.
    teacher: Option<Teacher>,
    /// Additional rewards of each UAV of an episode.
    extra: Vec<f64>,
    rewards: Vec<f32>,
    ended: [Vec<u8>; 2],
    metrics: Vec<Metrics>,
    held: Vec<f32>,
}

impl Fleet {
    /// `environments` missions, reset with seed 0.
    pub fn new(task: TrainingTask, environments: usize, treatment: RewardShaping) -> Fleet {
        let model = task.model;
        let uavs = model.uav_count();
        let mut fleet = Fleet {
            environments,
            states: vec![0; environments * model.state_words()],
            scratch: vec![0; Scratch::words_for(&model)],
            observations: vec![0.0; environments * uavs * model.observation_len()],
            global: vec![0.0; environments * model.global_len()],
            components: vec![0.0; environments * COMPONENTS],
            uav_components: Vec::new(),
            informing: KnowledgeCredit::new(environments, uavs),
            informed: Informed::default(),
            teacher: (treatment.credit == Credit::Teacher).then(Teacher::new),
            extra: vec![0.0; uavs],
            rewards: vec![0.0; environments],
            ended: [vec![0; environments], vec![0; environments]],
            metrics: vec![Metrics::default(); environments],
            held: vec![0.0; environments * 2 * uavs],
            treatment,
            model,
        };
        fleet.reset(0);
        fleet
    }

    fn start(&mut self, seed: u64) {
        let seeds: Vec<u64> = (0..self.environments as u64)
            .map(|m| derive_seed(seed, m))
            .collect();
        let mut scratch =
            Scratch::new(&self.model, &mut self.scratch).expect("sized for this model");
        self.model
            .batch_reset(
                &mut self.states,
                &mut scratch,
                &seeds,
                &mut self.observations,
                &mut self.global,
            )
            .expect("buffers are sized for this model");
        self.look();
    }

    /// Keeps the last global state of an episode, and starts the next one. Its seed is derived from
    /// that of the episode, as the kernel does by itself.
    fn start_anew(&mut self, m: usize, out: &mut StepOut) {
        let (words, global_len) = (self.model.state_words(), self.model.global_len());
        let rows = self.model.uav_count() * self.model.observation_len();
        let (own, state) = (m * rows..(m + 1) * rows, m * words..(m + 1) * words);
        let global = m * global_len..(m + 1) * global_len;
        out.final_global[global.clone()].copy_from_slice(&self.global[global.clone()]);
        let words = &mut self.states[state];
        let ended = self.model.state(words).expect("a state of this model");
        let seed = derive_seed(ended.seed(), 0);
        let mut scratch =
            Scratch::new(&self.model, &mut self.scratch).expect("sized for this model");
        self.model
            .batch_reset(
                words,
                &mut scratch,
                &[seed],
                &mut self.observations[own],
                &mut self.global[global],
            )
            .expect("buffers are sized for this model");
    }

    /// Restarts the credits from the present states.
    fn look(&mut self) {
        let states = self.states.chunks_exact(self.model.state_words());
        for (m, state) in states.enumerate() {
            let state = self.model.state(state).expect("a state of this model");
            self.informing.start(m, &self.model, &state);
        }
    }

    /// Computes the rewards of an episode's step. A UAV's reward is the kernel's plus the
    /// additional rewards of training; the team's is the mean over the fleet. An episode that ended
    /// has been reset, so only the knowledge that completed it counts.
    fn pay(&mut self, m: usize, out: &mut StepOut) {
        let words = self.model.state_words();
        let state = &self.states[m * words..(m + 1) * words];
        let state = self.model.state(state).expect("a state of this model");
        let extra = &mut self.extra;
        extra.fill(0.0);
        if out.terminated[m] || out.truncated[m] {
            if out.terminated[m] {
                self.informing.completed(m, &self.model, &mut self.informed);
                add(extra, self.treatment.informing, &self.informed.hotspots);
            }
            self.informing.start(m, &self.model, &state);
        } else {
            let informed = &mut self.informed;
            self.informing.gained(m, &self.model, &state, informed);
            add(extra, self.treatment.informing, &informed.hotspots);
            add(extra, self.treatment.meeting, &informed.cells);
        }
        let uavs = extra.len();
        let components = || self.uav_components.chunks_exact(COMPONENTS);
        if out.rewards.len() > self.environments {
            let own = out.rewards.iter_mut().zip(components()).skip(m * uavs);
            for ((reward, components), extra) in own.zip(&*extra) {
                *reward = (self.treatment.reward(components) + extra) as f32;
            }
        } else {
            let components = &self.components[m * COMPONENTS..(m + 1) * COMPONENTS];
            let team = self.treatment.reward(components);
            let mean = extra.iter().sum::<f64>() / uavs as f64;
            out.rewards[m] = (team + mean) as f32;
        }
    }
}

fn add(sums: &mut [f64], weight: f64, values: &[f64]) {
    for (sum, value) in sums.iter_mut().zip(values) {
        *sum += weight * value;
    }
}

impl VectorEnvironment for Fleet {
    fn shape(&self) -> Shape {
        Shape {
            environments: self.environments,
            ..shape_of(&self.model)
        }
    }

    fn reset(&mut self, seed: u64) {
        self.start(seed);
    }

    fn observe(&mut self, observations: &mut [f32], global: &mut [f32]) {
        observations.copy_from_slice(&self.observations);
        global.copy_from_slice(&self.global);
    }

    fn step(&mut self, actions: &[f32], out: &mut StepOut) {
        if let Some(teacher) = &mut self.teacher {
            teacher.teach(&self.model, &self.states, &mut out.labels);
        }
        self.held.copy_from_slice(actions);
        if let Some(pilot) = self.treatment.constant_pilot {
            self.held
                .chunks_exact_mut(2)
                .for_each(|action| action[1] = pilot);
        }
        if out.rewards.len() > self.environments {
            let rows = self.held.len() / 2;
            self.uav_components.resize(rows * COMPONENTS, 0.0);
        }
        let [terminated, truncated] = &mut self.ended;
        let mut scratch =
            Scratch::new(&self.model, &mut self.scratch).expect("sized for this model");
        InstructionSet::best()
            .batch_step(
                &self.model,
                &mut self.states,
                &mut scratch,
                &self.held,
                false,
                &mut BatchOut {
                    observations: &mut self.observations,
                    global: &mut self.global,
                    rewards: &mut self.rewards,
                    components: &mut self.components,
                    terminated,
                    truncated,
                    final_metrics: &mut self.metrics,
                    uav_components: &mut self.uav_components,
                    ..BatchOut::default()
                },
            )
            .expect("actions of a head are numbers, and missions start anew by themselves");
        out.finished.clear();
        for m in 0..self.environments {
            out.terminated[m] = self.ended[0][m] == 1;
            out.truncated[m] = self.ended[1][m] == 1;
            if out.terminated[m] || out.truncated[m] {
                self.start_anew(m, out);
                out.finished.push(Episode::of(&self.metrics[m]));
            }
            self.pay(m, out);
        }
    }

    fn save(&self) -> Vec<u8> {
        self.states
            .iter()
            .flat_map(|word| word.to_le_bytes())
            .collect()
    }

    /// Restores the states. The observations and the credits follow from these.
    fn load(&mut self, bytes: &[u8]) -> Result<(), FormatError> {
        let expected = self.states.len() * 8;
        if bytes.len() != expected {
            return Err(FormatError::States {
                got: bytes.len(),
                expected,
            });
        }
        for (word, bytes) in self.states.iter_mut().zip(bytes.chunks_exact(8)) {
            *word = u64::from_le_bytes(bytes.try_into().expect("chunks of eight"));
        }
        let words = self.model.state_words();
        let rows = self.model.uav_count() * self.model.observation_len();
        let global_len = self.model.global_len();
        let mut scratch =
            Scratch::new(&self.model, &mut self.scratch).expect("sized for this model");
        for (m, state) in self.states.chunks_exact(words).enumerate() {
            let state = self.model.state(state)?;
            let observations = &mut self.observations[m * rows..(m + 1) * rows];
            jcas_core::observation::observe(&self.model, &state, &mut scratch, observations)?;
            let global = &mut self.global[m * global_len..(m + 1) * global_len];
            jcas_core::observation::observe_global(&self.model, &state, global)?;
        }
        self.look();
        Ok(())
    }
}

impl Episode {
    /// The summary of an episode for the log.
    pub fn of(metrics: &Metrics) -> Episode {
        Episode {
            return_sum: metrics.return_sum,
            success: metrics.terminated,
            steps: metrics.steps,
            energy_kwh: metrics.energy_kwh,
            throughput: metrics.throughput_mean,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::settings::Preset;
    use jcas_core::Config;

    /// Episodes of three steps, with a hotspot in most cells.
    fn short(credit: Credit) -> (Fleet, StepOut) {
        let config = Config {
            horizon_steps: 3,
            hotspot_count: 100,
            ..Config::default()
        };
        let settings = Settings {
            credit,
            ..Settings::preset(Preset::Time)
        };
        let task = TrainingTask::new(&config, &settings).unwrap();
        let fleet = Fleet::new(task, 2, RewardShaping::new(&settings, None).unwrap());
        let out = StepOut::new(fleet.shape(), credit);
        (fleet, out)
    }

    // The kernel alone starts the next episodes itself.
    #[test]
    fn an_episode_follows_as_it_does_in_the_kernel() {
        let (mut fleet, mut out) = short(Credit::Team);
        let model = fleet.model.clone();
        let mut states = fleet.states.clone();
        let mut scratch = vec![0; Scratch::words_for(&model)];
        let mut scratch = Scratch::new(&model, &mut scratch).unwrap();
        let (mut rewards, mut ended) = ([0.0; 2], [[0; 2]; 2]);
        let mut observations = vec![0.0; fleet.observations.len()];
        let [mut global, mut last_global] = [(); 2].map(|()| vec![0.0; fleet.global.len()]);
        let actions = [0.4, 0.0].repeat(2 * model.uav_count());
        for step in 1..=7 {
            let [terminated, truncated] = &mut ended;
            let mut kernel = BatchOut {
                observations: &mut observations,
                global: &mut global,
                rewards: &mut rewards,
                terminated,
                truncated,
                final_global: &mut last_global,
                ..BatchOut::default()
            };
            model
                .batch_step(&mut states, &mut scratch, &actions, true, &mut kernel)
                .unwrap();
            fleet.step(&actions, &mut out);
            assert_eq!(out.truncated, [step % 3 == 0; 2]);
            assert_eq!(fleet.states, states);
            assert_eq!(
                (&fleet.observations, &fleet.global),
                (&observations, &global)
            );
            assert_eq!(out.final_global, last_global);
        }
    }

    #[test]
    fn a_label_is_for_the_state_before_the_step() {
        let (mut fleet, mut out) = short(Credit::Teacher);
        let model = fleet.model.clone();
        let mut teacher = Teacher::new();
        let mut expected = vec![0.0; out.labels.len()];
        for step in 0..7 {
            teacher.teach(&model, &fleet.states, &mut expected);
            fleet.step(&[0.4, 0.0].repeat(2 * model.uav_count()), &mut out);
            assert_eq!(out.labels, expected, "{step}");
        }
    }
}
