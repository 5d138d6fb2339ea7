//! `jcas bench`: measures how fast the kernel steps on one core.

use std::time::{Duration, Instant};

use clap::Args;
use jcas_core::batch::BatchOut;
use jcas_core::rng::{self, Purpose};
use jcas_core::{Error, Model, Scratch, Sim};
use jcas_simd::InstructionSet;
use serde::Serialize;

use crate::error::{CliError, Outcome};
use crate::options::ModelOptions;
use crate::{files, interrupt};

const EXAMPLES: &str = "\
Examples:
  jcas bench
  jcas bench --uavs 15 --hotspots 7 --json
  jcas bench --uavs 1000 --hotspots 50 --set grid_width=98 --set grid_height=98";

/// Number of steps whose actions are drawn before the clock starts; a power of two.
const ACTION_STEPS: usize = 64;
/// Number of parts of the measured time; the fastest part gives the rate.
const TENTHS: u32 = 10;
/// Name of each phase of a step, in order.
const PHASES: [&str; 5] = ["begin", "sense", "communicate", "end", "observe"];

/// Measure environment steps and agent steps a second on one core
///
/// Every step takes uniformly random actions and writes all observations and the reward. Ended
/// episodes are reset within the measured time. The time is cut into tenths. The rate of the
/// fastest tenth is reported beside the rate of the whole, since other programs disturbed that
/// tenth least. A second run puts a clock around each phase of a step and divides the time among
/// the phases. The phases are begin (actions, return to base, move), sense (radar draws, quorum,
/// learning), communicate (graph, throughput, consensus), end (energy, carbon, reward), and observe
/// (observations).
#[derive(Args)]
#[command(after_help = EXAMPLES)]
pub struct Bench {
    #[command(flatten)]
    model: ModelOptions,
    /// Environments stepped in turn, side by side in memory
    #[arg(
        long,
        value_name = "COUNT",
        default_value_t = 64,
        value_parser = clap::value_parser!(u32).range(1..=65536)
    )]
    environments: u32,
    /// Seconds to measure for, each run
    #[arg(long, value_name = "S", default_value_t = 2.0)]
    seconds: f64,
    /// Print JSON
    #[arg(long)]
    json: bool,
}

/// The output of `--json`.
#[derive(Serialize)]
struct Report {
    uavs: u32,
    hotspots: u32,
    grid_width: u32,
    grid_height: u32,
    environments: u32,
    env_steps: u64,
    seconds: f64,
    /// Rate over the whole measured time.
    env_steps_per_s_mean: f64,
    /// Rate in the fastest tenth, as are the rates below.
    env_steps_per_s: f64,
    agent_steps_per_s: f64,
    ns_per_env_step: f64,
    ns_per_agent_step: f64,
    phases: Vec<Phase>,
}

#[derive(Serialize)]
struct Phase {
    name: &'static str,
    share: f64,
    ns_per_env_step: f64,
}

impl Bench {
    /// Measures and prints the report.
    pub fn run(self) -> Result<Outcome, CliError> {
        if !(0.01..=3600.0).contains(&self.seconds) {
            return Err(CliError::input(format!(
                "seconds = {}: must be a number from 0.01 to 3600",
                self.seconds
            )));
        }
        let config = self.model.load()?;
        let model = Model::new(config)?;
        let actions = random_actions(&model, self.environments as usize);
        let time = Duration::from_secs_f64(self.seconds);
        let measured = measure_batch(&model, self.environments, &actions, time)?;
        let shares = measure_phases(&model, &actions, time)?;
        if interrupt::requested() {
            return Err(CliError::Interrupted("interrupted".to_owned()));
        }
        let uavs = f64::from(config.uav_count);
        let ns_per_env_step = 1e9 / measured.fastest_per_s;
        let report = Report {
            uavs: config.uav_count,
            hotspots: config.hotspot_count,
            grid_width: config.grid_width,
            grid_height: config.grid_height,
            environments: self.environments,
            env_steps: measured.env_steps,
            seconds: measured.seconds,
            env_steps_per_s_mean: measured.env_steps as f64 / measured.seconds,
            env_steps_per_s: measured.fastest_per_s,
            agent_steps_per_s: measured.fastest_per_s * uavs,
            ns_per_env_step,
            ns_per_agent_step: ns_per_env_step / uavs,
            phases: PHASES
                .iter()
                .zip(shares)
                .map(|(name, share)| Phase {
                    name,
                    share,
                    ns_per_env_step: share * ns_per_env_step,
                })
                .collect(),
        };
        if self.json {
            files::print_json(&report)?;
        } else {
            files::print(&report.to_text())?;
        }
        Ok(Outcome::Done)
    }
}

/// Uniform actions for every environment over [`ACTION_STEPS`] steps.
fn random_actions(model: &Model<'_>, environments: usize) -> Vec<f32> {
    let len = ACTION_STEPS * environments * model.action_len();
    (0..len)
        .map(|index| {
            let bits = rng::bits64(1, 0, 0, index as u32, Purpose::Policy);
            (2.0 * rng::unit(bits) - 1.0) as f32
        })
        .collect()
}

/// The result of one measurement of a batch.
struct Measured {
    env_steps: u64,
    seconds: f64,
    /// Environment steps per second in the fastest tenth of the time.
    fastest_per_s: f64,
}

/// Steps a batch with automatic resets until the time is up.
fn measure_batch(
    model: &Model<'_>,
    environments: u32,
    actions: &[f32],
    time: Duration,
) -> Result<Measured, Error> {
    let count = environments as usize;
    let mut states = vec![0; count * model.state_words()];
    let mut scratch_words = vec![0; Scratch::words_for(model)];
    let mut scratch = Scratch::new(model, &mut scratch_words)?;
    let mut observations = vec![0.0; count * model.uav_count() * model.observation_len()];
    let mut rewards = vec![0.0; count];
    let (mut terminated, mut truncated) = (vec![0; count], vec![0; count]);
    let seeds: Vec<u64> = (0..u64::from(environments))
        .map(|index| rng::derive_seed(1, index))
        .collect();
    model.batch_reset(
        &mut states,
        &mut scratch,
        &seeds,
        &mut observations,
        &mut [],
    )?;

    let rows: Vec<&[f32]> = actions.chunks_exact(count * model.action_len()).collect();
    let sweep = |steps: usize| -> Result<(), Error> {
        for step in 0..steps {
            let mut out = BatchOut {
                observations: &mut observations,
                rewards: &mut rewards,
                terminated: &mut terminated,
                truncated: &mut truncated,
                ..BatchOut::default()
            };
            InstructionSet::best().batch_step(
                model,
                &mut states,
                &mut scratch,
                rows[step % ACTION_STEPS],
                true,
                &mut out,
            )?;
        }
        Ok(())
    };
    measure_sweeps(sweep, environments, time)
}

/// Calls `sweep`, which takes a number of steps of every environment, until the time is up.
fn measure_sweeps(
    mut sweep: impl FnMut(usize) -> Result<(), Error>,
    environments: u32,
    time: Duration,
) -> Result<Measured, Error> {
    // This warms caches and clocks, and finds how many steps to take between two clock readings.
    let started = Instant::now();
    let mut between_looks = 1;
    while started.elapsed() < time / 10 {
        sweep(between_looks)?;
        between_looks = (between_looks * 2).min(ACTION_STEPS);
    }
    let mut measured = Measured {
        env_steps: 0,
        seconds: 0.0,
        fastest_per_s: 0.0,
    };
    for _ in 0..TENTHS {
        let started = Instant::now();
        let mut env_steps = 0;
        while started.elapsed() < time / TENTHS && !interrupt::requested() {
            sweep(between_looks)?;
            env_steps += between_looks as u64 * u64::from(environments);
        }
        let seconds = started.elapsed().as_secs_f64();
        measured.env_steps += env_steps;
        measured.seconds += seconds;
        measured.fastest_per_s = measured.fastest_per_s.max(env_steps as f64 / seconds);
    }
    Ok(measured)
}

/// The share of the time that each phase takes, without the time that the clock itself takes.
fn measure_phases(model: &Model<'_>, actions: &[f32], time: Duration) -> Result<[f64; 5], Error> {
    let mut sim = Sim::new(model);
    let mut observations = vec![0.0; model.uav_count() * model.observation_len()];
    let mut spent = [0.0; 5];
    let (mut steps, mut episode) = (0u64, 0);
    let rows: Vec<&[f32]> = actions.chunks_exact(model.action_len()).collect();
    let clock_s = clock_seconds();
    let started = Instant::now();
    while started.elapsed() < time && !interrupt::requested() {
        sim.reset(rng::derive_seed(1, episode));
        episode += 1;
        for _ in 0..model.config().horizon_steps {
            let actions = rows[steps as usize % rows.len()];
            let mut marks = [Instant::now(); 6];
            sim.step_begin(actions)?;
            marks[1] = Instant::now();
            sim.step_sense()?;
            marks[2] = Instant::now();
            sim.step_communicate()?;
            marks[3] = Instant::now();
            let outcome = sim.step_end()?;
            marks[4] = Instant::now();
            sim.observe(&mut observations)?;
            marks[5] = Instant::now();
            for (phase, spent) in spent.iter_mut().enumerate() {
                *spent += marks[phase + 1].duration_since(marks[phase]).as_secs_f64();
            }
            steps += 1;
            if outcome.terminated || outcome.truncated {
                break;
            }
        }
    }
    let corrected = spent.map(|seconds| (seconds - clock_s * steps as f64).max(0.0));
    let total: f64 = corrected.iter().sum();
    Ok(corrected.map(|seconds| seconds / total.max(f64::MIN_POSITIVE)))
}

/// The time that one clock reading takes.
fn clock_seconds() -> f64 {
    const LOOKS: u32 = 100_000;
    let started = Instant::now();
    for _ in 0..LOOKS {
        std::hint::black_box(Instant::now());
    }
    started.elapsed().as_secs_f64() / f64::from(LOOKS)
}

impl Report {
    fn to_text(&self) -> String {
        let mut text = format!(
            "{} UAVs, {} hotspots, grid {} x {}, {} environments, one core, {:.2} s\n\n\
             {:>14.0} environment steps/s  {:>9.1} ns each\n\
             {:>14.0} agent steps/s        {:>9.1} ns each\n\n\
             in the fastest tenth of the time; {:.0} environment steps/s over the whole\n\n\
             of an environment step\n",
            self.uavs,
            self.hotspots,
            self.grid_width,
            self.grid_height,
            self.environments,
            self.seconds,
            self.env_steps_per_s,
            self.ns_per_env_step,
            self.agent_steps_per_s,
            self.ns_per_agent_step,
            self.env_steps_per_s_mean,
        );
        for phase in &self.phases {
            text += &format!(
                "  {:12} {:5.1} %  {:>9.1} ns\n",
                phase.name,
                100.0 * phase.share,
                phase.ns_per_env_step
            );
        }
        text
    }
}
