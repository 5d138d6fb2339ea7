//! Metrics of each iteration, as CSV.

use crate::environment::Episode;
use crate::error::TrainError;
use crate::store::{csv_bytes, write_whole};
use crate::trainer::Iteration;
use serde::Serialize;
use std::path::{Path, PathBuf};

/// One line of the metrics file. Times are of this machine; all else is the same in every run.
#[derive(Clone, Debug, Serialize)]
pub struct Row {
    /// Iteration, from 1.
    pub iteration: u64,
    /// Environment steps so far.
    pub environment_steps: u64,
    /// Missions that ended in this iteration.
    pub missions: usize,
    /// Means over them; empty where none ended.
    pub return_mean: Option<f64>,
    /// Share that succeeded.
    pub success_rate: Option<f64>,
    /// Steps a mission took.
    pub mission_steps_mean: Option<f64>,
    /// Energy of the fleet.
    pub energy_kwh_mean: Option<f64>,
    /// Normalised throughput.
    pub throughput_mean: Option<f64>,
    /// Actor loss.
    pub actor_loss: f64,
    /// Critic loss.
    pub critic_loss: f64,
    /// Entropy of the policy.
    pub entropy: f64,
    /// KL divergence from the policy that collected.
    pub kl: f64,
    /// Share of samples whose ratio was clipped.
    pub clip_fraction: f64,
    /// How much of the returns the critic explains.
    pub explained_variance: f64,
    /// Norm of the actor's gradient.
    pub gradient_norm: f64,
    /// Learning rate of the actor.
    pub learning_rate: f64,
    /// Wall time of the iteration.
    pub wall_s: f64,
    /// Environment steps a second.
    pub steps_per_s: f64,
    /// UAV samples a second.
    pub samples_per_s: f64,
    /// Share of wall time in the simulator.
    pub simulation_share: f64,
    /// Share of wall time in the actor while collecting.
    pub inference_share: f64,
    /// Share of wall time learning.
    pub learning_share: f64,
    /// Some episodes have not had the time to end yet. The means are over those that ended early,
    /// which are the successful ones.
    #[serde(skip)]
    pub first_to_end: bool,
}

fn mean(episodes: &[Episode], of: impl Fn(&Episode) -> f64) -> Option<f64> {
    let sum: f64 = episodes.iter().map(of).sum();
    (!episodes.is_empty()).then(|| sum / episodes.len() as f64)
}

impl Row {
    /// The row of an iteration with `steps` environment steps and `samples` UAV samples.
    pub fn of(iteration: &Iteration, steps: u64, samples: u64) -> Row {
        let finished = &iteration.finished;
        let wall = iteration.wall.as_secs_f64().max(1e-9);
        let per_row = |sum: f64, rows: f64| if rows > 0.0 { sum / rows } else { 0.0 };
        let actor = &iteration.actor;
        let collecting = iteration.collecting.as_secs_f64() / wall;
        let learning = iteration.learning.as_secs_f64();
        Row {
            iteration: iteration.index,
            environment_steps: iteration.environment_steps,
            missions: finished.len(),
            return_mean: mean(finished, |e| e.return_sum),
            success_rate: mean(finished, |e| f64::from(u8::from(e.success))),
            mission_steps_mean: mean(finished, |e| f64::from(e.steps)),
            energy_kwh_mean: mean(finished, |e| e.energy_kwh),
            throughput_mean: mean(finished, |e| e.throughput),
            actor_loss: per_row(actor.loss, actor.rows),
            critic_loss: per_row(iteration.critic.loss, iteration.critic.rows),
            entropy: per_row(actor.entropy, actor.rows),
            kl: per_row(actor.kl, actor.rows),
            clip_fraction: per_row(actor.clipped, actor.rows),
            explained_variance: iteration.explained_variance,
            gradient_norm: per_row(actor.gradient_norm, actor.updates),
            learning_rate: iteration.learning_rate,
            wall_s: wall,
            steps_per_s: steps as f64 / wall,
            samples_per_s: samples as f64 / wall,
            simulation_share: collecting * iteration.simulation_share,
            inference_share: collecting * (1.0 - iteration.simulation_share),
            learning_share: learning / wall,
            first_to_end: false,
        }
    }

    /// The share of successes in words, and of which missions where not of all.
    pub fn success(&self) -> String {
        match (self.success_rate, self.first_to_end) {
            (None, _) => "-".into(),
            (Some(rate), false) => format!("{rate:.2}"),
            (Some(rate), true) => format!("{rate:.2} of the first to end"),
        }
    }
}

/// The metrics file: rewritten whole for each row that is added after a resume, appended else.
pub struct MetricsFile {
    path: PathBuf,
    lines: Vec<String>,
}

impl MetricsFile {
    /// Keeps what an interrupted run had written up to `iterations`; later rows are flown again.
    pub fn open(path: &Path, iterations: u64) -> Result<MetricsFile, TrainError> {
        let text = match std::fs::read_to_string(path) {
            Ok(text) if iterations > 0 => text,
            _ => String::new(),
        };
        let lines = text
            .lines()
            .take(iterations as usize + 1)
            .map(str::to_owned)
            .collect();
        Ok(MetricsFile {
            path: path.to_owned(),
            lines,
        })
    }

    /// Adds a row; [`MetricsFile::write`] puts it on disk.
    pub fn push(&mut self, row: &Row) -> Result<(), TrainError> {
        let rows = std::slice::from_ref(row);
        let bytes = csv_bytes(rows, self.lines.is_empty(), &self.path)?;
        let text = String::from_utf8(bytes).map_err(TrainError::format(&self.path))?;
        self.lines.extend(text.lines().map(str::to_owned));
        Ok(())
    }

    /// Puts all rows on disk.
    pub fn write(&self) -> Result<(), TrainError> {
        write_whole(&self.path, (self.lines.join("\n") + "\n").as_bytes())
    }
}
