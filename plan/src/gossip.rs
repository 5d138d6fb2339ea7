//! What the UAVs have observed, and how much of it each one has received from the others.

use alloc::vec;
use alloc::vec::Vec;

use jcas_core::{Model, StateRef};
use jcas_policy::memory::save_cell;
use jcas_policy::{MemoryError, MemoryReader};

use crate::belief::{Observation, Observations};

/// The observations of all UAVs, step by step, and the share of them that each UAV has received.
#[derive(Clone, Debug, Default)]
pub(crate) struct Gossip {
    /// The step from which on observations are recorded.
    since: u32,
    /// Where each UAV was in each step so far.
    observations: Vec<Vec<Observation>>,
    /// `received[i][k]`: the number of UAV k's observations that UAV i has received.
    received: Vec<Vec<usize>>,
}

impl Gossip {
    /// Begins to record in a state.
    pub(crate) fn begin(&mut self, state: &StateRef<'_>) {
        self.since = state.t();
        self.observations.clear();
        self.received.clear();
    }

    /// Records where each UAV is in the step that has just ended. `densities` are those of the
    /// levels of a plan.
    pub(crate) fn record(&mut self, state: &StateRef<'_>, densities: &[f64]) {
        self.observations.resize(state.uav_count(), Vec::new());
        for (uav, observations) in self.observations.iter_mut().enumerate() {
            let level = if state.grounded(uav) {
                densities.len().saturating_sub(1)
            } else {
                nearest(densities, state.pilot_density(uav))
            };
            let observation = Observation {
                cell: state.cell(uav),
                level: level as u8,
            };
            observations.resize(state.t().saturating_sub(self.since) as usize, observation);
        }
        self.received
            .resize(state.uav_count(), vec![0; state.uav_count()]);
    }

    /// Exchanges the observations of the members of a component, and what each received before.
    pub(crate) fn exchange(&mut self, members: &[usize]) {
        let mut received = self.received[members[0]].clone();
        for &member in members {
            for (received, one) in received.iter_mut().zip(&self.received[member]) {
                *received = (*received).max(*one);
            }
        }
        for &member in members {
            received[member] = self.observations[member].len();
        }
        for &member in members {
            self.received[member].clone_from(&received);
        }
    }

    /// Returns, for each UAV, the number of its observations that a UAV has not received.
    pub(crate) fn missing(&self, uav: usize) -> impl Iterator<Item = usize> {
        let observations = self.observations.iter().zip(&self.received[uav]);
        observations.map(|(observations, &received)| observations.len() - received)
    }

    /// Returns what a UAV knows about the observations of each one: those that it has received, and
    /// those that it assumes since then.
    pub(crate) fn known_to<'l>(
        &'l self,
        uav: usize,
        assumed: &'l [Vec<Observation>],
    ) -> Vec<Observations<'l>> {
        let observations = self.observations.iter().zip(&self.received[uav]);
        observations
            .zip(assumed)
            .map(|((observations, &received), assumed)| Observations {
                received: &observations[..received],
                assumed,
            })
            .collect()
    }

    pub(crate) fn save(&self, write: &mut dyn FnMut(u64)) {
        write(u64::from(self.since));
        save_lists(write, &self.observations);
        for received in &self.received {
            received.iter().for_each(|&count| write(count as u64));
        }
    }

    /// Reads what [`Gossip::save`] wrote, for observations at fewer than `levels` levels.
    pub(crate) fn load(
        read: &mut MemoryReader<'_>,
        model: &Model<'_>,
        levels: usize,
    ) -> Result<Self, MemoryError> {
        let since = read.below(u64::from(model.config().horizon_steps))? as u32;
        let observations = load_lists(read, model, levels)?;
        let mut received = Vec::with_capacity(observations.len());
        for _ in 0..observations.len() {
            let row: Result<Vec<usize>, MemoryError> = observations
                .iter()
                .map(|observations| read.index(observations.len() + 1))
                .collect();
            received.push(row?);
        }
        Ok(Self {
            since,
            observations,
            received,
        })
    }
}

/// Writes a list of observations for each UAV, each observation as one word for its cell and one
/// for its level.
pub(crate) fn save_lists(write: &mut dyn FnMut(u64), lists: &[Vec<Observation>]) {
    write(lists.len() as u64);
    for observations in lists {
        write(observations.len() as u64);
        for observation in observations {
            save_cell(write, observation.cell);
            write(u64::from(observation.level));
        }
    }
}

/// Reads no list, or one for each UAV.
pub(crate) fn load_lists(
    read: &mut MemoryReader<'_>,
    model: &Model<'_>,
    levels: usize,
) -> Result<Vec<Vec<Observation>>, MemoryError> {
    let count = read.count()?;
    if count != 0 && count != model.uav_count() {
        return Err(MemoryError::Corrupt);
    }
    let mut lists = Vec::with_capacity(count);
    for _ in 0..count {
        let length = read.count()?;
        if length > model.config().horizon_steps as usize {
            return Err(MemoryError::Corrupt);
        }
        let mut observations = Vec::with_capacity(length);
        for _ in 0..length {
            observations.push(Observation {
                cell: read.cell(model)?,
                level: read.index(levels)? as u8,
            });
        }
        lists.push(observations);
    }
    Ok(lists)
}

/// Returns the level of the nearest density; the last one stands for an empty battery.
fn nearest(densities: &[f64], density: f64) -> usize {
    let distance = |level: &usize| (densities[*level] - density).abs();
    let levels = 0..densities.len().saturating_sub(1);
    levels
        .min_by(|a, b| distance(a).total_cmp(&distance(b)))
        .unwrap_or(0)
}
