//! A plan as the members of a radio component share it, with what they knew when they made it.

use alloc::vec;
use alloc::vec::Vec;

use jcas_core::{Cell, Model, StateRef, TargetVisibility};
use jcas_policy::{MemoryError, MemoryReader};

use crate::belief::Observation;
use crate::gossip::{load_lists, save_lists};
use crate::objective::Expectation;
use crate::paths::Paths;
use crate::plan::Plan;
use crate::problem::STEPS_MAX;
use crate::rounds::Rounds;

/// A plan as the members of a component share it.
#[derive(Clone, Debug)]
pub(crate) struct View {
    pub(crate) first_step: u32,
    /// The step of the episode at which the plan has run out.
    pub(crate) ends_step: u32,
    /// Whether the members have lost the others, of whose plans they assume nothing more.
    pub(crate) alone: bool,
    pub(crate) plan: Plan,
    /// The hotspots that the members knew when they planned.
    pub(crate) known: Vec<bool>,
    /// The rounds that the plan begins, where they are faster than fixed trajectories.
    pub(crate) rounds: Option<Rounds>,
    /// The reports that the members knew when they planned.
    pub(crate) reports: Vec<u64>,
    /// Whether positions are hidden, so that the first plan serves all episodes.
    pub(crate) hidden: bool,
    /// For each UAV, the observations from the last contact with it to the plan's beginning, as the
    /// plans before had them. There are none before the first step.
    pub(crate) assumed: Vec<Vec<Observation>>,
}

impl View {
    pub(crate) fn elapsed(&self, state: &StateRef<'_>) -> usize {
        state.t().saturating_sub(self.first_step) as usize
    }

    /// Returns the cell of a UAV in the plan now.
    pub(crate) fn cell(&self, state: &StateRef<'_>, uav: usize) -> Cell {
        self.plan.cell(uav, self.elapsed(state))
    }

    /// Returns the last observations of a UAV, as the plans have them.
    pub(crate) fn assumed(
        &self,
        state: &StateRef<'_>,
        uav: usize,
        count: usize,
    ) -> Vec<Observation> {
        let mut observations = self.assumed.get(uav).cloned().unwrap_or_default();
        observations.extend((1..=self.elapsed(state)).map(|step| Observation {
            cell: self.plan.cell(uav, step),
            level: self.plan.paths.level(uav, step),
        }));
        observations.split_off(observations.len().saturating_sub(count))
    }

    /// Whether the plan has run out, and the episode goes on.
    pub(crate) fn has_run_out(&self, state: &StateRef<'_>) -> bool {
        state.t() >= self.ends_step
    }

    /// Whether the members know no more than when they planned.
    pub(crate) fn holds(&self, known: &[bool], reports: &[u64]) -> bool {
        // Before the first step there are no reports.
        let planned = self.reports.iter().chain(core::iter::repeat(&0));
        self.known == known && reports.iter().zip(planned).all(|(now, then)| now == then)
    }

    pub(crate) fn save(&self, write: &mut dyn FnMut(u64)) {
        let Plan {
            seed,
            iterations,
            stopped,
            ref paths,
            expected,
            start_steps,
            bound_steps,
            ..
        } = self.plan;
        write(u64::from(self.first_step));
        write(u64::from(self.ends_step));
        write(u64::from(self.alone));
        for word in [seed, iterations, u64::from(stopped)] {
            write(word);
        }
        let figures = [
            expected.steps,
            expected.confirmed_steps,
            expected.success,
            start_steps,
            bound_steps,
        ];
        for figure in figures {
            write(figure.to_bits());
        }
        write(paths.steps() as u64);
        for uav in 0..paths.uav_count() {
            let steps = paths.cells_of(uav).iter().zip(paths.levels_of(uav));
            steps.for_each(|(&cell, &level)| write(u64::from(level) << 32 | u64::from(cell)));
        }
        self.known.iter().for_each(|&known| write(u64::from(known)));
        write(u64::from(self.rounds.is_some()));
        if let Some(rounds) = &self.rounds {
            rounds.save(write);
        }
        write(self.reports.len() as u64);
        self.reports.iter().for_each(|&word| write(word));
        save_lists(write, &self.assumed);
    }

    /// Reads what [`View::save`] wrote. `densities` are those of the levels of every plan of the
    /// model.
    pub(crate) fn load(
        read: &mut MemoryReader<'_>,
        model: &Model<'_>,
        densities: &[f64],
    ) -> Result<Self, MemoryError> {
        let config = model.config();
        let first_step = read.below(u64::from(config.horizon_steps))? as u32;
        let ends_step = read.below(1 << 32)? as u32;
        let alone = read.flag()?;
        let (seed, iterations, stopped) = (read.word()?, read.word()?, read.flag()?);
        let (steps, confirmed_steps, success) = (read.real()?, read.real()?, read.real()?);
        let (start_steps, bound_steps) = (read.real()?, read.real()?);
        let plan = Plan {
            config_hash: model.config_hash(),
            seed,
            iterations,
            stopped,
            first_step,
            paths: load_paths(read, model, densities.len())?,
            densities: densities.to_vec(),
            grid_width: config.grid_width,
            expected: Expectation {
                steps,
                confirmed_steps,
                success,
            },
            start_steps,
            bound_steps,
        };
        let known: Result<Vec<bool>, MemoryError> =
            (0..model.hotspot_count()).map(|_| read.flag()).collect();
        let rounds = match read.flag()? {
            true => Some(Rounds::load(read, model)?),
            false => None,
        };
        let reports: Result<Vec<u64>, MemoryError> =
            (0..read.count()?).map(|_| read.word()).collect();
        Ok(Self {
            first_step,
            ends_step,
            alone,
            plan,
            known: known?,
            rounds,
            reports: reports?,
            hidden: config.target_visibility == TargetVisibility::Hidden,
            assumed: load_lists(read, model, densities.len())?,
        })
    }
}

fn load_paths(
    read: &mut MemoryReader<'_>,
    model: &Model<'_>,
    levels: usize,
) -> Result<Paths, MemoryError> {
    let steps = read.count()?;
    let cells = model.config().cell_count() as u64;
    if steps > STEPS_MAX {
        return Err(MemoryError::Corrupt);
    }
    let mut paths = Paths::hovering(&vec![0; model.uav_count()], steps, 0);
    for uav in 0..model.uav_count() {
        for step in 0..=steps {
            let word = read.word()?;
            let (cell, level) = (word & u64::from(u32::MAX), word >> 32);
            if cell >= cells || level >= levels as u64 {
                return Err(MemoryError::Corrupt);
            }
            paths.set(uav, step, cell as u32, level as u8);
        }
    }
    Ok(paths)
}
