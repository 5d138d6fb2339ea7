//! `line`: lines abreast that sweep the grid, in the formation with the least expected time to
//! confirm all.

use jcas_core::motion::toward;
use jcas_core::{Cell, Model, Motion, StateRef};

use super::memory::{OutOfMemory, collect, filled};
use super::pilot::PilotMode;
use super::steering::{Steering, can_fly};
use crate::geometry::{Formation, Rank, one_more};
use crate::{MemoryError, MemoryReader};

/// The number of steps over which a formation is evaluated.
const STEPS: usize = 60;
/// The maximum number of cells along each axis at which a formation is evaluated.
const SAMPLES: u32 = 12;

/// Lines of UAVs abreast, each with a band of the grid, which it sweeps strip by strip, back and
/// forth.
///
/// The numbers of lines and strips and the spread of a line are chosen once for each model. The
/// chosen formation confirms hotspots in random cells in the least expected time, starting from the
/// depot. A flock confirms reliably but covers few cells at a time. A wide line covers many cells,
/// but confirms only where a quorum of it detects a hotspot in the same step.
#[derive(Clone, Debug)]
pub struct Line {
    pilot: PilotMode,
    chosen: Option<(u64, Formation)>,
    ranks: Vec<Rank>,
    /// The cell of each UAV that can fly.
    cells: Vec<Option<Cell>>,
}

impl Line {
    /// Builds the policy for the pilot density of the lines, which decides their formation.
    #[must_use]
    pub fn new(pilot: PilotMode) -> Self {
        Self {
            pilot,
            chosen: None,
            ranks: Vec::new(),
            cells: Vec::new(),
        }
    }

    /// Takes over the formation that another one has chosen for its model.
    pub(super) fn take_formation(&mut self, other: &Self) {
        self.chosen = other.chosen;
    }

    /// Forms the lines at the depot for `seers` UAVs that have to see a hotspot in one step.
    pub(super) fn form(&mut self, model: &Model<'_>, seers: u32) -> Result<(), OutOfMemory> {
        let formation = match self.chosen {
            Some((hash, formation)) if hash == model.config_hash() => formation,
            _ => choose(model, self.pilot.sensing_density(model), seers)?,
        };
        self.chosen = Some((model.config_hash(), formation));
        self.ranks = collect(ranks(model, formation))?;
        self.cells = filled(None, model.uav_count())?;
        Ok(())
    }

    /// Steers the UAVs that are not away. The lines go on without the others.
    pub(super) fn steer_without(
        &mut self,
        state: &StateRef<'_>,
        away: impl Fn(usize) -> bool,
        motions: &mut [Motion],
    ) {
        for (uav, cell) in self.cells.iter_mut().enumerate() {
            *cell = (can_fly(state, uav) && !away(uav)).then(|| state.cell(uav));
        }
        for rank in &mut self.ranks {
            rank.advance(|uav| self.cells[uav]);
            for (index, uav) in rank.uavs().enumerate() {
                motions[uav] = toward(state.cell(uav), rank.place(index));
            }
        }
    }
}

impl Steering for Line {
    fn reset(&mut self, model: &Model<'_>) -> Result<(), OutOfMemory> {
        self.form(model, model.config().quorum)
    }

    fn save(&self, write: &mut dyn FnMut(u64)) {
        for rank in &self.ranks {
            let (station, forward) = rank.position();
            write(station as u64);
            write(u64::from(forward));
        }
    }

    fn load(&mut self, _: &Model<'_>, read: &mut MemoryReader<'_>) -> Result<(), MemoryError> {
        for rank in &mut self.ranks {
            rank.set_position(read.index(rank.stations())?, read.flag()?);
        }
        Ok(())
    }

    fn steer(
        &mut self,
        _: &Model<'_>,
        state: &StateRef<'_>,
        motions: &mut [Motion],
    ) -> Result<(), OutOfMemory> {
        self.steer_without(state, |_| false, motions);
        Ok(())
    }
}

/// Returns the lines of a formation at the first depot.
fn ranks(model: &Model<'_>, formation: Formation) -> impl Iterator<Item = Rank> + use<> {
    formation.ranks(model.config(), model.depots()[0], model.uav_count())
}

/// Returns the formation with the least expected time to see all hotspots, and the simplest one
/// among equals.
fn choose(model: &Model<'_>, density: f64, seers: u32) -> Result<Formation, OutOfMemory> {
    let mut best = Formation {
        lines: 1,
        strips: 1,
        thirds: 0,
    };
    let mut least = f64::INFINITY;
    for formation in Formation::all(model.config(), model.uav_count()) {
        let steps = expected_steps(model, density, seers, formation)?;
        if steps < least {
            (best, least) = (formation, steps);
        }
    }
    Ok(best)
}

/// Returns the expected steps until all hotspots are seen, each in a random cell, at most
/// [`STEPS`]. A hotspot is seen by at least `seers` UAVs in one step; with θ it is confirmed.
///
/// Let Q be the probability that at least `seers` of the UAVs detect a hotspot in cell c in one
/// step. After t steps it is unseen with probability m_c(t) = prod (1 - Q). With m the mean over
/// cells, all n are seen with probability (1 - m)^n.
fn expected_steps(
    model: &Model<'_>,
    density: f64,
    seers: u32,
    formation: Formation,
) -> Result<f64, OutOfMemory> {
    let (config, uavs) = (model.config(), model.uav_count());
    let mut ranks = collect(ranks(model, formation))?;
    let mut cells = filled(Some(model.depots()[0]), uavs)?;
    let sampled = collect(sample(config.grid_width, config.grid_height))?;
    let detection = Detection::new(model, density)?;
    let mut missed = filled(1.0, sampled.len())?;
    let mut exactly = filled(0.0, seers as usize)?;
    let mut expected = 0.0;
    for _ in 0..STEPS {
        let mean = missed.iter().sum::<f64>() / missed.len() as f64;
        expected += 1.0 - libm::pow(1.0 - mean, f64::from(config.hotspot_count));
        for rank in &mut ranks {
            rank.advance(|uav| cells[uav]);
            for (index, uav) in rank.uavs().enumerate() {
                if let Some(cell) = &mut cells[uav] {
                    let motion = toward(*cell, rank.place(index));
                    *cell = jcas_core::motion::destination(
                        *cell,
                        motion,
                        config.grid_width,
                        config.grid_height,
                    );
                }
            }
        }
        for (missed, &cell) in missed.iter_mut().zip(&sampled) {
            *missed *= below_quorum(&mut exactly, &detection, &cells, cell);
        }
    }
    Ok(expected)
}

/// Returns cells spread evenly over the grid.
fn sample(width: u32, height: u32) -> impl Iterator<Item = Cell> {
    let axis = |extent: u32| {
        let count = extent.min(SAMPLES);
        (0..count).map(move |k| (2 * k + 1) * extent / (2 * count))
    };
    axis(height).flat_map(move |y| axis(width).map(move |x| Cell { x, y }))
}

/// A table of the probability of a detection for every offset.
struct Detection {
    width: u32,
    probabilities: Vec<f64>,
}

impl Detection {
    fn new(model: &Model<'_>, density: f64) -> Result<Self, OutOfMemory> {
        let (width, height) = (model.config().grid_width, model.config().grid_height);
        let offsets = (0..width * height).map(|offset| (offset % width, offset / width));
        let probabilities =
            collect(offsets.map(|(dx, dy)| model.detection_probability(dx, dy, density)))?;
        Ok(Self {
            width,
            probabilities,
        })
    }

    fn probability(&self, a: Cell, b: Cell) -> f64 {
        let (dx, dy) = (a.x.abs_diff(b.x), a.y.abs_diff(b.y));
        self.probabilities[(dy * self.width + dx) as usize]
    }
}

/// Returns the probability that fewer than θ UAVs detect a hotspot in one step, each with its own
/// probability. It sets `exactly[k]` to the probability of k detections, for each k below θ.
fn below_quorum(
    exactly: &mut [f64],
    detection: &Detection,
    uavs: &[Option<Cell>],
    hotspot: Cell,
) -> f64 {
    exactly.fill(0.0);
    exactly[0] = 1.0;
    for cell in uavs.iter().flatten() {
        one_more(exactly, detection.probability(*cell, hotspot));
    }
    exactly.iter().sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::baselines::quorum_probability;
    use jcas_core::{Config, Preset};

    #[test]
    fn equal_probabilities_give_the_binomial_tail() {
        let model = Model::new(Config::preset(Preset::Search)).unwrap();
        let here = Cell { x: 3, y: 3 };
        let there = Cell { x: 6, y: 3 };
        let p = model.detection_probability(3, 0, 0.3);
        for uavs in 1..8 {
            let detection = Detection::new(&model, 0.3).unwrap();
            let got = below_quorum(&mut [0.0; 3], &detection, &vec![Some(here); uavs], there);
            assert!((got - (1.0 - quorum_probability(uavs, 3, p))).abs() < 1e-12);
        }
    }

    #[test]
    fn a_weak_radar_keeps_together_and_a_strong_one_spreads() {
        let strong = Config {
            uav_count: 20,
            ..Config::preset(Preset::Search)
        };
        let weak = Config {
            uav_count: 6,
            ..Config::default()
        };
        assert!(choose(&Model::new(strong).unwrap(), 0.3, 3).unwrap().thirds > 0);
        let flock = choose(&Model::new(weak).unwrap(), 0.3, 3).unwrap();
        assert_eq!((flock.lines, flock.thirds), (1, 0));
    }
}
