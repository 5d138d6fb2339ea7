//! Saving a run so that it goes on bit for bit, whenever it was stopped.
//!
//! All random numbers follow from the seed and the iteration. So a checkpoint between two
//! iterations holds only weights, optimiser moments, statistics and the episodes' states.

use crate::error::{FormatError, TrainError};
use crate::ppo::normalise::Running;
use crate::ppo::update::Trainable;
use crate::store::{Array, Arrays, encode, write_whole};
use crate::trainer::Trainer;
use serde::{Deserialize, Serialize};
use std::path::Path;

const FORMAT: u32 = 2;

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Notes {
    format: u32,
    /// The run it belongs to: settings and configurations, as text.
    run: String,
    iterations: u64,
    environment_steps: u64,
    actor_updates: u64,
    critic_updates: u64,
    values_count: f64,
    workers: usize,
    critic_only_batches: u64,
}

fn model_arrays(name: &str, model: &Trainable, arrays: &mut Vec<Array>) {
    let shape = [model.parameters.len()];
    arrays.push(Array::f32(
        &format!("{name}.parameters"),
        &shape,
        &model.parameters,
    ));
    arrays.push(Array::f32(
        &format!("{name}.mean"),
        &shape,
        &model.adam.mean,
    ));
    arrays.push(Array::f32(
        &format!("{name}.square"),
        &shape,
        &model.adam.square,
    ));
}

fn read_model(name: &str, model: &mut Trainable, arrays: &Arrays) -> Result<(), FormatError> {
    let length = model.parameters.len();
    model.parameters = arrays.f32(&format!("{name}.parameters"), length)?;
    model.adam.mean = arrays.f32(&format!("{name}.mean"), length)?;
    model.adam.square = arrays.f32(&format!("{name}.square"), length)?;
    Ok(())
}

fn statistics_arrays(name: &str, running: &Running, arrays: &mut Vec<Array>) {
    arrays.push(Array::f64(&format!("{name}.mean"), &running.mean));
    arrays.push(Array::f64(&format!("{name}.deviation"), &running.deviation));
}

fn read_statistics(
    name: &str,
    running: &mut Running,
    count: f64,
    arrays: &Arrays,
) -> Result<(), FormatError> {
    let length = running.mean.len();
    running.mean = arrays.f64(&format!("{name}.mean"), length)?;
    running.deviation = arrays.f64(&format!("{name}.deviation"), length)?;
    running.count = count;
    Ok(())
}

/// Writes the present state of a run; `run` identifies its settings and configurations.
pub fn save(trainer: &Trainer, run: &str, path: &Path) -> Result<(), TrainError> {
    let mut arrays = Vec::new();
    model_arrays("actor", &trainer.actor, &mut arrays);
    model_arrays("critic", &trainer.critic, &mut arrays);
    statistics_arrays("values", &trainer.value_statistics, &mut arrays);
    for (index, worker) in trainer.workers.iter().enumerate() {
        arrays.push(Array::bytes(&format!("worker.{index}"), worker.save()));
    }
    let notes = Notes {
        format: FORMAT,
        run: run.to_owned(),
        iterations: trainer.iterations,
        environment_steps: trainer.environment_steps,
        actor_updates: trainer.actor.adam.steps,
        critic_updates: trainer.critic.adam.steps,
        values_count: trainer.value_statistics.count,
        workers: trainer.workers.len(),
        critic_only_batches: trainer.critic_only_batches,
    };
    let notes = serde_json::to_string(&notes).map_err(TrainError::format(path))?;
    let bytes = encode(&arrays, &notes).map_err(TrainError::format(path))?;
    write_whole(path, &bytes)
}

/// Brings a fresh trainer of the same run to where the checkpoint was written.
pub fn load(trainer: &mut Trainer, run: &str, path: &Path) -> Result<(), TrainError> {
    let bytes = std::fs::read(path).map_err(TrainError::file(path))?;
    read(trainer, run, &bytes).map_err(TrainError::format(path))
}

/// Gives a fresh trainer what another run has learnt: weights, moments and statistics, not its
/// missions. Its environment steps count on.
pub fn load_learnt(trainer: &mut Trainer, path: &Path) -> Result<(), TrainError> {
    let bytes = std::fs::read(path).map_err(TrainError::file(path))?;
    let learnt = decode(&bytes).and_then(|(notes, arrays)| {
        read_learnt(trainer, &notes, &arrays)?;
        // A critic that was not ready for its actor is not ready in another run.
        trainer.critic_only_batches = notes.critic_only_batches.saturating_sub(notes.iterations);
        Ok(())
    });
    learnt.map_err(TrainError::format(path))
}

fn read(trainer: &mut Trainer, run: &str, bytes: &[u8]) -> Result<(), FormatError> {
    let (notes, arrays) = decode(bytes)?;
    if notes.run != run {
        return Err(FormatError::OtherRun {
            stored: notes.run,
            given: run.to_owned(),
        });
    }
    if notes.workers != trainer.workers.len() {
        return Err(FormatError::Workers {
            stored: notes.workers,
            given: trainer.workers.len(),
        });
    }
    read_learnt(trainer, &notes, &arrays)?;
    for (index, worker) in trainer.workers.iter_mut().enumerate() {
        worker.load(&arrays.bytes(&format!("worker.{index}"))?)?;
    }
    trainer.iterations = notes.iterations;
    trainer.critic_only_batches = notes.critic_only_batches;
    Ok(())
}

fn decode(bytes: &[u8]) -> Result<(Notes, Arrays<'_>), FormatError> {
    let arrays = Arrays::decode(bytes)?;
    let notes = arrays.notes.as_deref();
    let notes = notes.ok_or(FormatError::NoNote)?;
    let notes: Notes = serde_json::from_str(notes)?;
    if notes.format != FORMAT {
        return Err(FormatError::Version {
            got: notes.format,
            expected: FORMAT,
        });
    }
    Ok((notes, arrays))
}

fn read_learnt(
    trainer: &mut Trainer,
    notes: &Notes,
    arrays: &Arrays<'_>,
) -> Result<(), FormatError> {
    read_model("actor", &mut trainer.actor, arrays)?;
    read_model("critic", &mut trainer.critic, arrays)?;
    trainer.actor.adam.steps = notes.actor_updates;
    trainer.critic.adam.steps = notes.critic_updates;
    let statistics = &mut trainer.value_statistics;
    read_statistics("values", statistics, notes.values_count, arrays)?;
    trainer.environment_steps = notes.environment_steps;
    Ok(())
}
