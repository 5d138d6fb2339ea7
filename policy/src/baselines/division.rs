//! Divisions of hotspots among teams, and how long they are expected to take.

use core::f64::consts::{PI, SQRT_2};

use jcas_core::Cell;

use super::memory::{OutOfMemory, collect, push};

/// The maximum number of routes that are compared for one division.
const COMPARISONS_MAX: usize = 3000;

/// The least time, in steps, that a change of a route has to gain. Rounding gains less.
const GAIN_MIN: f64 = 1e-9;

/// UAVs in teams, each of which visits some hotspots one after the other.
pub(super) struct Division<'a> {
    hotspots: &'a [Cell],
    /// The teams.
    pub(super) teams: Vec<Team>,
}

/// A team on its way.
pub(super) struct Team {
    /// Its hotspots in the order of the visits. There is at least one.
    pub(super) route: Vec<usize>,
    /// The mean number of steps until a quorum detects a hotspot.
    wait: f64,
    spread: Spread,
}

/// When and where a team is done, in steps.
#[derive(Clone, Copy)]
struct Finish {
    mean: f64,
    /// The variance of the waits, which are geometric.
    variance: f64,
    cell: Cell,
}

impl<'a> Division<'a> {
    /// Forms a division whose teams go on to the nearest free hotspot.
    ///
    /// `sizes_and_firsts` has the size and the first hotspot of each team, and `team_of_uav` the
    /// team of each of `uavs`.
    pub(super) fn nearest_next(
        hotspots: &'a [Cell],
        uavs: &[Cell],
        team_of_uav: &[usize],
        sizes_and_firsts: impl Iterator<Item = (usize, Cell)>,
        wait: &impl Fn(usize) -> f64,
    ) -> Result<Self, OutOfMemory> {
        let mut free = collect(0..hotspots.len())?;
        let mut teams = Vec::new();
        let mut done = Vec::new();
        for (number, (size, first)) in sizes_and_firsts.enumerate() {
            let members = team_of_uav.iter().zip(uavs);
            let members = members.filter(|&(&team, _)| team == number);
            let spread = Spread::of(members.map(|(_, &cell)| cell));
            let mut route = Vec::new();
            // No insertion has to allocate afterwards.
            route.try_reserve_exact(hotspots.len())?;
            route.extend((0..hotspots.len()).find(|&hotspot| hotspots[hotspot] == first));
            free.retain(|&hotspot| hotspots[hotspot] != first);
            let wait = wait(size);
            push(&mut done, (spread.steps_to(first) + wait, first))?;
            let team = Team {
                route,
                wait,
                spread,
            };
            push(&mut teams, team)?;
        }
        while !free.is_empty() {
            let soonest = (0..done.len()).min_by(|&a, &b| done[a].0.total_cmp(&done[b].0));
            let Some(soonest) = soonest else { break };
            let (steps, here) = done[soonest];
            let nearest =
                (0..free.len()).min_by_key(|&index| here.manhattan(hotspots[free[index]]));
            let Some(nearest) = nearest else { break };
            let hotspot = free.swap_remove(nearest);
            let (team, cell) = (&mut teams[soonest], hotspots[hotspot]);
            done[soonest] = (steps + steps_between(here, cell) + team.wait, cell);
            team.route.push(hotspot);
        }
        Ok(Self { hotspots, teams })
    }

    /// Returns the step at which all is confirmed and the teams have met, if each wait takes its
    /// mean. The other teams fly to the team that is last.
    pub(super) fn steps(&self) -> f64 {
        let (last, finishes) = self.finishes();
        let met = finishes.map(|finish| finish.mean + steps_between(finish.cell, last.cell));
        met.fold(last.mean, f64::max)
    }

    /// Returns the expected step at which all is confirmed and the teams have met.
    ///
    /// The time of a team is taken for normal. The time of the last one follows from the mean and
    /// the variance of the greater of two normals (C. E. Clark, The greatest of a finite set of
    /// random variables, Operations Research 9, 1961).
    pub(super) fn expected_steps(&self) -> f64 {
        let (last, finishes) = self.finishes();
        let met = finishes.map(|finish| Finish {
            mean: finish.mean + steps_between(finish.cell, last.cell),
            ..finish
        });
        met.reduce(later).map_or(0.0, |finish| finish.mean)
    }

    /// Returns the team that is expected to be last, and the finishes of all teams.
    fn finishes(&self) -> (Finish, impl Iterator<Item = Finish>) {
        let finish = |team: &Team| team.finish(self.hotspots);
        let finishes = || self.teams.iter().map(finish);
        let last = finishes().max_by(|a, b| a.mean.total_cmp(&b.mean));
        let nothing = Finish {
            mean: 0.0,
            variance: 0.0,
            cell: Cell::default(),
        };
        (last.unwrap_or(nothing), finishes())
    }

    /// Changes routes as long as this shortens the expected time. Returns that time.
    ///
    /// A change moves a hotspot to another place, exchanges two, or reverses a part of a route.
    pub(super) fn improve(&mut self) -> f64 {
        let mut least = self.expected_steps();
        let mut left = COMPARISONS_MAX;
        while let Some(less) = self.shorten(least, &mut left) {
            least = less;
        }
        least
    }

    /// Makes the first change that shortens the expected time. Returns the time then.
    fn shorten(&mut self, least: f64, left: &mut usize) -> Option<f64> {
        for team in 0..self.teams.len() {
            for place in 0..self.teams[team].route.len() {
                if *left == 0 {
                    return None;
                }
                let less = self.reverse_from(team, place, least, left);
                let less = less.or_else(|| self.exchange(team, place, least, left));
                let less = less.or_else(|| self.shift(team, place, least, left));
                if less.is_some() {
                    return less;
                }
            }
        }
        None
    }

    /// Reverses a part of a route that begins at a place, if this is shorter.
    fn reverse_from(
        &mut self,
        team: usize,
        place: usize,
        least: f64,
        left: &mut usize,
    ) -> Option<f64> {
        for last in place + 1..self.teams[team].route.len() {
            self.teams[team].route[place..=last].reverse();
            if let Some(less) = self.is_shorter(least, left) {
                return Some(less);
            }
            self.teams[team].route[place..=last].reverse();
        }
        None
    }

    /// Exchanges a hotspot for one of a later team, if this is shorter.
    fn exchange(&mut self, team: usize, place: usize, least: f64, left: &mut usize) -> Option<f64> {
        for other in team + 1..self.teams.len() {
            for there in 0..self.teams[other].route.len() {
                self.swap((team, place), (other, there));
                if let Some(less) = self.is_shorter(least, left) {
                    return Some(less);
                }
                self.swap((team, place), (other, there));
            }
        }
        None
    }

    fn swap(&mut self, (team, place): (usize, usize), (other, there): (usize, usize)) {
        let [one, two] = [
            self.teams[team].route[place],
            self.teams[other].route[there],
        ];
        self.teams[team].route[place] = two;
        self.teams[other].route[there] = one;
    }

    /// Moves a hotspot to another place in its own or another route, if this is shorter.
    fn shift(&mut self, team: usize, place: usize, least: f64, left: &mut usize) -> Option<f64> {
        for other in 0..self.teams.len() {
            // Each team keeps a hotspot.
            if other != team && self.teams[team].route.len() < 2 {
                continue;
            }
            let hotspot = self.teams[team].route.remove(place);
            for there in 0..=self.teams[other].route.len() {
                self.teams[other].route.insert(there, hotspot);
                if let Some(less) = self.is_shorter(least, left) {
                    return Some(less);
                }
                self.teams[other].route.remove(there);
            }
            self.teams[team].route.insert(place, hotspot);
        }
        None
    }

    /// Returns the expected time if it is less, as long as comparisons are left.
    fn is_shorter(&self, least: f64, left: &mut usize) -> Option<f64> {
        *left = left.checked_sub(1)?;
        let steps = self.expected_steps();
        (steps < least - GAIN_MIN).then_some(steps)
    }
}

impl Team {
    /// Returns when and where the team is done.
    fn finish(&self, hotspots: &[Cell]) -> Finish {
        let mut finish = Finish {
            mean: 0.0,
            variance: 0.0,
            cell: Cell::default(),
        };
        for (place, &hotspot) in self.route.iter().enumerate() {
            let cell = hotspots[hotspot];
            let way = if place == 0 {
                self.spread.steps_to(cell)
            } else {
                steps_between(finish.cell, cell)
            };
            finish = Finish {
                mean: finish.mean + way + self.wait,
                variance: finish.variance + self.wait * (self.wait - 1.0),
                cell,
            };
        }
        finish
    }
}

fn steps_between(a: Cell, b: Cell) -> f64 {
    f64::from(a.manhattan(b))
}

/// Returns the mean and the variance of the greater of two independent normals.
fn later(a: Finish, b: Finish) -> Finish {
    let deviation = libm::sqrt(a.variance + b.variance);
    if deviation <= 0.0 {
        return if a.mean < b.mean { b } else { a };
    }
    let apart = (a.mean - b.mean) / deviation;
    let density = libm::exp(-apart * apart / 2.0) / libm::sqrt(2.0 * PI);
    let a_is_last = (1.0 + libm::erf(apart / SQRT_2)) / 2.0;
    let b_is_last = 1.0 - a_is_last;
    let mean = a.mean * a_is_last + b.mean * b_is_last + deviation * density;
    let square = |finish: Finish| finish.mean * finish.mean + finish.variance;
    let square =
        square(a) * a_is_last + square(b) * b_is_last + (a.mean + b.mean) * deviation * density;
    Finish {
        mean,
        variance: (square - mean * mean).max(0.0),
        ..a
    }
}

/// The spread of a team along both diagonals of the grid. The distance of the farthest member from
/// a cell follows from it.
struct Spread {
    sums: [i64; 2],
    differences: [i64; 2],
}

impl Spread {
    fn of(cells: impl Iterator<Item = Cell>) -> Self {
        let none = [i64::MAX, i64::MIN];
        let mut spread = Self {
            sums: none,
            differences: none,
        };
        for cell in cells {
            let [sum, difference] = diagonals(cell);
            spread.sums = [spread.sums[0].min(sum), spread.sums[1].max(sum)];
            let [least, most] = spread.differences;
            spread.differences = [least.min(difference), most.max(difference)];
        }
        spread
    }

    /// Returns the distance of the farthest member, 0 without any.
    fn steps_to(&self, cell: Cell) -> f64 {
        if self.sums[0] > self.sums[1] {
            return 0.0;
        }
        let [sum, difference] = diagonals(cell);
        let along = |[least, most]: [i64; 2], at: i64| (at - least).max(most - at);
        along(self.sums, sum).max(along(self.differences, difference)) as f64
    }
}

fn diagonals(cell: Cell) -> [i64; 2] {
    let (x, y) = (i64::from(cell.x), i64::from(cell.y));
    [x + y, x - y]
}

#[cfg(test)]
mod tests {
    use core::f64::consts::PI;

    use jcas_core::rng::{Purpose, bits64, unit};
    use proptest::prelude::*;

    use super::*;

    fn cell(x: u32, y: u32) -> Cell {
        Cell { x, y }
    }

    // Two teams of four at the depot, each with a wait of five steps.
    fn two_teams(hotspots: &[Cell], firsts: [Cell; 2]) -> Division<'_> {
        let uavs = [cell(10, 0); 8];
        let team_of_uav = [0, 0, 0, 0, 1, 1, 1, 1];
        let firsts = firsts.into_iter().map(|first| (4, first));
        Division::nearest_next(hotspots, &uavs, &team_of_uav, firsts, &|_| 5.0).unwrap()
    }

    // The greater of two standard normals has the mean 1/√π and the variance 1 - 1/π.
    #[test]
    fn the_greater_of_two_standard_normals() {
        let standard = Finish {
            mean: 0.0,
            variance: 1.0,
            cell: cell(0, 0),
        };
        let greater = later(standard, standard);
        assert!((greater.mean - 1.0 / PI.sqrt()).abs() < 1e-12);
        assert!((greater.variance - (1.0 - 1.0 / PI)).abs() < 1e-12);
        let sure = Finish {
            mean: 3.0,
            variance: 0.0,
            ..standard
        };
        let early = Finish { mean: 1.0, ..sure };
        assert_eq!(later(early, sure).mean, 3.0);
    }

    // From 10 the nearest next are 11, 8 and 18, after 14 steps. The best order takes 12 steps.
    #[test]
    fn a_route_is_shortened() {
        let hotspots = [cell(11, 0), cell(8, 0), cell(18, 0)];
        let firsts = core::iter::once((4, hotspots[0]));
        let mut division =
            Division::nearest_next(&hotspots, &[cell(10, 0); 4], &[0; 4], firsts, &|_| 5.0)
                .unwrap();
        assert_eq!(division.steps(), 14.0 + 15.0);
        assert_eq!(division.improve(), 12.0 + 15.0);
        assert_eq!(division.teams[0].route, [1, 0, 2]);
    }

    // Both teams begin on the right. The second one is sent to the left instead.
    #[test]
    fn hotspots_are_moved_between_teams() {
        let hotspots = [cell(20, 0), cell(22, 0), cell(0, 0), cell(2, 0)];
        let mut division = two_teams(&hotspots, [hotspots[0], hotspots[1]]);
        division.improve();
        let mut routes = division.teams.iter().map(|team| team.route.clone());
        let (mut first, mut second) = (routes.next().unwrap(), routes.next().unwrap());
        first.sort_unstable();
        second.sort_unstable();
        assert!([first, second].iter().any(|route| *route == [2, 3]));
    }

    // Waits are drawn for a hundred thousand episodes of three teams.
    #[test]
    fn the_expected_time_is_that_of_drawn_waits() {
        let hotspots = [
            cell(12, 0),
            cell(16, 0),
            cell(8, 0),
            cell(5, 0),
            cell(10, 7),
        ];
        let uavs = [cell(10, 0); 12];
        let team_of_uav: Vec<usize> = (0..12).map(|uav| uav / 4).collect();
        let firsts = [hotspots[0], hotspots[2], hotspots[4]];
        let firsts = firsts.into_iter().map(|first| (4, first));
        let division =
            Division::nearest_next(&hotspots, &uavs, &team_of_uav, firsts, &|_| 5.0).unwrap();
        let (last, finishes) = division.finishes();
        let finishes: Vec<Finish> = finishes.collect();
        let episodes = 100_000;
        let mut sum = 0.0;
        for episode in 0..episodes {
            let ends = finishes.iter().zip(&division.teams).zip(0..);
            let ends = ends.map(|((finish, team), number)| {
                let waits = (0..team.route.len() as u32).map(|visit| {
                    // A geometric wait with a mean of five steps.
                    let u = 1.0 - unit(bits64(episode, visit, number, 0, Purpose::Policy));
                    (u.ln() / 0.8f64.ln()).ceil().max(1.0)
                });
                let travel = finish.mean - 5.0 * team.route.len() as f64;
                travel + waits.sum::<f64>() + steps_between(finish.cell, last.cell)
            });
            sum += ends.fold(0.0, f64::max);
        }
        let drawn = sum / episodes as f64;
        let expected = division.expected_steps();
        assert!((expected / drawn - 1.0).abs() < 0.03, "{expected} {drawn}");
        // The mean of the latest is later than the latest mean.
        assert!(
            division.steps() < 0.95 * drawn,
            "{} {drawn}",
            division.steps()
        );
    }

    proptest! {
        #[test]
        fn the_farthest_member_is_found(
            members in prop::collection::vec((0u32..64, 0u32..64), 1..9),
            to in (0u32..64, 0u32..64),
        ) {
            let members: Vec<Cell> = members.into_iter().map(|(x, y)| cell(x, y)).collect();
            let to = cell(to.0, to.1);
            let farthest = members.iter().map(|member| member.manhattan(to)).max().unwrap();
            let spread = Spread::of(members.into_iter());
            prop_assert_eq!(spread.steps_to(to), f64::from(farthest));
        }

        #[test]
        fn improving_keeps_each_hotspot_in_one_route(
            hotspots in prop::collection::hash_set((0u32..16, 0u32..16), 2..9),
        ) {
            let hotspots: Vec<Cell> = hotspots.into_iter().map(|(x, y)| cell(x, y)).collect();
            let mut division = two_teams(&hotspots, [hotspots[0], hotspots[1]]);
            let before = division.expected_steps();
            prop_assert!(division.improve() <= before);
            let mut visited: Vec<usize> =
                division.teams.iter().flat_map(|team| team.route.iter().copied()).collect();
            prop_assert!(division.teams.iter().all(|team| !team.route.is_empty()));
            visited.sort_unstable();
            prop_assert!(visited.into_iter().eq(0..hotspots.len()));
        }
    }
}
