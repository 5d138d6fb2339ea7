//! Runs random missions, sequences of calls and batches for a given number of agent-steps:
//!
//! ```console
//! $ cargo run --release -p jcas-verification --example soak -- 1e9 out/soak.txt
//! ```
//!
//! Every fourth agent-step is compared with the specification: in whole missions, and in random
//! sequences of every public call. The batch step makes the others twice: on the baseline and, in
//! turns, on one of the machine's other instruction sets. Their bits have to be the same. Such a
//! step counts once. Sizes are those of `sampling::fleet_size`.
//!
//! The file holds the progress of the run, and the same command resumes it. The third argument is a
//! seed, zero by default: runs of different seeds make different rounds. A difference ends the run,
//! which prints how to reproduce it. A failing sequence of calls is shortened first.

use jcas_core::batch::BatchOut;
use jcas_core::{Model, Scratch};
use jcas_simd::InstructionSet;
use jcas_verification::machine::{Counts, play};
use jcas_verification::mission;
use jcas_verification::sampling::{self, Dice};
use jcas_verification::specification::draws::derive_seed;
use proptest::prelude::*;
use proptest::test_runner::{Config, RngAlgorithm, TestCaseError, TestRng, TestRunner};
use std::cell::RefCell;
use std::path::Path;

/// Missions in a round.
const MISSIONS: u32 = 100;
/// Steps of a mission from one comparison of observations to the next.
const OBSERVED_EVERY: u32 = 4;
/// Sequences of calls in a round.
const SEQUENCES: u32 = 50;
/// Agent-steps of a round for each that is compared with the specification.
const STEPS_PER_COMPARED: u64 = 4;
/// Environments in a batch.
const ENVIRONMENTS: usize = 4;
/// Steps of a batch.
const BATCH_STEPS: u32 = 60;

/// The text that describes the first difference.
type Outcome = Result<(), String>;

/// The progress of a run.
#[derive(Default)]
struct Soak {
    seed: u64,
    rounds: u64,
    agent_steps: u64,
    compared: u64,
    /// Compared, of fleets of eight UAVs and more.
    compared_from_eight: u64,
}

fn main() -> Outcome {
    let usage = "usage: soak <agent-steps> <file> [<seed>]";
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let (steps, path, seed) = match &arguments[..] {
        [steps, path] => (steps, path, "0"),
        [steps, path, seed] => (steps, path, seed.as_str()),
        _ => return Err(usage.to_owned()),
    };
    let wanted: f64 = steps.parse().map_err(|_| usage)?;
    let seed: u64 = seed.parse().map_err(|_| usage)?;
    let path = Path::new(path);
    let mut progress = read(path, seed)?;
    let sets: Vec<&str> = InstructionSet::all().map(InstructionSet::name).collect();
    println!("instruction sets: {}", sets.join(", "));
    while (progress.agent_steps as f64) < wanted {
        let seed = derive_seed(progress.seed, progress.rounds);
        let round = progress.rounds;
        fly_round(seed, &mut progress).map_err(|why| format!("round {round}, {why}"))?;
        progress.rounds += 1;
        write(path, &progress)?;
    }
    println!("{}", text(&progress));
    Ok(())
}

fn fly_round(seed: u64, progress: &mut Soak) -> Outcome {
    let mut counts = fly_missions(seed)?;
    counts.add(&play_sequences(seed)?);
    progress.compared += counts.compared;
    progress.compared_from_eight += counts.compared_from_eight;
    progress.agent_steps += counts.agent_steps;
    let due = counts.compared * STEPS_PER_COMPARED;
    let others: Vec<InstructionSet> = InstructionSet::all().skip(1).collect();
    let (mut flown, mut batch) = (counts.agent_steps, 0);
    while flown < due {
        let (before, seed) = (flown, derive_seed(seed, batch));
        let sets = 1.max(others.len() as u64);
        let other = others.get((batch % sets) as usize).copied();
        flown += fly_batch(seed, other).map_err(|why| format!("batch {batch}: {why}"))?;
        progress.agent_steps += flown - before;
        batch += 1;
    }
    Ok(())
}

/// Whole missions beside the specification, observations and all.
fn fly_missions(seed: u64) -> Result<Counts, String> {
    let mut counts = Counts::default();
    let mut dice = Dice::new(seed);
    for mission in 0..MISSIONS {
        let config = if dice.one_in(200) {
            sampling::large_configuration(&mut dice)
        } else {
            sampling::configuration(&mut dice)
        };
        let pilot = sampling::pilot(&mut dice);
        let uavs = u64::from(config.uav_count);
        mission::fly(&config, pilot, &mut dice, OBSERVED_EVERY, |_, _| {
            counts.count_compared(uavs);
        })
        .map_err(|why| format!("mission {mission}: {why}"))?;
    }
    Ok(counts)
}

/// Sequences of every public call, beside the specification.
fn play_sequences(seed: u64) -> Result<Counts, String> {
    let mut start = [0; 32];
    start[..8].copy_from_slice(&seed.to_le_bytes());
    let config = Config {
        cases: SEQUENCES,
        failure_persistence: None,
        ..Config::default()
    };
    let rng = TestRng::from_seed(RngAlgorithm::ChaCha, &start);
    let mut runner = TestRunner::new_with_rng(config, rng);
    let counts = RefCell::new(Counts::default());
    let sequence = (any::<u64>(), prop::collection::vec(any::<u64>(), 0..200));
    let outcome = runner.run(&sequence, |(seed, calls)| {
        let one = play(seed, &calls).map_err(TestCaseError::fail)?;
        counts.borrow_mut().add(&one);
        Ok(())
    });
    outcome.map_err(|failure| format!("sequences: {failure}"))?;
    Ok(counts.into_inner())
}

/// The outputs of a batch on one instruction set.
struct SetFlight {
    set: InstructionSet,
    states: Vec<u64>,
    scratch: Vec<u64>,
    observations: Vec<f32>,
    rewards: Vec<f32>,
    uav_rewards: Vec<f32>,
    terminated: Vec<u8>,
    truncated: Vec<u8>,
}

impl SetFlight {
    fn new(set: InstructionSet, model: &Model<'_>, seeds: &[u64; ENVIRONMENTS]) -> Self {
        let uavs = ENVIRONMENTS * model.uav_count();
        let mut flight = SetFlight {
            set,
            states: vec![0; ENVIRONMENTS * model.state_words()],
            scratch: vec![0; Scratch::words_for(model)],
            observations: vec![0.0; uavs * model.observation_len()],
            rewards: vec![0.0; ENVIRONMENTS],
            uav_rewards: vec![0.0; uavs],
            terminated: vec![0; ENVIRONMENTS],
            truncated: vec![0; ENVIRONMENTS],
        };
        let mut scratch = Scratch::new(model, &mut flight.scratch).expect("enough memory");
        model
            .batch_reset(
                &mut flight.states,
                &mut scratch,
                seeds,
                &mut flight.observations,
                &mut [],
            )
            .expect("buffers of the right lengths");
        flight
    }

    fn step(&mut self, model: &Model<'_>, actions: &[f32]) -> Outcome {
        let mut scratch = Scratch::new(model, &mut self.scratch).expect("enough memory");
        let mut out = BatchOut {
            observations: &mut self.observations,
            rewards: &mut self.rewards,
            uav_rewards: &mut self.uav_rewards,
            terminated: &mut self.terminated,
            truncated: &mut self.truncated,
            ..BatchOut::default()
        };
        self.set
            .batch_step(
                model,
                &mut self.states,
                &mut scratch,
                actions,
                true,
                &mut out,
            )
            .map_err(|error| error.to_string())
    }

    /// Returns the first output that differs in a bit.
    fn differs_from(&self, other: &Self) -> Option<&'static str> {
        let bits = |ours: &[f32], theirs: &[f32]| {
            let mut pairs = ours.iter().zip(theirs);
            pairs.any(|(a, b)| a.to_bits() != b.to_bits())
        };
        if self.states != other.states {
            Some("states")
        } else if bits(&self.observations, &other.observations) {
            Some("observations")
        } else if bits(&self.rewards, &other.rewards) {
            Some("rewards")
        } else if bits(&self.uav_rewards, &other.uav_rewards) {
            Some("rewards of UAVs")
        } else if self.terminated != other.terminated || self.truncated != other.truncated {
            Some("ends of episodes")
        } else {
            None
        }
    }
}

/// One batch on the baseline and on another instruction set; returns its agent-steps.
fn fly_batch(seed: u64, other: Option<InstructionSet>) -> Result<u64, String> {
    let mut dice = Dice::new(seed);
    let config = if dice.one_in(50) {
        sampling::large_configuration(&mut dice)
    } else {
        sampling::configuration(&mut dice)
    };
    let model = Model::new(config).map_err(|error| error.to_string())?;
    let seeds = std::array::from_fn(|_| dice.bits());
    let mut baseline = SetFlight::new(InstructionSet::BASELINE, &model, &seeds);
    let mut other = other.map(|set| SetFlight::new(set, &model, &seeds));
    let uavs = ENVIRONMENTS * model.uav_count();
    for t in 1..=BATCH_STEPS {
        let actions: Vec<f32> = (0..uavs)
            .flat_map(|_| {
                // Both components of a UAV from one draw, a tenth of them beyond [-1, 1].
                let bits = dice.bits();
                [bits as u32, (bits >> 32) as u32].map(|half| half as f32 / 2.0f32.powi(31))
            })
            .map(|unit| unit * 1.1 - 1.1)
            .collect();
        baseline.step(&model, &actions)?;
        if let Some(flight) = &mut other {
            flight.step(&model, &actions)?;
            if let Some(what) = flight.differs_from(&baseline) {
                let set = flight.set.name();
                return Err(format!("{set}, step {t}: other {what}\n{config:?}"));
            }
        }
    }
    Ok(u64::from(BATCH_STEPS) * uavs as u64)
}

const NAMES: [&str; 5] = [
    "seed",
    "rounds",
    "agent-steps",
    "compared",
    "compared-from-eight",
];

fn text(progress: &Soak) -> String {
    let numbers = [
        progress.seed,
        progress.rounds,
        progress.agent_steps,
        progress.compared,
        progress.compared_from_eight,
    ];
    let pairs = NAMES.iter().zip(numbers);
    let words: Vec<String> = pairs
        .map(|(name, number)| format!("{name} {number}"))
        .collect();
    words.join(" ")
}

/// Reads the progress of an earlier run of the seed.
fn read(path: &Path, seed: u64) -> Result<Soak, String> {
    let Ok(text) = std::fs::read_to_string(path) else {
        return Ok(Soak {
            seed,
            ..Soak::default()
        });
    };
    let numbers: Vec<u64> = text
        .split_whitespace()
        .filter_map(|word| word.parse().ok())
        .collect();
    match numbers[..] {
        [of, rounds, agent_steps, compared, compared_from_eight] if of == seed => Ok(Soak {
            seed,
            rounds,
            agent_steps,
            compared,
            compared_from_eight,
        }),
        _ => Err(format!("{} is not of this run", path.display())),
    }
}

fn write(path: &Path, progress: &Soak) -> Outcome {
    let partial = path.with_extension("partial");
    std::fs::write(&partial, text(progress) + "\n")
        .and_then(|()| std::fs::rename(&partial, path))
        .map_err(|error| format!("{}: {error}", path.display()))
}
