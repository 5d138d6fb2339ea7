//! Sampled episodes of rounds, which differ in the waits for a quorum.

use alloc::vec;
use alloc::vec::Vec;

use jcas_core::Cell;

use super::charging::Duty;
use super::crew::Crew;
use super::{HOTSPOTS_MAX, Rounds};
use crate::battery;
use crate::draws::Draws;
use crate::objective::{Expectation, hazard};
use crate::problem::Problem;

/// Samples of the waits, by which rounds are compared.
pub(super) struct Race<'p, 'm> {
    problem: &'p Problem<'m>,
    hotspots: &'p [Cell],
    /// -ln(1 - q(m)) of m UAVs.
    pub(super) hazard: Vec<f64>,
    /// -ln(1 - p) of one UAV: it learns of a confirmed hotspot by a detection of its own.
    hazard_of_one: f64,
    /// -ln(U) of each sample, first for the quorum at each hotspot and then for a detection.
    limits: Vec<f64>,
    /// The energy in µJ of a step, by whether it moves and whether it senses a hotspot.
    asked_uj: [[u64; 2]; 2],
}

/// The times of rounds over the samples.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Times {
    pub(super) expected: Expectation,
    /// The longest sample in steps.
    pub(super) longest: u32,
}

/// Returns -ln(1 - q(m)) for each number m of UAVs over a hotspot.
pub(super) fn hazards(problem: &Problem<'_>) -> Vec<f64> {
    let (odds, here) = (&problem.odds, Cell::default());
    let p = odds.detection(odds.highest(), here, here);
    let quorum = problem.model.config().quorum as usize;
    let uavs = problem.situation.cells.len();
    (0..=uavs).map(|uavs| hazard(quorum, uavs, p)).collect()
}

/// A sampled episode of rounds.
#[derive(Clone)]
struct Episode<'t> {
    crews: Vec<Crew<'t>>,
    /// The hotspots that a quorum has confirmed, one bit each.
    confirmed: u64,
    /// The sum of the hazards of each hotspot so far.
    waited: Vec<f64>,
    /// Whether a battery may run low.
    may_run_low: bool,
}

impl<'p, 'm> Race<'p, 'm> {
    pub(super) fn new(
        problem: &'p Problem<'m>,
        hotspots: &'p [Cell],
        samples: usize,
        draws: &mut Draws,
    ) -> Self {
        let (odds, here) = (&problem.odds, Cell::default());
        let limits = (0..samples * hotspots.len() * 2)
            .map(|_| -libm::log(draws.unit()))
            .collect();
        let densities = [
            odds.densities()[0],
            odds.densities()[usize::from(odds.highest())],
        ];
        let energy = problem.model.energy();
        let asked = |moved| densities.map(|density| energy.most_asked_at_uj(moved, density));
        Self {
            problem,
            hotspots,
            hazard: hazards(problem),
            hazard_of_one: hazard(1, 1, odds.detection(odds.highest(), here, here)),
            limits,
            asked_uj: [asked(false), asked(true)],
        }
    }

    /// Returns the times over the samples. It may end early if the mean exceeds `most`.
    pub(super) fn times(&self, rounds: &Rounds, most: f64) -> Times {
        let left = self.problem.steps_left;
        let mut times = Times::default();
        let begin = self.begin(rounds);
        let samples = self.limits.chunks_exact(2 * self.hotspots.len());
        let share = 1.0 / samples.len() as f64;
        for limits in samples {
            let (confirmed, ended) = self.run(begin.clone(), limits);
            times.expected.confirmed_steps += share * f64::from(confirmed.unwrap_or(left));
            times.expected.steps += share * f64::from(ended.unwrap_or(left));
            times.expected.success += share * f64::from(u8::from(ended.is_some()));
            times.longest = times.longest.max(ended.unwrap_or(left));
            if times.expected.steps > most {
                break;
            }
        }
        times
    }

    fn begin<'t>(&self, rounds: &'t Rounds) -> Episode<'t> {
        let model = self.problem.model;
        let crews: Vec<Crew<'_>> = rounds.teams.iter().flat_map(Crew::of).collect();
        let may_run_low = rounds.teams.iter().any(|team| {
            let steps = (model.config().horizon_steps - team.first_step) as usize;
            let lasts = |uj| battery::never_low(model, uj, steps);
            !team.members.iter().all(|member| lasts(member.charge_uj))
        });
        Episode {
            confirmed: crews.iter().fold(0, |union, crew| union | crew.known),
            crews,
            waited: vec![0.0; self.hotspots.len()],
            may_run_low,
        }
    }

    /// Flies one sample. Returns the steps from now until all is confirmed, and until the end.
    fn run(&self, mut episode: Episode<'_>, limits: &[f64]) -> (Option<u32>, Option<u32>) {
        let now = self.problem.situation.step;
        let all = u64::MAX >> (HOTSPOTS_MAX - self.hotspots.len());
        let begin = episode.crews.iter().map(|crew| crew.team.first_step).min();
        let mut confirmed = None;
        for step in begin.unwrap_or(now)..now + self.problem.steps_left {
            self.fly(&mut episode, step);
            self.sense(&mut episode, step, limits);
            if step < now {
                continue;
            }
            self.share(&mut episode.crews);
            let passed = step + 1 - now;
            let crews = &episode.crews;
            let union = crews.iter().fold(0, |union, crew| union | crew.known);
            if union == all && confirmed.is_none() {
                confirmed = Some(passed);
            }
            if crews.iter().all(|crew| crew.known == all) {
                return (confirmed, Some(passed));
            }
        }
        (confirmed, None)
    }

    /// Flies each crew one cell, and settles its batteries.
    fn fly(&self, episode: &mut Episode<'_>, step: u32) {
        let model = self.problem.model;
        let crews = &mut episode.crews;
        let mut index = 0;
        while index < crews.len() {
            if crews[index].team.first_step > step {
                index += 1;
                continue;
            }
            if episode.may_run_low
                && let Some(others) = crews[index].part(model)
            {
                crews.push(others);
            }
            if crews[index].duty == Duty::Round {
                crews[index].turn(self.hotspots);
            }
            let known = crews[index].known;
            let unaware = || crews.iter().find(|other| other.known & known != known);
            let target = match crews[index].target {
                Some(hotspot) => self.hotspots[hotspot],
                None => unaware().map_or(crews[index].cell, |other| other.cell),
            };
            let crew = &mut crews[index];
            let moved = crew.fly(model, target);
            if episode.may_run_low {
                let senses = crew.target.is_some() && crew.cell == target;
                let asked_uj = self.asked_uj[usize::from(moved)][usize::from(senses)];
                crew.settle(
                    model,
                    if crew.duty == Duty::Grounded {
                        0
                    } else {
                        asked_uj
                    },
                );
            }
            index += 1;
        }
    }

    /// Adds the hazards of the crews that have reached their hotspots.
    fn sense(&self, episode: &mut Episode<'_>, step: u32, limits: &[f64]) {
        let (limits, limits_of_one) = limits.split_at(self.hotspots.len());
        let there = |crew: &Crew<'_>| {
            let target = crew.target?;
            (crew.cell == self.hotspots[target] && crew.team.first_step <= step).then_some(target)
        };
        let mut uavs = [0; HOTSPOTS_MAX];
        for crew in &episode.crews {
            if let Some(hotspot) = there(crew) {
                uavs[hotspot] += crew.count();
            }
        }
        let before = episode.confirmed;
        for (hotspot, waited) in episode.waited.iter_mut().enumerate() {
            *waited += self.hazard[uavs[hotspot].min(self.hazard.len() - 1)];
            if uavs[hotspot] > 0 && *waited >= limits[hotspot] {
                episode.confirmed |= 1 << hotspot;
            }
        }
        for crew in &mut episode.crews {
            let Some(hotspot) = there(crew) else { continue };
            if before >> hotspot & 1 == 1 {
                crew.waited += self.hazard_of_one * crew.count() as f64;
                if crew.waited < limits_of_one[hotspot] {
                    continue;
                }
            }
            crew.known |= episode.confirmed & 1 << hotspot;
        }
    }

    /// Lets linked crews share what they know, until nothing is new.
    fn share(&self, crews: &mut [Crew<'_>]) {
        let odds = &self.problem.odds;
        let mut changed = true;
        while changed {
            changed = false;
            for a in 1..crews.len() {
                let (before, rest) = crews.split_at_mut(a);
                for other in before {
                    let crew = &mut rest[0];
                    let union = crew.known | other.known;
                    if crew.known == other.known {
                        continue;
                    }
                    let here = (crew.cell, crew.level(odds, self.hotspots));
                    if odds.linked(here, (other.cell, other.level(odds, self.hotspots))) {
                        (crew.known, other.known, changed) = (union, union, true);
                    }
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use alloc::vec;
    use core::ops::Range;
    use std::println;

    use jcas_core::{Cell, Config, Model, Preset};

    use super::*;
    use crate::problem::Situation;
    use crate::rounds::charging::Charging;
    use crate::rounds::{Member, Team};
    use crate::targets::Targets;

    /// 1 / q(m) of the preset `mission`, θ = 3 and p = 0.15797555, by SciPy's `binom.sf(2, m, p)`.
    const WAITS: [(usize, f64); 2] = [(3, 253.647_382_600_491_3), (10, 4.977_144_196_312_413)];

    #[test]
    fn waits_agree_with_the_binomial_distribution() {
        with_hotspots(&[Cell { x: 9, y: 6 }], |problem, _| {
            let hazards = hazards(problem);
            for (uavs, wait) in WAITS {
                let quorum = 1.0 - libm::exp(-hazards[uavs]);
                assert!(
                    (1.0 / quorum / wait - 1.0).abs() < 1e-6,
                    "{uavs}: {}",
                    1.0 / quorum
                );
            }
        });
    }

    /// A team of ten that is three cells away senses the hotspot first in its third step.
    #[test]
    fn one_hotspot_takes_the_way_and_a_geometric_wait() {
        with_hotspots(&[Cell { x: 9, y: 6 }], |problem, hotspots| {
            let rounds = Rounds {
                teams: vec![team(problem, 0..10, Cell { x: 6, y: 6 }, 0)],
            };
            let samples = 20_000;
            let race = Race::new(problem, hotspots, samples, &mut Draws::new(3));
            let quorum = 1.0 - libm::exp(-race.hazard[10]);
            let spread = libm::sqrt((1.0 - quorum) / samples as f64) / quorum;
            let (steps, exact) = (
                race.times(&rounds, f64::INFINITY).expected.steps,
                2.0 + 1.0 / quorum,
            );
            println!("{steps} expected, {exact} exactly");
            assert!((steps - exact).abs() < 4.0 * spread, "{steps} {exact}");
        });
    }

    /// Two teams far apart each confirm a hotspot. Neither knows of the other's before they meet.
    #[test]
    fn knowledge_takes_radio_contact() {
        let hotspots = [Cell { x: 0, y: 6 }, Cell { x: 11, y: 6 }];
        with_hotspots(&hotspots, |problem, hotspots| {
            let rounds = Rounds {
                teams: vec![
                    team(problem, 0..5, hotspots[0], 0),
                    team(problem, 5..10, hotspots[1], 1),
                ],
            };
            let race = Race::new(problem, hotspots, 1, &mut Draws::new(1));
            // Both waits end in the first step.
            let (confirmed, ended) = race.run(race.begin(&rounds), &[0.0; 4]);
            assert_eq!(confirmed, Some(1));
            // Each flies toward the other's hotspot, at two cells a step, until they are linked.
            let reach = (0..12).rev().find(|&x| {
                problem
                    .odds
                    .linked((Cell { x, y: 0 }, 0), (Cell::default(), 0))
            });
            let apart = 11 - reach.unwrap();
            assert_eq!(ended, Some(1 + apart.div_ceil(2)));
        });
    }

    fn team(problem: &Problem<'_>, uavs: Range<usize>, cell: Cell, hotspot: usize) -> Team {
        let charge_uj = problem.model.energy().capacity_uj;
        let member = |uav| Member {
            uav,
            cell,
            charge_uj,
        };
        Team {
            members: uavs.map(member).collect(),
            first_step: 0,
            known: 0,
            route: vec![hotspot],
            charging: Charging::as_policies(problem.model),
        }
    }

    fn with_hotspots(hotspots: &[Cell], check: impl FnOnce(&Problem<'_>, &[Cell])) {
        let model = Model::new(Config {
            uav_count: 10,
            hotspot_count: hotspots.len() as u32,
            ..Config::preset(Preset::Mission)
        })
        .unwrap();
        let targets = Targets::known(&model, hotspots).unwrap();
        let problem = Problem::new(&model, &targets, Situation::at_reset(&model)).unwrap();
        check(&problem, hotspots);
    }
}
