//! Initial trajectories for known hotspots: teams that fly from hotspot to hotspot.

use alloc::vec;
use alloc::vec::Vec;

use jcas_core::Cell;

use crate::formation::Recorder;
use crate::paths::Paths;
use crate::problem::Problem;

/// The hover times that are tried, as multiples of the expected time to a quorum.
const HOVERS: [f64; 4] = [0.0, 0.5, 1.0, 2.0];
/// The maximum number of teams.
const TEAMS_MAX: usize = 8;

/// The maximum number of tours.
pub(crate) const TOURS_MAX: usize = TEAMS_MAX * HOVERS.len();

/// A team on its tour.
struct Team {
    /// The cell where the team is next free, and the step after which it is.
    cell: Cell,
    free_at: u32,
    /// The cells that the team hovers in, each until a step.
    errands: Vec<(Cell, u32)>,
}

/// Returns tours of one to several teams, with several hover times, sensing at a level. It is empty
/// if no hotspot is known.
pub(crate) fn tours(problem: &Problem<'_>, level: u8) -> Vec<Paths> {
    let known = &problem.known;
    if known.is_empty() {
        return Vec::new();
    }
    let quorum = problem.model.config().quorum as usize;
    let uavs = problem.situation.cells.len();
    let most = (uavs / quorum).max(1).min(known.len()).min(TEAMS_MAX);
    let mut tours = Vec::new();
    for teams in 1..=most {
        for hover in HOVERS {
            tours.push(tour(problem, known, teams, hover, level));
        }
    }
    tours
}

/// Makes one tour. The team that is free first takes the hotspot that it reaches first. When none
/// is left, all are visited again.
fn tour(problem: &Problem<'_>, known: &[Cell], teams: usize, hover: f64, level: u8) -> Paths {
    let uavs = problem.situation.cells.len();
    let team_of = |uav: usize| uav * teams / uavs;
    let starts = &problem.situation.cells;
    let mut fleet: Vec<Team> = (0..teams)
        .map(|team| Team {
            cell: starts[(team * uavs).div_ceil(teams)],
            free_at: 0,
            errands: Vec::new(),
        })
        .collect();
    let mut open = known.to_vec();
    let steps = problem.steps as u32;
    while let Some(free) = (0..teams).min_by_key(|&team| fleet[team].free_at) {
        if fleet[free].free_at >= steps {
            break;
        }
        if open.is_empty() {
            open = known.to_vec();
        }
        let here = fleet[free].cell;
        let Some(next) = (0..open.len()).min_by_key(|&index| here.manhattan(open[index])) else {
            break;
        };
        let target = open.swap_remove(next);
        let members = (0..uavs).filter(|&uav| team_of(uav) == free).count();
        let wait = libm::round(hover * steps_to_quorum(problem, members)).min(f64::from(steps));
        // At least one step passes, so that the loop ends.
        let until = fleet[free].free_at + here.manhattan(target).max(1) + wait as u32;
        let team = &mut fleet[free];
        team.errands.push((target, until));
        team.cell = target;
        team.free_at = until;
    }
    let mut recorder = Recorder::new(problem, level);
    let mut next = vec![0; teams];
    for step in 1..=steps {
        for (team, next) in fleet.iter().zip(&mut next) {
            while *next + 1 < team.errands.len() && team.errands[*next].1 < step {
                *next += 1;
            }
        }
        recorder.fly(|uav| fleet[team_of(uav)].errands[next[team_of(uav)]].0);
    }
    recorder.finish()
}

/// Returns the expected steps until a team in the hotspot's cell has a quorum of positives in one
/// step.
fn steps_to_quorum(problem: &Problem<'_>, members: usize) -> f64 {
    let odds = &problem.odds;
    let here = Cell::default();
    let p = odds.detection(odds.highest(), here, here);
    let quorum = problem.model.config().quorum as usize;
    let mut exactly = vec![0.0; quorum];
    exactly[0] = 1.0;
    for _ in 0..members {
        for k in (1..quorum).rev() {
            exactly[k] = exactly[k] * (1.0 - p) + exactly[k - 1] * p;
        }
        exactly[0] *= 1.0 - p;
    }
    let chance = 1.0 - exactly.iter().sum::<f64>();
    1.0 / f64::max(chance, 1e-6)
}
