//! Detection credit: the expected confirmations that each UAV adds.
//!
//! It is a difference reward (Wolpert and Tumer, "Optimal payoff functions for members of
//! collectives", 2001). A known hotspot counts in its cell. The position of a hidden hotspot begins
//! uniform and follows Bayes' rule, given what the radar would have missed so far. Unlike a
//! confirmation, this credit arrives at every step of a search and does not depend on the drawn
//! positions.

use jcas_core::{Cell, Model, StateRef, TargetVisibility};

/// Chances below this count as zero.
const NEGLIGIBLE: f64 = 1e-3;

/// State of the credit: what the searches of several episodes have not found yet.
#[derive(Clone, Debug, PartialEq)]
pub struct DetectionCredit {
    cells: usize,
    /// One value for each episode and cell. With hidden hotspots it is the chance that a hotspot
    /// there is still unconfirmed. With known hotspots it is their number.
    missed: Vec<f64>,
    /// Unconfirmed hotspots of each mission.
    open: Vec<usize>,
    radar: Radar,
}

/// Detection chances of a UAV's radar, for all cells within its reach.
#[derive(Clone, Debug, PartialEq)]
struct Radar {
    /// Cells along each axis beyond which no UAV detects.
    reach: [u32; 2],
    /// Chances with a pilot density in the middle of the range and with the highest, for each
    /// distance within reach, along x first.
    chances: Vec<[f64; 2]>,
}

/// Chances that a UAV detects a hotspot.
#[derive(Clone, Copy, Debug)]
struct Chance {
    uav: usize,
    now: f64,
    /// With a pilot density in the middle of the range.
    middling: f64,
    /// With the highest.
    highest: f64,
}

impl DetectionCredit {
    /// State for `missions` episodes, before the first of them starts.
    pub fn new(missions: usize, model: &Model<'_>) -> DetectionCredit {
        let config = model.config();
        let cells = (config.grid_width * config.grid_height) as usize;
        DetectionCredit {
            cells,
            missed: vec![1.0; missions * cells],
            open: vec![0; missions],
            radar: Radar::new(model),
        }
    }

    /// Starts an episode, in which no cell has been searched.
    pub fn start(&mut self, mission: usize, model: &Model<'_>, state: &StateRef<'_>) {
        self.missed[mission * self.cells..][..self.cells].fill(1.0);
        self.look(mission, model, state);
    }

    /// Counts the hotspots that are unconfirmed now, each in its cell where they are known.
    fn look(&mut self, mission: usize, model: &Model<'_>, state: &StateRef<'_>) {
        let open = (0..model.hotspot_count()).filter(|&hotspot| !state.confirmed(hotspot));
        self.open[mission] = open.clone().count();
        if model.config().target_visibility == TargetVisibility::Known {
            let cells = &mut self.missed[mission * self.cells..][..self.cells];
            cells.fill(0.0);
            for cell in open.map(|hotspot| state.hotspot_cell(hotspot)) {
                cells[(cell.y * model.config().grid_width + cell.x) as usize] += 1.0;
            }
        }
    }

    /// Writes the confirmations that each UAV is expected to have added in the step that led to
    /// this state. A UAV adds one if it detects a hotspot and exactly θ − 1 of the others do.
    ///
    /// If `by_pilot` has room, it receives the part that is due to the UAV's pilot density,
    /// relative to the middle of the range. The others count with their own densities or with the
    /// highest one, whichever gives the UAV more. Otherwise none of θ UAVs that all sense little
    /// would gain by sensing more alone.
    pub fn gained(
        &mut self,
        mission: usize,
        model: &Model<'_>,
        state: &StateRef<'_>,
        gains: &mut [f64],
        by_pilot: &mut [f64],
    ) {
        gains.fill(0.0);
        by_pilot.fill(0.0);
        if self.open[mission] == 0 {
            return;
        }
        let config = model.config();
        let missed = &mut self.missed[mission * self.cells..][..self.cells];
        let each = self.open[mission] as f64 / missed.iter().sum::<f64>();
        let quorum = config.quorum as usize;
        let mut chances = Vec::new();
        let (mut now, mut highest) = (Quorum::new(quorum), Quorum::new(quorum));
        for (index, missed) in (0..).zip(missed).filter(|(_, missed)| **missed > 0.0) {
            let there = Cell {
                x: index % config.grid_width,
                y: index / config.grid_width,
            };
            self.radar.chances_of(model, state, there, &mut chances);
            if chances.len() < quorum {
                continue;
            }
            now.count(chances.iter().map(|chance| chance.now));
            if !by_pilot.is_empty() {
                highest.count(chances.iter().map(|chance| chance.highest));
            }
            for (event, chance) in chances.iter().enumerate() {
                let decides = now.decided_by(event);
                gains[chance.uav] += each * *missed * decides * chance.now;
                if let Some(by_pilot) = by_pilot.get_mut(chance.uav) {
                    let decides = decides.max(highest.decided_by(event));
                    *by_pilot += each * *missed * decides * (chance.now - chance.middling);
                }
            }
            *missed *= now.fewer();
        }
        self.look(mission, model, state);
    }

    /// For each cell: the chance that a hotspot there is still unconfirmed, or the number of known
    /// unconfirmed ones.
    pub fn missed(&self, mission: usize) -> &[f64] {
        &self.missed[mission * self.cells..][..self.cells]
    }

    /// The words that a resumed run needs.
    pub fn save(&self) -> impl Iterator<Item = u64> {
        self.missed.iter().map(|missed| missed.to_bits())
    }

    /// Restores saved words, after the episodes have been started.
    pub fn load(&mut self, words: impl Iterator<Item = u64>) {
        for (missed, word) in self.missed.iter_mut().zip(words) {
            *missed = f64::from_bits(word);
        }
    }

    /// Words of [`Self::save`].
    pub fn words(&self) -> usize {
        self.missed.len()
    }
}

impl Radar {
    fn new(model: &Model<'_>) -> Radar {
        let config = model.config();
        let (low, high) = (config.pilot_density_min, config.pilot_density_max);
        let detects = |dx, dy| model.detection_probability(dx, dy, high) >= NEGLIGIBLE;
        let (width, height) = (config.grid_width, config.grid_height);
        let reach = [
            (0..width).take_while(|&dx| detects(dx, 0)).count() as u32,
            (0..height).take_while(|&dy| detects(0, dy)).count() as u32,
        ];
        let distances = (0..reach[1]).flat_map(|dy| (0..reach[0]).map(move |dx| (dx, dy)));
        let chances = distances.map(|(dx, dy)| {
            [f64::midpoint(low, high), high]
                .map(|density| model.detection_probability(dx, dy, density))
        });
        Radar {
            reach,
            chances: chances.collect(),
        }
    }

    /// The UAVs that may detect a hotspot in a cell, with their chances.
    fn chances_of(
        &self,
        model: &Model<'_>,
        state: &StateRef<'_>,
        there: Cell,
        chances: &mut Vec<Chance>,
    ) {
        chances.clear();
        for uav in 0..model.uav_count() {
            let cell = state.cell(uav);
            let (dx, dy) = (cell.x.abs_diff(there.x), cell.y.abs_diff(there.y));
            if dx < self.reach[0] && dy < self.reach[1] && !state.grounded(uav) {
                let [middling, highest] = self.chances[(dy * self.reach[0] + dx) as usize];
                if highest >= NEGLIGIBLE {
                    chances.push(Chance {
                        uav,
                        now: model.detection_probability(dx, dy, state.pilot_density(uav)),
                        middling,
                        highest,
                    });
                }
            }
        }
    }
}

/// Chances that exactly 0, 1, … θ − 1 of several independent events happen. They are kept for every
/// prefix and suffix of the events, so that any single event can be left out.
struct Quorum {
    quorum: usize,
    /// The θ chances of each prefix: the first 0, 1, … events.
    first: Vec<f64>,
    /// The θ chances of each suffix: the last 0, 1, … events.
    last: Vec<f64>,
}

impl Quorum {
    fn new(quorum: usize) -> Quorum {
        Quorum {
            quorum,
            first: Vec::new(),
            last: Vec::new(),
        }
    }

    fn count(&mut self, chances: impl DoubleEndedIterator<Item = f64> + Clone) {
        one_by_one(&mut self.first, self.quorum, chances.clone());
        one_by_one(&mut self.last, self.quorum, chances.rev());
    }

    /// The chance that fewer than θ happen.
    fn fewer(&self) -> f64 {
        self.first[self.first.len() - self.quorum..].iter().sum()
    }

    /// The chance that exactly θ − 1 of the others happen.
    fn decided_by(&self, event: usize) -> f64 {
        let quorum = self.quorum;
        let first = &self.first[event * quorum..][..quorum];
        let last = &self.last[self.last.len() - (event + 2) * quorum..][..quorum];
        first
            .iter()
            .zip(last.iter().rev())
            .map(|(f, l)| f * l)
            .sum()
    }
}

/// Computes the θ chances of the first none, one, two, … events.
fn one_by_one(exactly: &mut Vec<f64>, quorum: usize, chances: impl Iterator<Item = f64>) {
    exactly.clear();
    exactly.resize(quorum, 0.0);
    exactly[0] = 1.0;
    for chance in chances {
        let before = exactly.len() - quorum;
        for k in before..before + quorum {
            let fewer = if k > before { exactly[k - 1] } else { 0.0 };
            exactly.push(exactly[k] * (1.0 - chance) + fewer * chance);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use jcas_core::{Config, Preset, Sim};

    fn quorum(quorum: usize, chances: &[f64]) -> Quorum {
        let mut counted = Quorum::new(quorum);
        counted.count([0.9; 3].into_iter());
        counted.count(chances.iter().copied());
        counted
    }

    #[test]
    fn coin_tosses() {
        assert_eq!(quorum(3, &[0.5; 5]).decided_by(1), 6.0 / 16.0);
        assert_eq!(quorum(1, &[0.5; 4]).decided_by(3), 1.0 / 8.0);
        assert_eq!(quorum(4, &[0.5; 3]).decided_by(0), 0.0);
        assert_eq!(quorum(2, &[0.5; 4]).fewer(), 5.0 / 16.0);
        let unlike = quorum(2, &[0.5, 0.25, 0.125]);
        assert_eq!(unlike.decided_by(0), 0.25 * 0.875 + 0.75 * 0.125);
        assert_eq!(unlike.decided_by(2), 0.5);
    }

    /// The chance that at least θ UAVs detect a hotspot in a cell, summed over all outcomes. UAVs
    /// without a pilot density are away.
    fn confirms(sim: &Sim<'_>, model: &Model<'_>, there: Cell, densities: &[Option<f64>]) -> f64 {
        let state = sim.state();
        let chances: Vec<f64> = (0..)
            .zip(densities)
            .map(|(uav, density)| {
                let cell = state.cell(uav);
                let (dx, dy) = (cell.x.abs_diff(there.x), cell.y.abs_diff(there.y));
                let with = |density| model.detection_probability(dx, dy, density);
                match density {
                    Some(density) if with(0.3) >= NEGLIGIBLE => with(*density),
                    _ => 0.0,
                }
            })
            .collect();
        (0..1u32 << chances.len())
            .filter(|outcome| outcome.count_ones() >= model.config().quorum)
            .map(|outcome| {
                let each = chances.iter().enumerate();
                let each = each.map(|(uav, &chance)| match outcome >> uav & 1 {
                    1 => chance,
                    _ => 1.0 - chance,
                });
                each.product::<f64>()
            })
            .sum()
    }

    // A fleet moves apart for two steps, and all outcomes are enumerated. Each UAV adds what the
    // fleet would confirm less without it. The second step's hotspots are where the first would
    // have missed them.
    #[test]
    fn a_gain_is_the_difference_that_the_uav_makes_to_what_is_not_found_yet() {
        let config = Config {
            uav_count: 5,
            hotspot_count: 4,
            ..Config::preset(Preset::Search)
        };
        let model = Model::new(config).unwrap();
        let cells: Vec<Cell> = (0..12)
            .flat_map(|y| (0..12).map(move |x| Cell { x, y }))
            .collect();
        let mut missed = vec![1.0; cells.len()];
        let mut sim = Sim::new(&model);
        sim.reset(3);
        let mut finding = DetectionCredit::new(2, &model);
        finding.start(1, &model, &sim.state());
        let (mut gains, mut by_pilot) = ([0.0; 5], [0.0; 5]);
        for _ in 0..2 {
            let open = finding.open[1] as f64;
            sim.step(&[0.4, 0.0, -0.4, 0.3, 0.8, -0.5, 0.0, 1.0, -0.8, 0.2])
                .unwrap();
            finding
                .clone()
                .gained(1, &model, &sim.state(), &mut gains, &mut []);
            let alone = gains;
            finding.gained(1, &model, &sim.state(), &mut gains, &mut by_pilot);
            assert_eq!(gains, alone, "whoever asks");
            let total: f64 = missed.iter().sum();
            let now: Vec<_> = (0..5)
                .map(|uav| Some(sim.state().pilot_density(uav)))
                .collect();
            for (uav, (gain, by_pilot)) in gains.iter().zip(by_pilot).enumerate() {
                // The difference made in each cell by its own density, against another one or its
                // absence.
                let own = |there, others: &[Option<f64>], instead: Option<f64>| {
                    let mut densities = others.to_vec();
                    densities[uav] = now[uav];
                    let with = confirms(&sim, &model, there, &densities);
                    densities[uav] = instead;
                    with - confirms(&sim, &model, there, &densities)
                };
                let sum = |in_cell: &dyn Fn(Cell) -> f64| {
                    let each = cells.iter().zip(&missed);
                    let each = each.map(|(&there, missed)| missed * in_cell(there));
                    each.sum::<f64>() * open / total
                };
                let expected = sum(&|there| own(there, &now, None));
                assert!(*gain > 0.01, "{gains:?}");
                assert!((gain - expected).abs() < 1e-12, "{uav}: {gain} {expected}");
                let expected = sum(&|there| {
                    let middling = |others| own(there, others, Some(0.155));
                    let (now, most) = (middling(&now), middling(&[Some(0.3); 5]));
                    if now.abs() > most.abs() { now } else { most }
                });
                assert!(
                    (by_pilot - expected).abs() < 1e-12,
                    "{uav}: {by_pilot} {expected}"
                );
                assert!(by_pilot.abs() > 1e-6 || uav == 0, "its density is middling");
            }
            for (&there, missed) in cells.iter().zip(&mut missed) {
                *missed *= 1.0 - confirms(&sim, &model, there, &now);
            }
        }
    }

    // Three UAVs over a known hotspot all have the lowest pilot density. Each is credited for
    // sensing more, although one alone would confirm almost nothing.
    #[test]
    fn a_quorum_that_senses_little_is_told_to_sense_more() {
        let config = Config {
            uav_count: 3,
            hotspot_count: 1,
            ..Config::preset(Preset::Mission)
        };
        let model = Model::new(config).unwrap();
        let mut sim = Sim::new(&model);
        sim.reset(1);
        sim.set_starts(&[sim.state().hotspot_cell(0); 3]).unwrap();
        let mut finding = DetectionCredit::new(1, &model);
        finding.start(0, &model, &sim.state());
        let (mut gains, mut by_pilot) = ([0.0; 3], [0.0; 3]);
        sim.step(&[1.0, -1.0, 1.0, -1.0, 1.0, -1.0]).unwrap();
        finding.gained(0, &model, &sim.state(), &mut gains, &mut by_pilot);
        let [low, middling, high] =
            [0.01, 0.155, 0.3].map(|density| model.detection_probability(0, 0, density));
        for (gain, by_pilot) in gains.iter().zip(by_pilot) {
            assert!((gain - low.powi(3)).abs() < 1e-12, "{gains:?}");
            let expected = high * high * (low - middling);
            assert!((by_pilot - expected).abs() < 1e-12, "{by_pilot} {expected}");
        }
    }

    #[test]
    fn what_is_saved_is_what_goes_on() {
        let model = Model::new(Config::preset(Preset::Search)).unwrap();
        let mut sim = Sim::new(&model);
        sim.reset(5);
        let mut finding = DetectionCredit::new(1, &model);
        finding.start(0, &model, &sim.state());
        let mut gains = vec![0.0; model.uav_count()];
        let mut by_pilot = gains.clone();
        let actions = vec![0.3; 2 * model.uav_count()];
        sim.step(&actions).unwrap();
        finding.gained(0, &model, &sim.state(), &mut gains, &mut by_pilot);
        let mut other = DetectionCredit::new(1, &model);
        other.start(0, &model, &sim.state());
        assert_ne!(other.missed, finding.missed);
        other.load(finding.save());
        assert_eq!(other.missed, finding.missed);
    }
}
