//! A fleet in steady flight, for benchmarks and profilers. UAVs walk at random from random cells,
//! so that their density and the number of neighbours stay constant on average.

use jcas_core::{Cell, Config, Error, Model, Scratch, action, motion, observation, rng};

/// A model of the default configuration with another fleet, grid and number of neighbour slots.
pub fn model(uavs: u32, hotspots: u32, side: u32, slots: u32) -> Result<Model<'static>, Error> {
    Model::new(Config {
        uav_count: uavs,
        hotspot_count: hotspots,
        grid_width: side,
        grid_height: side,
        neighbour_slots: slots,
        ..Config::default()
    })
}

/// A state in flight with everything that a step reads and writes.
pub struct Flight<'m> {
    model: &'m Model<'m>,
    words: Vec<u64>,
    scratch: Vec<u64>,
    actions: Vec<Vec<f32>>,
    cells: Vec<Cell>,
    observations: Vec<f32>,
    step: usize,
}

impl<'m> Flight<'m> {
    /// Takes off.
    pub fn new(model: &'m Model<'m>) -> Self {
        let (uavs, config) = (model.uav_count() as u64, model.config());
        let uniform = |seed, index| rng::unit(rng::derive_seed(seed, index));
        let mut flight = Self {
            model,
            words: vec![0; model.state_words()],
            scratch: vec![0; Scratch::words_for(model)],
            actions: (0..64)
                .map(|seed| {
                    (0..2 * uavs)
                        .map(|i| uniform(seed, i) as f32 * 2.0 - 1.0)
                        .collect()
                })
                .collect(),
            cells: (0..uavs)
                .map(|i| Cell {
                    x: (uniform(64, i) * f64::from(config.grid_width)) as u32,
                    y: (uniform(65, i) * f64::from(config.grid_height)) as u32,
                })
                .collect(),
            observations: vec![0.0; model.uav_count() * model.observation_len()],
            step: 0,
        };
        flight.reset();
        flight
    }

    fn reset(&mut self) {
        let mut scratch = Scratch::new(self.model, &mut self.scratch).expect("sized for the model");
        self.model
            .reset(&mut self.words, &mut scratch, self.step as u64)
            .expect("sized for the model");
    }

    /// One step with observations and reward written; the reward.
    pub fn step(&mut self) -> f64 {
        let Self {
            model,
            words,
            scratch,
            actions,
            cells,
            observations,
            step,
        } = self;
        let actions = &actions[*step % actions.len()];
        *step += 1;
        let (width, height) = (model.config().grid_width, model.config().grid_height);
        for (cell, action) in cells.iter_mut().zip(actions.chunks(2)) {
            let motion = action::motion(action[0], model.config().motion_map);
            *cell = motion::destination(*cell, motion, width, height);
        }
        let mut state = model.state_mut(words).expect("reset before");
        let mut scratch = Scratch::new(model, scratch).expect("sized for the model");
        model.step_begin(&mut state, actions).expect("in order");
        model.set_positions(&mut state, cells).expect("on the grid");
        model
            .step_sense(&mut state, &mut scratch)
            .expect("in order");
        model
            .step_communicate(&mut state, &mut scratch)
            .expect("in order");
        let outcome = model.step_end(&mut state, &mut scratch).expect("in order");
        observation::observe(model, &state.as_ref(), &mut scratch, observations).expect("sized");
        if outcome.terminated || outcome.truncated {
            self.reset();
        }
        outcome.reward
    }
}
