//! Detection credit: the expected confirmations that each UAV adds.
//!
//! It is a difference reward (Wolpert and Tumer, "Optimal payoff functions for members of
//! collectives", 2001). Unlike a confirmation, this credit arrives at every step over a hotspot and
//! does not depend on the drawn detections.

use jcas_core::{Cell, Model, StateRef};

/// Chances below this count as zero.
const NEGLIGIBLE: f64 = 1e-3;

/// State of the credit: the hotspots that several episodes have not confirmed yet.
#[derive(Clone, Debug, PartialEq)]
pub struct DetectionCredit {
    /// Cells of the unconfirmed hotspots of each episode.
    open: Vec<Vec<Cell>>,
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
        DetectionCredit {
            open: vec![Vec::new(); missions],
            radar: Radar::new(model),
        }
    }

    /// Starts an episode, or continues one from this state.
    pub fn start(&mut self, mission: usize, model: &Model<'_>, state: &StateRef<'_>) {
        let cells = &mut self.open[mission];
        cells.clear();
        cells.extend(unconfirmed(model, state).map(|hotspot| state.hotspot_cell(hotspot)));
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
        let quorum = model.config().quorum as usize;
        let mut chances = Vec::new();
        let (mut now, mut highest) = (Quorum::new(quorum), Quorum::new(quorum));
        for &there in &self.open[mission] {
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
                gains[chance.uav] += decides * chance.now;
                if let Some(by_pilot) = by_pilot.get_mut(chance.uav) {
                    let decides = decides.max(highest.decided_by(event));
                    *by_pilot += decides * (chance.now - chance.middling);
                }
            }
        }
        self.start(mission, model, state);
    }

    /// Confirmations of the step that led to this state less the expected ones, as a share of the
    /// hotspots that were unconfirmed before it. Called before [`DetectionCredit::gained`].
    pub fn surplus(&self, mission: usize, model: &Model<'_>, state: &StateRef<'_>) -> f64 {
        let open = &self.open[mission];
        if open.is_empty() {
            return 0.0;
        }
        let quorum = model.config().quorum as usize;
        let (mut chances, mut exactly) = (Vec::new(), Vec::new());
        let expected = open.iter().map(|&there| {
            self.radar.chances_of(model, state, there, &mut chances);
            one_by_one(
                &mut exactly,
                quorum,
                chances.iter().map(|chance| chance.now),
            );
            1.0 - exactly[exactly.len() - quorum..].iter().sum::<f64>()
        });
        let expected: f64 = expected.sum();
        let confirmed = open.len() - unconfirmed(model, state).count();
        (confirmed as f64 - expected) / open.len() as f64
    }
}

fn unconfirmed(model: &Model<'_>, state: &StateRef<'_>) -> impl Iterator<Item = usize> {
    (0..model.hotspot_count()).filter(|&hotspot| !state.confirmed(hotspot))
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

    fn model(preset: Preset, uav_count: u32, hotspot_count: u32) -> Model<'static> {
        let config = Config {
            uav_count,
            hotspot_count,
            ..Config::preset(preset)
        };
        Model::new(config).unwrap()
    }

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

    // A fleet moves apart for two steps over many hotspots, and all outcomes are enumerated. Each
    // UAV adds what the fleet would confirm less without it.
    #[test]
    fn a_gain_is_the_difference_that_the_uav_makes_to_what_is_not_found_yet() {
        let model = model(Preset::Paper, 5, 100);
        let mut sim = Sim::new(&model);
        sim.reset(3);
        let mut finding = DetectionCredit::new(2, &model);
        finding.start(1, &model, &sim.state());
        let (mut gains, mut by_pilot) = ([0.0; 5], [0.0; 5]);
        for _ in 0..2 {
            let open = finding.open[1].clone();
            sim.step(&[0.4, 0.0, -0.4, 0.3, 0.8, -0.5, 0.0, 1.0, -0.8, 0.2])
                .unwrap();
            finding
                .clone()
                .gained(1, &model, &sim.state(), &mut gains, &mut []);
            let alone = gains;
            finding.gained(1, &model, &sim.state(), &mut gains, &mut by_pilot);
            assert_eq!(gains, alone, "whoever asks");
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
                let sum = |in_cell: &dyn Fn(Cell) -> f64| -> f64 {
                    open.iter().map(|&there| in_cell(there)).sum()
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
            let confirmed = |&cell: &Cell| {
                let mut hotspots = 0..model.hotspot_count();
                let hotspot = hotspots.find(|&hotspot| sim.state().hotspot_cell(hotspot) == cell);
                sim.state().confirmed(hotspot.unwrap())
            };
            let expected: Vec<Cell> = open.into_iter().filter(|cell| !confirmed(cell)).collect();
            assert_eq!(finding.open[1], expected);
        }
    }

    // Three UAVs over a known hotspot all have the lowest pilot density. Each is credited for
    // sensing more, although one alone would confirm almost nothing.
    #[test]
    fn a_quorum_that_senses_little_is_told_to_sense_more() {
        let model = model(Preset::Mission, 3, 1);
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

    // Ten UAVs stay over hotspots. Over many steps they confirm what is expected, within five
    // standard deviations.
    #[test]
    fn a_surplus_is_zero_on_average() {
        let model = model(Preset::Mission, 10, 2);
        let mut sim = Sim::new(&model);
        let mut finding = DetectionCredit::new(1, &model);
        let (mut sum, mut squares, mut confirmed) = (0.0, 0.0, 0);
        for seed in 0..400 {
            sim.reset(seed);
            let there = [0, 1].map(|hotspot| sim.state().hotspot_cell(hotspot));
            sim.set_starts(&[0, 0, 0, 0, 0, 0, 1, 1, 1, 1].map(|hotspot: usize| there[hotspot]))
                .unwrap();
            finding.start(0, &model, &sim.state());
            for _ in 0..5 {
                let outcome = sim.step(&[0.8, 0.5].repeat(10)).unwrap();
                let surplus = finding.surplus(0, &model, &sim.state());
                sum += surplus;
                squares += surplus * surplus;
                confirmed += u32::from(surplus > 0.0);
                if outcome.terminated {
                    break;
                }
                finding.start(0, &model, &sim.state());
            }
        }
        assert!(confirmed > 100, "{confirmed}");
        assert!(f64::abs(sum) < 5.0 * f64::sqrt(squares), "{sum} {squares}");
    }

    #[test]
    fn a_surplus_is_a_share_of_what_was_unconfirmed() {
        let model = model(Preset::Paper, 3, 2);
        let mut sim = Sim::new(&model);
        sim.reset(1);
        let there = sim.state().hotspot_cell(0);
        sim.set_starts(&[there; 3]).unwrap();
        let mut finding = DetectionCredit::new(1, &model);
        finding.start(0, &model, &sim.state());
        sim.step(&[0.8; 6]).unwrap();
        let state = sim.state();
        let expected: f64 = [0, 1]
            .map(|hotspot| {
                confirms(
                    &sim,
                    &model,
                    state.hotspot_cell(hotspot),
                    &[0, 1, 2].map(|uav| Some(state.pilot_density(uav))),
                )
            })
            .iter()
            .sum();
        let confirmed = [0, 1].map(|hotspot| f64::from(u8::from(state.confirmed(hotspot))));
        let surplus = finding.surplus(0, &model, &state);
        let expected = (confirmed[0] + confirmed[1] - expected) / 2.0;
        assert!((surplus - expected).abs() < 1e-9, "{surplus} {expected}");
    }
}
