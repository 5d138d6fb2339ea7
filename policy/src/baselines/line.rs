//! `line`: lines abreast that sweep the grid, in the formation with the least expected time to
//! confirm all.

use core::ops::Range;

use jcas_core::motion::toward;
use jcas_core::{Cell, Model, Motion, StateRef};

use super::memory::{OutOfMemory, collect, filled, push};
use super::pilot::PilotMode;
use super::steering::{Steering, can_fly};
use crate::{MemoryError, MemoryReader};

/// The maximum number of lines, and of strips that a line sweeps one after the other.
const MOST: u32 = 4;
/// The maximum spread of a line, in thirds of the width of its strip. A spread of 0 is a flock.
const THIRDS: u32 = 3;
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
    rows: Vec<FlightLine>,
    /// The cell of each UAV that can fly.
    cells: Vec<Option<Cell>>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Formation {
    lines: u32,
    strips: u32,
    thirds: u32,
}

/// A line with its stations, and the place of each of its UAVs at them.
#[derive(Clone, Debug)]
struct FlightLine {
    uavs: Range<usize>,
    /// Offset of each UAV from the station, across the sweep, in cells.
    places: Vec<i64>,
    /// The stations as (across, along), in cells.
    stations: Vec<(i64, i64)>,
    next: usize,
    forward: bool,
}

impl Line {
    /// Builds the policy for the pilot density of the lines, which decides their formation.
    #[must_use]
    pub fn new(pilot: PilotMode) -> Self {
        Self {
            pilot,
            chosen: None,
            rows: Vec::new(),
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
        self.rows = rows(model, formation)?;
        self.cells = filled(None, model.uav_count())?;
        Ok(())
    }

    /// Steers the UAVs that are not away. The lines go on without the others.
    pub(super) fn steer_without(
        &mut self,
        model: &Model<'_>,
        state: &StateRef<'_>,
        away: impl Fn(usize) -> bool,
        motions: &mut [Motion],
    ) {
        for (uav, cell) in self.cells.iter_mut().enumerate() {
            *cell = (can_fly(state, uav) && !away(uav)).then(|| state.cell(uav));
        }
        for row in &mut self.rows {
            row.advance(model, &self.cells);
            for (index, uav) in row.uavs.clone().enumerate() {
                motions[uav] = toward(state.cell(uav), row.place(model, index));
            }
        }
    }
}

impl Steering for Line {
    fn reset(&mut self, model: &Model<'_>) -> Result<(), OutOfMemory> {
        self.form(model, model.config().quorum)
    }

    fn save(&self, write: &mut dyn FnMut(u64)) {
        for row in &self.rows {
            write(row.next as u64);
            write(u64::from(row.forward));
        }
    }

    fn load(&mut self, _: &Model<'_>, read: &mut MemoryReader<'_>) -> Result<(), MemoryError> {
        for row in &mut self.rows {
            row.next = read.index(row.stations.len())?;
            row.forward = read.flag()?;
        }
        Ok(())
    }

    fn steer(
        &mut self,
        model: &Model<'_>,
        state: &StateRef<'_>,
        motions: &mut [Motion],
    ) -> Result<(), OutOfMemory> {
        self.steer_without(model, state, |_| false, motions);
        Ok(())
    }
}

/// Returns the width across the sweep, the length along it, and whether x runs along it.
fn extents(model: &Model<'_>) -> (i64, i64, bool) {
    let (w, h) = (model.config().grid_width, model.config().grid_height);
    (i64::from(w.min(h)), i64::from(w.max(h)), w > h)
}

fn rows(model: &Model<'_>, formation: Formation) -> Result<Vec<FlightLine>, OutOfMemory> {
    let (across, along, transposed) = extents(model);
    let depot = model.depots()[0];
    let start = i64::from(if transposed { depot.x } else { depot.y });
    let (lines, uavs) = (i64::from(formation.lines), model.uav_count());
    let strips = i64::from(formation.strips);
    let mut rows = Vec::new();
    for line in 0..lines {
        let share = |end: i64| (end as usize) * uavs / formation.lines as usize;
        let uavs = share(line)..share(line + 1);
        let band = line * along / lines..(line + 1) * along / lines;
        // The sweep begins at the end of the band that is nearer to the start of the fleet.
        let near_first = (start - band.start).abs() <= (start - (band.end - 1)).abs();
        let length = band.end - band.start;
        let stations = collect((0..strips * length).map(|station| {
            let (strip, step) = (station / length, station % length);
            let x = (across * (2 * strip + 1) / (2 * strips)).min(across - 1);
            if (strip % 2 == 0) == near_first {
                (x, band.start + step)
            } else {
                (x, band.end - 1 - step)
            }
        }))?;
        let count = uavs.len() as i64;
        let spread = across * i64::from(formation.thirds);
        let places = collect((0..count).map(|k| {
            let twice = (2 * k - (count - 1)) * spread;
            twice.div_euclid(2 * i64::from(THIRDS) * strips * count)
        }))?;
        let row = FlightLine {
            uavs,
            places,
            stations,
            next: 0,
            forward: true,
        };
        push(&mut rows, row)?;
    }
    Ok(rows)
}

impl FlightLine {
    /// Returns the cell of a UAV of the line at its present station.
    fn place(&self, model: &Model<'_>, index: usize) -> Cell {
        let (across, _, transposed) = extents(model);
        let (x, y) = self.stations[self.next];
        let x = (x + self.places[index]).clamp(0, across - 1) as u32;
        let y = y as u32;
        if transposed {
            Cell { x: y, y: x }
        } else {
            Cell { x, y }
        }
    }

    /// Advances to the next station once most of the UAVs that can fly are in place, and turns back
    /// at the end.
    fn advance(&mut self, model: &Model<'_>, cells: &[Option<Cell>]) {
        let last = self.stations.len() - 1;
        let mut flying = 0;
        let mut arrived = 0;
        for (index, uav) in self.uavs.clone().enumerate() {
            if let Some(cell) = cells[uav] {
                flying += 1;
                arrived += usize::from(cell == self.place(model, index));
            }
        }
        if flying == 0 || 2 * arrived <= flying || last == 0 {
            return;
        }
        if self.next == if self.forward { last } else { 0 } {
            self.forward = !self.forward;
        }
        self.next = if self.forward {
            self.next + 1
        } else {
            self.next - 1
        };
    }
}

/// Returns the formation with the least expected time to see all hotspots, and the simplest one
/// among equals.
fn choose(model: &Model<'_>, density: f64, seers: u32) -> Result<Formation, OutOfMemory> {
    let (across, along, _) = extents(model);
    let mut best = Formation {
        lines: 1,
        strips: 1,
        thirds: 0,
    };
    let mut least = f64::INFINITY;
    for lines in 1..=MOST.min(model.uav_count() as u32).min(along as u32) {
        for strips in 1..=MOST.min(across as u32) {
            for thirds in 0..=THIRDS {
                let formation = Formation {
                    lines,
                    strips,
                    thirds,
                };
                let steps = expected_steps(model, density, seers, formation)?;
                if steps < least {
                    (best, least) = (formation, steps);
                }
            }
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
    let mut rows = rows(model, formation)?;
    let mut cells = filled(Some(model.depots()[0]), uavs)?;
    let sampled = collect(sample(config.grid_width, config.grid_height))?;
    let detection = Detection::new(model, density)?;
    let mut missed = filled(1.0, sampled.len())?;
    let mut exactly = filled(0.0, seers as usize)?;
    let mut expected = 0.0;
    for _ in 0..STEPS {
        let mean = missed.iter().sum::<f64>() / missed.len() as f64;
        expected += 1.0 - libm::pow(1.0 - mean, f64::from(config.hotspot_count));
        for row in &mut rows {
            row.advance(model, &cells);
            for (index, uav) in row.uavs.clone().enumerate() {
                if let Some(cell) = &mut cells[uav] {
                    let motion = toward(*cell, row.place(model, index));
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
        let p = detection.probability(*cell, hotspot);
        for k in (1..exactly.len()).rev() {
            exactly[k] = exactly[k] * (1.0 - p) + exactly[k - 1] * p;
        }
        exactly[0] *= 1.0 - p;
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

    #[test]
    fn every_place_of_every_formation_is_on_the_grid() {
        for (width, height, uavs) in [(12, 12, 5), (1, 7, 3), (30, 2, 20)] {
            let config = Config {
                grid_width: width,
                grid_height: height,
                uav_count: uavs,
                hotspot_count: 1,
                ..Config::default()
            };
            let model = Model::new(config).unwrap();
            for lines in 1..=MOST.min(width.max(height)).min(uavs) {
                for strips in 1..=MOST.min(width.min(height)) {
                    let formation = Formation {
                        lines,
                        strips,
                        thirds: THIRDS,
                    };
                    for mut row in rows(&model, formation).unwrap() {
                        for next in 0..row.stations.len() {
                            row.next = next;
                            for index in 0..row.uavs.len() {
                                let cell = row.place(&model, index);
                                assert!(cell.x < width && cell.y < height);
                            }
                        }
                    }
                }
            }
        }
    }
}
