//! jcas missions as the trainer sees them: one slab of states, stepped by the kernel in batch.

use super::gather::Gather;
use super::{Episode, Shape, StepOut, VectorEnvironment};
use crate::settings::Settings;
use jcas_core::batch::BatchOut;
use jcas_core::reward::{COMPONENTS, NAMES};
use jcas_core::rng::derive_seed;
use jcas_core::{Metrics, Model, Scratch};
use jcas_evaluate::policy::{Baseline, BaselineKind, PilotMode, Policy};
use std::sync::Arc;

/// What training changes about the missions it flies.
#[derive(Clone, Debug, PartialEq)]
pub struct Treatment {
    /// Factor on each reward component.
    pub factors: [f64; COMPONENTS],
    /// Subtracted in every step.
    pub step_cost: f64,
    /// Pilot action held, whatever the policy says.
    pub constant_pilot: Option<f32>,
    /// Potential added, with its discount.
    pub gather: (Gather, f64),
}

impl Treatment {
    /// From the settings' names; an unknown component is refused.
    pub fn new(settings: &Settings, constant_pilot: Option<f32>) -> Result<Treatment, String> {
        let gather = Gather {
            weight: settings.gather_weight,
            uavs: settings.gather_uavs,
        };
        let mut treatment = Treatment {
            factors: [1.0; COMPONENTS],
            step_cost: settings.step_cost,
            constant_pilot,
            gather: (gather, f64::from(settings.discount)),
        };
        for (name, &factor) in &settings.reward_factors {
            let index = NAMES
                .iter()
                .position(|known| known == name)
                .ok_or_else(|| {
                    format!(
                        "reward_factors.{name}: no such component; allowed: {}",
                        NAMES.join(", ")
                    )
                })?;
            treatment.factors[index] = factor;
        }
        Ok(treatment)
    }

    /// Of one step, with the gathering potential before and after it.
    fn reward(&self, components: &[f64], [before, after]: [f64; 2]) -> f32 {
        let paid: f64 = components
            .iter()
            .zip(&self.factors)
            .map(|(c, f)| c * f)
            .sum();
        (paid - self.step_cost + self.gather.1 * after - before) as f32
    }
}

/// A teacher by name, such as `swarm:adaptive`.
pub fn teacher_named(name: &str) -> Result<(BaselineKind, PilotMode), String> {
    let (kind, pilot) = name
        .split_once(':')
        .ok_or_else(|| format!("teacher: {name:?} is not of the form baseline:pilot"))?;
    let kind = kind.parse().map_err(|error| format!("teacher: {error}"))?;
    let pilot = pilot.parse().map_err(|error| format!("teacher: {error}"))?;
    Ok((kind, pilot))
}

/// Missions of one configuration side by side.
pub struct Fleet {
    model: Arc<Model<'static>>,
    treatment: Treatment,
    teacher: Option<(BaselineKind, PilotMode)>,
    teachers: Vec<Baseline>,
    environments: usize,
    states: Vec<u64>,
    scratch: Vec<u64>,
    observations: Vec<f32>,
    global: Vec<f32>,
    components: Vec<f64>,
    rewards: Vec<f32>,
    ended: [Vec<u8>; 2],
    metrics: Vec<Metrics>,
    held: Vec<f32>,
    potentials: Vec<f64>,
}

impl Fleet {
    /// `environments` missions, reset with seed 0.
    pub fn new(
        model: Arc<Model<'static>>,
        environments: usize,
        treatment: Treatment,
        teacher: Option<(BaselineKind, PilotMode)>,
    ) -> Fleet {
        let uavs = model.uav_count();
        let mut fleet = Fleet {
            treatment,
            teacher,
            teachers: Vec::new(),
            environments,
            states: vec![0; environments * model.state_words()],
            scratch: vec![0; Scratch::words_for(&model)],
            observations: vec![0.0; environments * uavs * model.observation_len()],
            global: vec![0.0; environments * model.global_len()],
            components: vec![0.0; environments * COMPONENTS],
            rewards: vec![0.0; environments],
            ended: [vec![0; environments], vec![0; environments]],
            metrics: vec![Metrics::default(); environments],
            held: vec![0.0; environments * 2 * uavs],
            potentials: vec![0.0; environments],
            model,
        };
        fleet.reset(0);
        fleet
    }

    fn potential(&self, mission: usize) -> f64 {
        if self.treatment.gather.0.weight == 0.0 {
            return 0.0;
        }
        let words = self.model.state_words();
        let state = &self.states[mission * words..(mission + 1) * words];
        let state = self.model.state(state).expect("a state of this model");
        self.treatment.gather.0.potential(&self.model, &state)
    }

    fn note_potentials(&mut self) {
        self.potentials = (0..self.environments).map(|m| self.potential(m)).collect();
    }

    fn start_teachers(&mut self) {
        let Some((kind, pilot)) = self.teacher else {
            return;
        };
        self.teachers = (0..self.environments)
            .map(|_| kind.build_privileged(pilot))
            .collect();
        let words = self.model.state_words();
        for (teacher, state) in self
            .teachers
            .iter_mut()
            .zip(self.states.chunks_exact(words))
        {
            let state = self
                .model
                .state(state)
                .expect("the slab holds states of this model");
            teacher.reset(&self.model, state.seed());
        }
    }
}

impl VectorEnvironment for Fleet {
    fn shape(&self) -> Shape {
        let config = self.model.config();
        Shape {
            environments: self.environments,
            agents: self.model.uav_count(),
            observation_len: self.model.observation_len(),
            global_len: self.model.global_len(),
            hotspots: self.model.hotspot_count(),
            neighbour_slots: self.model.neighbour_slots(),
            grid: [config.grid_width, config.grid_height],
        }
    }

    fn reset(&mut self, seed: u64) {
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
        self.note_potentials();
        self.start_teachers();
    }

    fn observe(&mut self, observations: &mut [f32], global: &mut [f32]) {
        observations.copy_from_slice(&self.observations);
        global.copy_from_slice(&self.global);
    }

    fn step(&mut self, actions: &[f32], out: &mut StepOut) {
        self.held.copy_from_slice(actions);
        if let Some(pilot) = self.treatment.constant_pilot {
            self.held
                .chunks_exact_mut(2)
                .for_each(|action| action[1] = pilot);
        }
        let [terminated, truncated] = &mut self.ended;
        let mut scratch =
            Scratch::new(&self.model, &mut self.scratch).expect("sized for this model");
        self.model
            .batch_step(
                &mut self.states,
                &mut scratch,
                &self.held,
                true,
                &mut BatchOut {
                    observations: &mut self.observations,
                    global: &mut self.global,
                    rewards: &mut self.rewards,
                    components: &mut self.components,
                    terminated,
                    truncated,
                    final_observations: &mut [],
                    final_global: &mut out.final_global,
                    final_metrics: &mut self.metrics,
                    ..BatchOut::default()
                },
            )
            .expect("actions of a head are numbers, and missions start anew by themselves");
        out.finished.clear();
        for m in 0..self.environments {
            let components = &self.components[m * COMPONENTS..(m + 1) * COMPONENTS];
            out.terminated[m] = self.ended[0][m] == 1;
            out.truncated[m] = self.ended[1][m] == 1;
            // The state is that of the next mission where this one has ended: its own last potential is
            // 0 where all is done, and about what it was where the time ran out.
            let before = self.potentials[m];
            let now = self.potential(m);
            let after = match (out.terminated[m], out.truncated[m]) {
                (true, _) => 0.0,
                (_, true) => before,
                _ => now,
            };
            out.rewards[m] = self.treatment.reward(components, [before, after]);
            self.potentials[m] = now;
            if out.terminated[m] || out.truncated[m] {
                out.finished.push(Episode::of(&self.metrics[m]));
                if let Some(teacher) = self.teachers.get_mut(m) {
                    let words = self.model.state_words();
                    let state = &self.states[m * words..(m + 1) * words];
                    let state = self.model.state(state).expect("a state of this model");
                    teacher.reset(&self.model, state.seed());
                }
            }
        }
    }

    fn begin_batch(&mut self) {
        self.start_teachers();
    }

    fn teacher_actions(&mut self, actions: &mut [f32]) -> bool {
        let words = self.model.state_words();
        let states = self.states.chunks_exact(words);
        let actions = actions.chunks_exact_mut(self.model.action_len());
        for ((teacher, state), actions) in self.teachers.iter_mut().zip(states).zip(actions) {
            let state = self.model.state(state).expect("a state of this model");
            teacher.act(&self.model, &state, actions);
        }
        !self.teachers.is_empty()
    }

    fn save(&self) -> Vec<u8> {
        self.states
            .iter()
            .flat_map(|word| word.to_le_bytes())
            .collect()
    }

    /// Observations follow from the states; teachers begin anew with the next batch.
    fn load(&mut self, bytes: &[u8]) -> Result<(), String> {
        if bytes.len() != self.states.len() * 8 {
            return Err(format!(
                "environment state: {} bytes, this run needs {}",
                bytes.len(),
                self.states.len() * 8
            ));
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
            let state = self.model.state(state).map_err(|error| error.to_string())?;
            let observations = &mut self.observations[m * rows..(m + 1) * rows];
            jcas_core::observation::observe(&self.model, &state, &mut scratch, observations)
                .map_err(|error| error.to_string())?;
            let global = &mut self.global[m * global_len..(m + 1) * global_len];
            jcas_core::observation::observe_global(&self.model, &state, global)
                .map_err(|error| error.to_string())?;
        }
        self.note_potentials();
        Ok(())
    }
}

impl Episode {
    /// What the log keeps of a mission.
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
