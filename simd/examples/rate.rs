//! Measures how fast each instruction set of this machine steps a batch, in turns:
//!
//! ```console
//! $ cargo run --release -p jcas-simd --example rate -- 15 7 12 256
//! ```
//!
//! The arguments are UAVs, hotspots, the side of the grid and environments. Actions are random,
//! observations and rewards are written, and ended episodes are reset. The time is that of the
//! fastest tenth of the steps; the memory of an environment is printed too. `count SET STEPS` as
//! further arguments runs only that many steps, for a profiler that counts instructions. After them
//! `isac` steps that preset, and `silent` the same without false alarms and reports.

use std::time::Instant;

use jcas_core::batch::BatchOut;
use jcas_core::{Config, Model, Preset, Scratch, rng};
use jcas_simd::InstructionSet;

/// Steps of each instruction set in a turn, and the number of turns.
const STEPS: usize = 8;
const TURNS: usize = 100;
/// Number of action sets, which the steps use in turn.
const ACTIONS: usize = 8;

/// A batch with all buffers that a step reads and writes.
struct Batch<'m> {
    model: &'m Model<'m>,
    states: Vec<u64>,
    scratch: Vec<u64>,
    actions: Vec<Vec<f32>>,
    observations: Vec<f32>,
    rewards: Vec<f32>,
    ended: [Vec<u8>; 2],
    step: usize,
}

impl<'m> Batch<'m> {
    fn new(model: &'m Model<'m>, missions: usize) -> Self {
        let uniform = |seed, index| rng::unit(rng::derive_seed(seed, index)) as f32 * 2.0 - 1.0;
        let mut batch = Self {
            model,
            states: vec![0; missions * model.state_words()],
            scratch: vec![0; Scratch::words_for(model)],
            actions: (0..ACTIONS as u64)
                .map(|seed| {
                    (0..(missions * model.action_len()) as u64)
                        .map(|index| uniform(seed, index))
                        .collect()
                })
                .collect(),
            observations: vec![0.0; missions * model.uav_count() * model.observation_len()],
            rewards: vec![0.0; missions],
            ended: [vec![0; missions], vec![0; missions]],
            step: 0,
        };
        let seeds: Vec<u64> = (0..missions as u64).collect();
        let mut scratch = Scratch::new(model, &mut batch.scratch).expect("sized for the model");
        model
            .batch_reset(
                &mut batch.states,
                &mut scratch,
                &seeds,
                &mut batch.observations,
                &mut [],
            )
            .expect("sized for the model");
        batch
    }

    fn step(&mut self, set: InstructionSet) {
        let actions = &self.actions[self.step % ACTIONS];
        self.step += 1;
        let mut scratch = Scratch::new(self.model, &mut self.scratch).expect("sized for the model");
        let [terminated, truncated] = &mut self.ended;
        let mut out = BatchOut {
            observations: &mut self.observations,
            rewards: &mut self.rewards,
            terminated,
            truncated,
            ..BatchOut::default()
        };
        set.batch_step(
            self.model,
            &mut self.states,
            &mut scratch,
            actions,
            true,
            &mut out,
        )
        .expect("a legal step");
    }
}

/// The configuration of a world: the default one, or one with a fluctuating echo.
fn world(name: Option<&str>) -> Result<Config, String> {
    let isac = Config::preset(Preset::Isac);
    match name {
        None => Ok(Config::default()),
        Some("isac") => Ok(isac),
        Some("silent") => Ok(Config {
            false_alarm_per_cell: 0.0,
            report_levels: 0,
            report_slots: 0,
            ..isac
        }),
        Some(other) => Err(format!("world = {other}: must be isac or silent")),
    }
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [uavs, hotspots, side, missions, counted @ ..] = arguments.as_slice() else {
        return Err(
            "usage: rate UAVS HOTSPOTS SIDE MISSIONS [count SET STEPS [isac|silent]]".into(),
        );
    };
    let model = Model::new(Config {
        uav_count: uavs.parse()?,
        hotspot_count: hotspots.parse()?,
        grid_width: side.parse()?,
        grid_height: side.parse()?,
        neighbour_slots: 14,
        ..world(counted.get(3).map(String::as_str))?
    })?;
    let missions: usize = missions.parse()?;
    let mut batch = Batch::new(&model, missions);
    if let [_, name, steps, ..] = counted {
        let set = InstructionSet::all()
            .find(|set| set.name() == name)
            .ok_or("no such instruction set here")?;
        for _ in 0..steps.parse()? {
            batch.step(set);
        }
        return Ok(());
    }

    println!(
        "bytes a mission: {} state, {} observations, {} actions; once a thread: {} scratch",
        8 * model.state_words(),
        4 * model.uav_count() * model.observation_len(),
        4 * model.action_len(),
        8 * Scratch::words_for(&model)
    );
    let sets: Vec<InstructionSet> = InstructionSet::all().collect();
    let mut times = vec![Vec::with_capacity(STEPS * TURNS); sets.len()];
    for _ in 0..TURNS {
        for (set, times) in sets.iter().zip(&mut times) {
            for _ in 0..STEPS {
                let begun = Instant::now();
                batch.step(*set);
                times.push(begun.elapsed().as_secs_f64());
            }
        }
    }
    for (set, times) in sets.iter().zip(&mut times) {
        times.sort_by(f64::total_cmp);
        let rate = |seconds: f64| (missions * model.uav_count()) as f64 / seconds / 1e6;
        println!(
            "{:10} {:7.3} million agent-steps/s; in the median step {:7.3}",
            set.name(),
            rate(times[times.len() / 10]),
            rate(times[times.len() / 2])
        );
    }
    Ok(())
}
