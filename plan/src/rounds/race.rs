//! Sampled episodes of rounds, which differ in the waits for a quorum.

use alloc::vec::Vec;

use jcas_core::Cell;
use jcas_core::motion::{destination, toward};

use super::{HOTSPOTS_MAX, Rounds, Team};
use crate::draws::Draws;
use crate::objective::{Expectation, hazard};
use crate::odds::Odds;
use crate::problem::Problem;

/// Samples of the waits, by which rounds are compared.
pub(super) struct Race<'p, 'm> {
    problem: &'p Problem<'m>,
    hotspots: &'p [Cell],
    /// -ln(1 - q(m)) of m UAVs.
    pub(super) hazard: Vec<f64>,
    /// -ln(U) of each sample and hotspot.
    limits: Vec<f64>,
}

/// Returns -ln(1 - q(m)) for each number m of UAVs over a hotspot.
pub(super) fn hazards(problem: &Problem<'_>) -> Vec<f64> {
    let (odds, here) = (&problem.odds, Cell::default());
    let p = odds.detection(odds.highest(), here, here);
    let quorum = problem.model.config().quorum as usize;
    let uavs = problem.situation.cells.len();
    (0..=uavs).map(|uavs| hazard(quorum, uavs, p)).collect()
}

/// A team in a sampled episode.
struct Runner<'t> {
    team: &'t Team,
    cell: Cell,
    known: u64,
    /// The hotspot that the team flies to or stays at, and the sum of its waits there.
    target: Option<usize>,
    waited: f64,
}

impl Runner<'_> {
    /// Turns to the next hotspot of the round, then to the nearest one not known. A team that knows
    /// all flies to the first team that does not.
    fn turn(&mut self, hotspots: &[Cell]) {
        let open = |hotspot: usize| self.known >> hotspot & 1 == 0;
        if self.target.is_some_and(open) {
            return;
        }
        let next = self
            .team
            .route
            .iter()
            .copied()
            .find(|&hotspot| open(hotspot));
        let nearest = || {
            let left = (0..hotspots.len()).filter(|&hotspot| open(hotspot));
            left.min_by_key(|&hotspot| self.cell.manhattan(hotspots[hotspot]))
        };
        self.target = next.or_else(nearest);
        self.waited = 0.0;
    }

    fn level(&self, odds: &Odds, hotspots: &[Cell]) -> u8 {
        match self.target {
            Some(hotspot) if self.cell == hotspots[hotspot] => odds.highest(),
            _ => 0,
        }
    }
}

impl<'p, 'm> Race<'p, 'm> {
    pub(super) fn new(
        problem: &'p Problem<'m>,
        hotspots: &'p [Cell],
        samples: usize,
        draws: &mut Draws,
    ) -> Self {
        let limits = (0..samples * hotspots.len())
            .map(|_| -libm::log(draws.unit()))
            .collect();
        Self {
            problem,
            hotspots,
            hazard: hazards(problem),
            limits,
        }
    }

    /// Returns the mean time over the samples.
    pub(super) fn expect(&self, rounds: &Rounds) -> Expectation {
        let mut expected = Expectation::default();
        let samples = self.limits.chunks_exact(self.hotspots.len());
        let share = 1.0 / samples.len() as f64;
        for limits in samples {
            let (confirmed, ended) = self.run(rounds, limits);
            let left = self.problem.steps_left;
            expected.confirmed_steps += share * f64::from(confirmed.unwrap_or(left));
            expected.steps += share * f64::from(ended.unwrap_or(left));
            expected.success += share * f64::from(u8::from(ended.is_some()));
        }
        expected
    }

    /// Flies one sample. Returns the steps from now until all is confirmed, and until the end.
    fn run(&self, rounds: &Rounds, limits: &[f64]) -> (Option<u32>, Option<u32>) {
        let now = self.problem.situation.step;
        let all = u64::MAX >> (HOTSPOTS_MAX - self.hotspots.len());
        let mut runners: Vec<Runner<'_>> = rounds
            .teams
            .iter()
            .map(|team| Runner {
                team,
                cell: team.cell,
                known: team.known,
                target: None,
                waited: 0.0,
            })
            .collect();
        let first = rounds.teams.iter().map(|team| team.first_step).min();
        let mut confirmed = None;
        for step in first.unwrap_or(now)..now + self.problem.steps_left {
            self.fly(&mut runners, step);
            self.look(&mut runners, step, limits);
            if step < now {
                continue;
            }
            self.share(&mut runners);
            let passed = step + 1 - now;
            let union = runners.iter().fold(0, |union, runner| union | runner.known);
            if union == all && confirmed.is_none() {
                confirmed = Some(passed);
            }
            if runners.iter().all(|runner| runner.known == all) {
                return (confirmed, Some(passed));
            }
        }
        (confirmed, None)
    }

    fn fly(&self, runners: &mut [Runner<'_>], step: u32) {
        let config = self.problem.model.config();
        for index in 0..runners.len() {
            if runners[index].team.first_step > step {
                continue;
            }
            runners[index].turn(self.hotspots);
            let known = runners[index].known;
            let unaware = || runners.iter().find(|other| other.known & known != known);
            let target = match runners[index].target {
                Some(hotspot) => self.hotspots[hotspot],
                None => unaware().map_or(runners[index].cell, |other| other.cell),
            };
            let runner = &mut runners[index];
            let motion = toward(runner.cell, target);
            runner.cell = destination(runner.cell, motion, config.grid_width, config.grid_height);
        }
    }

    fn look(&self, runners: &mut [Runner<'_>], step: u32, limits: &[f64]) {
        for index in 0..runners.len() {
            let Some(hotspot) = runners[index].target else {
                continue;
            };
            let cell = self.hotspots[hotspot];
            if runners[index].cell != cell || runners[index].team.first_step > step {
                continue;
            }
            let there =
                |runner: &&Runner<'_>| runner.cell == cell && runner.target == Some(hotspot);
            let uavs = runners
                .iter()
                .filter(there)
                .map(|runner| runner.team.members.len())
                .sum::<usize>();
            let runner = &mut runners[index];
            runner.waited += self.hazard[uavs];
            if runner.waited >= limits[hotspot] {
                runner.known |= 1 << hotspot;
            }
        }
    }

    /// Lets linked teams share what they know, until nothing is new.
    fn share(&self, runners: &mut [Runner<'_>]) {
        let odds = &self.problem.odds;
        let mut changed = true;
        while changed {
            changed = false;
            for a in 1..runners.len() {
                let (before, rest) = runners.split_at_mut(a);
                for other in before {
                    let runner = &mut rest[0];
                    let union = runner.known | other.known;
                    if runner.known == other.known {
                        continue;
                    }
                    let here = (runner.cell, runner.level(odds, self.hotspots));
                    if odds.linked(here, (other.cell, other.level(odds, self.hotspots))) {
                        (runner.known, other.known, changed) = (union, union, true);
                    }
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use alloc::vec;
    use std::println;

    use jcas_core::{Cell, Config, Model, Preset};

    use super::*;
    use crate::problem::Situation;
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
                teams: vec![Team {
                    members: (0..10).collect(),
                    cell: Cell { x: 6, y: 6 },
                    first_step: 0,
                    known: 0,
                    route: vec![0],
                }],
            };
            let samples = 20_000;
            let race = Race::new(problem, hotspots, samples, &mut Draws::new(3));
            let quorum = 1.0 - libm::exp(-race.hazard[10]);
            let spread = libm::sqrt((1.0 - quorum) / samples as f64) / quorum;
            let (steps, exact) = (race.expect(&rounds).steps, 2.0 + 1.0 / quorum);
            println!("{steps} expected, {exact} exactly");
            assert!((steps - exact).abs() < 4.0 * spread, "{steps} {exact}");
        });
    }

    /// Two teams far apart each confirm a hotspot. Neither knows of the other's before they meet.
    #[test]
    fn knowledge_takes_radio_contact() {
        let hotspots = [Cell { x: 0, y: 6 }, Cell { x: 11, y: 6 }];
        with_hotspots(&hotspots, |problem, hotspots| {
            let team = |members: core::ops::Range<usize>, hotspot: usize| Team {
                members: members.collect(),
                cell: hotspots[hotspot],
                first_step: 0,
                known: 0,
                route: vec![hotspot],
            };
            let rounds = Rounds {
                teams: vec![team(0..5, 0), team(5..10, 1)],
            };
            let race = Race::new(problem, hotspots, 1, &mut Draws::new(1));
            // Both waits end in the first step.
            let (confirmed, ended) = race.run(&rounds, &[0.0, 0.0]);
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
