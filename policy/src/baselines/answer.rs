//! `answer`: lines abreast that search, and θ UAVs that go where a report came from.

use jcas_core::motion::toward;
use jcas_core::{Model, Motion, StateRef};

use super::line::Line;
use super::memory::{OutOfMemory, filled};
use super::pilot::PilotMode;
use super::steering::{Steering, can_fly, cell_of, settled};
use crate::memory::save_index;
use crate::{MemoryError, MemoryReader};

/// The Manhattan distance in cells from which a UAV senses a reported cell.
const NEAR_CELLS: u32 = 1;
/// The least number of UAVs, in quorums, of a fleet that answers. In a smaller one an answer stops
/// the search of the others.
const QUORUMS: u32 = 3;

/// Searches as [`Line`] does, in a wider formation, and sends θ UAVs to cells with reports.
///
/// The formation is chosen for fewer UAVs that see a hotspot in one step than the quorum. The UAVs
/// that answer make up the quorum. A cell calls once θ UAVs that can come know a report of it
/// at the highest level. The nearest of them leave their lines for the cell. They come back when a
/// quorum has confirmed it, truly or falsely, or when θ of them have sensed it from nearby in vain.
///
/// A UAV is called by what it knows itself. Without reports, and with fewer UAVs than three
/// quorums, this is [`Line`].
#[derive(Clone, Debug)]
pub struct Answer {
    lines: Line,
    /// The row-major index of the cell that each UAV is called to.
    called_to: Vec<Option<usize>>,
    /// Whether θ UAVs have sensed each cell in vain.
    empty: Vec<bool>,
}

impl Answer {
    /// Builds the policy for the pilot density of the lines, which decides their formation.
    #[must_use]
    pub fn new(pilot: PilotMode) -> Self {
        Self {
            lines: Line::new(pilot),
            called_to: Vec::new(),
            empty: Vec::new(),
        }
    }

    /// Takes over the formation that another one has chosen for its model.
    pub(super) fn take_formation(&mut self, other: &Self) {
        self.lines.take_formation(&other.lines);
    }

    /// Ends answers to cells that are confirmed, or that θ UAVs have sensed.
    fn end(&mut self, model: &Model<'_>, state: &StateRef<'_>) {
        for (index, empty) in self.empty.iter_mut().enumerate() {
            let cell = cell_of(model, index);
            let called = self.called_to.iter().enumerate();
            let near = called.filter(|&(uav, &to)| {
                to == Some(index) && state.cell(uav).manhattan(cell) <= NEAR_CELLS
            });
            *empty |= near.count() >= model.config().quorum as usize;
        }
        for uav in 0..self.called_to.len() {
            let ended = |index| !self.is_open(model, state, index);
            if !can_fly(state, uav) || self.called_to[uav].is_some_and(ended) {
                self.called_to[uav] = None;
            }
        }
    }

    /// Returns whether a cell may call.
    fn is_open(&self, model: &Model<'_>, state: &StateRef<'_>, index: usize) -> bool {
        !self.empty[index] && !settled(state, index, cell_of(model, index))
    }

    /// Calls the nearest UAVs to each reported cell that has fewer than θ on the way.
    fn call(&mut self, model: &Model<'_>, state: &StateRef<'_>) {
        let (quorum, levels) = (model.config().quorum as usize, model.config().report_levels);
        for index in 0..self.empty.len() {
            if !self.is_open(model, state, index) {
                continue;
            }
            let coming = self.called_to.iter().filter(|&&to| to == Some(index));
            let missing = quorum.saturating_sub(coming.count());
            let can_come = |called_to: &[Option<usize>], uav: usize| {
                called_to[uav].is_none()
                    && can_fly(state, uav)
                    && state.report_level(uav, index) >= levels
            };
            let uavs = 0..model.uav_count();
            let free = uavs.clone().filter(|&uav| can_come(&self.called_to, uav));
            if free.count() < missing {
                continue;
            }
            for _ in 0..missing {
                let free = uavs.clone().filter(|&uav| can_come(&self.called_to, uav));
                let cell = cell_of(model, index);
                if let Some(uav) = free.min_by_key(|&uav| state.cell(uav).manhattan(cell)) {
                    self.called_to[uav] = Some(index);
                }
            }
        }
    }
}

/// Returns whether the fleet answers reports.
fn answers(model: &Model<'_>) -> bool {
    let config = model.config();
    config.report_levels > 0 && config.quorum > 1 && config.uav_count / config.quorum >= QUORUMS
}

impl Steering for Answer {
    fn reset(&mut self, model: &Model<'_>) -> Result<(), OutOfMemory> {
        let (uavs, quorum) = (model.config().uav_count, model.config().quorum);
        self.called_to = filled(None, model.uav_count())?;
        self.empty = filled(false, model.config().cell_count())?;
        let seers = if answers(model) {
            (uavs / (2 * quorum)).min(quorum - 1)
        } else {
            quorum
        };
        self.lines.form(model, seers)
    }

    fn save(&self, write: &mut dyn FnMut(u64)) {
        self.lines.save(write);
        self.called_to
            .iter()
            .for_each(|&cell| save_index(write, cell));
        self.empty.iter().for_each(|&empty| write(u64::from(empty)));
    }

    fn load(&mut self, model: &Model<'_>, read: &mut MemoryReader<'_>) -> Result<(), MemoryError> {
        self.lines.load(model, read)?;
        for cell in &mut self.called_to {
            *cell = read.optional_index(self.empty.len())?;
        }
        for empty in &mut self.empty {
            *empty = read.flag()?;
        }
        Ok(())
    }

    fn steer(
        &mut self,
        model: &Model<'_>,
        state: &StateRef<'_>,
        motions: &mut [Motion],
    ) -> Result<(), OutOfMemory> {
        if answers(model) {
            self.end(model, state);
            self.call(model, state);
        }
        let called_to = &self.called_to;
        let away = |uav: usize| called_to[uav].is_some();
        self.lines.steer_without(state, away, motions);
        for (uav, called_to) in called_to.iter().enumerate() {
            if let Some(index) = *called_to {
                motions[uav] = toward(state.cell(uav), cell_of(model, index));
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::BaselineKind;
    use crate::Policy;
    use jcas_core::{Config, Preset, Sim};

    fn actions_of(config: Config, kind: BaselineKind) -> Vec<f32> {
        let model = Model::new(config).unwrap();
        let mut policy = kind.build(&model, PilotMode::Max).unwrap();
        let mut sim = Sim::new(&model);
        let mut actions = vec![0.0; model.action_len()];
        let mut all = Vec::new();
        for seed in 0..5 {
            sim.reset(seed);
            policy.reset(&model, seed);
            while !sim.state().terminated() && !sim.state().truncated() {
                policy.act(&model, &sim.state(), &mut actions);
                sim.step(&actions).unwrap();
                all.extend_from_slice(&actions);
            }
        }
        all
    }

    #[test]
    fn without_reports_or_enough_uavs_it_is_line() {
        let isac = Config::preset(Preset::Isac);
        let silent = Config {
            uav_count: 15,
            report_levels: 0,
            report_slots: 0,
            ..isac
        };
        let small = Config {
            uav_count: 8,
            ..isac
        };
        for config in [silent, small] {
            let answer = actions_of(config, BaselineKind::Answer);
            assert_eq!(answer, actions_of(config, BaselineKind::Line));
        }
    }

    /// θ UAVs that know of a report leave for its cell and come back after sensing it. A UAV that
    /// knows of none is never called.
    #[test]
    fn those_who_know_answer_and_return() {
        let config = Config {
            uav_count: 15,
            hotspot_count: 7,
            ..Config::preset(Preset::Isac)
        };
        let model = Model::new(config).unwrap();
        let mut answer = Answer::new(PilotMode::Max);
        let mut sim = Sim::new(&model);
        let mut motions = vec![Motion::Stay; model.uav_count()];
        let (mut calls, mut ends) = (0, 0);
        for seed in 0..5 {
            sim.reset(seed);
            answer.reset(&model).unwrap();
            while !sim.state().terminated() && !sim.state().truncated() {
                let before = answer.called_to.clone();
                answer.steer(&model, &sim.state(), &mut motions).unwrap();
                for (uav, (before, now)) in before.iter().zip(&answer.called_to).enumerate() {
                    let Some(index) = *now else {
                        ends += usize::from(before.is_some());
                        continue;
                    };
                    calls += usize::from(before.is_none());
                    assert_eq!(sim.state().report_level(uav, index), 2);
                    let together = answer.called_to.iter().filter(|&&to| to == Some(index));
                    assert_eq!(together.count(), config.quorum as usize);
                }
                let actions = motions
                    .iter()
                    .flat_map(|motion| [motion.to_action(config.motion_map), 1.0]);
                sim.step(&actions.collect::<Vec<f32>>()).unwrap();
            }
        }
        assert!(calls > 0 && ends > 0, "{calls} {ends}");
    }
}
